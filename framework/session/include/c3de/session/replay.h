// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/session/recording_file.h"

namespace c3de::session {

class Session;

/// Repeats a recording in a simulator that has been built from its start. The caller steps: applyDueEvents(), a step,
/// countStep(), until isAtEnd().
class Replay {
 public:
  /// @param file  the recording, for messages and for files of scenes
  /// @param checksHashes  compares the recorded state hashes
  Replay(Recording recording, std::filesystem::path file, bool checksHashes);

  [[nodiscard]] const Recording &recording() const { return recording_; }
  /// Whether this simulator is the one that was recorded. Errors: plugin, with both plugins and versions.
  [[nodiscard]] Expected<void> checkSimulator(const SimulatorIdentity &identity) const;

  /// Applies what was recorded between the last step and the next one. On the thread that steps, between two steps.
  /// Errors name the recording, the step and what cannot be repeated.
  /// @param changes  of the simulator; null: none
  [[nodiscard]] Expected<void> applyDueEvents(Session &session, c3de_object *simulator, const c3de_simulator_v1 *table,
                                              const std::shared_ptr<ChangeLog> &changes,
                                              const ProgressFn &progress = {});
  void countStep() { ++made_; }
  /// Everything is repeated, or a state hash differs.
  [[nodiscard]] bool isAtEnd() const { return next_ == recording_.events.size() || !difference_.empty(); }
  /// The step at which something is repeated next. @pre  not isAtEnd()
  [[nodiscard]] std::uint64_t nextStep() const { return stepsOf(recording_.events[next_]); }
  /// The first state hash that differs: step, time, both hashes; empty: none so far.
  [[nodiscard]] const std::string &difference() const { return difference_; }
  [[nodiscard]] std::uint64_t equalHashes() const { return equalHashes_; }
  [[nodiscard]] double fraction() const;

  /// How far a replay is.
  struct Position {
    std::size_t next = 0;    ///< index of the event that is repeated next
    std::uint64_t made = 0;  ///< steps since the recording began

    friend bool operator==(const Position &, const Position &) = default;
  };
  [[nodiscard]] Position position() const { return {next_, made_}; }
  /// Continues from there: the simulator has the state of that position.
  void goTo(const Position &position);
  /// Continues behind a state hash that differs. @pre  there is a difference
  void passDifference();

 private:
  class Applier;

  Recording recording_;
  std::filesystem::path file_;
  bool checksHashes_;
  std::size_t next_ = 0;
  std::uint64_t made_ = 0, planned_ = 0;  ///< steps
  std::uint64_t equalHashes_ = 0;
  std::string difference_;
};

}  // namespace c3de::session
