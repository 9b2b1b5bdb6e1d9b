// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>

#include "c3de/imaging/volume.h"

namespace c3de::imaging {

/// An upright box of the world, mm; empty as it is made.
struct WorldBox {
  Vec3 low = filled(std::numeric_limits<double>::infinity());
  Vec3 high = filled(-std::numeric_limits<double>::infinity());

  void add(const Vec3 &point);  ///< a point that is not finite is ignored
  void cutTo(const WorldBox &other);
  [[nodiscard]] WorldBox grown(double by_mm) const;
  [[nodiscard]] bool isEmpty() const { return !(low[0] <= high[0] && low[1] <= high[1] && low[2] <= high[2]); }
  [[nodiscard]] bool holds(const WorldBox &other) const;

 private:
  static Vec3 filled(double value) { return {value, value, value}; }
};
/// Around all voxels, half a voxel around the outermost centres.
[[nodiscard]] WorldBox boxOf(const VolumeGeometry &geometry);

/// How many points a grid of displacements may have, and how coarse it may become for that.
struct WarpGridLimits {
  std::size_t mostPoints = 96;  ///< along an axis
  double coarsestStep = 2.0;    ///< spacings of the finest body; a longer box is cut around where the bodies were first
};

/// The grid on which the displacement of moving bodies is asked for. It stays where it is while it holds the bodies
/// with their rim; once they leave it, or shrink so far that a new one would be much finer, it is laid anew with room
/// to move. Its step is half the spacing, longer where the limits ask for it.
class FollowingGrid {
 public:
  explicit FollowingGrid(WarpGridLimits limits = {}) : limits_(limits) {}

  /// The next bodies are others.
  void forget();
  /// @param bodies  surfaces as they are now
  /// @param spacing_mm  the finest of a body
  /// @return whether the grid was laid anew
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
  std::optional<Vec3> home_;  // middle of the bodies when they were first seen
};

}  // namespace c3de::imaging
