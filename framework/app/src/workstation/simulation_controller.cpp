// SPDX-License-Identifier: Apache-2.0
#include "workstation/simulation_controller.h"

#include <utility>
#include <vector>

#include "c3de/abi/log.h"
#include "c3de/core/log.h"
#include "c3de/ui/commands.h"

namespace c3de::app {
namespace {

std::string keyOf(ui::Command command) {
  const ui::CommandInfo &info = ui::commandInfo(command);
  return ui::keyText(info.key, info.modifiers);
}

}  // namespace

void SimulationController::connect(ui::WindowActions &actions) {
  actions.simulators = [this] {
    std::vector<ui::SimulatorChoice> choices;
    for (const SimulatorIdentity &one : session_.simulators())
      choices.push_back({one.classId, one.label, one.plugin, one.classId == session_.simulatorClass()});
    return choices;
  };
  actions.chooseSimulator = [this](const std::string &id) { session_.setSimulatorClass(id); };
  actions.transport = [this](std::uint32_t action) {
    if (scene::Simulation *simulation = session_.simulation()) simulation->transport(action);
  };
  actions.setTargetRate = [this](double rate) {
    targetRate_ = rate;
    if (session_.simulation()) applyTargetRate();
  };
}

ui::SimulationView SimulationController::view() {
  ui::SimulationView view;
  view.transport.size = sizeof view.transport;
  const scene::Simulation *simulation = session_.simulation();
  if (!simulation) return view;
  view.exists = true;
  view.transport = simulation->state();
  if (view.isLongStep()) {
    // Between two steps the reason of the last one is kept.
    if (std::string now = simulation->activity(); !now.empty()) activity_ = std::move(now);
    view.activity = activity_;
  }
  if (const scene::Node *node = session_.sceneGraph().find(session_.simulationNode())) view.title = node->name;
  return view;
}

void SimulationController::reportProblems() {
  reportFailure();
  reportAbortedSteps();
}

/// With the remedy.
void SimulationController::reportFailure() {
  scene::Simulation *simulation = session_.simulation();
  const bool hasFailed = simulation && simulation->state().mode == C3DE_SIM_FAILED;
  if (hasFailed && !hasReportedFailure_) {
    const std::string why = simulation->failure();
    log(LogLevel::error, "the simulation stopped: " + why);
    panels_.notify(C3DE_LOG_ERROR, "The simulation stopped",
                   why + "\nThe last good state is shown. Reset (" + keyOf(ui::Command::reset) +
                       ") goes back to the initial state.",
                   {{"Save a report…", saveReport_}}, registry::About::simulation);
  }
  hasReportedFailure_ = hasFailed;
}

/// An aborted step has paused the simulation: reports why, and what would help.
void SimulationController::reportAbortedSteps() {
  const scene::Simulation *simulation = session_.simulation();
  const scene::Simulation::AbortedSteps now =
      simulation ? simulation->abortedSteps() : scene::Simulation::AbortedSteps();
  if (now.steps > abortedSteps_)
    panels_.notify(C3DE_LOG_WARN, "Paused: a step took too long",
                   now.why + "\n" + keyOf(ui::Command::playPause) + " tries it again, " + keyOf(ui::Command::reset) +
                       " goes back to the initial state.",
                   {{"Save a report…", saveReport_}}, registry::About::simulation);
  abortedSteps_ = now.steps;
}

}  // namespace c3de::app
