// SPDX-License-Identifier: Apache-2.0
#include "tools/interaction_history.h"

namespace pointbased {

void InteractionHistory::begin(const sdk::Ref<WorldSimulator> &simulator) {
  pending_.reset();
  const std::shared_ptr<const Snapshot> snapshot = simulator->snapshot();
  if (!services_.history || !snapshot) return;
  UndoState undo{simulator, std::make_shared<InteractionState>(), snapshot->historyEpoch, snapshot->steps, {}};
  const auto posted = services_.simulation.post(
      simulator->node(), [simulator, state = undo.state] { *state = simulator->parts().grasps.checkpoint(); });
  if (posted) pending_ = std::move(undo);
}

void InteractionHistory::end(const std::string &title, Kind kind) {
  if (!pending_) return;
  UndoState undo = std::move(*pending_);
  pending_.reset();
  const std::shared_ptr<const Snapshot> snapshot = undo.simulator->snapshot();
  if (isOutdated(undo) || !snapshot || (kind == Kind::simulation && snapshot->steps == undo.steps)) return;
  const auto exchangeStates = [this, undo] { return exchange(undo); };
  const auto step = services_.history.add(title, exchangeStates, exchangeStates);
  if (!step) return;
  undo.step = *step;
  undoStates_.push_back(std::move(undo));
  if (undoStates_.size() <= kMaxSteps) return;
  services_.history.remove(undoStates_.front().step);
  undoStates_.pop_front();
}

sdk::Result<void> InteractionHistory::exchange(const UndoState &undo) const {
  undo.simulator->abandonLongStep();
  return services_.simulation.post(undo.simulator->node(), [simulator = undo.simulator, state = undo.state] {
    simulator->parts().grasps.exchange(*state);
  });
}

bool InteractionHistory::isOutdated(const UndoState &undo) {
  const std::shared_ptr<const Snapshot> snapshot = undo.simulator->snapshot();
  return !snapshot || snapshot->historyEpoch != undo.historyEpoch;
}

void InteractionHistory::update() {
  std::erase_if(undoStates_, [this](const UndoState &undo) {
    if (!isOutdated(undo)) return false;
    services_.history.remove(undo.step);
    return true;
  });
}

void InteractionHistory::clear() {
  pending_.reset();
  for (const UndoState &undo : undoStates_) services_.history.remove(undo.step);
  undoStates_.clear();
}

}  // namespace pointbased
