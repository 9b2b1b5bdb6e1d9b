// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/core/thread_pool.h"
#include "c3de/core/vec.h"
#include "c3de/geometry/triangle_mesh.h"

namespace c3de::registration {

/// A point of the body at rest and where it was measured.
struct LandmarkPair {
  Vec3 body_mm{}, measured_mm{};
};

/// What was measured on the surface of a body. Missing and false parts are allowed.
struct MeasuredSurface {
  std::vector<Vec3> points_mm;
  std::vector<Vec3> normals;        ///< unit; empty: not measured, otherwise one per point
  bool areNormalsOriented = false;  ///< they point outwards; false: the sign has no meaning
  std::vector<LandmarkPair> pairs;  ///< fitted as well; may be empty
};

struct RegistrationOptions {
  double noise_mm = 1.0;           ///< > 0: standard deviation of the distance from a point to the surface
  double pointsPerPair = 10.0;     ///< > 0: how many points a landmark pair counts as
  std::size_t mostCandidates = 8;  ///< >= 1
};

/// Minimum number of different points: twice the unknowns of a rigid motion.
inline constexpr std::size_t kFewestSurfacePoints = 12;

struct RegistrationCandidate {
  Mat4 measuredFromBody = kIdentity4;  ///< rotation with determinant 1, and translation
  double rms_mm = 0.0;                 ///< of the distances of the inliers to the surface
  double inlierShare = 0.0;            ///< 0 … 1: points nearer than Residuals::limit_mm of the best candidate
};

/// Distances of all points to the moved surface.
struct Residuals {
  std::vector<double> distance_mm;  ///< in the order of the points, at least 0
  double limit_mm = 0.0;            ///< a point that is farther is an outlier
  double rms_mm = 0.0;              ///< of the inliers
  double inlierShare = 0.0;         ///< 0 … 1
  double p95_mm = 0.0;              ///< 95th percentile of all distances
};

enum class RegistrationVerdict {
  found,        ///< one motion, and the noise explains the residual
  unexplained,  ///< one motion, but its residual is larger than the noise: the body has another shape now
  ambiguous,    ///< several motions fit equally well, or some part of the motion is not determined
  refused       ///< no motion is credible; the warnings say why
};
[[nodiscard]] const char *nameOf(RegistrationVerdict verdict);  ///< "found", "unexplained", "ambiguous", "refused"

struct RigidRegistration {
  RegistrationVerdict verdict = RegistrationVerdict::refused;
  Mat4 measuredFromBody = kIdentity4;  ///< of the best candidate
  Residuals before, after;             ///< with the body at rest, and after the motion; same limit
  /// 0 … 1: share of the area of the body near which points were measured
  double coverage = 0.0;
  /// Root mean square over the body's surface of the expected error of the motion: the larger of what noise and
  /// coverage give, and of how differently halves of the points move the body. A change of shape is not in it.
  double motionError_mm = 0.0;
  /// The best, then those whose residual cannot be distinguished from it; at least one
  std::vector<RegistrationCandidate> candidates;
  std::vector<std::string> warnings;  ///< sentences with values
};

/// The rigid motion that brings the surface of a body to points measured on it. No initial position is needed: some
/// 220 000 motions (anchors on both surfaces, uniform rotations) are rated with a truncated distance, the best
/// are refined by point-to-plane iterations with decreasing weights for far points (iterative closest points: Besl and
/// McKay 1992, Chen and Medioni 1992; reweighted with Tukey's function). A reflection is never the result. The result
/// is the same for any number of threads.
///
/// Half of the points may be outliers. A result is only `found` if the noise explains its residual and no other motion
/// does as well.
///
/// @param body      its closed surface, mm; an open one is accepted with a warning
/// @param pool      null: one thread
/// @param progress  called on the calling thread
/// Errors (usage) state value and what is accepted: a body without area, noise that is not above 0, fewer than
/// kFewestSurfacePoints different points, coordinates that are not finite, normals of another count, points whose
/// extent shows another unit than mm. ErrorCode::cancelled if `progress` returned false. Any thread.
[[nodiscard]] Expected<RigidRegistration> registerRigid(const geometry::TriangleMesh &body,
                                                        const MeasuredSurface &measured,
                                                        const RegistrationOptions &options, ThreadPool *pool = nullptr,
                                                        const ProgressFn &progress = {});

/// Residuals of points against the surface of a body after a given motion, without a fit. Errors as for
/// registerRigid(). @param limit_mm  see Residuals
[[nodiscard]] Expected<Residuals> residualsOf(const geometry::TriangleMesh &body, const std::vector<Vec3> &points_mm,
                                              const Mat4 &measuredFromBody, double limit_mm,
                                              ThreadPool *pool = nullptr);

}  // namespace c3de::registration
