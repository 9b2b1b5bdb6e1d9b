// SPDX-License-Identifier: Apache-2.0
#include "tools/interactive_tool.h"

#include <algorithm>

namespace pointbased {
namespace {

constexpr float kLineWidth = 3.0f;      // px
constexpr double kLongestArrow = 0.04;  // m

}  // namespace

void InteractiveTool::setSimulator(WorldSimulator *simulator) {
  if (simulator_.get() == simulator) return;
  detach();
  history_.clear();
  simulator_ = simulator ? sdk::Ref<WorldSimulator>::share(simulator) : sdk::Ref<WorldSimulator>();
}

void InteractiveTool::post(std::function<void(WorldSimulator &)> command) const {
  if (!simulator_) return;
  (void)services_.simulation.post(simulator_->node(), [simulator = simulator_, command = std::move(command)] {
    try {
      command(*simulator);
    } catch (const sdk::Error &error) {
      // It was there when the user acted, and has been removed since.
      if (error.status() != C3DE_E_NOT_FOUND && error.status() != C3DE_E_STALE) throw;
    }
  });
}

std::string InteractiveTool::idleReason() const {
  if (!simulator_) return {};
  const auto state = services_.simulation.state(simulator_->node());
  switch (state ? state->mode : C3DE_SIM_PLAYING) {
    case C3DE_SIM_STOPPED: return "Stopped: press Space to play";
    case C3DE_SIM_PAUSED: return "Paused: press Space to play";
    case C3DE_SIM_FAILED: return "Failed: Ctrl+R resets the simulation";
    default: return {};
  }
}

void InteractiveTool::showLines(sdk::Proxy &lines, std::span<const Vec3> points, const sdk::Material &material) const {
  if (lines)
    (void)services_.render.update(lines.handle(), C3DE_ATTR_POSITIONS, viewOf(points));
  else if (auto made = services_.render.createLines(simulator_->node(), viewOf(points), kLineWidth, material))
    lines = std::move(*made);
}

Vec3 InteractiveTool::showArrow(sdk::Proxy &arrow, const Vec3 &from, const Vec3 &force, double largest) const {
  const double size = force.norm();
  const Vec3 vector = size > 0.0 ? Vec3(kLongestArrow / std::max(largest, size) * force) : Vec3(Vec3::Zero());
  showArrow(arrow, from, vector);
  return from + vector;
}

// Its head has barbs on four sides, because a slice shows it from one side only.
void InteractiveTool::showArrow(sdk::Proxy &arrow, const Vec3 &from, const Vec3 &vector) const {
  const double length = vector.norm();
  if (!(length > 0.0)) return arrow.reset();
  const Vec3 side = 0.12 * length * vector.unitOrthogonal(), other = side.cross(vector) / length;
  const Vec3 tip = from + vector, neck = tip - 0.25 * vector;
  showLines(arrow,
            std::array<Vec3, 10>{from, tip, tip, neck + side, tip, neck - side, tip, neck + other, tip, neck - other},
            kForce);
}

bool InteractiveTool::warnIfQuasiStatic(const Snapshot &snapshot, const char *title, const std::string &what,
                                        const std::string &help) const {
  if (snapshot.quasiStatic)
    (void)services_.notifier.notify(C3DE_LOG_WARN, title,
                                    "A quasi-static solution has no time in which " + what +
                                        ". solver.integrator = auto, explicit or implicit has" + help);
  return snapshot.quasiStatic;
}

void InteractiveTool::showLabel(sdk::Proxy &label, const Vec3 &at, const std::string &text,
                                const sdk::Material &material) const {
  if (label)
    (void)services_.render.setLabel(label.handle(), toArray(at), text);
  else if (auto made = services_.render.createLabel(simulator_->node(), toArray(at), text, material))
    label = std::move(*made);
}

}  // namespace pointbased
