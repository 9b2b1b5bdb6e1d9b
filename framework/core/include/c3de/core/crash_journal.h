// SPDX-License-Identifier: Apache-2.0
// What a run that dies leaves behind, so that the next one can say why, and which code from outside it was in.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/foreign_call.h"
#include "c3de/core/platform.h"

namespace c3de {

/// How a run has died.
struct CrashRecord {
  enum class Place {
    program,  ///< no code from outside was in it
    call,     ///< in a call of `owner`
    thread,   ///< on a thread that `owner` runs itself
    before,   ///< not in a call, but `owner` was the last one called on that thread
    hang      ///< ended from outside while a call of `owner` did not return
  };
  Place place = Place::program;
  std::string how;          ///< "SIGSEGV, an invalid access to memory"; of a hang: for how long
  std::string owner, what;  ///< as of ForeignCall; `what` may be empty

  /// For a person, to follow "the last run": "ended by SIGSEGV, …, in plugin org.x (step)".
  [[nodiscard]] std::string cause() const;
};

/// The journal of the present run: a file that is empty while all goes well, and names the culprit when the process
/// dies or hangs. From its making on, fatal signals are written to it and to the error stream, then the process dies
/// as it would have. A process has one at a time.
class CrashJournal {
 public:
  /// @param folder  made if it is not there; the same one for all runs that are to know of each other
  /// ErrorCode::output: there can be no journal; crashes are then only told on the error stream
  [[nodiscard]] static Expected<CrashJournal> begin(const std::filesystem::path &folder);
  CrashJournal(CrashJournal &&) noexcept;
  CrashJournal &operator=(CrashJournal &&) = delete;
  ~CrashJournal();  ///< the run has ended well: nothing is left

  /// Runs that have died since this was last asked; each is told once.
  [[nodiscard]] static std::vector<CrashRecord> takeLeft(const std::filesystem::path &folder);

 private:
  struct Impl;
  explicit CrashJournal(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// From now on fatal signals are told on the error stream, with the code from outside they are in. Also what the making
/// of a journal does.
void tellFatalErrors();

/// Tells whose code a crash on a thread of its own is in; the last owner of a range counts. One thread; ranges beyond
/// the first 256 are not known.
/// @param owner  lives as long as the program
void noteForeignCode(const char *owner, const CodeRange &range);

/// For the journal of this run, where there is one: a call that does not return is in it until it does. Any thread.
void noteHang(const LongCall &call);

}  // namespace c3de
