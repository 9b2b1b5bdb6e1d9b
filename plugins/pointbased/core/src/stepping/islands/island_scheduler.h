// SPDX-License-Identifier: Apache-2.0
// Scheduling of the bodies and islands of a step on threads. Private to the core.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "stepping/islands/island.h"
#include "stepping/monitoring/step_activity.h"

namespace pointbased::detail {

/// Advances bodies and islands: small ones concurrently, each of the others with all threads. Concurrent ones have
/// separate clocks and event lists, which are merged in the order of the bodies. Results are identical for any number
/// of threads.
class IslandScheduler {
 public:
  struct Member {
    std::size_t id = 0;              ///< of an island that of its first body
    BodyStepper *stepper = nullptr;  ///< null: an island
    Island *island = nullptr;        ///< null: a single body
    double advanced = 0.0;           ///< s, by which it has advanced; set by the callback
    double seconds = 0.0;            ///< s, wall-clock time spent on it

   private:
    friend class IslandScheduler;
    bool isSmall = false, wasEnded = false;
    std::vector<std::pair<std::string, std::string>> events;
  };

  void clear() { size_ = 0; }
  void add(std::size_t id, BodyStepper &stepper);
  void add(Island &island);
  [[nodiscard]] std::span<Member> members() { return {members_.data(), size_}; }

  /// Calls advance(member, context) for each of them. Throws Stopped if one was cancelled, after all have ended.
  /// @param plainLoops  loops without cancellation: each body adds its own
  void run(const StepContext &context, const ParallelFor &plainLoops, StepActivity &activity,
           const std::function<void(Member &, const StepContext &)> &advance);

 private:
  Member &addMember(std::size_t id);

  std::vector<Member> members_;  // memory is reused
  std::size_t size_ = 0;
  std::vector<Member *> small_;
  std::vector<StageClock> clocks_;  // of the small members
};

}  // namespace pointbased::detail
