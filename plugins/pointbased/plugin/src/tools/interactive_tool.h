// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "c3de/sdk/tool.hpp"
#include "simulator/world_simulator.h"
#include "tools/interaction_history.h"
#include "view/scene_pick.h"

namespace pointbased {

/// Base class of the interactive simulation tools: the simulator, commands to it, and undo steps. Main thread.
class InteractiveTool : public sdk::Tool {
 public:
  /// The simulator the tool works on; null if none. Leaves the previous one.
  void setSimulator(WorldSimulator *simulator);

 protected:
  /// @param steps  undo steps of all tools
  InteractiveTool(const Services &services, std::shared_ptr<InteractionSteps> steps)
      : services_(services), history_(services, std::move(steps)) {}
  /// Releases everything, because the simulator changes or is removed.
  virtual void detach() = 0;
  /// Makes a change between two steps of the simulation, on its thread. No effect if what it names has been removed.
  /// @param make  returns the change
  template <class Make>
  void change(Make make) const {
    post([make = std::move(make)](WorldSimulator &simulator) {
      (void)simulator.parts().changes.make(make(simulator.parts().queries));
    });
  }
  /// Creates or moves lines between pairs of points, m.
  void showLines(sdk::Proxy &lines, std::span<const Vec3> points, const sdk::Material &material) const;
  /// Creates or moves a text at a position, m.
  void showLabel(sdk::Proxy &label, const Vec3 &at, const std::string &text, const sdk::Material &material) const;

  /// Why the tool moves nothing now, and the remedy: "Paused: press Space to play". Empty while the simulation plays.
  [[nodiscard]] std::string idleReason() const;

  /// Creates or moves an arrow, m; removes it if its length is zero.
  void showArrow(sdk::Proxy &arrow, const Vec3 &from, const Vec3 &vector) const;
  /// A force, N, as an arrow; the force `largest`, N, has the maximum arrow length. @return its tip, m
  Vec3 showArrow(sdk::Proxy &arrow, const Vec3 &from, const Vec3 &force, double largest) const;
  static constexpr sdk::Material kForce{{1.0f, 0.85f, 0.2f, 1.0f}, false, true};
  /// Warns if the solution has no time, so that the tool cannot act on it.
  /// @param help  appended to the remedy: begins with ';', or is empty
  [[nodiscard]] bool warnIfQuasiStatic(const Snapshot &snapshot, const char *title, const std::string &what,
                                       const std::string &help = {}) const;

  const Services &services_;
  sdk::Ref<WorldSimulator> simulator_;
  InteractionHistory history_;

 private:
  void post(std::function<void(WorldSimulator &)> command) const;
};

}  // namespace pointbased
