// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/session/change_log.h"
#include "c3de/session/session_file.h"
#include "c3de/session/simulator_identity.h"

namespace c3de::session {

/// The version of recordings (.c3dr) that this program writes, and the newest that it reads.
inline constexpr std::uint32_t kRecordingFormat = 1;

/// Steps between two state hashes. A hash takes a seventh of a step of 3 000 points on one thread: 0.15 % of all steps.
inline constexpr std::uint64_t kDefaultHashEvery = 100;

/// What a recorded simulation began with.
struct RecordingStart {
  SimulatorIdentity simulator;  ///< without its label
  std::uint64_t hashEvery = 0;  ///< steps between two state hashes
  SessionFile session;          ///< paths are relative to the folder of the recording

  friend bool operator==(const RecordingStart &, const RecordingStart &) = default;
};

// In what follows, `steps` counts the steps since the last reset when it happened.

struct RecordedReset {
  std::uint64_t steps = 0;

  friend bool operator==(const RecordedReset &, const RecordedReset &) = default;
};

/// A state was loaded.
struct RecordedState {
  std::uint64_t steps = 0;
  std::string bytes;  ///< as stateBytes() gives it

  friend bool operator==(const RecordedState &, const RecordedState &) = default;
};

/// The bodies of a scene were added.
struct RecordedScene {
  std::uint64_t steps = 0;
  SessionFile session;  ///< with one scene and no state

  friend bool operator==(const RecordedScene &, const RecordedScene &) = default;
};

struct RecordedHash {
  std::uint64_t steps = 0;
  std::uint64_t made = 0;  ///< steps since the recording began
  double time_s = 0.0;     ///< simulated
  std::uint64_t hash = 0;  ///< of the state

  friend bool operator==(const RecordedHash &, const RecordedHash &) = default;
};

/// The recording ends with this state.
struct RecordedEnd : RecordedHash {
  friend bool operator==(const RecordedEnd &, const RecordedEnd &) = default;
};

using RecordedEvent =
    std::variant<SimulationChange, RecordedReset, RecordedState, RecordedScene, RecordedHash, RecordedEnd>;

[[nodiscard]] std::uint64_t stepsOf(const RecordedEvent &event);
/// Null: not a state hash.
[[nodiscard]] const RecordedHash *hashOf(const RecordedEvent &event);

struct Recording {
  RecordingStart start;
  std::vector<RecordedEvent> events;  ///< in their order

  /// False: the program that recorded it was terminated, or its disk was full. What was recorded before is there.
  [[nodiscard]] bool isComplete() const;
  /// The state hash that was recorded last; null: none.
  [[nodiscard]] const RecordedHash *lastHash() const;
  /// "ends early, after step 300"; empty: it is complete.
  [[nodiscard]] std::string whyIncomplete() const;
};

/// Of a recording without a scene, which cannot be replayed.
inline constexpr const char *kNothingToReplay =
    "is a report without a simulation; accepted: a recording with one. c3de info shows its log and versions";

/// Whether the file name has the extension of a recording (".c3dr").
[[nodiscard]] bool isRecordingPath(const std::filesystem::path &path);

/// The first bytes of a recording. Errors: as sessionBytes().
[[nodiscard]] Expected<std::string> recordingBytes(const RecordingStart &start);
/// The same in pieces. Embedded files are read and packed twice, because a record begins with its size. Errors: as
/// sessionBytes(), and those of the sink; cancelled, if `progress` returns false.
[[nodiscard]] Expected<void> writeRecordingStart(const RecordingStart &start,
                                                 const std::function<Expected<void>(std::string_view)> &sink,
                                                 const ProgressFn &progress = {});
/// The bytes of one event, which follow. Errors: usage, as sessionBytes(); only of a RecordedScene.
[[nodiscard]] Expected<std::string> recordingBytes(const RecordedEvent &event);

/// Reads a recording into memory, except embedded files, which stay in it (EmbeddedContent::stays). One that ends within a record is read up to the record before. Errors
/// (input) name the file, and the record with its place: no recording, a newer format, a record of an unknown type or
/// with another checksum, more than the free memory. Any thread.
[[nodiscard]] Expected<Recording> readRecording(const std::filesystem::path &path);

}  // namespace c3de::session
