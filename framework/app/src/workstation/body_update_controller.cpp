// SPDX-License-Identifier: Apache-2.0
#include "workstation/body_update_controller.h"

#include <fmt/format.h>

#include <utility>

#include "c3de/abi/log.h"
#include "c3de/core/log.h"
#include "c3de/session/body_creation.h"

namespace c3de::app {
namespace {

constexpr int kTries = 3;  // while the user changes parameters meanwhile

std::string energyText(double joule) {
  if (std::abs(joule) < 1e-3) return fmt::format("{:.3g} µJ", 1e6 * joule);
  return std::abs(joule) < 1.0 ? fmt::format("{:.3g} mJ", 1e3 * joule) : fmt::format("{:.3g} J", joule);
}

}  // namespace

void BodyUpdateController::showBodies() {
  const std::shared_ptr<ChangeLog> log = parts_.session.changes();
  const std::uint64_t count = log ? log->count() : 0;
  if (log.get() == shownLog_ && count == shownCount_) return;
  shownLog_ = log.get();
  shownCount_ = count;
  std::vector<segmentation::SegmentationWorkflow::ExistingBody> bodies;
  if (log)
    for (MaskedBody &body : maskedBodies(log->source())) bodies.push_back({std::move(body.name), std::move(body.mask)});
  parts_.images.workflow().setBodies(std::move(bodies));
}

void BodyUpdateController::update(const std::string &body, std::shared_ptr<const imaging::Mask> mask) {
  Request request{body, std::move(mask), Clock::now()};
  request.isOfStroke = parts_.images.workflow().isUpdatedLive();
  if (isRunning_)
    next_ = std::move(request);
  else
    begin(std::move(request));
}

void BodyUpdateController::begin(Request request) {
  scene::Simulation *simulation = parts_.session.simulation();
  if (!simulation) return onFailed(request, {ErrorCode::state, "there is no simulation"});
  if (!bodyNames(parts_.session).contains(request.body))
    return onFailed(request, {ErrorCode::usage, "the simulation has no body of this name any more"});
  if (const std::string reason = prepare_(); !reason.empty()) return onFailed(request, {ErrorCode::state, reason});
  isRunning_ = true;
  request.isPlaying = simulation->state().mode == C3DE_SIM_PLAYING;
  parts_.history.captureBefore([this, request = std::move(request)](std::uint64_t) { build(request); });
}

void BodyUpdateController::build(const Request &request) {
  scene::Simulation *simulation = parts_.session.simulation();
  const std::shared_ptr<ChangeLog> log = parts_.session.changes();
  if (!simulation || !log) return onFailed(request, {ErrorCode::state, "the simulation was closed"});
  const CapturedState *before = parts_.history.before();
  if (before == nullptr) return onFailed(request, {ErrorCode::state, parts_.history.notCaptured()});
  auto source = withMask(before->source, request.body, request.mask);
  if (!source) return onFailed(request, source.error());
  auto opened = std::make_shared<WorkstationLoader::OpenedSession>();
  opened->action = "update " + request.body;
  if (const scene::Node *node = parts_.session.sceneGraph().find(parts_.session.simulationNode()))
    opened->title = node->name;
  opened->saved.simulatorClass = before->identity.classId;
  opened->source = std::move(*source);
  c3de_object *object = simulation->object();
  object->vt->retain(object);
  opened->continuesFrom = std::make_shared<ObjectRef>(object);
  opened->continued = std::make_shared<std::vector<ContinuedBody>>();
  opened->isOutdated = [this, object, log, count = log->count()] {
    const scene::Simulation *present = parts_.session.simulation();
    return !present || present->object() != object || log->count() != count;
  };
  parts_.loader.openSession(
      opened, true,
      [this, request, continued = opened->continued, isOutdated = opened->isOutdated](const Expected<void> &result) {
        if (result) return onBuilt(request, *continued);
        scene::Simulation *present = parts_.session.simulation();
        if (result.error().code != ErrorCode::cancelled && present && isOutdated() && request.tries + 1 < kTries) {
          Request again = request;
          ++again.tries;
          return begin(std::move(again));
        }
        onFailed(request, result.error());
      });
}

void BodyUpdateController::onBuilt(const Request &request, const std::vector<ContinuedBody> &bodies) {
  parts_.tools.cancelActive();  // the tissue that a tool held belongs to the earlier body
  using MaskUndo = SimulationHistory::MaskUndo;
  parts_.history.add("update " + request.body, request.isOfStroke ? MaskUndo::ofStroke : MaskUndo::none);
  parts_.sessions.onReplaced();
  if (request.isPlaying) parts_.session.simulation()->transport(C3DE_TRANSPORT_PLAY);
  const double took_ms = std::chrono::duration<double, std::milli>(Clock::now() - request.requested).count();
  std::string text = fmt::format("{:.0f} ms after the request. It continues with its present deformation.", took_ms);
  for (const ContinuedBody &body : bodies)
    if (body.name == request.body)
      text += fmt::format("\nElastic and kinetic energy: {} → {}.", energyText(body.energyBefore_J),
                          energyText(body.energyAfter_J));
  parts_.panels.notify(C3DE_LOG_INFO, "Body updated: " + request.body, text, {}, registry::About::simulation);
  log(LogLevel::info, "body updated: " + request.body + "; " + text);
  end();
}

void BodyUpdateController::onFailed(const Request &request, const Error &error) {
  parts_.failed("Could not update " + request.body, {error.code, error.message + "\nThe body stays as it was."});
  end();
}

void BodyUpdateController::end() {
  isRunning_ = false;
  if (auto next = std::exchange(next_, std::nullopt)) begin(std::move(*next));
}

}  // namespace c3de::app
