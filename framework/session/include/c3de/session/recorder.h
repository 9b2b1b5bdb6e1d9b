// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/core/output_file.h"
#include "c3de/core/progress.h"
#include "c3de/session/change_log.h"
#include "c3de/session/recording_file.h"
#include "c3de/session/saved_session.h"
#include "c3de/session/simulator_access.h"

namespace c3de::session {

class Session;

struct RecorderOptions {
  /// Called once if the recording ends with an error, on the thread that writes; must not destroy the recorder.
  std::function<void(const Error &)> onFailure;
  ProgressFn progress;                             ///< of the files that are embedded; create() only
  std::size_t queueBytes = std::size_t{64} << 20;  ///< that wait for the disk; beyond that the recording ends
};

/// Records a simulation in a file: all that Replay needs to repeat it. A thread of its own writes, within half a
/// second. What it has written is readable if the program is terminated. An error ends the recording, not the
/// simulation.
class Recorder {
 public:
  /// Writes the start; replaces an existing file. Errors: output; those of writeRecordingStart(), which leave no file.
  [[nodiscard]] static Expected<std::shared_ptr<Recorder>> create(const std::filesystem::path &file,
                                                                  const RecordingStart &start, c3de_object *simulator,
                                                                  RecorderOptions options = {});
  Recorder(const Recorder &) = delete;
  Recorder &operator=(const Recorder &) = delete;
  ~Recorder();  ///< without finish(), the recording is complete up to what was added last

  // Each once it has succeeded, in their order. `steps` are those since the last reset, before what happened. [sim]: on
  // the simulation's thread.
  void addChange(const SimulationChange &change);  ///< any thread
  void addStep();                                  ///< after a completed step; hashes the state if that is due [sim]
  void addReset(std::uint64_t steps);              ///< [sim]
  void addState(std::uint64_t steps, std::string bytes);              ///< as stateBytes() gives it [sim]
  void addScene(std::uint64_t steps, const SessionFile &ofOneScene);  ///< of a session with one scene [sim]

  /// Records a state hash of the present state. Errors: the one that ended the recording; the simulator's. [sim]
  [[nodiscard]] Expected<void> addPresent();
  /// Waits until what was added before is in the file. Errors: the one that ended the recording. Any thread.
  [[nodiscard]] Expected<void> waitUntilWritten();

  /// True: it has ended with an error, which finish() returns. Any thread.
  [[nodiscard]] bool hasFailed() const { return hasFailed_; }
  /// Records the end and waits until everything is written. Returns the error that ended the recording, if any. [sim]
  [[nodiscard]] Expected<void> finish();

 private:
  Recorder(OutputRows rows, std::filesystem::path file, const RecordingStart &start, c3de_object *simulator,
           const c3de_simulator_v1 *table, RecorderOptions options);
  void add(const RecordedEvent &event);
  /// Appends the hash of the present state. False: a change was made meanwhile.
  template <class Event>
  [[nodiscard]] Expected<bool> addHash();
  void endWith(const Error &error);
  void enqueue(const std::string &bytes);  ///< with the mutex held
  void stopThread();
  void write();

  OutputRows rows_;
  std::filesystem::path file_;
  ObjectRef simulator_;
  const c3de_simulator_v1 *table_;
  RecorderOptions options_;
  std::uint64_t hashEvery_;
  std::uint64_t made_ = 0, sinceHash_ = 0;  ///< steps [sim]
  bool isFinished_ = false;                 ///< [sim]

  std::mutex mutex_;
  std::condition_variable wake_, written_;
  std::string queue_;
  std::uint64_t changes_ = 0;
  bool isStopping_ = false, isWriting_ = false;
  std::optional<Error> error_;
  std::atomic<bool> hasFailed_{false};
  std::thread thread_;
};

/// What a recording of a simulation that was built from `source` begins with: its present state. Call on the thread
/// that steps it, between two steps. Errors: as sessionOf().
/// @param file  the recording
[[nodiscard]] Expected<RecordingStart> recordingStart(Session &session, c3de_object *simulator,
                                                      const SimulatorIdentity &identity, SimulationSource source,
                                                      const std::filesystem::path &file, std::uint64_t hashEvery,
                                                      const ProgressFn &progress = {},
                                                      Embedding embedding = Embedding::extracted);

}  // namespace c3de::session
