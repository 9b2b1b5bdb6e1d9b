// SPDX-License-Identifier: Apache-2.0
// The simple mode of the panel: what a user needs first.
#include "panels/controller.h"
#include "panels/holds_panel.h"

namespace pointbased {

void Controller::drawSimple(sdk::Ui &ui, const Snapshot *snapshot) {
  drawRun(ui, snapshot);
  if (snapshot) {
    drawTissue(ui, *snapshot);
    drawSupports(ui, *snapshot);
  }
  ui.heading("Gravity");
  ui.params(worldParameters_.handle(), "Gravity");
  drawAccuracy(ui, snapshot);
  if (!view_) return;
  ui.heading("Result");
  drawColours(ui, snapshot);
}

void Controller::drawTissue(sdk::Ui &ui, const Snapshot &snapshot) {
  ui.heading("Tissue");
  const BodySnapshot *body = snapshot.body(body_);
  if (!body) {
    ui.text("There is no body yet.");
    return;
  }
  if (snapshot.bodies.size() == 1) ui.value("Body", body->name);
  if (body->rigid) {
    ui.text("The body is rigid: it keeps its shape, whatever its stiffness is.");
    return;
  }
  if (body->tissues && !body->tissues->empty()) {
    // A choice for the whole body would change none of them.
    ui.value("Tissues", std::to_string(body->tissues->size()) + ", each with a stiffness of its own");
    ui.tooltip("Their stiffness is specified by the scene");
    return;
  }
  ui.params(bodyParameters_.handle(), "Stiffness");
}

void Controller::drawSupports(sdk::Ui &ui, const Snapshot &snapshot) {
  ui.heading("Supports");
  if (const BodySnapshot *body = snapshot.body(body_)) drawHolds(ui, snapshot, *body);
  if (tools_.load.isActive()) {
    loads_.draw(ui, &snapshot);
    return;
  }
  loads_.drawList(ui, snapshot);
  if (ui.button("hold", "Add a support or load…", !snapshot.bodies.empty()))
    (void)static_cast<InteractiveTool &>(tools_.load).select();
  ui.tooltip(
      "Activates the tool Load (N): press on the surface to select a part of it, then set a support, a displacement in "
      "mm, a force in N, or a pressure in kPa or mmHg");
}

}  // namespace pointbased
