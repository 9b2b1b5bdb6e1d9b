// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/core/thread_pool.h"
#include "c3de/geometry/mesh_formats.h"
#include "c3de/registration/rigid_registration.h"
#include "c3de/scene/scene_file.h"
#include "c3de/session/body_match.h"
#include "c3de/session/body_sources.h"
#include "c3de/session/measurements.h"

namespace c3de::session {

/// What was measured, as points.
struct MatchTargets {
  std::filesystem::path file;
  registration::MeasuredSurface surface;  ///< without landmarks
  std::vector<std::string> notices;       ///< about the file
};

/// Reads the points, surface or label of a match. Surfaces become kTargetSamples points with normals. Errors
/// (ErrorCode::input) name the file, and for tables the line. Any thread.
/// @param sources  reads label maps
[[nodiscard]] Expected<MatchTargets> readMatchTargets(const scene::SceneMatch &match,
                                                      const geometry::MeshFormats &formats, BodySources &sources,
                                                      const ProgressFn &progress);
/// Number of points that represent a measured surface.
inline constexpr std::size_t kTargetSamples = 1500;

struct MatchedLandmark {
  std::string name;
  bool isFitted = false;                         ///< false: it only judges
  Vec3 reference_mm{}, rigid_mm{}, target_mm{};  ///< at rest, after the rigid motion, measured; LPS
  [[nodiscard]] double errorBefore_mm() const { return norm(reference_mm - target_mm); }
  [[nodiscard]] double errorRigid_mm() const { return norm(rigid_mm - target_mm); }
};

/// A body after the rigid motion to what was measured.
struct RigidMatch {
  std::string body;
  std::filesystem::path file;
  double noise_mm = 0.0;
  bool isGiven = false;  ///< the motion is the identity, by the scene
  std::size_t points = 0;
  registration::RigidRegistration rigid;
  double rmsBefore_mm = 0.0;  ///< of the points that are inliers after the motion, with the body at rest
  std::vector<MatchedLandmark> landmarks;
  std::optional<ErrorSummary> before, after;  ///< of all landmarks; none: there are none
  double wall_s = 0.0;

  /// Whether the motion can be used: found, or with a residual that the noise does not explain.
  [[nodiscard]] bool isUsable() const {
    return rigid.verdict == registration::RegistrationVerdict::found ||
           rigid.verdict == registration::RegistrationVerdict::unexplained;
  }
};

/// The rigid part of a match. Errors (ErrorCode::input) name the file of what was measured; ErrorCode::cancelled.
/// @param skin       of the body at rest, LPS mm
/// @param landmarks  those with a target take part
[[nodiscard]] Expected<RigidMatch> matchRigid(const geometry::TriangleMesh &skin, const MatchTargets &targets,
                                              const std::vector<Landmark> &landmarks, const scene::SceneMatch &match,
                                              ThreadPool *pool, const ProgressFn &progress);

/// The body where it is at rest, as a match without a rigid motion. Errors as of matchRigid().
[[nodiscard]] Expected<RigidMatch> matchInPlace(const geometry::TriangleMesh &skin, const MatchTargets &targets,
                                                const std::vector<Landmark> &landmarks, const scene::SceneMatch &match,
                                                ThreadPool *pool);

/// The body after its deformation, at the rigid motion.
struct ElasticMatch {
  std::optional<BodyMatch> body;      ///< none: not requested, or `failure`
  std::string failure;                ///< why there is none; the rigid motion remains valid
  std::vector<Vec3> landmarks_mm;     ///< of RigidMatch::landmarks, in their order, where they were measured
  std::optional<ErrorSummary> after;  ///< of all landmarks; none: there are none
  double wall_s = 0.0;
};

/// Where landmarks of the simulation are after the rigid motion, and their errors.
/// @param at_mm  present positions of the landmarks with a target, in the order of RigidMatch::landmarks
void addLandmarks(const RigidMatch &match, std::vector<Vec3> at_mm, ElasticMatch &out);

/// "found", "unexplained", "ambiguous", "refused", or "given".
[[nodiscard]] std::string verdictOf(const RigidMatch &match);
/// Why the deformation should not be trusted: sentences with values.
[[nodiscard]] std::vector<std::string> warningsOf(const ElasticMatch &elastic);
/// "1.2 ± 0.3 mm, at most 2".
[[nodiscard]] std::string errorText(const ErrorSummary &errors);
/// The match with another of its candidates as the motion, which a person has chosen; the verdict stays. Errors
/// (usage):
/// no such candidate.
/// @param skin  of the body at rest
[[nodiscard]] Expected<RigidMatch> withCandidate(const RigidMatch &match, std::size_t candidate,
                                                 const geometry::TriangleMesh &skin, const MatchTargets &targets,
                                                 ThreadPool *pool);

/// `match` of a report.
[[nodiscard]] std::string matchJson(const RigidMatch &match, const ElasticMatch &elastic);
/// For people: a line each.
[[nodiscard]] std::vector<std::string> matchLines(const RigidMatch &match, const ElasticMatch &elastic);
/// A table of the measured points with their distances before, after the motion, and after the deformation, CSV.
[[nodiscard]] std::string residualTable(const MatchTargets &targets, const RigidMatch &match,
                                        const ElasticMatch &elastic);

}  // namespace c3de::session
