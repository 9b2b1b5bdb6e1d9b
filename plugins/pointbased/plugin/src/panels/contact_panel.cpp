// SPDX-License-Identifier: Apache-2.0
#include "panels/contact_panel.h"

#include <cmath>

#include "base/number_text.h"

namespace pointbased {
namespace {

constexpr double kMillimetres = 1e3, kSquareMillimetres = 1e6;
constexpr double kReach_mm = 300.0;  // range of the position sliders, around the centre of the organs

std::string vectorText(const Vec3 &v, const char *unit) {
  return significant(v[0]) + "  " + significant(v[1]) + "  " + significant(v[2]) + " " + unit;
}

std::string percent(double part) { return significant(100.0 * part) + " %"; }

// Middle of the box around all bodies, m.
Vec3 middleOf(const Snapshot &snapshot) {
  Vec3 low = Vec3::Constant(1e300), high = -low;
  for (const BodySnapshot &body : snapshot.bodies) {
    low = low.cwiseMin(body.surface->min);
    high = high.cwiseMax(body.surface->max);
  }
  return snapshot.bodies.empty() ? Vec3(Vec3::Zero()) : Vec3(0.5 * (low + high));
}

/// Three sliders. Returns the C3DE_UI_* flags of any of them.
std::uint32_t placeSliders(sdk::Ui &ui, const std::string &id, const Vec3 &around, Vec3 &place) {
  std::uint32_t result = 0;
  for (int axis = 0; axis < 3; ++axis) {
    double value = kMillimetres * place[axis];
    const double middle = std::round(kMillimetres * around[axis]);
    const std::uint32_t changed =
        ui.slider(id + "xyz"[axis], std::string(1, "xyz"[axis]), "mm", value, middle - kReach_mm, middle + kReach_mm);
    if (changed & C3DE_UI_CHANGED) place[axis] = value / kMillimetres;
    result |= changed;
  }
  return result;
}

/// @param on  " on plate": rows of a panel have different names
void drawContactState(sdk::Ui &ui, const ObstacleTouch &touch, const std::string &on = {}) {
  ui.value("Contact force" + on, significant(touch.force.norm(), 4) + " N");
  ui.tooltip("Total force of all bodies on it, mean over the last step");
  ui.value("Force x, y, z" + on, vectorText(touch.force, "N"));
  ui.value("Contact area" + on, significant(kSquareMillimetres * touch.area) + " mm²");
  ui.tooltip("Of the skin that presses on it, at rest");
  ui.value("Displaced" + on, significant(1e6 * touch.displaced) + " ml");
  ui.tooltip("Volume of tissue whose reference position is inside it now");
  ui.value("Depth" + on, fixed(kMillimetres * touch.depth, 3) + " mm");
  ui.tooltip("Depth of the deepest point inside it: penetration not yet resolved by contact");
}

void drawCurve(sdk::Ui &ui, const std::string &id, const std::string &what, const ForceCurve &curve) {
  ui.curve(id, what + " over the last " + significant(ForceCurve::kInterval * ForceCurve::kMaxSamples) + " s", "N",
           curve.values());
}

constexpr double kAway = 1e-3;  // m: the target is ahead of the obstacle

void drawWay(sdk::Ui &ui, const Snapshot &snapshot, const Vec3 &now, const Vec3 &target) {
  const double away = (now - target).norm();
  if (away < kAway) return;
  if (snapshot.quasiStatic)
    ui.text(
        "A quasi-static solution has no time in which it could move there: reset, then place it before the first step");
  else
    ui.text("It is " + significant(kMillimetres * away, 2) +
            " mm away from there, and moves while the simulation plays (Space)");
}

}  // namespace

void drawContacts(sdk::Ui &ui, const Snapshot &snapshot) {
  for (const ContactSnapshot &contact : snapshot.contacts) {
    const ContactSummary &now = contact.summary;
    const std::string other = now.first == now.second ? "itself" : contact.second;
    ui.value(contact.first + " – " + other, significant(now.force.norm(), 4) + " N, " +
                                                significant(kSquareMillimetres * now.area, 2) + " mm², " +
                                                fixed(kMillimetres * now.depth, 3) + " mm deep");
    ui.tooltip("Force, area of the skin that presses, and how deep the deepest point is");
  }
  for (const AttachmentSnapshot &one : snapshot.attachments) {
    std::string text = significant(one.force, 4) + " N";
    if (one.tornPart > 0.0) text += ", " + percent(one.tornPart) + " torn";
    ui.value(one.first + " = " + one.second, text);
    ui.tooltip("Attachment '" + one.name + "'");
  }
}

void drawTouch(sdk::Ui &ui, TouchTool &touch, const Snapshot *snapshot) {
  ui.heading("Touch");
  if (ui.button("touch", touch.isActive() ? "Touch is active" : "Activate touch tool", !touch.isActive()))
    (void)touch.select();
  ui.tooltip(
      "Press on an organ to place the instrument. Drag to move it, turn the wheel or press D and B to push it deeper "
      "and back, press X to remove it");
  InstrumentSettings settings = touch.settings();
  (void)ui.slider("touch_radius", "Radius", "mm", settings.radius_mm, 1.0, 40.0);
  (void)ui.slider("touch_length", "Length", "mm", settings.length_mm, 0.0, 200.0);
  ui.tooltip("Between the middles of its ends; 0: a sphere. The end that is pressed with is away from the eye");
  (void)ui.slider("touch_friction", "Friction", "", settings.friction, 0.0, 2.0);
  touch.setSettings(settings);
  const ObstacleSnapshot *instrument = snapshot ? snapshot->instrument() : nullptr;
  if (!instrument || !touch.target()) {
    ui.value("Contact force", "–");
    return;
  }
  drawContactState(ui, instrument->touch);
  for (const ContactSnapshot &contact : snapshot->contacts) {
    const BodySnapshot *body = snapshot->body(contact.summary.first);
    if (contact.summary.second != instrument->id || !body || instrument->tool->radius >= body->rest->spacing) continue;
    ui.text("Thinner than the spacing of " + body->name + " (" + significant(kMillimetres * body->rest->spacing) +
            " mm): it can penetrate between the contact points. A larger radius, or more phyxels, help");
  }
  drawCurve(ui, "touch_curve", "Force", touch.forces());
  drawWay(ui, *snapshot, instrument->middle(), *touch.target());
  Vec3 place = *touch.target();
  if (placeSliders(ui, "touch_", middleOf(*snapshot), place) & C3DE_UI_CHANGED) touch.moveTo(place);
  if (ui.button("touch_away", "Remove")) touch.removeInstrument();
}

void drawGrasp(sdk::Ui &ui, GraspTool &grasp, const Snapshot *snapshot) {
  ui.heading("Grasp");
  if (ui.button("grasp", grasp.isActive() ? "Grasp is active" : "Activate grasp tool", !grasp.isActive()))
    (void)grasp.select();
  ui.tooltip("Press on an organ: two jaws grasp it and close. Drag to move them, wheel to rotate, X to release");
  GraspSettings settings = grasp.settings();
  const auto length = [&](const char *id, const char *label, double low_mm, double high_mm, double &value) {
    double mm = kMillimetres * value;
    if (ui.slider(id, label, "mm", mm, low_mm, high_mm) & C3DE_UI_CHANGED) value = mm / kMillimetres;
  };
  // Values that still have their default ratio to the size follow it, as in a scene.
  const bool openingFollows = settings.opening == 2.0 * settings.jaw,
             gapFollows = settings.closed == 0.5 * settings.opening;
  length("grasp_jaw", "Jaw size", 2.0, 60.0, settings.jaw);
  if (openingFollows) settings.opening = 2.0 * settings.jaw;
  ui.tooltip("Diameter of the patch of skin that each jaw holds, from the next press on; at least two spacings");
  length("grasp_opening", "Opening", 4.0, 120.0, settings.opening);
  ui.tooltip("Between the middles of the jaws before they close");
  if (gapFollows) settings.closed = 0.5 * settings.opening;
  length("grasp_closed", "Closed gap", 0.0, 120.0, settings.closed);
  ui.tooltip("Distance of the held patches at which the jaws stop closing");
  (void)ui.slider("grasp_limit", "Closing force limit", "N", settings.forceLimit, 0.0, 20.0);
  ui.tooltip("Closing stops above this squeezing force; 0: no limit");
  grasp.setSettings(settings);
  const GraspSnapshot *now = snapshot ? snapshot->interactiveGrasp() : nullptr;
  if (!now) {
    ui.value("Pull force", "–");
    return;
  }
  ui.value("Pull force", significant(now->forces.pull.norm(), 4) + " N");
  ui.tooltip("Of both jaws together, on the tissue");
  ui.value("Pull x, y, z", vectorText(now->forces.pull, "N"));
  ui.value("Squeezing force", significant(now->forces.squeeze, 4) + " N");
  ui.tooltip("Half of the difference of the two, along the axis of the jaws");
  ui.value("Gap", fixed(kMillimetres * now->forces.gap, 2) + " mm");
  ui.tooltip("Distance between the centres of the held patches");
  drawCurve(ui, "grasp_curve", "Pull", grasp.forces());
  if (ui.button("grasp_let_go", "Let go")) grasp.releaseGrasp();
}

void drawPlacement(sdk::Ui &ui, MoveTool &move, const Snapshot *snapshot) {
  std::vector<std::string> names{"none"};
  std::vector<std::uint64_t> ids{0};
  std::uint32_t index = 0;
  if (snapshot)
    for (const ObstacleSnapshot &obstacle : snapshot->obstacles) {
      if (obstacle.isInstrument || obstacle.hasOwnMotion) continue;
      if (obstacle.id == move.chosen()) index = static_cast<std::uint32_t>(ids.size());
      names.push_back(obstacle.name);
      ids.push_back(obstacle.id);
    }
  if (ids.size() == 1) return;
  if (ui.button("move", move.isActive() ? "Move is active" : "Activate move tool", !move.isActive()))
    (void)move.select();
  ui.tooltip("Press on an obstacle and drag; its arrows and rings move it along and about one axis");
  if (ui.choice("placed", "Obstacle", index, names)) move.choose(ids[index]);
  const ObstacleSnapshot *chosen = snapshot->obstacle(move.chosen());
  if (!chosen || !move.pose()) return;
  drawContactState(ui, chosen->touch, " on " + chosen->name);
  drawWay(ui, *snapshot, chosen->middle(), move.pose()->middle);
  ObstaclePose pose = *move.pose();
  std::uint32_t result = placeSliders(ui, "placed_", middleOf(*snapshot), pose.middle);
  Vec3 angles = anglesOf(pose.rotation);
  for (int axis = 0; axis < 3; ++axis) {
    double value = angles[axis];
    const std::uint32_t changed = ui.slider(std::string("placed_turn_") + "xyz"[axis],
                                            std::string("Turned about ") + "xyz"[axis], "°", value, -180.0, 180.0);
    if (changed & C3DE_UI_CHANGED) {
      angles[axis] = value;
      pose.rotation = rotationOf(angles);
    }
    result |= changed;
  }
  if (result & C3DE_UI_CHANGED) move.setPose(pose);
  if (result & C3DE_UI_COMMITTED) move.commit();
}

}  // namespace pointbased
