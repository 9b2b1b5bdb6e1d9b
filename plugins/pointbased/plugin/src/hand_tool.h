// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "c3de/sdk/tool.hpp"
#include "hand_history.h"
#include "scene_pick.h"
#include "world_simulator.h"

namespace pointbased {

/// Base of the tools that work on a simulation by hand: which one, commands to it, and steps of Undo. Main thread.
class HandTool : public sdk::Tool {
 public:
  /// Which simulator it works on; null: none. Leaves the one before.
  void setSimulator(WorldSimulator *simulator);

 protected:
  explicit HandTool(const Services &services) : services_(services), history_(services) {}
  /// Lets go of everything; another simulator comes, or none.
  virtual void leave() = 0;
  /// Between two steps of the simulation, on its thread.
  void post(std::function<void(WorldSimulator &)> command) const;
  /// Lines between pairs of points, m: made, or moved.
  void showLines(sdk::Proxy &lines, std::span<const Vec3> points, const sdk::Material &material) const;
  /// A text at a place, m: made, or moved.
  void showLabel(sdk::Proxy &label, const Vec3 &at, const std::string &text, const sdk::Material &material) const;

  const Services &services_;
  sdk::Ref<WorldSimulator> simulator_;
  HandHistory history_;
};

}  // namespace pointbased
