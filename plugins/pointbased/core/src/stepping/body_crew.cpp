// SPDX-License-Identifier: Apache-2.0
#include "stepping/body_crew.h"

#include <algorithm>
#include <chrono>

namespace pointbased::detail {
namespace {

constexpr std::size_t kMostPointsOfSmall = 4000;  // more are worth all threads

// Complaints of laws of plugins are the law's, which several bodies may share.
bool isSmallBody(const Body &body) {
  if (body.rest().pointCount() > kMostPointsOfSmall) return false;
  const std::vector<Material> &materials = body.constitution().materials;
  return std::none_of(materials.begin(), materials.end(), [](const Material &m) { return m.custom != nullptr; });
}

}  // namespace

BodyCrew::Member &BodyCrew::addMember(std::size_t id) {
  if (size_ == members_.size()) members_.emplace_back();
  Member &member = members_[size_++];
  member.id = id;
  member.runner = nullptr;
  member.group = nullptr;
  member.wasEnded = false;
  member.gone = member.seconds = 0.0;
  return member;
}

void BodyCrew::add(std::size_t id, BodyStepper &runner) {
  Member &member = addMember(id);
  member.runner = &runner;
  member.isSmall = isSmallBody(runner.body());
}

void BodyCrew::add(BodyGroup &group) {
  Member &member = addMember(group.members().front().id);
  member.group = &group;
  member.isSmall = std::all_of(group.members().begin(), group.members().end(),
                               [](const BodyGroup::Member &one) { return isSmallBody(one.runner->body()); });
}

void BodyCrew::run(const StepContext &order, const ParallelFor &plainLoops, StepActivity &activity,
                   const std::function<void(Member &, const StepContext &)> &advance) {
  const auto runOne = [&](Member &member, const StepContext &own) {
    activity.enter(member.id);
    const auto begin = std::chrono::steady_clock::now();
    try {
      advance(member, own);
    } catch (const Stopped &) {
      member.wasEnded = true;  // it stays entered
      return;
    }
    member.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    activity.leave(member.id);
  };
  small_.clear();
  for (Member &member : members())
    if (member.isSmall) small_.push_back(&member);
  if (small_.size() < 2) small_.clear();  // one alone has all threads to itself
  while (clocks_.size() < small_.size()) clocks_.emplace_back(stageNames());
  const auto some = [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      Member &member = *small_[k];
      StepContext own = order;
      own.environment.clock = &clocks_[k];
      own.reportEvent = [&member](const char *kind, const std::string &text) {
        member.events.emplace_back(kind, text);
      };
      runOne(member, own);
    }
  };
  if (!small_.empty()) plainLoops(small_.size(), 1, std::cref(some));
  for (StageClock &clock : clocks_) order.environment.clock->take(clock);
  auto next = small_.begin();
  for (Member &member : members()) {
    if (next == small_.end() || *next != &member) {
      runOne(member, order);
    } else {
      ++next;
      for (const auto &[kind, text] : member.events) order.reportEvent(kind.c_str(), text);
      member.events.clear();
    }
    if (member.wasEnded) throw Stopped{};
  }
}

}  // namespace pointbased::detail
