// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/imaging/masks.h"
#include "surface/edit_mesh.h"

namespace c3de::imaging {

/// The border between voxels filled to at least a half and others, in index coordinates, with the cell centres of its
/// vertices.
struct SurfaceNet {
  EditMesh mesh;            ///< vertices at the mean of the border crossings of the surrounding edges
  std::vector<Vec3> homes;  ///< [points] centre of each vertex's cell: the corner shared by eight voxels
};

/// @param fill        with an empty outermost layer
/// @param leftHanded  handedness of the index in the world: determines the front of triangles
[[nodiscard]] SurfaceNet surfaceNetOf(const Fill &fill, bool leftHanded);

/// Iteratively moves every vertex towards the mean of its neighbours, at most 0.45 voxels from its cell centre.
/// @source Tukey's twicing (Exploratory Data Analysis, 1977)
void relax(SurfaceNet &net, std::size_t times);

/// The cells between eight voxels that the border crosses: where vertices may be.
class BorderCells {
 public:
  /// @param edge  the shortest edge length, in voxels. The gap between the ranges of two cells is shorter than this;
  /// otherwise edges across it would be split indefinitely
  BorderCells(const Fill &fill, double edge);
  /// The nearest point that is at most 0.45 voxels (up to 0.5 for edges below half a voxel) from the centre of such a
  /// cell, along every axis of the index; the point itself where neither its cell nor a neighbour is such a cell.
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
