// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/accuracy_target.h"
#include "simulator/simulated_world.h"

namespace pointbased {

/// The accuracy target of the world, its budget, and the trials from which errors of its bodies are estimated. Any
/// thread.
class AccuracyControl {
 public:
  explicit AccuracyControl(SimulatedWorld &world) : world_(world) {}

  /// Input of the accuracy setting for a body that is built now.
  [[nodiscard]] SamplingRequest samplingRequest();
  /// Number of bodies that share a budget target.
  void shareBudget(std::size_t bodies);
  /// Computes the trials from which displacement errors are estimated, for bodies that have none yet: some tenths of a
  /// second each. If a body cannot be tried, or its trials are cancelled, its statement reports this.
  void computeTrials(const sdk::Progress &progress, const ParallelFor &parallelFor);

 private:
  /// measureFrame() in this world.
  [[nodiscard]] double frameTime(const Body &body, const StopRequest *stop) const;

  SimulatedWorld &world_;
  Simulator &simulator_ = world_.simulator;
  BodyTable &table_ = world_.table;
};

}  // namespace pointbased
