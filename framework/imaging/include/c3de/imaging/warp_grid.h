// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>

#include "c3de/imaging/volume.h"

namespace c3de::imaging {

/// An axis-aligned box in world space, mm; initially empty.
struct WorldBox {
  Vec3 low = filled(std::numeric_limits<double>::infinity());
  Vec3 high = filled(-std::numeric_limits<double>::infinity());

  void add(const Vec3 &point);  ///< a non-finite point is ignored
  void cutTo(const WorldBox &other);
  [[nodiscard]] WorldBox grown(double by_mm) const;
  [[nodiscard]] bool isEmpty() const { return !(low[0] <= high[0] && low[1] <= high[1] && low[2] <= high[2]); }
  [[nodiscard]] bool holds(const WorldBox &other) const;

 private:
  static Vec3 filled(double value) { return {value, value, value}; }
};
/// Encloses all voxels, half a voxel beyond the outermost centres.
[[nodiscard]] WorldBox boxOf(const VolumeGeometry &geometry);

/// Maximum number of points of a displacement grid, and how coarse it may become to meet it.
struct WarpGridLimits {
  std::size_t mostPoints = 96;  ///< along an axis
  double coarsestStep = 2.0;    ///< spacings of the finest body; a longer box is cropped
};

/// The grid on which the displacement of moving bodies is sampled. It stays fixed while it contains the bodies with
/// their falloff distance. Once they leave it, or shrink so far that a new one would be much finer, it is rebuilt with
/// a margin for motion. Its step is half the spacing, longer where the limits require it.
class FollowingGrid {
 public:
  explicit FollowingGrid(WarpGridLimits limits = {}) : limits_(limits) {}

  /// Call before other bodies are followed.
  void forget();
  /// @param bodies  present surfaces
  /// @param spacing_mm  the finest of all bodies
  /// @return whether the grid was rebuilt
  bool follow(const WorldBox &bodies, double spacing_mm, double rim_mm);
  /// Without points (size 0): there are no bodies.
  [[nodiscard]] const VolumeGeometry &geometry() const { return geometry_; }

 private:
  struct Plan {
    WorldBox needed, laid;
    double step_mm = 0.0;
  };
  [[nodiscard]] Plan plan(const WorldBox &bodies, double spacing_mm, double rim_mm) const;

  WarpGridLimits limits_;
  VolumeGeometry geometry_{{0, 0, 0}, kIdentity4};
  WorldBox laid_;
  double rim_mm_ = -1.0, step_mm_ = 0.0;
  std::optional<Vec3> home_;  // centre of the bodies at the first call
};

}  // namespace c3de::imaging
