// SPDX-License-Identifier: Apache-2.0
#include "hand_tool.h"

namespace pointbased {
namespace {

constexpr float kLineWidth = 3.0f;  // px

}  // namespace

void HandTool::setSimulator(WorldSimulator *simulator) {
  if (simulator_.get() == simulator) return;
  leave();
  history_.forget();
  simulator_ = simulator ? sdk::Ref<WorldSimulator>::share(simulator) : sdk::Ref<WorldSimulator>();
}

void HandTool::post(std::function<void(WorldSimulator &)> command) const {
  if (!simulator_) return;
  (void)services_.simulation.post(simulator_->node(),
                                  [simulator = simulator_, command = std::move(command)] { command(*simulator); });
}

void HandTool::showLines(sdk::Proxy &lines, std::span<const Vec3> points, const sdk::Material &material) const {
  if (lines)
    (void)services_.render.update(lines.handle(), C3DE_ATTR_POSITIONS, viewOf(points));
  else if (auto made = services_.render.createLines(simulator_->node(), viewOf(points), kLineWidth, material))
    lines = std::move(*made);
}

void HandTool::showLabel(sdk::Proxy &label, const Vec3 &at, const std::string &text,
                         const sdk::Material &material) const {
  if (label)
    (void)services_.render.setLabel(label.handle(), toArray(at), text);
  else if (auto made = services_.render.createLabel(simulator_->node(), toArray(at), text, material))
    label = std::move(*made);
}

}  // namespace pointbased
