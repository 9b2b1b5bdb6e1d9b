// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/session/simulator_access.h"
#include "simulation.h"

namespace c3de::embed {

/// Long work that cancel() of another thread ends. cancel() has an effect only while this object exists.
class EmbeddedSimulation::Running {
 public:
  explicit Running(EmbeddedSimulation &of) : of_(of) {
    const std::lock_guard lock(of.cancelMutex_);
    of.isRunning_ = true;
    of.isCancelled_ = false;
  }
  ~Running() {
    const std::lock_guard lock(of_.cancelMutex_);
    of_.isRunning_ = false;
    if (of_.isCancelled_ && session::endsSteps(of_.table_)) (void)of_.table_->interrupt(of_.simulator_->get(), 0);
  }
  Running(const Running &) = delete;
  Running &operator=(const Running &) = delete;
  [[nodiscard]] bool isOver() const { return of_.isCancelled_ || of_.isClosing_; }
  /// The progress of the work, which ends with cancel() as well.
  [[nodiscard]] ProgressFn progress(ProgressFn shown) const {
    return [this, shown = std::move(shown)](double fraction, const std::string &what) {
      return !isOver() && (!shown || shown(fraction, what));
    };
  }

 private:
  EmbeddedSimulation &of_;
};

}  // namespace c3de::embed
