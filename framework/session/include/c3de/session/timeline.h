// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/scene/simulation.h"
#include "c3de/session/keyframes.h"
#include "c3de/session/replay.h"
#include "c3de/session/timeline_axis.h"

namespace c3de::session {

struct TimelineOptions {
  std::size_t keyframeBytes = std::size_t{256} << 20;  ///< memory for states
  std::uint64_t keyframeEvery = 100;                   ///< steps
};

/// A replay that jumps: back to the last state before a position, then forward. The caller executes the jumps, see
/// jumpTo(). One thread at a time; functions marked [sim] on the simulation's thread, between two steps.
///
/// A keyframe stores the state. Where the recorded simulation stored its state, that repeats what was recorded.
/// Elsewhere it resets iterative solvers, which changes the result of implicit runs. The first of these extra keyframes
/// is therefore a trial: it is stored only if a recorded state hash lies between it and the target. If that hash
/// differs, all unverified extra keyframes are removed, no more are stored, and the replay begins again before them.
class Timeline {
 public:
  /// @param file    the recording, for messages
  /// @param source  what the recorded simulation was built from when the recording began
  Timeline(Recording recording, std::filesystem::path file, SimulationSource source, TimelineOptions options = {});

  [[nodiscard]] const Replay &replay() const { return replay_; }
  [[nodiscard]] const Recording &recording() const { return replay_.recording(); }
  [[nodiscard]] const TimelineAxis &axis() const { return axis_; }
  [[nodiscard]] const Keyframes &keyframes() const { return keyframes_; }
  /// Steps made since the recording began.
  [[nodiscard]] std::uint64_t position() const { return replay_.position().made; }
  [[nodiscard]] bool isAtEnd() const { return position() >= axis_.length(); }
  /// "differs from the recording at step 300"; empty: all state hashes so far are equal.
  [[nodiscard]] const std::string &difference() const { return difference_; }

  enum class JumpKind {
    forward,  ///< the target is ahead: advance()
    restore,  ///< restore(), then advance()
    rebuild   ///< build another simulator from the keyframe's source and state, rebuilt(), then advance()
  };
  struct Jump {
    JumpKind kind = JumpKind::forward;
    std::shared_ptr<const Keyframe> from;  ///< null for forward
  };
  /// How to reach a position.
  [[nodiscard]] Jump jumpTo(std::uint64_t made) const;
  /// A jump that begins the replay anew. It is the first one, too.
  [[nodiscard]] Jump jumpToStart() const { return {JumpKind::rebuild, start_}; }
  /// The simulator has been built from the source and the state of the keyframe.
  void rebuilt(std::shared_ptr<const Keyframe> keyframe);
  /// The simulation that replays. Another one may become that of the session meanwhile.
  struct Target {
    Session &session;
    scene::Simulation &simulation;
    std::shared_ptr<ChangeLog> changes;  ///< of the simulation
  };
  /// Takes up the state of the keyframe. After an error, jumpTo() no longer proposes this. [sim]
  [[nodiscard]] Expected<void> restore(const Target &target, std::shared_ptr<const Keyframe> keyframe);

  struct Limits {
    std::uint64_t until = 0;                                       ///< position
    double simulated_s = std::numeric_limits<double>::infinity();  ///< simulated time to advance by
    std::chrono::steady_clock::time_point deadline{std::chrono::steady_clock::time_point::max()};
    std::function<bool()> isStopped;  ///< asked before each step; may be empty
    bool mayTry = false;              ///< positions up to `until` are not shown: an extra keyframe may be tried
  };
  enum class Outcome {
    reached,  ///< the position, or the end
    paused,   ///< by a limit
    retry     ///< a keyframe was unsuitable and is removed: jumpTo() the target again
  };
  struct Advanced {
    Outcome outcome = Outcome::reached;
    double simulated_s = 0.0;
  };
  /// Repeats the recording. Errors: a change cannot be repeated, or a step fails, also from the start; the simulation
  /// stays there. [sim]
  [[nodiscard]] Expected<Advanced> advance(const Target &target, const Limits &limits);

 private:
  enum class Applied { done, retry };
  [[nodiscard]] Expected<Applied> applyDue(const Target &target);
  void onHashes(std::size_t firstEvent, bool areEqual);
  [[nodiscard]] bool discardSuspectKeyframes();
  [[nodiscard]] bool acceptDifference();
  void storeIfDue(const Target &target, const Limits &limits);
  [[nodiscard]] Expected<double> step(const Target &target);
  [[nodiscard]] bool isStoredHere() const;
  [[nodiscard]] bool hasHashUpTo(std::uint64_t made) const;
  [[nodiscard]] bool isUsableUpTo(const Keyframe &keyframe, std::uint64_t made) const;
  void begin(std::shared_ptr<const Keyframe> keyframe, bool isRestored);
  void indexChanges();

  Replay replay_;
  TimelineAxis axis_;
  TimelineOptions options_;
  Keyframes keyframes_;
  std::shared_ptr<const Keyframe> start_;
  std::vector<std::size_t> persistent_;                         ///< persistent changes before each event
  std::vector<std::pair<std::size_t, std::size_t>> exchanges_;  ///< events: one, and that which stored what it restores
  std::string difference_;
  std::optional<std::uint64_t> differsFrom_;  ///< position

  // The present pass: what was replayed since the last jump back.
  std::shared_ptr<const Keyframe> origin_;  ///< null: none, the simulator is in no position
  bool isOriginRestored_ = false;
  bool hasStoredSinceHash_ = false;  ///< an extra keyframe
  std::optional<std::uint64_t> lastHash_;
  std::uint64_t storedAt_ = 0;

  bool mayStore_ = true;           ///< extra keyframes are not known to change the result
  bool areExtraVerified_ = false;  ///< an extra keyframe was verified
  bool mayRestoreStart_ = true;
  std::shared_ptr<const SimulationSource> source_;  ///< of the last keyframe
  std::size_t sourceChanges_ = 0;
};

}  // namespace c3de::session
