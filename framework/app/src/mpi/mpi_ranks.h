// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "commands/study_ranks.h"

namespace c3de::app {

/// MPI of this process. Points go to other ranks one by one; each runs its own in a child process, as the first one
/// does beside handing out. All tell each other every second that they are there; who is silent for half a minute is lost,
/// and what it ran is run again by others.
class MpiRanks : public StudyRanks {
 public:
  MpiRanks(int &argc, char **&argv);
  [[nodiscard]] bool isFirst() const { return rank_ == 0; }
  /// Of the other ranks: runs what it is handed until it is told to end. Returns the exit code.
  [[nodiscard]] int work();
  /// Of the first: tells the others to end, and ends MPI. Does not return where a rank is lost, which MPI would wait for.
  void end(int exitCode);

  [[nodiscard]] std::unique_ptr<study::Workers> workers(std::size_t jobs) override;
  [[nodiscard]] std::size_t count() const override { return static_cast<std::size_t>(size_); }

 private:
  friend class RankWorkers;
  int rank_ = 0, size_ = 1;
  std::set<int> lost_;
};

}  // namespace c3de::app
