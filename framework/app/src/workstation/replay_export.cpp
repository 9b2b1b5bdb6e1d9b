// SPDX-License-Identifier: Apache-2.0
// The export of a stretch of a recording.
#include <fmt/format.h>

#include <utility>

#include "c3de/abi/log.h"
#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"
#include "c3de/render/renderer.h"
#include "c3de/session/simulator_access.h"
#include "workstation/replay_controller.h"

namespace c3de::app {
namespace {

constexpr std::chrono::milliseconds kExportPart{120};
constexpr const char *kExportFailed = "The export could not be completed";

}  // namespace

void ReplayController::connectExport(ui::ReplayActions &actions) {
  actions.setBegin = [this] {
    if (isReplaying() && !export_) stretch_.setBegin(position_, opened_->timeline->axis().length());
  };
  actions.setEnd = [this] {
    if (isReplaying() && !export_) stretch_.setEnd(position_, opened_->timeline->axis().length());
  };
  actions.exportStretch = [this](const ui::StretchExport &wanted) { startExport(wanted); };
}

/// Finds out what can be exported of the simulation that was built.
void ReplayController::beginStretch() {
  filmProgram_ = ui::findProgram("ffmpeg", environmentVariable("PATH"));
  scene::Simulation *simulation = parts_.session.simulation();
  simulation->post([this, simulation, serial = serial_, queue = &parts_.session.mainQueue()] {
    const auto probes = readProbes(simulation->table(), simulation->object());
    const auto tools = readProbeTools(simulation->object());
    queue->post([this, serial, hasProbes = (probes && !probes->empty()) || (tools && !tools->empty())] {
      if (serial == serial_) hasProbes_ = hasProbes;
    });
  });
}

void ReplayController::startExport(const ui::StretchExport &wanted) {
  if (!isReplaying() || isBusy_ || target_ || pending_ || export_) return;
  play(false);
  const TimelineAxis &axis = opened_->timeline->axis();
  auto writer = std::make_shared<StretchWriter>(wanted, stretch_, [&](std::uint64_t at) { return axis.timeAt_s(at); });
  if (auto prepared = writer->prepare(); !prepared) return parts_.failed(kExportFailed, prepared.error());
  export_ = Export{std::move(writer), position_, parts_.window.camera()};
  seek(stretch_.begin);
}

/// The simulation is at the begin of the stretch, or further.
void ReplayController::continueExport() {
  scene::Simulation *simulation = parts_.session.simulation();
  export_->isWriting = true;
  isBusy_ = true;
  stop_ = std::make_shared<std::atomic<bool>>(false);
  Timeline::Limits limits;
  limits.deadline = Clock::now() + kExportPart;
  limits.isStopped = [stop = stop_] { return stop->load(); };
  simulation->post([this, limits = std::move(limits), writer = export_->writer, timeline = opened_->timeline,
                    serial = serial_,
                    target = Timeline::Target{parts_.session, *simulation, parts_.session.changes()}] {
    const auto reached = writer->advance(*timeline, target, limits);
    target.session.mainQueue().post([this, serial, reached] {
      if (serial == serial_) onExported(reached);
    });
  });
}

void ReplayController::onExported(const Expected<StretchWriter::Reached> &reached) {
  using Reached = StretchWriter::Reached;
  isBusy_ = false;
  position_ = opened_->timeline->position();
  if (!opened_->timeline->difference().empty()) warning_ = "The replay " + opened_->timeline->difference();
  if (!export_) return;
  export_->pictures = export_->writer->picturesDrawn();
  if (!reached) return finishExport(tl::unexpected(reached.error()));
  if (export_->isCancelled || *reached == Reached::end) return finishExport({});
  if (*reached == Reached::paused) return continueExport();
  if (*reached == Reached::retry) {
    // A state was unsuitable, so what was written may be wrong.
    export_->writer->restart();
    export_->isWriting = false;
    return seek(export_->writer->begin());
  }
  // The simulation publishes its snapshot after the part before this one.
  isBusy_ = true;
  parts_.session.simulation()->post([this, serial = serial_, queue = &parts_.session.mainQueue()] {
    queue->post([this, serial] {
      if (serial != serial_ || !export_) return;
      isBusy_ = false;
      if (export_->isCancelled) return finishExport({});
      export_->isPictureReady = true;
    });
  });
}

void ReplayController::drawPicture() {
  if (!export_ || !export_->isPictureReady || !parts_.isViewCurrent()) return;
  export_->isPictureReady = false;
  parts_.session.plugins().syncScene();
  const ui::StretchExport &wanted = export_->writer->wanted();
  auto picture = parts_.renderer.drawToImage(export_->camera, wanted.width, wanted.height);
  if (!picture) return finishExport(tl::unexpected(picture.error()));
  export_->writer->setPicture(std::move(*picture));
  continueExport();
}

void ReplayController::finishExport(const Expected<void> &result) {
  const Export done = std::move(*export_);
  export_.reset();
  const auto finished = done.writer->finish();
  const std::string written = done.writer->written();
  if (!result || !finished) {
    const Error &error = result ? finished.error() : result.error();
    parts_.failed(kExportFailed, {error.code, error.message + (written.empty() ? "" : "\nWritten:\n" + written)});
  } else if (done.isCancelled) {
    parts_.panels.notify(C3DE_LOG_INFO, "Export cancelled",
                         written.empty() ? "Nothing was written." : "What was written is kept:\n" + written);
  } else {
    if (!written.empty()) parts_.panels.notify(C3DE_LOG_INFO, "Exported", written);
    if (done.writer->wanted().hasFilm) writeFilmOf(done.writer);
  }
  seek(done.returnTo);
}

void ReplayController::writeFilmOf(const std::shared_ptr<StretchWriter> &writer) {
  const std::string film = pathText(filesOf(writer->wanted()).film);
  (void)parts_.session.jobs().submit(
      kJobOwner, "Writing " + pathText(filesOf(writer->wanted()).film.filename()),
      [writer, program = filmProgram_](const ProgressFn &progress) { return writeFilm(*writer, program, progress); },
      [this, film](const Expected<void> &result) {
        if (result) return parts_.panels.notify(C3DE_LOG_INFO, "Exported", film);
        parts_.failed(result.error().code == ErrorCode::cancelled ? "Export cancelled" : kExportFailed, result.error());
      });
}

void ReplayController::showExport(ui::ReplayView &replay) const {
  replay.stretch = stretch_;
  replay.hasProbes = hasProbes_;
  if (filmProgram_.empty()) replay.whyNoFilm = "No ffmpeg was found in the folders of PATH.";
  replay.folder = opened_->file.parent_path();
  if (!export_) return;
  const StretchWriter &writer = *export_->writer;
  // Positions are read by the main thread only as they were last reported.
  const std::uint64_t at = export_->isWriting ? position_ - stretch_.begin : 0;
  replay.exporting = fmt::format("Exporting: step {} of {}", at, stretch_.end - stretch_.begin);
  if (writer.pictureCount() > 0)
    replay.exporting += fmt::format(", picture {} of {}", export_->pictures, writer.pictureCount());
}

}  // namespace c3de::app
