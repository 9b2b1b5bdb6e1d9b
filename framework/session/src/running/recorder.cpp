// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/recorder.h"
#include "c3de/core/file_path.h"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "c3de/core/path_text.h"
#include "c3de/session/saved_session.h"
#include "c3de/session/session.h"

namespace c3de::session {
namespace {

constexpr std::chrono::milliseconds kLongestWait{500};
constexpr std::size_t kWrittenAtOnce = std::size_t{1} << 20;  // without waiting for more

}  // namespace

Expected<std::shared_ptr<Recorder>> Recorder::create(const std::filesystem::path &file, const RecordingStart &start,
                                                     c3de_object *simulator, RecorderOptions options) {
  const auto table = simulatorTable(simulator);
  if (!table) return tl::unexpected(table.error());
  std::optional<OutputRows> rows;
  Expected<void> added;
  // The file is opened after everything that is embedded has been read once.
  const auto written = writeRecordingStart(
      start,
      [&](std::string_view piece) -> Expected<void> {
        if (!rows) {
          auto opened = OutputRows::open(file);
          if (!opened) return added = tl::unexpected(opened.error());
          rows.emplace(std::move(*opened));
        }
        return added = rows->add(piece);
      },
      options.progress);
  if (!written) {
    std::error_code ignored;
    if (rows.has_value()) {
      rows.reset();
      std::filesystem::remove(file, ignored);
    }
    if (!added) return tl::unexpected(added.error());
    if (written.error().code == ErrorCode::cancelled) return tl::unexpected(written.error());
    return fail(written.error().code,
                fmt::format("{}: could not be recorded: {}", pathText(file), written.error().message));
  }
  std::shared_ptr<Recorder> recorder(
      new Recorder(std::move(*rows), file, start, simulator, *table, std::move(options)));
  recorder->thread_ = std::thread([one = recorder.get()] { one->write(); });
  return recorder;
}

Recorder::Recorder(OutputRows rows, std::filesystem::path file, const RecordingStart &start, c3de_object *simulator,
                   const c3de_simulator_v1 *table, RecorderOptions options)
    : rows_(std::move(rows)), file_(std::move(file)), simulator_(simulator), table_(table),
      options_(std::move(options)), hashEvery_(start.hashEvery) {
  simulator->vt->retain(simulator);
}

Recorder::~Recorder() { stopThread(); }

void Recorder::stopThread() {
  {
    const std::lock_guard lock(mutex_);
    isStopping_ = true;
  }
  wake_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void Recorder::enqueue(const std::string &bytes) {
  if (error_ || isStopping_) return;
  // One record may be larger than the limit: a state.
  if (queue_.size() > options_.queueBytes) {
    error_ =
        Error{ErrorCode::output, fmt::format("{}: the recording ends: {} bytes wait for the disk; accepted: up to {}",
                                             pathText(file_), queue_.size(), options_.queueBytes)};
  } else {
    queue_ += bytes;
  }
  wake_.notify_one();
}

void Recorder::endWith(const Error &error) {
  const std::lock_guard lock(mutex_);
  if (!error_) error_ = error;
  wake_.notify_one();
  written_.notify_all();
}

void Recorder::add(const RecordedEvent &event) {
  if (hasFailed_) return;
  const auto bytes = recordingBytes(event);
  if (!bytes)
    return endWith(
        {bytes.error().code, fmt::format("{}: the recording ends: {}", pathText(file_), bytes.error().message)});
  const std::lock_guard lock(mutex_);
  if (std::holds_alternative<SimulationChange>(event)) ++changes_;
  enqueue(*bytes);
}

void Recorder::addChange(const SimulationChange &change) { add(change); }
void Recorder::addReset(std::uint64_t steps) { add(RecordedReset{steps}); }
void Recorder::addState(std::uint64_t steps, std::string bytes) { add(RecordedState{steps, std::move(bytes)}); }
void Recorder::addScene(std::uint64_t steps, const SessionFile &ofOneScene) { add(RecordedScene{steps, ofOneScene}); }

template <class Event>
Expected<bool> Recorder::addHash() {
  std::uint64_t changesBefore = 0;
  {
    const std::lock_guard lock(mutex_);
    changesBefore = changes_;
  }
  const auto status = simulatorStatus(table_, simulator_.get());
  if (!status) return tl::unexpected(status.error());
  const auto hash = stateHash(table_, simulator_.get());
  if (!hash) return tl::unexpected(hash.error());
  Event event;
  event.steps = status->steps;
  event.made = made_;
  event.time_s = status->time_s;
  event.hash = *hash;
  const auto bytes = recordingBytes(RecordedEvent(event));
  if (!bytes) return tl::unexpected(bytes.error());
  // A change by another thread: whether the hash is of the state before or after it is unknown.
  const std::lock_guard lock(mutex_);
  if (changes_ != changesBefore) return false;
  enqueue(*bytes);
  return true;
}

void Recorder::addStep() {
  ++made_;
  if (hasFailed_ || ++sinceHash_ < hashEvery_) return;
  if (const auto added = addHash<RecordedHash>(); !added)
    endWith(added.error());
  else if (*added)
    sinceHash_ = 0;
}

Expected<void> Recorder::addPresent() {
  for (bool isAdded = hasFailed_; !isAdded;) {
    const auto added = addHash<RecordedHash>();
    if (!added) return tl::unexpected(added.error());
    isAdded = *added;
  }
  sinceHash_ = 0;
  return {};
}

Expected<void> Recorder::waitUntilWritten() {
  std::unique_lock lock(mutex_);
  written_.wait(lock, [this] { return error_ || (queue_.empty() && !isWriting_); });
  return error_ ? Expected<void>(tl::unexpected(*error_)) : Expected<void>();
}

Expected<void> Recorder::finish() {
  if (!std::exchange(isFinished_, true)) {
    for (bool isAdded = hasFailed_; !isAdded;) {
      const auto added = addHash<RecordedEnd>();
      if (!added) endWith(added.error());
      isAdded = !added || *added;
    }
    stopThread();
    if (const auto closed = rows_.close(); !closed) endWith(closed.error());
  }
  const std::lock_guard lock(mutex_);
  return error_ ? Expected<void>(tl::unexpected(*error_)) : Expected<void>();
}

/// The thread: what waits is written together, so that many small changes are few calls of the system.
void Recorder::write() {
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [this] { return isStopping_ || error_ || !queue_.empty(); });
    wake_.wait_for(lock, kLongestWait, [this] { return isStopping_ || error_ || queue_.size() >= kWrittenAtOnce; });
    const std::string batch = std::exchange(queue_, {});
    isWriting_ = true;
    lock.unlock();
    const auto written = batch.empty() ? Expected<void>() : rows_.add(batch);
    lock.lock();
    isWriting_ = false;
    written_.notify_all();
    if (!written && !error_) error_ = written.error();
    if (error_) break;
    if (isStopping_ && queue_.empty()) return;
  }
  queue_.clear();
  hasFailed_ = true;
  written_.notify_all();
  const Error error = *error_;
  lock.unlock();
  if (options_.onFailure) options_.onFailure(error);
}

Expected<RecordingStart> recordingStart(Session &session, c3de_object *simulator, const SimulatorIdentity &identity,
                                        SimulationSource source, const std::filesystem::path &file,
                                        std::uint64_t hashEvery, const ProgressFn &progress, Embedding embedding) {
  RecordingStart start;
  start.simulator = identity;
  start.simulator.label.clear();
  start.hashEvery = hashEvery;
  const auto captured = captureState(session, simulator, identity, std::move(source));
  if (!captured) return tl::unexpected(captured.error());
  FileReferences references;
  auto saved = sessionOf(*captured, absolutePath(file).parent_path(), references, progress, embedding);
  if (!saved) return tl::unexpected(saved.error());
  start.session = std::move(*saved);
  return start;
}

}  // namespace c3de::session
