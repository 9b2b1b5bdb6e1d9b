// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app.h"
#include "c3de/core/expected.h"
#include "c3de/core/platform.h"
#include "c3de/session/saved_session.h"

namespace c3de::app {

/// What the window shows beside the simulation, with the paths of its files.
struct ShownView {
  std::filesystem::path image;
  std::vector<std::filesystem::path> labels;
  std::filesystem::path comparison;           ///< of view.comparison, which exists if this is not empty
  SessionView view;                           ///< without the names of files and members
  std::shared_ptr<const imaging::Mask> mask;  ///< of view.selection; null: none
};

/// A session file of captured state and view. Any thread, one at a time with these references.
[[nodiscard]] Expected<SessionFile> sessionWithView(const CapturedState &captured, const ShownView &shown,
                                                    const std::filesystem::path &folder, FileReferences &references,
                                                    const ProgressFn &progress, Embedding embedding);

/// A session that a run left behind when it ended without saving.
struct LostSession {
  std::filesystem::path file;
  std::string title, savedAt;
  std::uint64_t steps = 0;
  double time_s = 0.0;
};

/// Removes it, with the file of its lock.
void removeRecovery(std::filesystem::path session);

/// The recovery file of this run: a session that a thread of its own writes. Main thread, unless stated otherwise.
class SessionRecovery {
 public:
  /// @param folder  created when the first session is written; the same for all runs of a user
  /// @param failed  called on the writing thread, for the first failure after a success only; not after stop()
  SessionRecovery(std::filesystem::path folder, std::function<void(const Error &)> failed);
  ~SessionRecovery() { stop(false); }
  SessionRecovery(const SessionRecovery &) = delete;
  SessionRecovery &operator=(const SessionRecovery &) = delete;

  /// Writes in the background and returns at once. A session that waits is replaced.
  void write(std::shared_ptr<Expected<CapturedState>> captured, ShownView shown);
  [[nodiscard]] bool isWriting() const;
  /// Ends the thread; later calls have no effect. @param leaves  the file stays for the next run
  void stop(bool leaves);
  /// Everything is saved: removes the file.
  void discard();
  /// The file has the last session that was requested.
  [[nodiscard]] bool isWritten() const;
  /// The last session could not be written.
  [[nodiscard]] bool hasFailed() const;
  /// The file stays as that of an ended run, and the next session gets another one. Empty: there is no file.
  [[nodiscard]] std::filesystem::path handOver();

  /// Sessions of runs that are not running any more; unreadable ones are left out. Any thread.
  [[nodiscard]] static std::vector<LostSession> lost(const std::filesystem::path &folder);

 private:
  struct Request {
    std::shared_ptr<Expected<CapturedState>> captured;
    ShownView shown;
  };
  void run();
  [[nodiscard]] Expected<void> writeNow(const Request &request);

  std::filesystem::path folder_, file_;
  std::function<void(const Error &)> failed_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<Request> waiting_;
  bool isWriting_ = false, isStopping_ = false, isDiscarded_ = false, hasFailed_ = false;
  bool isWritten_ = false;
  FileReferences references_;
  std::optional<FileLock> lock_;
  std::thread thread_;
};

}  // namespace c3de::app
