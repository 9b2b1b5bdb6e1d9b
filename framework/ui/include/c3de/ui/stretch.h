// SPDX-License-Identifier: Apache-2.0
// A stretch of a recording that is exported: its bounds, its frames and the files that are written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace c3de::ui {

/// Begin and end, as positions: steps since the recording began. Begin lies before end, unless there is no step.
struct Stretch {
  std::uint64_t begin = 0, end = 0;

  /// An end that is not after it becomes the end of the recording.
  void setBegin(std::uint64_t position, std::uint64_t length);
  /// A begin that is not before it becomes the start of the recording.
  void setEnd(std::uint64_t position, std::uint64_t length);
};

/// What is exported of a stretch.
struct StretchExport {
  bool hasFrames = true;                            ///< a series for ParaView
  bool hasProbes = false;                           ///< a table with one row per step
  bool hasPictures = false;                         ///< PNG
  bool hasFilm = false;                             ///< of the pictures
  double frameEvery_ms = 40.0, pictureRate = 25.0;  ///< simulated time; pictures per simulated second
  int width = 1280, height = 720;                   ///< of a picture, pixels
  std::filesystem::path folder;
  std::string name;  ///< of the files, without extension
};

/// The files of an export. Those that are not wanted are named, too.
struct StretchFiles {
  std::filesystem::path frames, framesFolder, probes, picturesFolder, film;
};
[[nodiscard]] StretchFiles filesOf(const StretchExport &wanted);
/// "picture_000012.png"
[[nodiscard]] std::string pictureName(std::size_t number);
/// The files and folders among them that are wanted and exist.
[[nodiscard]] std::vector<std::filesystem::path> existingFiles(const StretchExport &wanted);
/// What is wrong: which value, and what is accepted. Empty: it can be exported.
/// @param duration_s  simulated time of the stretch
[[nodiscard]] std::string problemOf(const StretchExport &wanted, double duration_s);

/// Simulated time at a position, s; does not decrease.
using TimeAt = std::function<double(std::uint64_t position)>;

/// Positions of frames at the times t_begin + k * interval_s, up to the end: for each time, the last step that is not
/// after it. Positions repeat where steps are longer than the interval. Steps without duration, as in static runs: each
/// position once. The interval must be positive.
[[nodiscard]] std::vector<std::uint64_t> framePositions(const Stretch &stretch, const TimeAt &timeAt_s,
                                                        double interval_s);
/// The number of these times for a stretch of this duration.
[[nodiscard]] double frameCount(double duration_s, double interval_s);

/// A program in one of the folders, which are separated as in PATH; empty: there is none.
[[nodiscard]] std::filesystem::path findProgram(const std::string &name, const std::string &folders);

}  // namespace c3de::ui
