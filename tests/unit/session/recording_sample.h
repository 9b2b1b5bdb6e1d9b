// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "c3de/session/recording_file.h"
#include "session_sample.h"

namespace c3de::test {

/// What the recording simulator begins with; plugin and class are those of no plugin.
inline session::RecordingStart recordingStart() {
  session::RecordingStart start;
  start.simulator = {"a.test.Recording/1", "", "test.recording", "1.2.3"};
  start.hashEvery = 2;
  start.session.program = "C3DE 0.1.0";
  start.session.title = "Liver, arm up – première";
  start.session.scenes = {"format = 1\n"};
  return start;
}

/// An event of each type, in an order that the recording simulator can repeat.
inline std::vector<session::RecordedEvent> eventsOfAllTypes() {
  using namespace session;
  RecordedScene scene{3, {}};
  scene.session.scenes = {"format = 1\n"};
  RecordedEnd end;
  end.steps = 4;
  end.made = 9;
  end.time_s = 0.4;
  end.hash = 0xfedcba9876543210ull;
  return {SimulationChange{"test.add", "", "add plate", 0, 0, std::string("pl\0ate", 6)},
          RecordedHash{2, 2, 0.1 + 0.2, 1},
          SimulationChange{"test.add", "key", "add hand – gauche", C3DE_SIM_CHANGE_TRANSIENT, 5, ""},
          RecordedReset{5},
          scene,
          RecordedState{3, std::string("state\0\xff", 7)},
          end};
}

/// Bytes of a recording, and where its records end; the first is the start.
struct RecordedBytes {
  std::string bytes;
  std::vector<std::size_t> ends;
};
inline RecordedBytes recordedBytes(const std::vector<session::RecordedEvent> &events) {
  RecordedBytes out{session::recordingBytes(recordingStart()).value(), {}};
  out.ends.push_back(out.bytes.size());
  for (const session::RecordedEvent &event : events) {
    out.bytes += session::recordingBytes(event).value();
    out.ends.push_back(out.bytes.size());
  }
  return out;
}

/// What reading such a file refuses it for; empty: it is read.
inline std::string refusedRecording(const std::filesystem::path &file) {
  const auto read = session::readRecording(file);
  if (read) return "";
  CHECK(read.error().code == ErrorCode::input);
  CHECK_THAT(read.error().message, Contains(file.filename().string() + ": "));
  return read.error().message;
}

}  // namespace c3de::test
