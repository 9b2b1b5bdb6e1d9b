// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app.h"
#include "c3de/core/expected.h"
#include "c3de/render/renderer.h"
#include "c3de/session/export_simulation.h"
#include "c3de/session/probe_table.h"
#include "c3de/session/timeline.h"
#include "c3de/ui/stretch.h"

namespace c3de::app {

/// Writes the files of an exported stretch while its recording is replayed. Pictures are drawn by the caller. One
/// thread at a time; functions marked [sim] on the simulation's thread.
class StretchWriter {
 public:
  StretchWriter(ui::StretchExport wanted, const ui::Stretch &stretch, const ui::TimeAt &timeAt_s);
  ~StretchWriter();  ///< removes pictures that were drawn for a film only
  StretchWriter(const StretchWriter &) = delete;
  StretchWriter &operator=(const StretchWriter &) = delete;

  [[nodiscard]] const ui::StretchExport &wanted() const { return wanted_; }
  [[nodiscard]] std::uint64_t begin() const { return stretch_.begin; }
  /// Creates the folder of the pictures.
  [[nodiscard]] Expected<void> prepare();
  /// The replay begins again at the begin of the stretch; files are written anew.
  void restart();

  enum class Reached {
    picture,  ///< a picture of the present position is due: setPicture(), then advance()
    paused,   ///< by a limit
    retry,    ///< the timeline has to jump to the begin again: restart()
    end       ///< everything but the film is written
  };
  /// Writes what is due at this position, and replays up to the next. [sim]
  [[nodiscard]] Expected<Reached> advance(Timeline &timeline, const Timeline::Target &target, Timeline::Limits limits);
  void setPicture(render::Image picture) { picture_ = std::move(picture); }
  /// Completes the files, also after an error or when cancelled.
  [[nodiscard]] Expected<void> finish();

  /// The files that have contents, one per line.
  [[nodiscard]] std::string written() const;
  [[nodiscard]] std::size_t picturesDrawn() const { return pictures_; }
  [[nodiscard]] std::size_t pictureCount() const { return pictureAt_.size(); }
  [[nodiscard]] const std::filesystem::path &picturesFolder() const { return picturesFolder_; }

 private:
  [[nodiscard]] Expected<void> writePictures(std::uint64_t at);
  [[nodiscard]] Expected<void> writeDue(const Timeline::Target &target, std::uint64_t at);
  [[nodiscard]] Expected<void> writeProbes(const Timeline::Target &target, double time_s);
  [[nodiscard]] std::uint64_t nextStop(std::uint64_t at) const;

  ui::StretchExport wanted_;
  ui::Stretch stretch_;
  ui::StretchFiles files_;
  bool isStatic_;  ///< steps have no duration
  std::vector<std::uint64_t> frameAt_, pictureAt_;
  std::filesystem::path picturesFolder_;

  std::unique_ptr<SimulationExport> frames_;
  std::optional<ProbeTable> probes_;
  std::optional<render::Image> picture_;
  std::size_t framesWritten_ = 0, pictures_ = 0;
  std::optional<std::uint64_t> writtenAt_;
  double lastTime_s_ = 0.0, resetOffset_s_ = 0.0;
};

/// Makes a film of the pictures of a writer by a child process; an existing film is replaced when the new one is
/// complete. Errors name the film, and contain what the program reports. Any thread.
[[nodiscard]] Expected<void> writeFilm(const StretchWriter &writer, const std::filesystem::path &program,
                                       const ProgressFn &progress);

}  // namespace c3de::app
