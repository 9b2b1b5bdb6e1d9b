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

  /// Why a hand moves nothing now, and what helps: "Paused: press Space to play". Empty while the simulation plays.
  [[nodiscard]] std::string whyStill() const;

  /// An arrow, m: made, or moved; taken away where it has no length.
  void showArrow(sdk::Proxy &arrow, const Vec3 &from, const Vec3 &way) const;
  /// A force, N, as an arrow; the largest one, N, is as long as arrows get. @return its tip, m
  Vec3 showArrow(sdk::Proxy &arrow, const Vec3 &from, const Vec3 &force, double largest) const;
  static constexpr sdk::Material kForce{{1.0f, 0.85f, 0.2f, 1.0f}, false, true};
  /// Tells where a solution has no time in which a hand could do something.
  /// @param help  follows what helps: begins with ';', or empty
  [[nodiscard]] bool isTimeless(const Snapshot &snapshot, const char *title, const std::string &what,
                                const std::string &help = {}) const;

  const Services &services_;
  sdk::Ref<WorldSimulator> simulator_;
  HandHistory history_;
};

}  // namespace pointbased
