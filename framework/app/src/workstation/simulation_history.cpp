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
  clear();
  parts_.edits.setSimulationSteps(nullptr);
}

void SimulationHistory::clear() {
  queue_.clear();
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

void SimulationHistory::captureBefore(const std::function<void(std::uint64_t capture)> &begin) {
  before_.reset();
  notCaptured_.clear();
  captureVersion([this, begin, capture = ++captures_](const Expected<SharedVersion> &version) {
    if (capture == captures_) {
      if (version)
        before_ = *version;
      else
        notCaptured_ = version.error().message;
    }
    begin(capture);
  });
}

bool SimulationHistory::addCaptured(std::uint64_t capture, const std::string &label) {
  if (capture != captures_) return false;
  add(label);
  return true;
}

Expected<const CapturedState *> SimulationHistory::before(std::uint64_t capture) const {
  if (capture != captures_) return fail(ErrorCode::state, "another change of the simulation has begun");
  if (!before_) return fail(ErrorCode::state, "its state could not be stored: " + notCaptured_);
  return &before_->captured;
}

void SimulationHistory::add(const std::string &label, MaskUndo mask, const MaskRange &range) {
  if (!before_) {
    if (const std::string why = std::exchange(notCaptured_, {}); !why.empty())
      parts_.panels.notify(C3DE_LOG_WARN, "This cannot be undone: " + label,
                           "The state before it could not be stored: " + why, {}, registry::About::simulation);
    return;
  }
  const std::uint64_t number = ++lastNumber_;
  auto step = std::make_unique<Step>(Step{this, number, label, std::exchange(before_, nullptr), {}, mask, range});
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
  const auto *step = static_cast<Step *>(self);
  try {
    step->history->enqueue(*step, isUndo);
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

void SimulationHistory::enqueue(const Step &step, bool isUndo) {
  queue_.push_back({step.number, ++lastSerial_, isUndo});
  if (queue_.size() == 1) begin();
}

void SimulationHistory::end() {
  if (!queue_.empty()) queue_.pop_front();
  if (!queue_.empty()) begin();
}

SimulationHistory::Step *SimulationHistory::stepOf(const Exchange &exchange) {
  const auto found = steps_.find(exchange.step);
  const bool isFirst = !queue_.empty() && queue_.front().serial == exchange.serial;
  return isFirst && found != steps_.end() ? found->second.get() : nullptr;
}

void SimulationHistory::begin() {
  const scene::Simulation *simulation = parts_.session.simulation();
  Exchange exchange = queue_.front();
  if (!stepOf(exchange)) return end();
  exchange.isPlaying = simulation && simulation->state().mode == C3DE_SIM_PLAYING;
  captureVersion([this, exchange](const Expected<SharedVersion> &present) mutable {
    if (!stepOf(exchange)) return;
    // Redo would not find the present state again.
    if (!present) return onNotCaptured(exchange, present.error());
    exchange.present = *present;
    restore(exchange);
  });
}

void SimulationHistory::onFailed(const Exchange &exchange, const Error &error) {
  const Step &step = *stepOf(exchange);
  parts_.failed("Could not " + actionText(step.label, exchange.isUndo), error);
  (void)parts_.edits.remove(step.edit);
  end();
}

void SimulationHistory::onNotCaptured(const Exchange &exchange, const Error &error) {
  parts_.failed("Could not " + actionText(stepOf(exchange)->label, exchange.isUndo),
                {error.code, error.message + "\nThe step is kept: try it again."});
  const std::deque<Exchange> waiting = std::exchange(queue_, {});
  for (auto one = waiting.rbegin(); one != waiting.rend(); ++one)
    if (const auto step = steps_.find(one->step); step != steps_.end())
      parts_.edits.takeBack(step->second->edit, one->isUndo);
}

void SimulationHistory::restore(const Exchange &exchange) {
  const Step &step = *stepOf(exchange);
  const CapturedState &target = step.other->captured;
  if (target.source.empty()) {
    parts_.removeSimulation();
    return onRestored(exchange);
  }
  const auto opened = std::make_shared<WorkstationLoader::OpenedSession>();
  opened->action = actionText(step.label, exchange.isUndo);
  opened->title = step.other->title;
  opened->source = target.source;
  opened->saved.simulatorClass = target.identity.classId;
  opened->saved.state = target.state;
  opened->saved.stateHash = target.hash;
  opened->saved.steps = target.steps;
  parts_.loader.openSession(opened, true, [this, exchange](const Expected<void> &result) {
    if (!stepOf(exchange)) return;
    result ? onRestored(exchange) : onFailed(exchange, result.error());
  });
}

void SimulationHistory::onRestored(const Exchange &exchange) {
  Step &step = *stepOf(exchange);
  const CapturedState &target = step.other->captured;
  segmentation::SegmentationWorkflow &workflow = parts_.images.workflow();
  if (exchange.isUndo) {
    if (step.mask == MaskUndo::ofCreation && workflow.hasJustCreated()) {
      workflow.undo();
      step.isMaskUndone = true;
    } else if (step.mask == MaskUndo::ofUpdate) {
      step.isMaskUndone = workflow.undoUpdate(step.range);
    }
  } else if (std::exchange(step.isMaskUndone, false)) {
    if (step.mask == MaskUndo::ofUpdate)
      (void)workflow.redoUpdate(step.range);
    else
      workflow.redo();
  }
  parts_.sessions.onReplaced();
  std::string text = "There is no simulation.";
  if (scene::Simulation *simulation = parts_.session.simulation()) {
    text = "The simulation is at t = " + formatNumber(std::round(1e3 * target.time_s) / 1e3) + " s.";
    if (exchange.isPlaying) simulation->transport(C3DE_TRANSPORT_PLAY);
  }
  std::string title = actionText(step.label, exchange.isUndo);
  title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
  parts_.panels.notify(C3DE_LOG_INFO, title, text, {}, registry::About::simulation);
  step.other = exchange.present;
  keepWithinBudget();
  end();
}

}  // namespace c3de::app
