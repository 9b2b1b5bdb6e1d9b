// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <set>

#include "tools/arrow_drag.h"
#include "view/simulator_view.h"

namespace pointbased {

/// What is drawn of supports and loads: for each a scene node below that of its body, with the patch, the arrow, a
/// handle at its tip and the value; a fix has neither arrow nor handle. The checkbox of the node in the scene list and
/// isShown() are the same. Main thread.
class ConditionMarks {
 public:
  explicit ConditionMarks(const Services &services) : services_(services) {}

  struct Frame {
    const Snapshot *snapshot = nullptr;   ///< null: none
    const SimulatorView *view = nullptr;  ///< null: no nodes of bodies
    c3de_handle node{};                   ///< of the simulation
    bool hasHandles = false;
    std::uint64_t dragged = 0;                ///< number; 0: none
    const SurfaceCondition *value = nullptr;  ///< shown instead of that of the dragged one
  };
  /// Called once per frame.
  void update(const Frame &frame);
  void clear();

  [[nodiscard]] bool isShown(std::uint64_t number) const { return !hidden_.contains(number); }
  void setShown(std::uint64_t number, bool isShown);
  /// The condition whose handle a ray hits. @param isSlice  the ray begins in the plane of a slice
  [[nodiscard]] std::optional<std::uint64_t> handleUnder(const Snapshot &snapshot, const PickRay &ray,
                                                         bool isSlice) const;
  [[nodiscard]] double metresPerNewton() const { return metresPerNewton_; }

  std::uint64_t chosen = 0, hovered = 0;  ///< numbers; 0: none

 private:
  struct Shown {
    c3de_handle parent{};
    sdk::SceneNode node;
    sdk::Proxy patch, arrow, label, handle;
    std::size_t triangles = 0;
    double handleRadius = 0.0;  // m
    bool isVisible = true;      // with all nodes above it
    void reset() {
      for (sdk::Proxy *drawn : {&patch, &arrow, &label, &handle}) drawn->reset();
      *this = Shown();
    }
  };
  [[nodiscard]] static double sizeOf(const Snapshot &snapshot, std::uint64_t body);
  void chooseScale(const Snapshot &snapshot);
  [[nodiscard]] bool makeNode(const Frame &frame, const ConditionSnapshot &one, Shown &shown);
  void show(const Frame &frame, const ConditionSnapshot &one, Shown &shown);
  void showPatch(const ConditionSnapshot &one, Shown &shown);

  const Services &services_;
  std::map<std::uint64_t, Shown> shown_;
  std::set<std::uint64_t> hidden_;
  double metresPerNewton_ = 0.0;
};

/// Moves points away from the surface, so that what is drawn there is seen; m.
[[nodiscard]] std::vector<Vec3> liftedFrom(std::vector<Vec3> points,
                                           const std::vector<std::array<std::uint32_t, 3>> &triangles);

}  // namespace pointbased
