// SPDX-License-Identifier: Apache-2.0
// State that StateArchive::restore() restores. Private to the core.
#pragma once

#include "stepping/simulation/simulation_state.h"

namespace pointbased {

struct detail::SimulatorCheckpoint {
  std::uint64_t historyEpoch = 0, contactSwitches = 0;
  std::map<std::size_t, BodyStepper::Checkpoint> bodies;
  std::vector<Probe> probes;
  Progress progress;
  std::vector<SimulationEvent> events;
  ReportedFindings reported;
  std::map<SkinContacts::PairId, SkinPair::State> contacts;
  std::map<std::size_t, std::vector<std::uint8_t>> torn;  // of attachments
  ObstacleSet obstacles;
};

}  // namespace pointbased
