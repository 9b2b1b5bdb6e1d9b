// SPDX-License-Identifier: Apache-2.0
#include "tools/interaction_history.h"

namespace pointbased {
namespace {

/// A change that has no effect if the simulation has been restarted, or has ended.
template <class Change>
Change makeIfPresent(WorldSimulator &simulator, const Change &change) {
  try {
    return simulator.parts().changes.make(change);
  } catch (const sdk::Error &error) {
    if (error.status() != C3DE_E_NOT_FOUND) throw;
    return change;
  }
}

/// Of a state of all bodies, approximately: displacements, velocities and history of the phyxels, and for each obstacle
/// the clearances of the contact points.
std::size_t bytesOf(const Snapshot &snapshot) {
  constexpr std::size_t kPhyxel = 500, kContact = 400;
  std::size_t phyxels = 0;
  for (const BodySnapshot &body : snapshot.bodies) phyxels += body.phyxels.size();
  return phyxels * (kPhyxel + kContact * snapshot.obstacles.size());
}

}  // namespace

/// A checkpoint of the simulator, until no undo step refers to it.
class InteractionHistory::StoredCheckpoint {
 public:
  StoredCheckpoint(const Services &services, sdk::Ref<WorldSimulator> simulator)
      : services_(services), simulator_(std::move(simulator)) {}
  ~StoredCheckpoint() {
    if (number_ == 0) return;
    (void)services_.simulation.post(simulator_->node(), [simulator = simulator_, number = number_] {
      (void)makeIfPresent(*simulator, DropCheckpoint{number});
    });
  }
  StoredCheckpoint(const StoredCheckpoint &) = delete;
  StoredCheckpoint &operator=(const StoredCheckpoint &) = delete;

  // On the simulation's thread.
  void store() { number_ = simulator_->parts().changes.make(StoreCheckpoint()).number; }
  void exchange() { (void)makeIfPresent(*simulator_, ExchangeCheckpoint{number_}); }

 private:
  const Services &services_;
  const sdk::Ref<WorldSimulator> simulator_;
  std::uint64_t number_ = 0;  // 0: not stored yet
};

void InteractionHistory::begin(const sdk::Ref<WorldSimulator> &simulator) {
  pending_.reset();
  const std::shared_ptr<const Snapshot> snapshot = simulator->snapshot();
  if (!services_.history || !snapshot) return;
  UndoState undo{simulator,
                 std::make_shared<StoredCheckpoint>(services_, simulator),
                 snapshot->historyEpoch,
                 snapshot->steps,
                 bytesOf(*snapshot),
                 {}};
  const auto posted =
      services_.simulation.post(simulator->node(), [checkpoint = undo.checkpoint] { checkpoint->store(); });
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
  std::deque<UndoState> &states = steps_->states_;
  states.push_back(std::move(undo));
  std::size_t bytes = 0;
  for (const UndoState &one : states) bytes += one.bytes;
  while (states.size() > 1 && bytes > InteractionSteps::kBudget) {
    bytes -= states.front().bytes;
    services_.history.remove(states.front().step);
    states.pop_front();
  }
}

sdk::Result<void> InteractionHistory::exchange(const UndoState &undo) const {
  undo.simulator->abandonLongStep();
  return services_.simulation.post(undo.simulator->node(), [checkpoint = undo.checkpoint] { checkpoint->exchange(); });
}

bool InteractionHistory::isOutdated(const UndoState &undo) {
  const std::shared_ptr<const Snapshot> snapshot = undo.simulator->snapshot();
  return !snapshot || snapshot->historyEpoch != undo.historyEpoch;
}

void InteractionHistory::update() {
  std::erase_if(steps_->states_, [this](const UndoState &undo) {
    if (!isOutdated(undo)) return false;
    services_.history.remove(undo.step);
    return true;
  });
}

void InteractionHistory::clear() {
  pending_.reset();
  for (const UndoState &undo : steps_->states_) services_.history.remove(undo.step);
  steps_->states_.clear();
}

}  // namespace pointbased
