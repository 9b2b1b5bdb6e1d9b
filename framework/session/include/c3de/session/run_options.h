// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "c3de/session/export_image.h"
#include "c3de/session/picture_view.h"
#include "c3de/session/recording_file.h"
#include "c3de/session/session.h"

namespace c3de::session {

/// Simulated time between two frames of an export: 25 per second, the frame rate of video.
inline constexpr double kDefaultExportEvery_s = 0.04;

struct RunOptions {
  SessionOptions session;
  std::filesystem::path scene;  ///< a scene, a session to continue, a mesh as one body, or a recording
  std::string sceneText;        ///< TOML to read instead of `scene`, whose folder its paths are relative to; or empty
  std::string meshUnit;         ///< of a mesh; empty: the unit stated in the file, otherwise mm
  std::optional<double> until_s;
  std::optional<std::uint64_t> steps;  ///< neither: kDefaultDuration_s, or until a quasi-static solution is finished
  std::optional<double> timeLimit_s;   ///< wall clock, since the start of the command
  std::vector<std::string> overrides;  ///< PATH=VALUE
  std::filesystem::path report, probes, screenshot;  ///< empty: not requested
  std::uint64_t probesEvery = 1;                     ///< steps
  std::filesystem::path energies, tissues;           ///< empty: not requested
  std::filesystem::path exportList, exportSurface;   ///< empty: not requested
  std::filesystem::path fromState, saveState;        ///< empty: not requested
  std::filesystem::path saveSession;                 ///< empty: not requested
  bool embed = false;                                ///< session and recording have the content of all files
  std::vector<std::filesystem::path> search{};       ///< folders with files of a session that have moved
  std::filesystem::path record;                      ///< empty: not requested
  std::uint64_t recordHashEvery = kDefaultHashEvery;
  bool isReplay = false;                        ///< `scene` is a recording, which is repeated
  std::optional<double> from_s;                 ///< of a replay: simulated time at which the export begins
  bool checkHashes = false;                     ///< of a replay: it ends at the first state hash that differs
  std::filesystem::path samplePoints, sampled;  ///< points to track, and their positions at the end; or empty
  std::vector<std::filesystem::path> landmarks, targetLandmarks;  ///< files in addition to those of the scene
  std::filesystem::path exportLandmarks;                          ///< empty: not requested
  double exportEvery_s = kDefaultExportEvery_s;
  ImageExport exportImage;
  int width = 1280, height = 720;
  std::optional<PictureView> view;  ///< none: four-up where the scene has an image, otherwise 3d
  PictureCamera camera;
  std::optional<PictureOverlay> overlay;  ///< none: default of PictureOverlay
  std::optional<std::uint64_t> seed;
  bool verify = false;  ///< estimate the error of the end state with a much finer solution
  bool quiet = false;
};

inline constexpr double kDefaultDuration_s = 1.0;

}  // namespace c3de::session
