// SPDX-License-Identifier: Apache-2.0
// A record left by a run that crashes, so that the next run can report the cause and the plugin code that was running.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/platform.h"
#include "c3de/core/plugin_call.h"

namespace c3de {

/// How a run crashed.
struct CrashRecord {
  enum class Place {
    program,  ///< no plugin code was running
    call,     ///< in a call of `owner`
    thread,   ///< on a thread created by `owner`
    before,   ///< not in a call, but `owner` was the last one called on that thread
    hang      ///< terminated from outside while a call of `owner` did not return
  };
  Place place = Place::program;
  std::string how;          ///< "SIGSEGV, an invalid access to memory"; for a hang: its duration
  std::string owner, what;  ///< as for PluginCall; `what` may be empty

  /// Continues the sentence "the last run": "ended by SIGSEGV, …, in plugin org.x (step)".
  [[nodiscard]] std::string cause() const;
};

/// The journal of the present run: a file that stays empty without a fault, and records the responsible code when the
/// process crashes or hangs. While it exists, fatal signals are written to it and to the error stream; the process then
/// terminates as it would have otherwise. One per process.
class CrashJournal {
 public:
  /// @param folder  created if missing; must be the same for all runs that report each other's crashes
  /// ErrorCode::output: a journal cannot be created; crashes are then only reported on the error stream
  [[nodiscard]] static Expected<CrashJournal> begin(const std::filesystem::path &folder);
  CrashJournal(CrashJournal &&) noexcept;
  CrashJournal &operator=(CrashJournal &&) = delete;
  ~CrashJournal();  ///< the run has ended normally: removes the file

  /// Runs that crashed since the last call; each is returned once.
  [[nodiscard]] static std::vector<CrashRecord> popCrashRecords(const std::filesystem::path &folder);

 private:
  struct Impl;
  explicit CrashJournal(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// From now on fatal signals are reported on the error stream, with the plugin code that was running. Also done by
/// creating a journal.
void installFatalErrorReport();

/// Registers code of a plugin, so that a crash on one of its threads can be attributed; the last owner of a range
/// counts. One thread; ranges beyond the first 256 are ignored.
/// @param owner  must outlive the program's run
void notePluginCode(const char *owner, const CodeRange &range);

/// Records in the journal of this run, if any, a call that does not return, until it does. Any thread.
void noteHang(const LongCall &call);

}  // namespace c3de
