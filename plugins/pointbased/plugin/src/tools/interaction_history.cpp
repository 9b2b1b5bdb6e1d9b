// SPDX-License-Identifier: Apache-2.0
#include "tools/interaction_history.h"

namespace pointbased {

void InteractionHistory::begin(const sdk::Ref<WorldSimulator> &simulator) {
  present_.reset();
  const std::shared_ptr<const Snapshot> snapshot = simulator->snapshot();
  if (!services_.history || !snapshot) return;
  Kept kept{simulator, std::make_shared<InteractionState>(), snapshot->historyEpoch, snapshot->steps, {}};
  const auto posted = services_.simulation.post(
      simulator->node(), [simulator, state = kept.state] { *state = simulator->parts().grasps.checkpoint(); });
  if (posted) present_ = std::move(kept);
}

void InteractionHistory::end(const std::string &title, Of of) {
  if (!present_) return;
  Kept kept = std::move(*present_);
  present_.reset();
  const std::shared_ptr<const Snapshot> snapshot = kept.simulator->snapshot();
  if (isOld(kept) || !snapshot || (of == Of::time && snapshot->steps == kept.steps)) return;
  const auto go = [this, kept] { return exchange(kept); };
  const auto step = services_.history.add(title, go, go);
  if (!step) return;
  kept.step = *step;
  done_.push_back(std::move(kept));
  if (done_.size() <= kMost) return;
  services_.history.remove(done_.front().step);
  done_.pop_front();
}

sdk::Result<void> InteractionHistory::exchange(const Kept &kept) const {
  kept.simulator->abandonLongStep();
  return services_.simulation.post(kept.simulator->node(), [simulator = kept.simulator, state = kept.state] {
    simulator->parts().grasps.exchange(*state);
  });
}

bool InteractionHistory::isOld(const Kept &kept) {
  const std::shared_ptr<const Snapshot> snapshot = kept.simulator->snapshot();
  return !snapshot || snapshot->historyEpoch != kept.historyEpoch;
}

void InteractionHistory::update() {
  std::erase_if(done_, [this](const Kept &kept) {
    if (!isOld(kept)) return false;
    services_.history.remove(kept.step);
    return true;
  });
}

void InteractionHistory::forget() {
  present_.reset();
  for (const Kept &kept : done_) services_.history.remove(kept.step);
  done_.clear();
}

}  // namespace pointbased
