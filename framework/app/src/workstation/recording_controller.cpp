// SPDX-License-Identifier: Apache-2.0
#include "workstation/recording_controller.h"

#include <utility>

#include "c3de/abi/log.h"
#include "c3de/core/log.h"
#include "c3de/core/path_text.h"
#include "c3de/session/recording_file.h"
#include "workstation/workstation_export.h"

namespace c3de::app {

void RecordingController::connect(ui::WindowActions &actions) {
  actions.startRecording = [this](const std::filesystem::path &file) { start(file); };
  actions.stopRecording = [this] { stop(); };
  actions.showTimeline = [this] { showTimeline(); };
}

std::string RecordingController::fileName() const { return recorder_ ? pathText(file_.filename()) : std::string(); }

void RecordingController::start(const std::filesystem::path &file) {
  Session &session = parts_.session;
  scene::Simulation *simulation = session.simulation();
  if (simulation == nullptr || recorder_ || isStarting_) return;
  const auto identity = presentSimulator(session);
  if (!identity) return parts_.failed("The recording could not be started", identity.error());
  // A replay has no states from before its beginning.
  parts_.edits.removeOwnedBy(identity->plugin);
  parts_.edits.removeOwnedBy({});
  isStarting_ = true;
  node_ = session.simulationNode();
  RecorderOptions options;
  options.onFailure = [this, file, queue = &session.mainQueue()](const Error &error) {
    queue->post([this, file, error] {
      if (recorder_ && file_ == file) end(error.message);
    });
  };
  simulation->post([this, &session, simulation, changes = session.changes(), set = session.recorderSetter(),
                    identity = *identity, file, options] {
    const std::uint64_t before = changes->count();
    Expected<std::shared_ptr<Recorder>> recorder;
    if (auto start =
            recordingStart(session, simulation->object(), identity, changes->source(), file, kDefaultHashEvery);
        !start)
      recorder = tl::unexpected(start.error());
    else
      recorder = Recorder::create(file, *start, simulation->object(), options);
    if (recorder) set(*recorder);
    if (recorder && changes->count() != before) {
      set(nullptr);
      recorder = fail(ErrorCode::state, "the simulation was changed meanwhile; try again");
    }
    session.mainQueue().post([this, file, recorder] { begin(file, recorder); });
  });
}

void RecordingController::begin(const std::filesystem::path &file,
                                const Expected<std::shared_ptr<Recorder>> &recorder) {
  isStarting_ = false;
  if (!recorder) return parts_.failed("The recording could not be started", recorder.error());
  recorder_ = *recorder;
  file_ = file;
  if (parts_.session.simulationNode() != node_) return end("Another simulation is open.");
  parts_.panels.notify(C3DE_LOG_INFO, "Recording", pathText(file) + "\nUndo steps from before it were removed.");
}

void RecordingController::complete(const Finished &finished) {
  const std::shared_ptr<Recorder> recorder = std::exchange(recorder_, nullptr);
  scene::Simulation *simulation = parts_.session.simulation();
  if (simulation == nullptr || parts_.session.simulationNode() != node_) return finished(recorder->finish());
  simulation->post([recorder, finished, set = parts_.session.recorderSetter(), queue = &parts_.session.mainQueue()] {
    set(nullptr);
    queue->post([finished, result = recorder->finish()] { finished(result); });
  });
}

void RecordingController::stop() {
  if (!recorder_) return;
  complete([this, file = file_](const Expected<void> &finished) {
    if (finished)
      parts_.panels.notify(C3DE_LOG_INFO, "Recording saved",
                           pathText(file) + "\nTo verify: c3de replay " + pathText(file) + " --check",
                           {{"Show timeline", [this, file] { parts_.showTimeline(file); }}});
    else
      parts_.failed("The recording ended", finished.error());
  });
}

bool RecordingController::hasTimeline() const {
  return recorder_ ||
         (!file_.empty() && parts_.session.simulation() != nullptr && parts_.session.simulationNode() == node_);
}

void RecordingController::showTimeline() {
  if (!hasTimeline()) return;
  if (!recorder_) return parts_.showTimeline(file_);
  complete([this, file = file_](const Expected<void> &finished) {
    finished ? parts_.showTimeline(file) : parts_.failed("The recording ended", finished.error());
  });
}

void RecordingController::end(const std::string &why) {
  if (!recorder_) return;
  log(LogLevel::warn, "the recording ended: " + why);
  complete([this, why, file = file_](const Expected<void> &finished) {
    parts_.panels.notify(
        C3DE_LOG_WARN, "The recording ended",
        why + "\n" + (finished ? pathText(file) + " is complete up to then." : finished.error().message));
  });
}

void RecordingController::finish() {
  scene::Simulation *simulation = parts_.session.simulation();
  if (!recorder_ || simulation == nullptr) return;
  Expected<void> finished;
  simulation->call([&] {
    parts_.session.setRecorder(nullptr);
    finished = recorder_->finish();
  });
  recorder_.reset();
  if (!finished) log(LogLevel::error, "the recording ended: " + finished.error().message);
}

}  // namespace c3de::app
