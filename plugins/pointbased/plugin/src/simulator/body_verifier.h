// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulator/simulated_world.h"
#include "simulator/snapshot_writer.h"

namespace pointbased {

/// Verifies the bodies against their fine references, in parallel to the steps of the simulation. Any thread.
class BodyVerifier {
 public:
  BodyVerifier(SimulatedWorld &world, SnapshotWriter &snapshots) : world_(world), snapshots_(snapshots) {}

  /// Deviation of the bodies from their fine references, between two steps. The simulation does not change, and may
  /// continue meanwhile. Throws sdk::Error when cancelled.
  std::shared_ptr<const WorldVerification> verify(const sdk::Progress &progress);
  /// Same, as JSON.
  void report(const c3de_progress *progress, c3de_sink json);

 private:
  SimulatedWorld &world_;
  SnapshotWriter &snapshots_;
  Simulator &simulator_ = world_.simulator;
  BodyTable &table_ = world_.table;
};

}  // namespace pointbased
