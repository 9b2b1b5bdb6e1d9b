// SPDX-License-Identifier: Apache-2.0
#include "workstation/body_creation_controller.h"

#include "c3de/abi/log.h"
#include "c3de/core/log.h"

namespace c3de::app {

BodyCreationController::BodyCreationController(const Parts &parts, Events events)
    : parts_(parts), events_(std::move(events)),
      creation_(parts_.session, {[this](const BodyCreation::Result &result) { onCreated(result); }, events_.failed}) {}

void BodyCreationController::onCreated(const BodyCreation::Result &result) {
  WorkstationImages &images = parts_.images;
  if (result.isNew) images.onBodiesRemoved();
  images.onBodiesReady(result.created);
  images.showMissing(result.coverage, result.isNew);
  parts_.tools.cancelActive();  // the simulation restarts, and what a tool held is lost
  events_.joined(result.isNew, result.hasReplaced);
  parts_.session.simulation()->transport(C3DE_TRANSPORT_PLAY);
  reportCreated(result);
  reportMissing(result);
  events_.created("create " + namesOf(result.created), true);
}

void BodyCreationController::reportCreated(const BodyCreation::Result &result) {
  const bool isOne = result.created.size() == 1;
  const std::string it = isOne ? "it" : "them";
  parts_.panels.notify(
      C3DE_LOG_INFO, (isOne ? "Body created: " : "Bodies created: ") + namesOf(result.created),
      result.isNew
          ? "Pinch " + it + " in the 3D view or in a slice (P). Gravity is off, because the scan shows the organ" +
                (isOne ? "" : "s") + " in balance with it; it is in the panel of the simulation."
          : std::string(isOne ? "It" : "They") + " was added to the present simulation, which restarts.",
      {}, registry::About::simulation);
}

void BodyCreationController::reportMissing(const BodyCreation::Result &result) {
  if (!result.notTried.empty())
    parts_.panels.notify(C3DE_LOG_INFO, "Cancelled",
                         namesOf(result.notTried) + (result.notTried.size() == 1 ? " was" : " were") + " not created.");
  std::string reasons;
  for (const auto &[name, error] : result.failed) reasons += error.message + "\n";
  if (reasons.empty()) return;
  log(LogLevel::error, "bodies that could not be created: " + reasons);
  const bool isOne = result.failed.size() == 1;
  parts_.panels.notify(C3DE_LOG_ERROR,
                       isOne ? result.failed.front().first + " could not be created"
                             : std::to_string(result.failed.size()) + " bodies could not be created",
                       reasons + (isOne ? "It stays" : "They stay") + " picked; the others were created.");
}

void BodyCreationController::createScanBody(const std::string &scene) {
  parts_.loader.openText(scene, [this](const Expected<void> &made) {
    const bool isShown = parts_.images.scanBody().finished(made);
    const std::string title = made ? "Scan body created" : "Could not create the body of the scan";
    // The dialog shows it.
    if (isShown) return log(LogLevel::error, title + ": " + made.error().message);
    if (!made) return events_.failed(title, made.error());
    events_.created("create the body of the scan", false);
    parts_.tools.cancelActive();
    parts_.session.simulation()->transport(C3DE_TRANSPORT_PLAY);
    parts_.panels.notify(
        C3DE_LOG_INFO, title,
        "Pull it in a slice or in the 3D view (pinch, P). It is in balance where it lies; another gravity is "
        "in the panel of the simulation.",
        {}, registry::About::simulation);
  });
}

}  // namespace c3de::app
