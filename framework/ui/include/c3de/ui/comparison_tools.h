// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "c3de/abi/tools.h"
#include "c3de/core/handle.h"
#include "c3de/ui/comparison.h"
#include "c3de/ui/image_views.h"

namespace c3de::registry {
class ToolRegistry;
}

namespace c3de::ui {

/// The tools that move the second scan in the plane of a slice, and rotate it about the cross-hair. A drag is one step
/// of undo; Escape cancels it. No drawing. Main thread; what is passed must outlive this.
class ComparisonTools {
 public:
  ComparisonTools(registry::ToolRegistry &tools, const ImageViews &images, Comparison &comparison)
      : registry_(tools), images_(images), comparison_(comparison) {}
  ~ComparisonTools() { offer(false); }
  ComparisonTools(const ComparisonTools &) = delete;
  ComparisonTools &operator=(const ComparisonTools &) = delete;

  /// Registers the tools, or removes them.
  void offer(bool isOffered);

 private:
  struct Tool {
    ComparisonTools *all = nullptr;
    bool isTurn = false;
    Handle handle{};
  };
  struct Drag {
    Vec3 from{}, normal{};   ///< world; normal of the slice
    Mat4 pose = kIdentity4;  ///< when it began
    double angle_rad = 0.0;  ///< up to the last event
    Vec3 last{};
  };
  bool handle(const Tool &tool, const c3de_event &event);
  void move(const Tool &tool, const Vec3 &world);

  registry::ToolRegistry &registry_;
  const ImageViews &images_;
  Comparison &comparison_;
  std::array<Tool, 2> tools_;
  std::optional<Drag> drag_;
};

}  // namespace c3de::ui
