// SPDX-License-Identifier: Apache-2.0
#include "tools/condition_edits.h"

#include <algorithm>
#include <utility>

namespace pointbased {

void ConditionEdits::clear() {
  for (const auto &[attempt, step] : std::exchange(steps_, {})) services_.history.remove(step);
  lastNumber_ = 0;
  refusals_ = std::make_shared<Refusals>();
}

std::uint64_t ConditionEdits::nextNumber(const Snapshot &snapshot) {
  for (const ConditionSnapshot &other : snapshot.conditions) lastNumber_ = std::max(lastNumber_, other.number);
  return ++lastNumber_;
}

void ConditionEdits::change(const std::string &title, std::uint64_t number, std::optional<SurfaceCondition> before,
                            std::optional<SurfaceCondition> after) {
  if (!simulator_) return;
  const std::uint64_t attempt = ++lastAttempt_;
  if (const auto posted = post(attempt, number, after); !posted) return fail(posted.failure().message);
  if (!services_.history) return;
  const auto step = services_.history.add(
      title, [this, attempt, number, before = std::move(before)] { return post(attempt, number, before); },
      [this, attempt, number, after = std::move(after)] { return post(attempt, number, after); });
  if (step) steps_.emplace(attempt, *step);
}

void ConditionEdits::remove(const ConditionSnapshot &one) {
  change("remove " + one.condition.name, one.number, one.condition, std::nullopt);
}

sdk::Result<void> ConditionEdits::post(std::uint64_t attempt, std::uint64_t number,
                                       std::optional<SurfaceCondition> condition) {
  simulator_->abandonLongStep();
  return services_.simulation.post(simulator_->node(), [simulator = simulator_, refusals = refusals_, attempt, number,
                                                        condition = std::move(condition)] {
    try {
      (void)simulator->parts().changes.make(SetSurfaceCondition{number, condition});
    } catch (const sdk::Error &error) {
      const std::lock_guard lock(refusals->mutex);
      refusals->all.emplace_back(attempt, error.what());
    }
  });
}

void ConditionEdits::update() {
  std::vector<std::pair<std::uint64_t, std::string>> refused;
  {
    const std::lock_guard lock(refusals_->mutex);
    refused.swap(refusals_->all);
  }
  for (const auto &[attempt, reason] : refused) {
    fail(reason);
    const auto step = steps_.find(attempt);
    if (step == steps_.end()) continue;
    services_.history.remove(step->second);
    steps_.erase(step);
  }
}

void ConditionEdits::fail(const std::string &text) const {
  (void)services_.notifier.notify(C3DE_LOG_ERROR, "The support or load was not set", text);
}

}  // namespace pointbased
