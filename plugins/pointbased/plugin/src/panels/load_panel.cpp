// SPDX-License-Identifier: Apache-2.0
#include "panels/load_panel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <locale>
#include <sstream>
#include <utility>

#include "base/number_text.h"
#include "base/placed_mesh.h"

namespace pointbased {
namespace {

const std::array<std::string, 2> kModes{"brush", "face"};
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
  for (const c3de_handle step : std::exchange(steps_, {})) services_.history.remove(step);
  simulator_ = simulator ? sdk::Ref<WorldSimulator>::share(simulator) : sdk::Ref<WorldSimulator>();
  lastNumber_ = 0;
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
  ui.tooltip("With the tool Load (N): press on the surface, or in a slice");
  (void)ui.checkbox("load_removing", "Remove from the selection", tool_.isRemoving);
  ui.tooltip("E switches it");
  if (tool_.mode == LoadTool::Mode::brush) {
    (void)ui.slider("load_radius", "Radius", "mm", tool_.radius_mm, LoadTool::kMinRadius, 50.0);
    ui.tooltip("The keys [ and ], and the wheel while painting, change it");
  } else {
    (void)ui.slider("load_angle", "Angle", "°", tool_.angle_deg, 1.0, 90.0);
    ui.tooltip("The connected surface whose normal deviates by less from that of the clicked point");
  }
  const SurfacePatch patch = tool_.patch(snapshot);
  const BodySnapshot *body = snapshot.body(tool_.body());
  ui.value("Selected", patch.triangles.empty() ? "nothing"
                                               : (body ? body->name + ", " : "") + fixed(1e6 * areaOf(patch), 1) +
                                                     " mm², " + std::to_string(patch.positions.size()) + " surfels");
  if (!patch.triangles.empty()) drawNew(ui, snapshot);
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
    if (!ramp) return fail("the time is '" + ramp_ + "'; accepted: a number of seconds");
    one.ramp = ramp->front();
  }
  if (kind == ConditionKind::pressure) {
    const auto value = numbersOf(pressure_, 1);
    if (!value) return fail("the pressure is '" + pressure_ + "'; accepted: a number in " + kPressureUnits[unit_]);
    one.pressure = kPascals[unit_] * value->front();
  } else if (kind == ConditionKind::force && direction_ != 0) {
    const auto value = numbersOf(force_, 1);
    if (!value) return fail("the force is '" + force_ + "'; accepted: a number in N");
    one.vector = value->front() * areaVectorOf(one.patch).normalized();
  } else if (kind != ConditionKind::fix) {
    const std::string &text = kind == ConditionKind::force ? vector_ : displacement_;
    if (!readValue(text, one))
      return fail("the value is '" + text + "'; accepted: three numbers in " + std::string(unitOf(kind)));
  }
  for (const ConditionSnapshot &other : snapshot.conditions) lastNumber_ = std::max(lastNumber_, other.number);
  const std::uint64_t number = ++lastNumber_;
  one.name = kKinds[kind_] + " " + std::to_string(number);
  one.body = simulator_->parts().queries.nameOfBody(body->id);
  if (const std::string problem = problemOf(one); !problem.empty()) return fail(problem);
  if (body->isStatic) return fail("body '" + body->name + "' is rigid and fixed, so nothing can move it");
  if (body->rigid && one.isSupport()) return fail("body '" + body->name + "' is rigid, so a part of it cannot be held");
  change("set " + one.name, number, std::nullopt, one);
  tool_.clear();
}

void LoadPanel::drawList(sdk::Ui &ui, const Snapshot &snapshot) {
  for (const ConditionSnapshot &one : snapshot.conditions) {
    const std::string id = std::to_string(one.number);
    ui.value(one.condition.name, one.condition.body.name + ", " + fixed(1e6 * one.area, 1) + " mm²");
    drawValue(ui, one);
    const std::string what = one.condition.isSupport() ? "Reaction on the body" : "Total force";
    ui.value(what, fixed(one.force.norm(), 3) + " N (" + fixed(one.force[0], 3) + " " + fixed(one.force[1], 3) + " " +
                       fixed(one.force[2], 3) + ")");
    if (!one.warning.empty()) ui.text(one.condition.name + ": " + one.warning);
    bool isShown = !tool_.hidden.contains(one.number);
    if (ui.checkbox("load_shown_" + id, "Show", isShown)) {
      if (isShown)
        tool_.hidden.erase(one.number);
      else
        tool_.hidden.insert(one.number);
    }
    ui.sameLine();
    if (ui.button("load_remove_" + id, "Remove")) {
      edited_.erase(one.number);
      change("remove " + one.condition.name, one.number, one.condition, std::nullopt);
    }
  }
  std::erase_if(edited_, [&](const auto &entry) {
    return std::none_of(snapshot.conditions.begin(), snapshot.conditions.end(),
                        [&](const ConditionSnapshot &one) { return one.number == entry.first; });
  });
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
    return fail("the value is '" + text +
                "'; accepted: " + (changed.kind == ConditionKind::pressure ? "a number" : "three numbers") + " in " +
                std::string(unitOf(changed.kind)));
  if (const std::string problem = problemOf(changed); !problem.empty()) return fail(problem);
  if (changed.vector == one.condition.vector && changed.pressure == one.condition.pressure) return;
  change("change " + one.condition.name, one.number, one.condition, changed);
}

void LoadPanel::change(const std::string &title, std::uint64_t number, std::optional<SurfaceCondition> before,
                       std::optional<SurfaceCondition> after) {
  if (const auto posted = post(number, after); !posted) return fail(posted.failure().message);
  if (!services_.history) return;
  const auto step = services_.history.add(
      title, [this, number, before = std::move(before)] { return post(number, before); },
      [this, number, after = std::move(after)] { return post(number, after); });
  if (step) steps_.push_back(*step);
}

sdk::Result<void> LoadPanel::post(std::uint64_t number, std::optional<SurfaceCondition> condition) {
  simulator_->abandonLongStep();
  return services_.simulation.post(simulator_->node(),
                                   [simulator = simulator_, number, condition = std::move(condition)] {
                                     (void)simulator->parts().changes.make(SetSurfaceCondition{number, condition});
                                   });
}

void LoadPanel::fail(const std::string &text) const {
  (void)services_.notifier.notify(C3DE_LOG_ERROR, "The support or load was not set", text);
}

}  // namespace pointbased
