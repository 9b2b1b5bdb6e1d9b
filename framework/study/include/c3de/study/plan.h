// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "c3de/scene/scene_file.h"
#include "c3de/session/session.h"
#include "c3de/study/study_file.h"
#include "c3de/study/study_parameters.h"

namespace c3de::study {

/// The program that runs the points.
struct Program {
  std::filesystem::path file;
  std::string version;
  std::string build;  ///< hash of its bytes: identifies the build that was measured
};

/// One run of a scene: a combination of a grid, or a refined run of a reference.
struct Point {
  std::size_t ofCase = 0;
  bool isReference = false;
  std::size_t grid = 0;  ///< of the case's grids; 0 for a reference
  std::vector<StudyParameterValue> parameters;
  std::vector<Setting> settings;  ///< all settings: of the case, then of the study parameters
  unsigned threads = 1;
  /// Whether no body in its scene has energy supply or damping, and whether no body has external action
  bool conservesEnergy = false, conservesMomentum = false;
  /// Hash of everything that determines its result: files of the scene, settings, program, simulator.
  std::string id;
};

struct PlannedCase {
  scene::SceneFile scene;           ///< with the settings of the case
  std::vector<std::string> bodies;  ///< that deform
  std::string contents;             ///< hash of the scene and of the files it names
};

/// Everything that a study runs.
struct Plan {
  std::vector<PlannedCase> cases;
  std::vector<Point> points;  ///< references of a case, then its grids
  /// Lines in which two studies of one folder must agree: "case beam: scene" and its value
  std::vector<std::pair<std::string, std::string>> identity;
};

/// Opens the scenes and generates the points. Sets every value in the scenes and checks it against the declarations of
/// the simulator. Refused values are thus reported, with the line of the study, before anything runs.
/// @param threads  of points that specify none
[[nodiscard]] Expected<Plan> planStudy(const Study &study, session::Session &session, const Program &program,
                                       unsigned threads);

/// FNV-1a over the bytes, as 16 digits.
[[nodiscard]] std::string hashOf(std::string_view bytes);
[[nodiscard]] Expected<std::string> hashOfFile(const std::filesystem::path &file);

/// Differences between the identities of two studies as display text, at most three lines; empty if there are none.
[[nodiscard]] std::string difference(const std::vector<std::pair<std::string, std::string>> &present,
                                     const std::vector<std::pair<std::string, std::string>> &before);

}  // namespace c3de::study
