// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>

#include "app.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/session/session.h"
#include "c3de/ui/workstation_window.h"

namespace c3de::app {

/// Transport, rate and simulator class as the window chooses them; the state that it shows. Main thread.
class SimulationController {
 public:
  /// @param saveReport  opens the dialog that saves a report about a problem
  SimulationController(Session &session, registry::PanelRegistry &panels, std::function<void()> saveReport)
      : session_(session), panels_(panels), saveReport_(std::move(saveReport)) {}

  /// Adds the actions of the simulation menu and the toolbar.
  void connect(ui::WindowActions &actions);
  /// Applies the chosen rate to a new simulation.
  void applyTargetRate() { session_.simulation()->setTargetRate(targetRate_); }
  [[nodiscard]] ui::SimulationView view();
  /// Reports a failed simulation and aborted steps, each once.
  void reportProblems();

 private:
  void reportFailure();
  void reportAbortedSteps();

  Session &session_;
  registry::PanelRegistry &panels_;
  std::function<void()> saveReport_;
  double targetRate_ = 1.0;
  bool hasReportedFailure_ = false;
  std::uint64_t abortedSteps_ = 0;
  std::string activity_;  ///< of the last step that took long
};

}  // namespace c3de::app
