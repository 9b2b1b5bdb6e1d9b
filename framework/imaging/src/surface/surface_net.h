// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/imaging/masks.h"
#include "surface/edit_mesh.h"

namespace c3de::imaging {

/// The border between voxels filled to a half and others, in index coordinates, and where its vertices belong.
struct SurfaceNet {
  EditMesh mesh;            ///< vertices at the mean of where the border crosses the edges around
  std::vector<Vec3> homes;  ///< [points] the corner of the voxels that each stands for
};

/// @param fill        with an empty outermost layer
/// @param leftHanded  of the index in the world: which side of a triangle is its front
[[nodiscard]] SurfaceNet surfaceNetOf(const Fill &fill, bool leftHanded);

/// Moves every vertex towards the mean of its neighbours again and again, at most 0.45 voxels from its home.
/// @source Tukey's twicing (Exploratory Data Analysis, 1977)
void relax(SurfaceNet &net, std::size_t times);

/// The cells between eight voxels that the border goes through: where vertices may be.
class BorderCells {
 public:
  /// @param edge  of the shortest edges, in voxels: what lies between the reaches of two cells is shorter, or the edges
  /// across it would be divided without end
  BorderCells(const Fill &fill, double edge);
  /// The nearest point that is at most 0.45 voxels (up to 0.5 for edges below half a voxel) from the middle of such a
  /// cell, along every axis of the index; the point itself where there is no such cell beside its own.
  [[nodiscard]] Vec3 nearest(const Vec3 &index) const;

 private:
  [[nodiscard]] bool isBorder(const std::array<std::size_t, 3> &cell) const {
    return border_[cell[0] + size_[0] * (cell[1] + size_[1] * cell[2])] != 0;
  }
  std::array<std::size_t, 3> size_;  // of cells
  std::vector<std::uint8_t> border_;
  double leash_;
};

}  // namespace c3de::imaging
