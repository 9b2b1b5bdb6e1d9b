// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/core/vec.h"
#include "c3de/scene/scene_file.h"
#include "c3de/session/landmark_file.h"

namespace c3de::session {

/// A material point that is followed, in the frame of the simulation, whose axes are LPS.
struct Landmark {
  std::string name;
  std::string body;  ///< empty: not known yet, or in no body, so that it does not move
  Vec3 at_m{}, reference_mm{};
  std::optional<Vec3> target_mm;
  std::string where;  ///< prefix of messages: its file and line
};

/// Landmarks of the scene, then those of the files. Errors: those of readLandmarks(); ErrorCode::input for a name that
/// two landmarks have, and for a target whose name no landmark has.
/// @param targets  files of targets, which replace the targets of the scene
[[nodiscard]] Expected<std::vector<Landmark>> landmarksOf(const scene::SceneFile &scene,
                                                          const std::vector<std::filesystem::path> &files,
                                                          const std::vector<std::filesystem::path> &targets);

/// Sets the targets of landmarks by name and removes those of all others. Errors (ErrorCode::input): a name
/// that no landmark has; the targets are then incomplete.
[[nodiscard]] Expected<void> setTargets(std::span<const FileLandmark> targets, std::vector<Landmark> &landmarks);

/// Determines the body of each landmark from the reference skins: the one that it names (of pieces, the nearest), or
/// else the one in which it lies, or the nearest within its spacing. A landmark without a body does not move. The error
/// (ErrorCode::input) refers to a landmark whose named body the simulator cannot follow there. Call on the thread that
/// steps the simulator, between two steps.
/// @param takeError  returns the text of the last failed call; may be empty
[[nodiscard]] Expected<void> findBodies(c3de_object *simulator, const scene::SceneFile &scene,
                                        std::vector<Landmark> &landmarks,
                                        const std::function<std::string()> &takeError);

/// The positions at rest of material points that are at the given positions now, mm, in their order. A position in no
/// body, nor within its spacing, does not move. A point that the simulator cannot follow keeps the displacement of the
/// nearest point of the skin. Call on the thread that steps the simulator, between two steps.
[[nodiscard]] Expected<std::vector<Vec3>> referencesOf(c3de_object *simulator, const std::vector<Vec3> &now_mm,
                                                       const std::function<std::string()> &takeError);

struct MeasuredLandmark {
  Landmark landmark;
  Vec3 position_mm{};
  [[nodiscard]] double displacement_mm() const { return norm(position_mm - landmark.reference_mm); }
  /// Distance to the target at rest and now; the landmark has one.
  [[nodiscard]] double errorBefore_mm() const { return norm(landmark.reference_mm - *landmark.target_mm); }
  [[nodiscard]] double errorAfter_mm() const { return norm(position_mm - *landmark.target_mm); }
};

struct MeasuredDistance {
  std::string name;
  std::array<std::string, 2> between;
  double reference_mm = 0.0, now_mm = 0.0;
};

struct MeasuredAngle {
  std::string name;
  std::array<std::string, 3> at;
  std::optional<double> reference_deg, now_deg;  ///< 0 … 180; none: two of the landmarks coincide
};

/// Of the errors of all landmarks with a target.
struct ErrorSummary {
  double mean_mm = 0.0, max_mm = 0.0;
  std::optional<double> sd_mm;  ///< of the sample (n - 1); none: one landmark
};

/// @param errors_mm  at least one
[[nodiscard]] ErrorSummary summaryOf(const std::vector<double> &errors_mm);

struct Measurements {
  std::vector<MeasuredLandmark> landmarks;
  std::vector<MeasuredDistance> distances;
  std::vector<MeasuredAngle> angles;
};

/// The present positions, which follow the displacement field of the simulator at the material point, and what is
/// measured between them. Call on the thread that steps the simulator, between two steps.
[[nodiscard]] Expected<Measurements> measure(c3de_object *simulator, const scene::SceneFile &scene,
                                             const std::vector<Landmark> &landmarks,
                                             const std::function<std::string()> &takeError);

/// Errors at rest and now; none: no landmark has a target.
[[nodiscard]] std::optional<std::array<ErrorSummary, 2>> landmarkErrors(const Measurements &measurements);

/// What was measured, for people: a line each.
[[nodiscard]] std::vector<std::string> measurementLines(const Measurements &measurements);

}  // namespace c3de::session
