// SPDX-License-Identifier: Apache-2.0
// Recordings: made while the simulation runs, and repeated.
#include <fmt/format.h>

#include <optional>
#include <utility>

#include "c3de/core/path_text.h"
#include "c3de/session/recorder.h"
#include "c3de/session/replay.h"
#include "running.h"
#include "use.h"

namespace c3de::embed {

Result<void> EmbeddedSimulation::record(const std::filesystem::path &file, std::uint64_t hashEvery) {
  const Use use(*this, Use::Access::write);
  if (use.isRefused()) return use.refusal();
  if (recorder_)
    return refuse(C3DE_E_STATE, fmt::format("{}: the simulation is recorded in {}; end that recording first",
                                            pathText(file), pathText(recordingFile_)));
  if (!session::isRecordingPath(file))
    return refuse(C3DE_E_ARG, fmt::format("file is '{}'; accepted: a name that ends with .c3dr", pathText(file)));
  const Running running(*this);
  const ProgressFn progress = running.progress({});
  const auto start = session::recordingStart(*session_, simulator_->get(), identity_, session_->changes()->source(),
                                             file, hashEvery != 0 ? hashEvery : session::kDefaultHashEvery, progress);
  if (!start) return refuse(start.error());
  session::RecorderOptions options;
  options.progress = progress;
  auto recorder = session::Recorder::create(file, *start, simulator_->get(), std::move(options));
  if (!recorder) return refuse(recorder.error());
  recorder_ = std::move(*recorder);
  recordingFailure_.reset();
  recordingFile_ = file;
  session_->setRecorder(recorder_);
  return {};
}

Result<void> EmbeddedSimulation::endRecording() {
  const Use use(*this, Use::Access::write);
  if (use.isRefused()) return use.refusal();
  return finishRecording();
}

Result<void> EmbeddedSimulation::finishRecording() {
  if (auto failure = std::exchange(recordingFailure_, std::nullopt)) return tl::unexpected(std::move(*failure));
  if (!recorder_) return {};
  session_->setRecorder(nullptr);
  const auto finished = std::exchange(recorder_, nullptr)->finish();
  if (!finished) return refuse(finished.error());
  return {};
}

Result<void> EmbeddedSimulation::repeatDue() {
  const auto applied = replay_->applyDueEvents(*session_, simulator_->get(), table_, session_->changes(),
                                               [this](double, const std::string &) { return !isCancelled_; });
  stateChanged();
  if (!applied) return refuse(applied.error());
  if (auto read = readStatus(); !read) return read;
  if (const std::string &difference = replay_->difference(); !difference.empty())
    return refuse(C3DE_E_DIVERGED, difference);
  return {};
}

Result<void> EmbeddedSimulation::replay(const Run &run) {
  const Use use(*this, Use::Access::write);
  if (use.isRefused()) return use.refusal();
  if (!replay_)
    return refuse(C3DE_E_STATE, "the simulation is of no recording; accepted: one that was opened from a file .c3dr");
  std::uint64_t made = 0;
  return makeSteps(run, made, true);
}

Result<c3de_embed_replay_state> EmbeddedSimulation::replayState() {
  const Use use(*this, Use::Access::read);
  if (use.isRefused()) return use.refusal();
  c3de_embed_replay_state out{};
  out.size = sizeof out;
  out.remark = "";
  if (!replay_) return out;
  out.flags = replay_->isAtEnd() && replay_->difference().empty() ? C3DE_EMBED_REPLAY_END : 0u;
  out.steps = replay_->position().made;
  out.equal_hashes = replay_->equalHashes();
  out.remark = intern(replay_->recording().whyIncomplete());
  return out;
}

}  // namespace c3de::embed
