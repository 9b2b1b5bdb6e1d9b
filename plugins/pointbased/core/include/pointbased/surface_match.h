// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "pointbased/constitution.h"
#include "pointbased/elastic_foundation.h"
#include "pointbased/rest_state.h"
#include "pointbased/stop_request.h"

namespace pointbased {

/// A measured point of the surface of the moved body.
struct MatchPoint {
  Vec3 position = Vec3::Zero();  ///< m, in the space of the measurement
  Vec3 normal = Vec3::Zero();    ///< unit, outwards; zero: not known
};

/// A material point whose moved position was measured. Landmarks are not weighted robustly:
/// SurfaceMatchResult::landmarkErrors shows a false one.
struct MatchLandmark {
  Vec3 reference = Vec3::Zero();  ///< at rest, world, m
  Vec3 position = Vec3::Zero();   ///< m, in the space of the measurement
  double noise = 0.0;             ///< m, standard deviation per axis; 0: that of the points
};

/// Motion from the world of the body to the space of the measurement: y = R x + t.
struct MatchMotion {
  Mat3 rotation = Mat3::Identity();
  Vec3 translation = Vec3::Zero();  ///< m
  [[nodiscard]] Vec3 of(const Vec3 &x) const { return rotation * x + translation; }
  [[nodiscard]] Vec3 inverse(const Vec3 &y) const { return rotation.transpose() * (y - translation); }
};

struct SurfaceMatchProgress {
  int iteration = 0, maxIterations = 0;
  double distance = 0.0;                ///< m, root mean square of the distances to the skin, by robust weights
  std::span<const Vec3> displacements;  ///< [phyxels] m
  MatchMotion motion;
};

struct SurfaceMatchSettings {
  double noise = 1e-3;             ///< m, > 0: standard deviation of a point across the surface
  MatchMotion start;               ///< rigid motion from which the match starts
  bool isMotionKnown = false;      ///< `start` is exact and remains
  double largestAngle_deg = 75.0;  ///< 0 … 180: between the normals of a point and of the skin near it
  int maxIterations = 40;          ///< >= 1, of the loads, and as many of the springs
  /// Whether expectedErrors and isUnknown are computed.
  bool findsExpectedErrors = true;
  const StopRequest *stop = nullptr;
  /// Called in each iteration on the calling thread; false: cancelled.
  std::function<bool(const SurfaceMatchProgress &)> progress;
};

struct SurfaceMatchResult {
  MatchMotion motion, rigid;           ///< found; and the best one without deformation, from which it started
  std::vector<Vec3> displacements;     ///< [phyxels] u, m, in the world of the body, before `motion`
  std::vector<Vec3> forces;            ///< [phyxels] N, found; with them the displacements are an equilibrium
  std::vector<Vec3> closest;           ///< [points] m, on the moved skin, in the space of the measurement
  std::vector<double> distances;       ///< [points] m, to the moved skin; infinite: no part of the skin faces it
  std::vector<double> weights;         ///< [points] 0 … 1: 0: an outlier
  std::vector<double> landmarkErrors;  ///< [landmarks] m
  double distanceAtStart = 0.0, distanceRigid = 0.0, distance = 0.0;  ///< m, root mean square by robust weights
  /// [phyxels] m, expected error of the moved position (root mean square of its length), from noise, coverage, motion,
  /// the loads that are expected a priori, what springs have changed and what remains unexplained. Errors of the
  /// material are not in it. Empty: not requested.
  std::vector<double> expectedErrors;
  std::vector<std::uint8_t> isUnknown;  ///< [phyxels] 1: the measurement hardly determines it
  double usedPart = 0.0;                ///< part of the points with a weight above a half
  int iterations = 0;                   ///< rounds of closest points
  double stiffness = 0.0;               ///< N/m, τ/σ² of a point; 0: loads alone explain the distances
  bool hasConverged = false;
};

/// The inverse problem of a partly seen surface: finds loads f and the rigid motion (R, t) after which the skin of the
/// body in equilibrium meets measured points and landmarks.
///
///     minimise  Σ_i w_i |n_i · (y_i - R x_i(u) - t)|² / (2 σ²)  +  |q|² / (2 s²),
///     u the response to Σ q_p B_p
///
/// The loads B_p are smooth tractions around sites of the skin, a uniform body force, and the tractions of uniform
/// stresses. They rotate with the body, so that u may be large: the gradients of the shape are close to exponentials
/// of the rotations and strains of the linear response. Their size s is unknown and follows from the marginal
/// likelihood, so that the size of Young's modulus cancels. Amplitudes q and motion follow together from Gauss-Newton
/// steps. Closest points, normals and the weights w (Huber's, in the end Tukey's) are found anew in each iteration.
///
/// The forces found hold the shape in equilibrium. Where smooth loads leave distances above the noise, springs between
/// points and skin are added. Their stiffness τ/σ² increases until the distances are those of the noise.
///
/// Limitation: if the motion is unknown, only the deformation of the seen part is measured. That of other parts is
/// expected from it and has large expected errors. If a tracked frame or bone determines the motion, pass it.
///
/// The body keeps its fixes and loads; materials respond without flow and relaxation. Not for clinical use.
/// @threads one at a time; bitwise identical for any number behind parallelFor
/// @source  MacKay, Bayesian interpolation, Neural Computation 4, 1992 (size of the loads); Morozov, Methods for
///          Solving Incorrectly Posed Problems, 1984 (discrepancy principle); Huber, Robust Statistics, 1981;
///          Tarantola, Inverse Problem Theory, 2005, ch. 3 (covariance of the result); Huang et al., IEEE TVCG 17, 2011
///          (rotation-strain coordinates)
class SurfaceMatch {
 public:
  /// Errors: no skin; a foundation that validate() refuses; nothing holds the body (a fix, or a foundation with both
  /// stiffnesses); a pressure that follows the surface; no equilibrium without further forces; "cancelled".
  [[nodiscard]] static Result<SurfaceMatch> create(std::shared_ptr<const RestState> rest,
                                                   const Constitution &constitution, const Foundation &foundation,
                                                   const ParallelFor &parallelFor, const StopRequest *stop = nullptr);
  ~SurfaceMatch();
  SurfaceMatch(SurfaceMatch &&) noexcept;
  SurfaceMatch &operator=(SurfaceMatch &&) noexcept;

  /// Starts from the loads and the τ of the previous match, if there was one (frames of a sequence).
  /// Errors: a position, normal or setting that is not finite or out of range, with its index and value; fewer than
  /// three points and landmarks together; no point that faces the skin; an unstable equilibrium without further forces;
  /// "cancelled".
  [[nodiscard]] Result<SurfaceMatchResult> match(std::span<const MatchPoint> points,
                                                 std::span<const MatchLandmark> landmarks,
                                                 const SurfaceMatchSettings &settings);
  /// Returns to the body without further forces.
  void reset();

 private:
  struct Impl;
  explicit SurfaceMatch(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace pointbased
