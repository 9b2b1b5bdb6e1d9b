// SPDX-License-Identifier: Apache-2.0
#include "panels/load_panel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <locale>
#include <sstream>

#include "base/number_text.h"
#include "base/placed_mesh.h"

namespace pointbased {
namespace {

const std::array<std::string, 3> kModes{"brush", "face", "box"};
const std::array<std::string, 2> kBorders{"at its edges", "where it tilts"};
const std::array<std::string, 4> kKinds{"Fix", "Displace", "Force", "Pressure"};
const std::array<std::string, 2> kPressureUnits{"kPa", "mmHg"};
const std::array<std::string, 2> kDirections{"x y z", "outward normal"};
constexpr std::array<double, 2> kPascals{1e3, 133.322};

/// `count` numbers separated by spaces, and nothing else.
std::optional<std::vector<double>> numbersOf(const std::string &text, std::size_t count) {
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  std::vector<double> out;
  for (double value = 0.0; in >> value;) out.push_back(value);
  if (!in.eof() || out.size() != count) return std::nullopt;
  return out;
}

std::string threeNumbers(const Vec3 &x, double scale) {
  return shortNumber(scale * x[0]) + " " + shortNumber(scale * x[1]) + " " + shortNumber(scale * x[2]);
}

std::string_view unitOf(ConditionKind kind) {
  switch (kind) {
    case ConditionKind::displace: return "mm";
    case ConditionKind::force: return "N";
    case ConditionKind::pressure: return "kPa";
    default: return "";
  }
}

std::string textOf(const SurfaceCondition &one) {
  switch (one.kind) {
    case ConditionKind::displace: return threeNumbers(one.vector, 1e3);
    case ConditionKind::force: return threeNumbers(one.vector, 1.0);
    case ConditionKind::pressure: return shortNumber(1e-3 * one.pressure);
    default: return {};
  }
}

/// False if the text is not a value of this kind.
bool readValue(const std::string &text, SurfaceCondition &one) {
  const auto numbers = numbersOf(text, one.kind == ConditionKind::pressure ? 1 : 3);
  if (!numbers) return false;
  if (one.kind == ConditionKind::pressure)
    one.pressure = 1e3 * numbers->front();
  else
    one.vector = (one.kind == ConditionKind::displace ? 1e-3 : 1.0) * Vec3(numbers->data());
  return true;
}

}  // namespace

void LoadPanel::setSimulator(WorldSimulator *simulator) {
  if (simulator_.get() == simulator) return;
  simulator_ = simulator ? sdk::Ref<WorldSimulator>::share(simulator) : sdk::Ref<WorldSimulator>();
  edited_.clear();
}

void LoadPanel::draw(sdk::Ui &ui, const Snapshot *snapshot) {
  ui.heading("Supports and loads");
  if (!snapshot) return;
  drawTool(ui, *snapshot);
  drawList(ui, *snapshot);
}

void LoadPanel::drawTool(sdk::Ui &ui, const Snapshot &snapshot) {
  auto mode = static_cast<std::uint32_t>(tool_.mode);
  if (ui.choice("load_mode", "Select with", mode, kModes)) tool_.mode = static_cast<LoadTool::Mode>(mode);
  ui.tooltip("With the tool Load (N), in 3D or in a slice: paint, click a face, or drag a box. Q switches it");
  (void)ui.checkbox("load_removing", "Remove from the selection", tool_.isRemoving);
  ui.tooltip("E switches it; Alt does the opposite while it is held");
  drawMode(ui);
  const SurfacePatch patch = tool_.patch(snapshot);
  const BodySnapshot *body = snapshot.body(tool_.body());
  ui.value("Selected", patch.triangles.empty() ? "nothing"
                                               : (body ? body->name + ", " : "") + fixed(1e6 * areaOf(patch), 1) +
                                                     " mm², " + std::to_string(patch.positions.size()) + " surfels");
  if (!tool_.note().empty()) ui.value("Note", tool_.note());
  if (const std::string dragged = tool_.draggedText(); !dragged.empty()) ui.value("Dragged", dragged);
  if (!patch.triangles.empty()) drawNew(ui, snapshot);
}

void LoadPanel::drawMode(sdk::Ui &ui) {
  switch (tool_.mode) {
    case LoadTool::Mode::brush:
      (void)ui.slider("load_radius", "Radius", "mm", tool_.radius_mm, LoadTool::kMinRadius, 50.0);
      ui.tooltip("The keys [ and ], and the wheel while painting, change it");
      break;
    case LoadTool::Mode::face: {
      auto border = static_cast<std::uint32_t>(tool_.border);
      if (ui.choice("load_border", "Face ends", border, kBorders)) tool_.border = static_cast<FaceBorder>(border);
      ui.tooltip(
          "At its edges: where neighbouring triangles differ in direction by more than the angle. Where it tilts: "
          "where "
          "the normal deviates from that of the clicked point by more than the angle");
      (void)ui.slider("load_angle", "Angle", "°", tool_.angle_deg, LoadTool::kMinAngle, LoadTool::kMaxAngle);
      ui.tooltip("The keys [ and ] change it by 5°");
      break;
    }
    case LoadTool::Mode::box:
      (void)ui.checkbox("load_through", "Through: also the far side", tool_.through);
      ui.tooltip("In 3D: all of the surface in the box; otherwise what is visible. X switches it");
      (void)ui.slider("load_depth", "Depth in slices", "mm", tool_.depth_mm, LoadTool::kMinDepth, 50.0);
      ui.tooltip(
          "To each side of the slice. The keys [ and ] change it; the wheel moves the slice while the box is "
          "dragged and extends the box to it");
      break;
  }
}

void LoadPanel::drawNew(sdk::Ui &ui, const Snapshot &snapshot) {
  (void)ui.choice("load_kind", "Set", kind_, kKinds);
  const auto kind = static_cast<ConditionKind>(kind_);
  if (kind == ConditionKind::fix) {
    (void)ui.checkbox("load_rest", "Return to rest", atRest_);
    ui.tooltip("Otherwise the points are held where they are now");
  } else if (kind == ConditionKind::displace) {
    (void)ui.inputText("load_displacement", "Displacement x y z (mm)", displacement_, 64);
  } else if (kind == ConditionKind::force) {
    (void)ui.choice("load_direction", "Direction", direction_, kDirections);
    if (direction_ == 0)
      (void)ui.inputText("load_vector", "Force x y z (N)", vector_, 64);
    else
      (void)ui.inputText("load_force", "Force (N), negative inwards", force_, 64);
    ui.tooltip("In total, distributed by area");
  } else {
    (void)ui.choice("load_unit", "Unit", unit_, kPressureUnits);
    (void)ui.inputText("load_pressure", "Pressure (" + kPressureUnits[unit_] + "), positive inwards", pressure_, 64);
    ui.tooltip("Along the present surface normal; 1 mmHg = 133.322 Pa");
  }
  if (kind == ConditionKind::displace || (kind == ConditionKind::fix && atRest_)) {
    (void)ui.inputText("load_ramp", "Reached after (s)", ramp_, 32);
    ui.tooltip("Of simulated time, at constant velocity; a quasi-static solution ends at load factor 1");
  }
  if (ui.button("load_add", "Set " + kKinds[kind_])) add(snapshot, kind);
  ui.tooltip("Acts from the next step; can be undone");
  ui.sameLine();
  if (ui.button("load_clear", "Clear selection")) tool_.clear();
}

void LoadPanel::add(const Snapshot &snapshot, ConditionKind kind) {
  const BodySnapshot *body = snapshot.body(tool_.body());
  if (!body) return;
  SurfaceCondition one;
  one.kind = kind;
  one.patch = tool_.patch(snapshot);
  const bool isRamped = kind == ConditionKind::displace || (kind == ConditionKind::fix && atRest_);
  one.atRest = kind == ConditionKind::fix && atRest_;
  if (isRamped) {
    const auto ramp = numbersOf(ramp_, 1);
    if (!ramp) return tool_.edits().fail("the time is '" + ramp_ + "'; accepted: a number of seconds");
    one.ramp = ramp->front();
  }
  if (kind == ConditionKind::pressure) {
    const auto value = numbersOf(pressure_, 1);
    if (!value)
      return tool_.edits().fail("the pressure is '" + pressure_ + "'; accepted: a number in " + kPressureUnits[unit_]);
    one.pressure = kPascals[unit_] * value->front();
  } else if (kind == ConditionKind::force && direction_ != 0) {
    const auto value = numbersOf(force_, 1);
    if (!value) return tool_.edits().fail("the force is '" + force_ + "'; accepted: a number in N");
    one.vector = value->front() * areaVectorOf(one.patch).normalized();
  } else if (kind != ConditionKind::fix) {
    const std::string &text = kind == ConditionKind::force ? vector_ : displacement_;
    if (!readValue(text, one))
      return tool_.edits().fail("the value is '" + text + "'; accepted: three numbers in " + std::string(unitOf(kind)));
  }
  const std::uint64_t number = tool_.edits().nextNumber(snapshot);
  one.name = kKinds[kind_] + " " + std::to_string(number);
  one.body = simulator_->parts().queries.nameOfBody(body->id);
  if (const std::string problem = problemOf(one); !problem.empty()) return tool_.edits().fail(problem);
  if (body->isStatic) return tool_.edits().fail("body '" + body->name + "' is rigid and fixed, so nothing can move it");
  if (body->rigid && one.isSupport())
    return tool_.edits().fail("body '" + body->name + "' is rigid, so a part of it cannot be held");
  tool_.edits().change("set " + one.name, number, std::nullopt, one);
  tool_.clear();
}

void LoadPanel::drawList(sdk::Ui &ui, const Snapshot &snapshot) {
  for (const ConditionSnapshot &one : snapshot.conditions) drawRow(ui, one);
  std::erase_if(edited_, [&](const auto &entry) {
    return std::none_of(snapshot.conditions.begin(), snapshot.conditions.end(),
                        [&](const ConditionSnapshot &one) { return one.number == entry.first; });
  });
}

void LoadPanel::drawRow(sdk::Ui &ui, const ConditionSnapshot &one) {
  const std::string id = std::to_string(one.number);
  ConditionMarks &marks = tool_.marks();
  ui.value(one.condition.name, one.condition.body.name + ", " + fixed(1e6 * one.area, 1) + " mm²");
  drawValue(ui, one);
  const std::string what = one.condition.isSupport() ? "Reaction on the body" : "Total force";
  ui.value(what, fixed(one.force.norm(), 3) + " N (" + fixed(one.force[0], 3) + " " + fixed(one.force[1], 3) + " " +
                     fixed(one.force[2], 3) + ")");
  if (!one.warning.empty()) ui.text(one.condition.name + ": " + one.warning);
  bool isChosen = marks.chosen == one.number;
  if (ui.checkbox("load_chosen_" + id, "Chosen", isChosen)) marks.chosen = isChosen ? one.number : 0;
  ui.tooltip(
      "Same as a click on the tip of its arrow in the view; Delete removes the chosen one while the tool Load is "
      "active");
  ui.sameLine();
  bool isShown = marks.isShown(one.number);
  if (ui.checkbox("load_shown_" + id, "Show", isShown)) marks.setShown(one.number, isShown);
  ui.tooltip("Same as its checkbox in the list Scene");
  ui.sameLine();
  if (ui.button("load_remove_" + id, "Remove")) {
    edited_.erase(one.number);
    tool_.edits().remove(one);
  }
}

void LoadPanel::drawValue(sdk::Ui &ui, const ConditionSnapshot &one) {
  if (one.condition.kind == ConditionKind::fix) return;
  const auto edited = edited_.find(one.number);
  std::string text = edited != edited_.end() ? edited->second : textOf(one.condition);
  const std::uint32_t result = ui.inputText(
      "load_value_" + std::to_string(one.number),
      kKinds[static_cast<std::size_t>(one.condition.kind)] + " (" + std::string(unitOf(one.condition.kind)) + ")", text,
      64);
  if ((result & C3DE_UI_CHANGED) != 0) edited_[one.number] = text;
  if ((result & C3DE_UI_COMMITTED) == 0) return;
  edited_.erase(one.number);
  SurfaceCondition changed = one.condition;
  if (!readValue(text, changed))
    return tool_.edits().fail("the value is '" + text + "'; accepted: " +
                              (changed.kind == ConditionKind::pressure ? "a number" : "three numbers") + " in " +
                              std::string(unitOf(changed.kind)));
  if (const std::string problem = problemOf(changed); !problem.empty()) return tool_.edits().fail(problem);
  if (changed.vector == one.condition.vector && changed.pressure == one.condition.pressure) return;
  tool_.edits().change("change " + one.condition.name, one.number, one.condition, changed);
}

}  // namespace pointbased
