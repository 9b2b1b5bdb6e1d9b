// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "c3de/session/recording_file.h"

namespace c3de::session {

/// A recorded change on the axis of its recording. Equal changes in a row, such as the moves of a pull, are one mark.
struct TimelineMark {
  std::uint64_t made = 0;  ///< steps since the recording began
  std::string text;        ///< for people: "pull on liver"
};

/// Steps and times of a recording, known before it is replayed. A position is the number of steps made since the
/// recording began: steps and times of the simulation begin again with each reset.
class TimelineAxis {
 public:
  explicit TimelineAxis(const Recording &recording);

  /// Steps of the whole recording.
  [[nodiscard]] std::uint64_t length() const { return length_; }
  /// Simulated time since the recording began, s; interpolated between the recorded state hashes.
  [[nodiscard]] double timeAt_s(std::uint64_t made) const;
  /// Position of each event.
  [[nodiscard]] const std::vector<std::uint64_t> &events() const { return events_; }
  [[nodiscard]] const std::vector<TimelineMark> &marks() const { return marks_; }

 private:
  void placeEvents(const Recording &recording);
  void addTimes(const Recording &recording);
  void addMarks(const Recording &recording);

  struct Point {
    std::uint64_t made = 0;
    double time_s = 0.0;
  };
  std::uint64_t length_ = 0;
  std::vector<std::uint64_t> events_;
  std::vector<Point> times_;  ///< in their order
  std::vector<TimelineMark> marks_;
};

}  // namespace c3de::session
