// SPDX-License-Identifier: Apache-2.0
#include "workstation/session_recovery.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <random>
#include <system_error>
#include <utility>

#include "c3de/core/path_text.h"
#include "c3de/core/thread_priority.h"

namespace c3de::app {
namespace {

constexpr const char *kExtension = ".c3de", *kLockExtension = ".lock";

/// Held while the run exists.
Expected<FileLock> lockOf(std::filesystem::path session) {
  return FileLock::take(session.replace_extension(kLockExtension), "the session of a running program");
}

/// No other run has it.
std::string runName() {
  std::random_device random;
  return fmt::format("{}-{:08x}", processId(), static_cast<std::uint32_t>(random()));
}

}  // namespace

void removeRecovery(std::filesystem::path session) {
  std::error_code ignored;
  std::filesystem::remove(session, ignored);
  std::filesystem::remove(session.replace_extension(kLockExtension), ignored);
}

Expected<SessionFile> sessionWithView(const CapturedState &captured, const ShownView &shown,
                                      const std::filesystem::path &folder, FileReferences &references,
                                      const ProgressFn &progress, Embedding embedding) {
  auto saved = sessionOf(captured, folder, references, progress, embedding);
  if (!saved) return saved;
  saved->view = shown.view;
  if (saved->title.empty()) saved->title = pathText(shown.image.filename());
  const auto add = [&](const std::filesystem::path &file) {
    return addFile(file, folder, references, progress, embedding, *saved);
  };
  if (!shown.image.empty()) {
    auto path = add(shown.image);
    if (!path) return tl::unexpected(path.error());
    saved->view.image = std::move(*path);
  }
  for (const std::filesystem::path &file : shown.labels) {
    auto path = add(file);
    if (!path) return tl::unexpected(path.error());
    saved->view.labels.push_back(std::move(*path));
  }
  if (!shown.comparison.empty() && saved->view.comparison) {
    auto path = add(shown.comparison);
    if (!path) return tl::unexpected(path.error());
    saved->view.comparison->image = std::move(*path);
  }
  if (shown.mask && saved->view.selection) addMaskOfSelection(*shown.mask, *saved);
  return saved;
}

SessionRecovery::SessionRecovery(std::filesystem::path folder, std::function<void(const Error &)> failed)
    : folder_(std::move(folder)), file_(folder_ / (runName() + kExtension)), failed_(std::move(failed)) {
  thread_ = std::thread([this] { run(); });
}

void SessionRecovery::stop(bool leaves) {
  {
    const std::lock_guard lock(mutex_);
    isStopping_ = true;
    waiting_.reset();
  }
  wake_.notify_one();
  if (thread_.joinable()) thread_.join();
  if (lock_ && !leaves) removeRecovery(file_);
  lock_.reset();
}

void SessionRecovery::write(std::shared_ptr<Expected<CapturedState>> captured, ShownView shown) {
  {
    const std::lock_guard lock(mutex_);
    if (isStopping_) return;
    waiting_ = Request{std::move(captured), std::move(shown)};
    isDiscarded_ = isWritten_ = false;
  }
  wake_.notify_one();
}

bool SessionRecovery::isWriting() const {
  const std::lock_guard lock(mutex_);
  return isWriting_ || waiting_;
}

bool SessionRecovery::isWritten() const {
  const std::lock_guard lock(mutex_);
  return isWritten_;
}

bool SessionRecovery::hasFailed() const {
  const std::lock_guard lock(mutex_);
  return hasFailed_;
}

void SessionRecovery::discard() {
  const std::lock_guard lock(mutex_);
  waiting_.reset();
  isDiscarded_ = true;
  isWritten_ = false;
  std::error_code ignored;
  if (!isWriting_) std::filesystem::remove(file_, ignored);
}

std::filesystem::path SessionRecovery::handOver() {
  const std::lock_guard lock(mutex_);
  std::error_code code;
  if (!lock_ || isWriting_ || !std::filesystem::exists(file_, code)) return {};
  std::filesystem::path left = std::exchange(file_, folder_ / (runName() + kExtension));
  lock_.reset();
  waiting_.reset();
  isWritten_ = false;
  return left;
}

void SessionRecovery::run() {
  lowerThreadPriority();
  for (;;) {
    Request request;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [this] { return isStopping_ || waiting_; });
      if (isStopping_) return;
      request = std::move(*waiting_);
      waiting_.reset();
      isWriting_ = true;
    }
    Expected<void> written;
    try {
      written = writeNow(request);
    } catch (const std::exception &error) {
      written = fail(ErrorCode::internal, error.what());
    }
    std::unique_lock lock(mutex_);
    isWriting_ = false;
    std::error_code ignored;
    if (isDiscarded_) std::filesystem::remove(file_, ignored);
    const bool isFirstFailure = !written && !hasFailed_ && !isStopping_;
    hasFailed_ = !written;
    isWritten_ = written && !isDiscarded_;
    lock.unlock();
    if (isFirstFailure && failed_) failed_(written.error());
  }
}

Expected<void> SessionRecovery::writeNow(const Request &request) {
  if (!*request.captured) return tl::unexpected(request.captured->error());
  std::error_code code;
  std::filesystem::create_directories(folder_, code);
  if (code) return fail(ErrorCode::output, pathText(folder_) + ": cannot be created: " + code.message());
  if (!lock_) {
    auto lock = lockOf(file_);
    if (!lock) return tl::unexpected(lock.error());
    lock_.emplace(std::move(*lock));
  }
  // A file of every few seconds has no images in it.
  auto saved = sessionWithView(**request.captured, request.shown, folder_, references_, {}, Embedding::none);
  if (!saved) return tl::unexpected(saved.error());
  nameArchives(folder_, *saved);
  return writeSession(*saved, file_);
}

std::vector<LostSession> SessionRecovery::lost(const std::filesystem::path &folder) {
  std::vector<LostSession> found;
  std::error_code code;
  for (std::filesystem::directory_iterator at(folder, code), end; !code && at != end; at.increment(code)) {
    if (at->path().extension() != kExtension || !lockOf(at->path())) continue;
    const auto saved = readSession(at->path());
    if (saved) found.push_back({at->path(), saved->title, saved->savedAt, saved->steps, saved->time_s});
  }
  std::sort(found.begin(), found.end(),
            [](const LostSession &a, const LostSession &b) { return a.savedAt > b.savedAt; });
  return found;
}

}  // namespace c3de::app
