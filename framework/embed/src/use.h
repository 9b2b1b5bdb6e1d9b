// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/core/embedding.h"
#include "simulation.h"

namespace c3de::embed {

/// A call to a simulation: waits for those of other threads, and is refused after its end. A call from within a
/// callback may read.
class EmbeddedSimulation::Use {
 public:
  /// cached: only what is in memory already, without a call to the simulator.
  enum class Access { cached, read, write };
  Use(EmbeddedSimulation &of, Access access) : of_(of), lock_(of.mutex_), wasInCall_(of.isInCall_) {
    if (of.isClosing_ && !wasInCall_)
      failure_ = Failure{C3DE_E_STALE, "the simulation has been closed"};
    else if (wasInCall_ && access == Access::write)
      failure_ = Failure{C3DE_E_STATE, "a callback of a simulation may read it, and must not step, change or close it"};
    of.isInCall_ = true;
    if (access != Access::cached) environment_.emplace();
  }
  ~Use() { of_.isInCall_ = wasInCall_; }
  Use(const Use &) = delete;
  Use &operator=(const Use &) = delete;

  [[nodiscard]] bool isRefused() const { return failure_.has_value(); }
  [[nodiscard]] tl::unexpected<Failure> refusal() const { return tl::unexpected(*failure_); }

 private:
  EmbeddedSimulation &of_;
  std::unique_lock<std::recursive_mutex> lock_;
  bool wasInCall_;
  std::optional<Failure> failure_;
  std::optional<OwnEnvironment> environment_;
};

}  // namespace c3de::embed
