// SPDX-License-Identifier: Apache-2.0
#include "pointbased/simulator.h"

#include "body/state_hash.h"
#include "stepping/simulation/simulation_state.h"

namespace pointbased {

Simulator::Simulator(ParallelFor parallelFor)
    : state_(std::make_unique<detail::SimulationState>(std::move(parallelFor))), world_(*state_),
      stepper_(*state_, world_), archive_(*state_), diagnostics_(*state_, world_) {}
Simulator::~Simulator() = default;

void Simulator::reset() { state_->reset(); }
double Simulator::time() const { return state_->time(); }
double Simulator::loadFactor() const { return quasiStatic() ? state_->progress.loadFactor : 1.0; }
bool Simulator::quasiStatic() const { return state_->quasiStatic(); }
bool Simulator::finished() const { return state_->finished(); }
std::uint64_t Simulator::steps() const { return state_->progress.steps; }

std::uint64_t Simulator::stateHash() const {
  std::uint64_t hash = detail::kHashStart;
  for (const auto &[id, stepper] : state_->bodies) hash = detail::hashOf(stepper->body(), hash);
  return hash;
}

}  // namespace pointbased
