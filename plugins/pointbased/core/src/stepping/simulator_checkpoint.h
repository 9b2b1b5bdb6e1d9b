// SPDX-License-Identifier: Apache-2.0
// State that Simulator::restore() restores. Private to the core.
#pragma once

#include "pointbased/simulator.h"
#include "stepping/body_stepper.h"
#include "stepping/skin_contacts.h"

namespace pointbased {

struct detail::SimulatorCheckpoint {
  std::uint64_t historyEpoch = 0, contactSwitches = 0;
  std::map<std::size_t, BodyStepper::Checkpoint> bodies;
  std::vector<Probe> probes;
  double time = 0.0, loadFactor = 0.0;
  std::uint64_t steps = 0;
  std::vector<SimulationEvent> events;
  std::set<std::size_t> notRereferenced;
  std::map<std::size_t, double> skinDeepest, rigidDeepest;
  std::set<std::pair<std::size_t, std::size_t>> overlaps;
  std::pair<std::size_t, std::size_t> lastPair;
  std::map<SkinContacts::PairId, SkinPair::State> contacts;
  std::map<std::size_t, std::vector<std::uint8_t>> torn;  // of attachments
  std::set<std::size_t> tornReported;
  std::vector<Obstacle> obstacles;
  std::vector<std::size_t> obstacleIds;
  std::set<std::size_t> instruments;
  std::map<std::size_t, std::function<RigidMotion(double t)>> ownMotions;
};

}  // namespace pointbased
