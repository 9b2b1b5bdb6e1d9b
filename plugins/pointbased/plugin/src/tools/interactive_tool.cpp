// SPDX-License-Identifier: Apache-2.0
#include "tools/interactive_tool.h"

#include <algorithm>

#include "tools/drawn_marks.h"

namespace pointbased {
namespace {

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
  DrawnMarks(services_, simulator_->node()).lines(lines, points, material);
}

Vec3 InteractiveTool::showArrow(sdk::Proxy &arrow, const Vec3 &from, const Vec3 &force, double largest) const {
  const double size = force.norm();
  const Vec3 vector = size > 0.0 ? Vec3(kLongestArrow / std::max(largest, size) * force) : Vec3(Vec3::Zero());
  showArrow(arrow, from, vector);
  return from + vector;
}

void InteractiveTool::showArrow(sdk::Proxy &arrow, const Vec3 &from, const Vec3 &vector) const {
  DrawnMarks(services_, simulator_->node()).arrow(arrow, from, vector, kForce);
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
  DrawnMarks(services_, simulator_->node()).label(label, at, text, material);
}

}  // namespace pointbased
