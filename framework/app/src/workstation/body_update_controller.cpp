// SPDX-License-Identifier: Apache-2.0
#include "workstation/body_update_controller.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "c3de/abi/log.h"
#include "c3de/core/log.h"
#include "c3de/session/body_creation.h"
#include "c3de/session/session.h"

namespace c3de::app {
namespace {

constexpr int kMaxAttempts = 3;  // if parameters change during the build

std::string energyText(double joule) {
  if (std::abs(joule) < 1e-3) return fmt::format("{:.3g} µJ", 1e6 * joule);
  return std::abs(joule) < 1.0 ? fmt::format("{:.3g} mJ", 1e3 * joule) : fmt::format("{:.3g} J", joule);
}

}  // namespace

void BodyUpdateController::onFrame() {
  showBodies();
  if (next_ && !isRunning_ && !parts_.loader.isLoading() && !parts_.history.isBusy())
    begin(*std::exchange(next_, std::nullopt));
}

void BodyUpdateController::showBodies() {
  const std::shared_ptr<ChangeLog> log = parts_.session.changes();
  const std::uint64_t count = log ? log->count() : 0;
  std::set<std::string> names = bodyNames(parts_.session);
  if (log == shownLog_ && count == shownCount_ && names == shownNames_) return;
  if (log != shownLog_ || count != shownCount_) masked_ = log ? maskedBodies(log->source()) : std::vector<MaskedBody>();
  shownLog_ = log;
  shownCount_ = count;
  shownNames_ = std::move(names);
  std::vector<segmentation::SegmentationWorkflow::ExistingBody> bodies;
  for (const MaskedBody &body : masked_)
    if (shownNames_.contains(body.name)) bodies.push_back({body.name, body.mask});
  parts_.images.workflow().setBodies(std::move(bodies));
}

void BodyUpdateController::update(const std::string &body, std::shared_ptr<const imaging::Mask> mask,
                                  const MaskRange &range) {
  Request request{body, std::move(mask), Clock::now(), range};
  // Undo of the later one reverts the changes of both.
  if (next_ && next_->body == body && next_->range.history == range.history)
    request.range.from = std::min(range.from, next_->range.from);
  next_ = std::move(request);
}

void BodyUpdateController::begin(Request request) {
  scene::Simulation *simulation = parts_.session.simulation();
  request.log = parts_.session.changes();
  if (!simulation || !request.log) return onFailed(request, {ErrorCode::state, "there is no simulation"});
  if (!bodyNames(parts_.session).contains(request.body))
    return onFailed(request, {ErrorCode::usage, "the simulation has no body of this name any more"});
  if (const std::string reason = blockingReason_(); !reason.empty())
    return onFailed(request, {ErrorCode::state, reason});
  isRunning_ = true;
  request.changes = request.log->count();
  parts_.history.captureBefore(
      [this, request = std::move(request)](std::uint64_t capture) { build(request, capture); });
}

void BodyUpdateController::build(const Request &request, std::uint64_t capture) {
  scene::Simulation *simulation = parts_.session.simulation();
  if (!simulation || parts_.session.changes() != request.log)
    return onFailed(request, {ErrorCode::state, "the simulation was closed"});
  const auto before = parts_.history.before(capture);
  if (!before) return onFailed(request, before.error());
  auto source = withMask((*before)->source, request.body, request.mask);
  if (!source) return onFailed(request, source.error());
  auto opened = std::make_shared<WorkstationLoader::OpenedSession>();
  opened->action = "update " + request.body;
  if (const scene::Node *node = parts_.session.sceneGraph().find(parts_.session.simulationNode()))
    opened->title = node->name;
  opened->saved.simulatorClass = (*before)->identity.classId;
  opened->source = std::move(*source);
  c3de_object *object = simulation->object();
  object->vt->retain(object);
  opened->continuesFrom = std::make_shared<ObjectRef>(object);
  opened->continued = std::make_shared<std::vector<ContinuedBody>>();
  const auto isOutdated = [this, request] {
    return parts_.session.changes() != request.log || request.log->count() != request.changes;
  };
  opened->isOutdated = [this, isOutdated] {
    if (const scene::Simulation *present = parts_.session.simulation())
      isPlaying_ = present->state().mode == C3DE_SIM_PLAYING;
    return isOutdated();
  };
  parts_.loader.openSession(
      opened, true, [this, request, isOutdated, continued = opened->continued](const Expected<void> &result) {
        if (result) return onBuilt(request, *continued);
        const bool isChanged = parts_.session.changes() == request.log && isOutdated();
        if (!isChanged || result.error().code == ErrorCode::cancelled || request.attempts + 1 >= kMaxAttempts)
          return onFailed(request, result.error());
        Request again = request;
        ++again.attempts;
        begin(std::move(again));
      });
}

void BodyUpdateController::onBuilt(const Request &request, const std::vector<ContinuedBody> &bodies) {
  // Tissue that a tool held belongs to the earlier body. The tools of the program hold none, and a stroke of the brush
  // continues.
  if (const registry::Tool *tool = parts_.tools.find(parts_.tools.active()); tool && tool->owner != kJobOwner)
    parts_.tools.cancelActive();
  const bool hasChanges = request.range.to > request.range.from;
  using MaskUndo = SimulationHistory::MaskUndo;
  parts_.history.add("update " + request.body, hasChanges ? MaskUndo::ofUpdate : MaskUndo::none, request.range);
  parts_.images.workflow().onBodyUpdated(request.range);
  parts_.sessions.onReplaced();
  if (isPlaying_) parts_.session.simulation()->transport(C3DE_TRANSPORT_PLAY);
  const double took_ms = std::chrono::duration<double, std::milli>(Clock::now() - request.requested).count();
  std::string text = fmt::format("{:.0f} ms after the request. It continues with its present deformation.", took_ms);
  for (const ContinuedBody &body : bodies)
    if (body.name == request.body)
      text += fmt::format("\nElastic and kinetic energy: {} → {}.", energyText(body.energyBefore_J),
                          energyText(body.energyAfter_J));
  parts_.panels.notify(C3DE_LOG_INFO, "Body updated: " + request.body, text, {}, registry::About::simulation);
  log(LogLevel::info, "body updated: " + request.body + "; " + text);
  isRunning_ = false;
}

void BodyUpdateController::onFailed(const Request &request, const Error &error) {
  const std::string text = error.message + "\nThe body stays as it was.";
  if (error.code == ErrorCode::cancelled)
    parts_.panels.notify(C3DE_LOG_INFO, "Update cancelled: " + request.body, text, {}, registry::About::simulation);
  else
    parts_.failed("Could not update " + request.body, {error.code, text});
  isRunning_ = false;
}

}  // namespace c3de::app
