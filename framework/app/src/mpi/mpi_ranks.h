// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "commands/study_ranks.h"

namespace c3de::app {

/// MPI of this process. Points are sent to other ranks one by one. Each rank runs its point in a child process; the
/// first rank also does so, besides distributing points. All ranks report to each other every second. A rank that is
/// silent for half a minute is lost, and its point is run again by others.
class MpiRanks : public StudyRanks {
 public:
  MpiRanks(int &argc, char **&argv);
  [[nodiscard]] bool isFirst() const { return rank_ == 0; }
  /// For the other ranks: runs the points it receives until the first rank stops it. Returns the exit code.
  [[nodiscard]] int work();
  /// For the first rank: stops the others and finalises MPI. Does not return if a rank is lost, because MPI would wait
  /// for it.
  void end(int exitCode);

  [[nodiscard]] std::unique_ptr<study::Workers> workers(std::size_t jobs) override;
  [[nodiscard]] std::size_t count() const override { return static_cast<std::size_t>(size_); }

 private:
  friend class RankWorkers;
  int rank_ = 0, size_ = 1;
  std::set<int> lost_;
};

}  // namespace c3de::app
