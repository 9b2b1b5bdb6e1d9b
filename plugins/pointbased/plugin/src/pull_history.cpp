// SPDX-License-Identifier: Apache-2.0
#include "pull_history.h"

namespace pointbased {

void PullHistory::begin(const sdk::Ref<WorldSimulator> &simulator) {
  present_.reset();
  const std::shared_ptr<const Snapshot> snapshot = simulator->snapshot();
  if (!services_.history || !snapshot) return;
  Pull pull{simulator, std::make_shared<Checkpoint>(), snapshot->course, snapshot->steps, {}};
  const auto posted = services_.simulation.post(simulator->node(),
                                                [simulator, state = pull.state] { *state = simulator->checkpoint(); });
  if (posted) present_ = std::move(pull);
}

void PullHistory::end(const std::string &title, Of of) {
  if (!present_) return;
  Pull pull = std::move(*present_);
  present_.reset();
  const std::shared_ptr<const Snapshot> snapshot = pull.simulator->snapshot();
  if (isOld(pull) || !snapshot || (of == Of::time && snapshot->steps == pull.steps)) return;
  const auto go = [this, pull] { return exchange(pull); };
  const auto step = services_.history.add(title, go, go);
  if (!step) return;
  pull.step = *step;
  done_.push_back(std::move(pull));
  if (done_.size() <= kMost) return;
  services_.history.remove(done_.front().step);
  done_.pop_front();
}

sdk::Result<void> PullHistory::exchange(const Pull &pull) const {
  pull.simulator->abandonLongStep();
  return services_.simulation.post(pull.simulator->node(),
                                   [simulator = pull.simulator, state = pull.state] { simulator->exchange(*state); });
}

bool PullHistory::isOld(const Pull &pull) {
  const std::shared_ptr<const Snapshot> snapshot = pull.simulator->snapshot();
  return !snapshot || snapshot->course != pull.course;
}

void PullHistory::update() {
  std::erase_if(done_, [this](const Pull &pull) {
    if (!isOld(pull)) return false;
    services_.history.remove(pull.step);
    return true;
  });
}

void PullHistory::forget() {
  present_.reset();
  for (const Pull &pull : done_) services_.history.remove(pull.step);
  done_.clear();
}

}  // namespace pointbased
