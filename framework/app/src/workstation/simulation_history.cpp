// SPDX-License-Identifier: Apache-2.0
#include "workstation/simulation_history.h"

#include <cctype>
#include <cmath>
#include <exception>
#include <utility>

#include "c3de/abi/log.h"
#include "c3de/core/log.h"
#include "c3de/core/text.h"

namespace c3de::app {
namespace {

/// Bytes of all stored states: 3 000 points take about 1 MB.
constexpr std::size_t kBudget = std::size_t{256} << 20;

std::string actionText(const std::string &label, bool isUndo) { return (isUndo ? "undo " : "redo ") + label; }

}  // namespace

SimulationHistory::~SimulationHistory() {
  while (!steps_.empty()) (void)parts_.edits.remove(steps_.begin()->second->edit);
}

void SimulationHistory::captureVersion(std::function<void(const Expected<SharedVersion> &)> done) {
  auto title = std::make_shared<std::string>();
  if (const scene::Node *node = parts_.session.sceneGraph().find(parts_.session.simulationNode())) *title = node->name;
  parts_.sessions.capture([title, done = std::move(done)](const SessionController::Captured &captured) {
    if (!*captured) return done(tl::unexpected(captured->error()));
    done(std::make_shared<const Version>(Version{std::move(**captured), *title}));
  });
}

void SimulationHistory::captureBefore(const std::function<void()> &act) {
  before_.reset();
  captureVersion([this, act](const Expected<SharedVersion> &version) {
    if (version)
      before_ = *version;
    else
      log(LogLevel::info, "what follows cannot be undone: " + version.error().message);
    act();
  });
}

void SimulationHistory::add(const std::string &label) {
  if (!before_) return;
  const std::uint64_t number = ++lastNumber_;
  auto step = std::make_unique<Step>(Step{this, number, label, std::exchange(before_, nullptr), {}});
  registry::Edit edit;
  edit.label = label;
  edit.self = step.get();
  edit.undo = &SimulationHistory::call<true>;
  edit.redo = &SimulationHistory::call<false>;
  edit.release = &SimulationHistory::release;
  Step &added = *steps_.emplace(number, std::move(step)).first->second;
  added.edit = parts_.edits.add(std::move(edit));
  keepWithinBudget();
}

void SimulationHistory::keepWithinBudget() {
  std::size_t bytes = 0;
  for (const auto &[number, step] : steps_) bytes += step->other->captured.state.size();
  while (bytes > kBudget && steps_.size() > 1) {
    const Step &oldest = *steps_.begin()->second;
    bytes -= oldest.other->captured.state.size();
    (void)parts_.edits.remove(oldest.edit);
  }
}

template <bool isUndo>
c3de_status C3DE_CALL SimulationHistory::call(void *self) noexcept {
  auto *step = static_cast<Step *>(self);
  try {
    step->history->exchange(*step, isUndo);
    return C3DE_OK;
  } catch (const std::exception &error) {
    log(LogLevel::error, std::string("an undo step failed: ") + error.what());
    return C3DE_E_INTERNAL;
  }
}

void C3DE_CALL SimulationHistory::release(void *self) noexcept {
  const auto *step = static_cast<Step *>(self);
  step->history->steps_.erase(step->number);
}

void SimulationHistory::exchange(Step &step, bool isUndo) {
  const scene::Simulation *simulation = parts_.session.simulation();
  const bool isPlaying = simulation && simulation->state().mode == C3DE_SIM_PLAYING;
  captureVersion([this, number = step.number, isUndo, isPlaying](const Expected<SharedVersion> &present) {
    const auto found = steps_.find(number);
    if (found == steps_.end()) return;
    if (present) return restore(number, isUndo, isPlaying, *present);
    // Redo would not find the present state again.
    parts_.failed("Could not " + actionText(found->second->label, isUndo), present.error());
    (void)parts_.edits.remove(found->second->edit);
  });
}

void SimulationHistory::restore(std::uint64_t number, bool isUndo, bool isPlaying, const SharedVersion &present) {
  const Step &step = *steps_.at(number);
  const CapturedState &target = step.other->captured;
  if (target.source.empty()) {
    parts_.removeSimulation();
    return onRestored(number, isUndo, isPlaying, present);
  }
  const auto opened = std::make_shared<WorkstationLoader::OpenedSession>();
  opened->action = actionText(step.label, isUndo);
  opened->title = step.other->title;
  opened->source = target.source;
  opened->saved.simulatorClass = target.identity.classId;
  opened->saved.state = target.state;
  opened->saved.stateHash = target.hash;
  opened->saved.steps = target.steps;
  parts_.loader.openSession(opened, true, [this, number, isUndo, isPlaying, present](const Expected<void> &result) {
    const auto found = steps_.find(number);
    if (found == steps_.end()) return;
    if (result) return onRestored(number, isUndo, isPlaying, present);
    parts_.failed("Could not " + actionText(found->second->label, isUndo), result.error());
    (void)parts_.edits.remove(found->second->edit);
  });
}

void SimulationHistory::onRestored(std::uint64_t number, bool isUndo, bool isPlaying, const SharedVersion &present) {
  const auto found = steps_.find(number);
  if (found == steps_.end()) return;
  Step &step = *found->second;
  const CapturedState &target = step.other->captured;
  segmentation::SegmentationWorkflow &workflow = parts_.images.workflow();
  // The structure is picked again, or not any more.
  if (isUndo && workflow.hasJustCreated()) {
    workflow.undo();
    step.isPickedAgain = true;
  } else if (!isUndo && std::exchange(step.isPickedAgain, false) && workflow.mask().canRedo()) {
    workflow.redo();
  }
  parts_.sessions.onReplaced();
  std::string text = "There is no simulation.";
  if (scene::Simulation *simulation = parts_.session.simulation()) {
    text = "The simulation is at t = " + formatNumber(std::round(1e3 * target.time_s) / 1e3) + " s.";
    if (isPlaying) simulation->transport(C3DE_TRANSPORT_PLAY);
  }
  std::string title = actionText(step.label, isUndo);
  title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
  parts_.panels.notify(C3DE_LOG_INFO, title, text, {}, registry::About::simulation);
  step.other = present;
  keepWithinBudget();
}

}  // namespace c3de::app
