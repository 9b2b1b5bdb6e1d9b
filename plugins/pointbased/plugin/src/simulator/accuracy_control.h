// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/accuracy_target.h"
#include "simulator/change_types.h"
#include "simulator/simulated_world.h"

namespace pointbased {

/// The accuracy target of the world, its budget, and the trials from which errors of its bodies are estimated. Any
/// thread.
class AccuracyControl {
 public:
  explicit AccuracyControl(SimulatedWorld &world) : world_(world) {}

  /// What the sampling of a body that is built now depends on besides the body.
  [[nodiscard]] SamplingInputs inputs() const;
  /// Input of the accuracy setting. Frames that it measures are appended to `inputs`.
  [[nodiscard]] SamplingRequest requestFor(SamplingInputs &inputs) const;
  /// The same with the frames that were measured when the inputs were recorded.
  [[nodiscard]] SamplingRequest repeatedRequest(const SamplingInputs &inputs) const;
  /// Computes the trials from which displacement errors are estimated, for bodies that have none yet: some tenths of a
  /// second each. If a body cannot be tried, or its trials are cancelled, its statement reports this.
  void computeTrials(const sdk::Progress &progress, const ParallelFor &parallelFor);

 private:
  [[nodiscard]] static SamplingRequest requestOf(const SamplingInputs &inputs);
  /// measureFrame() in this world.
  [[nodiscard]] double frameTime(const Body &body, const StopRequest *stop) const;

  SimulatedWorld &world_;
  Simulator &simulator_ = world_.simulator;
  BodyTable &table_ = world_.table;
};

}  // namespace pointbased
