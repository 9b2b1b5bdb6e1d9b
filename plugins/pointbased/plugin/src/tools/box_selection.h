// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>

#include "tools/surface_selection.h"
#include "view/scene_pick.h"

namespace pointbased {

/// Surface in a rectangle that is drawn in the 3D view or in a slice. In 3D: what is visible, or what is behind it as
/// well; in a slice: what is within a depth of the plane, before and behind it. It works on the state at the press.
/// Visibility is computed by rays in portions, at most kRaysPerFrame per call of advance(). Main thread.
class BoxSelection {
 public:
  /// @param first  ray of the press, in the frame of the simulation
  BoxSelection(const Services &services, std::shared_ptr<const Snapshot> snapshot, bool isSlice, const PickRay &first,
               double x_px, double y_px);

  /// The rectangle ends at this pixel now.
  void moveTo(const PickRay &ray, double x_px, double y_px);
  /// @param through   3D: also what is hidden, or faces away
  /// @param depth_m   slice: to each side of the plane
  void set(bool through, double depth_m);
  /// Computes a portion. @return true: the result is complete
  bool advance();
  /// Of the rays, 0 … 1.
  [[nodiscard]] double progress() const;

  /// Selected triangles of each body that has any, by id, ascending.
  [[nodiscard]] const std::map<std::uint64_t, std::vector<std::uint32_t>> &found() const { return found_; }
  /// The body of which a part is selected: `preferred` if it has any, else the one that was pressed, else the one with
  /// the largest area in the rectangle. 0: none.
  [[nodiscard]] std::uint64_t chosenBody(std::uint64_t preferred) const;
  [[nodiscard]] const Snapshot &snapshot() const { return *snapshot_; }
  /// Edges of the rectangle as pairs of points, m; empty before it has a size.
  [[nodiscard]] std::vector<Vec3> outline() const;
  [[nodiscard]] bool isSlice() const { return isSlice_; }
  static constexpr std::size_t kRaysPerFrame = 10'000;

 private:
  enum class Visibility : std::uint8_t { unknown, seen, hidden };
  void restart();
  void testVisibility(std::uint64_t body, std::span<const std::uint32_t> triangles);
  void addMiddle();

  const Services &services_;
  const std::shared_ptr<const Snapshot> snapshot_;
  const bool isSlice_;
  PixelRay first_, last_;
  Vec3 view_;
  double lowest_ = 0.0, highest_ = 0.0;  // m, of the planes since the press, from the first one
  double outlineDepth_ = 0.0;            // m, of a perspective view
  std::uint64_t pressed_ = 0;            // body under the press
  bool through_ = false;
  double depth_ = 0.0;  // m
  std::optional<ViewFrame> frame_;
  std::map<std::uint64_t, std::vector<std::uint32_t>> candidates_, found_;
  std::map<std::uint64_t, std::vector<Visibility>> visibility_;  // by triangle; the view does not move during a drag
  std::size_t tested_ = 0, wanted_ = 0;
  bool isComplete_ = true;
};

}  // namespace pointbased
