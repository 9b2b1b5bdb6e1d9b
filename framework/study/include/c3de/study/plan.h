// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "c3de/scene/scene_file.h"
#include "c3de/session/session.h"
#include "c3de/study/levers.h"
#include "c3de/study/study_file.h"

namespace c3de::study {

/// The program that runs the points.
struct Program {
  std::filesystem::path file;
  std::string version;
  std::string build;  ///< hash of its bytes: what was measured is no other build's
};

/// One run of a scene: a combination of a grid, or a refined run of a reference.
struct Point {
  std::size_t ofCase = 0;
  bool isReference = false;
  std::size_t grid = 0;  ///< of the case's; of a reference 0
  std::vector<LeverValue> levers;
  std::vector<Setting> settings;  ///< all that is set: of the case, then of the levers
  unsigned threads = 1;
  /// What nothing feeds and nothing damps in its scene, and what nothing acts on
  bool conservesEnergy = false, conservesMomentum = false;
  /// Hash over all that its result follows from: files of the scene, settings, program, simulator.
  std::string id;
};

struct PlannedCase {
  scene::SceneFile scene;           ///< with the settings of the case
  std::vector<std::string> bodies;  ///< that deform
  std::string contents;             ///< hash of the scene and of the files that it names
};

/// What a study will run.
struct Plan {
  std::vector<PlannedCase> cases;
  std::vector<Point> points;  ///< references of a case, then its grids
  /// What two studies of one folder have to agree in, one line each: "case beam: scene" and its value
  std::vector<std::pair<std::string, std::string>> identity;
};

/// Opens the scenes and works out the points; sets every value in them and holds it against the declarations of the
/// simulator, so that what is refused is heard, with the line of the study, before anything runs.
/// @param threads  of points that name none
[[nodiscard]] Expected<Plan> planStudy(const Study &study, session::Session &session, const Program &program,
                                       unsigned threads);

/// FNV-1a over the bytes, as 16 digits.
[[nodiscard]] std::string hashOf(std::string_view bytes);
[[nodiscard]] Expected<std::string> hashOfFile(const std::filesystem::path &file);

/// For people: what differs between the identities of two studies, at most three lines; empty: nothing.
[[nodiscard]] std::string difference(const std::vector<std::pair<std::string, std::string>> &present,
                                     const std::vector<std::pair<std::string, std::string>> &before);

}  // namespace c3de::study
