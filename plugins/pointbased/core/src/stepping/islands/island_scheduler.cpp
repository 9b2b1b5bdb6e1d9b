// SPDX-License-Identifier: Apache-2.0
#include "stepping/islands/island_scheduler.h"

#include <algorithm>
#include <chrono>

namespace pointbased::detail {
namespace {

constexpr std::size_t kMaxPointsOfSmall = 4000;  // larger ones use all threads

// Error texts belong to the laws of plugins, which several bodies may share.
bool isSmallBody(const Body &body) {
  if (body.rest().pointCount() > kMaxPointsOfSmall) return false;
  const std::vector<Material> &materials = body.constitution().materials;
  return std::none_of(materials.begin(), materials.end(), [](const Material &m) { return m.custom != nullptr; });
}

}  // namespace

IslandScheduler::Member &IslandScheduler::addMember(std::size_t id) {
  if (size_ == members_.size()) members_.emplace_back();
  Member &member = members_[size_++];
  member.id = id;
  member.stepper = nullptr;
  member.island = nullptr;
  member.wasEnded = false;
  member.advanced = member.seconds = 0.0;
  return member;
}

void IslandScheduler::add(std::size_t id, BodyStepper &stepper) {
  Member &member = addMember(id);
  member.stepper = &stepper;
  member.isSmall = isSmallBody(stepper.body());
}

void IslandScheduler::add(Island &island) {
  Member &member = addMember(island.members().front().id);
  member.island = &island;
  member.isSmall = std::all_of(island.members().begin(), island.members().end(),
                               [](const Island::Member &one) { return isSmallBody(one.stepper->body()); });
}

void IslandScheduler::run(const StepContext &context, const ParallelFor &plainLoops, StepActivity &activity,
                          const std::function<void(Member &, const StepContext &)> &advance) {
  const auto advanceOne = [&](Member &member, const StepContext &own) {
    activity.enter(member.id);
    const auto begin = std::chrono::steady_clock::now();
    try {
      advance(member, own);
    } catch (const Stopped &) {
      member.wasEnded = true;  // it remains marked as entered
      return;
    }
    member.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    activity.leave(member.id);
  };
  small_.clear();
  for (Member &member : members())
    if (member.isSmall) small_.push_back(&member);
  if (small_.size() < 2) small_.clear();  // a single one uses all threads
  while (clocks_.size() < small_.size()) clocks_.emplace_back(stageNames());
  const auto some = [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      Member &member = *small_[k];
      StepContext own = context;
      own.environment.clock = &clocks_[k];
      own.reportEvent = [&member](const char *kind, const std::string &text) {
        member.events.emplace_back(kind, text);
      };
      advanceOne(member, own);
    }
  };
  if (!small_.empty()) plainLoops(small_.size(), 1, std::cref(some));
  for (StageClock &clock : clocks_) context.environment.clock->take(clock);
  auto next = small_.begin();
  for (Member &member : members()) {
    if (next == small_.end() || *next != &member) {
      advanceOne(member, context);
    } else {
      ++next;
      for (const auto &[kind, text] : member.events) context.reportEvent(kind.c_str(), text);
      member.events.clear();
    }
    if (member.wasEnded) throw Stopped{};
  }
}

}  // namespace pointbased::detail
