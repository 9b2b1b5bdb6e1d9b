// SPDX-License-Identifier: Apache-2.0
// The bodies of a simulation on their way through a step, side by side. Private to the core.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "stepping/body_group.h"
#include "stepping/step_activity.h"

namespace pointbased::detail {

/// Advances bodies: small ones side by side, each of the others with all threads. Every body has a clock and an event
/// list of its own meanwhile, which are taken over in the order of the bodies: the same for any number of threads.
class BodyCrew {
 public:
  struct Member {
    std::size_t id = 0;             ///< of a group that of its first body
    BodyStepper *runner = nullptr;  ///< null: a group
    BodyGroup *group = nullptr;     ///< of bodies that may touch each other
    double gone = 0.0;              ///< s, that it has advanced; for who advances
    double seconds = 0.0;           ///< s of wall-clock time that it took

   private:
    friend class BodyCrew;
    bool isSmall = false, wasEnded = false;
    std::vector<std::pair<std::string, std::string>> events;
  };

  void clear() { size_ = 0; }
  void add(std::size_t id, BodyStepper &runner);
  void add(BodyGroup &group);
  [[nodiscard]] std::span<Member> members() { return {members_.data(), size_}; }

  /// Calls advance(member, order) for each of them; Stopped where one was ended, after all have.
  /// @param plainLoops  that nobody ends: each body ends its own
  void run(const StepContext &order, const ParallelFor &plainLoops, StepActivity &activity,
           const std::function<void(Member &, const StepContext &)> &advance);

 private:
  Member &addMember(std::size_t id);

  std::vector<Member> members_;  // room is kept
  std::size_t size_ = 0;
  std::vector<Member *> small_;
  std::vector<StageClock> clocks_;  // of the small ones
};

}  // namespace pointbased::detail
