// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "c3de/core/vec.h"

namespace c3de::imaging {

/// The voxel grid of a volume in space. Indices count from 0, i fastest; an integer index is the centre of its voxel.
/// World is LPS (left, posterior, superior increase), right-handed, millimetres.
struct VolumeGeometry {
  std::array<std::size_t, 3> size{};  ///< voxels along i, j, k; each at least 1
  Mat4 indexToWorld = kIdentity4;     ///< affine, invertible; any direction, shear allowed (gantry tilt)

  [[nodiscard]] std::size_t voxelCount() const { return size[0] * size[1] * size[2]; }
  [[nodiscard]] Vec3 worldAt(const Vec3 &index) const { return transformPoint(indexToWorld, index); }
  /// Distance of neighbouring voxel centres along i, j, k, mm.
  [[nodiscard]] Vec3 spacing() const;
  /// Volume of one voxel, mm³; positive for either handedness of the index.
  [[nodiscard]] double voxelVolume() const;
  /// Negative: the index axes are left-handed in the world.
  [[nodiscard]] double handedness() const;
  /// Largest |cos| between two index axes; 0 for an orthogonal grid.
  [[nodiscard]] double shear() const;
};

/// Inverse of an affine matrix (last row 0 0 0 1). The matrix must be invertible.
[[nodiscard]] Mat4 affineInverse(const Mat4 &affine);
/// The voxel that contains a point given by its index coordinates; none outside of the grid.
[[nodiscard]] std::optional<std::array<std::size_t, 3>> voxelAt(const VolumeGeometry &grid, const Vec3 &index);
/// Whether two volumes have the same voxels in the world: equal sizes, and corners within the tolerance (mm).
[[nodiscard]] bool sameGrid(const VolumeGeometry &a, const VolumeGeometry &b, double tolerance = 1e-3);

/// Voxels in the type stored in the file.
using Voxels = std::variant<std::vector<std::int8_t>, std::vector<std::uint8_t>, std::vector<std::int16_t>,
                            std::vector<std::uint16_t>, std::vector<std::int32_t>, std::vector<std::uint32_t>,
                            std::vector<float>, std::vector<double>>;

/// Red, green, blue and opacity as stored in files (sRGB).
using Rgba = std::array<std::uint8_t, 4>;

/// A scalar image. Immutable once it is built; any number of threads may read it.
struct Volume {
  VolumeGeometry geometry;
  Voxels voxels;       ///< geometry.voxelCount() of them, i fastest; for a colour image its luma (Rec. 709)
  double slope = 1.0;  ///< value = slope * voxel + intercept
  double intercept = 0.0;
  std::string unit{};           ///< of values: "HU", or empty when the file does not state it
  std::vector<Rgba> colours{};  ///< of a colour image, geometry.voxelCount(); empty: not a colour image

  [[nodiscard]] std::size_t offset(std::size_t i, std::size_t j, std::size_t k) const {
    return i + geometry.size[0] * (j + geometry.size[1] * k);
  }
  /// Rescaled value of a voxel; the index must be inside.
  [[nodiscard]] double value(std::size_t i, std::size_t j, std::size_t k) const;
  [[nodiscard]] std::size_t bytes() const;           ///< of all voxels and colours
  [[nodiscard]] const char *scalarTypeName() const;  ///< "int16", "uint8", "float32", …
};

/// 0 is background. Names of labels come from the file, or a table next to it.
struct LabelMap {
  struct Label {
    std::uint16_t value = 0;
    std::string name;               ///< "label 7" for an unnamed label
    std::array<float, 3> colour{};  ///< linear RGB, 0 … 1
  };
  VolumeGeometry geometry;            ///< its own grid, which may differ from that of any image
  std::vector<std::uint16_t> voxels;  ///< geometry.voxelCount(), i fastest
  std::vector<Label> labels;          ///< those that occur, by value, without the background
};

/// One byte per voxel: 0 outside, 1 inside.
struct Mask {
  VolumeGeometry geometry;
  std::vector<std::uint8_t> voxels;
};

}  // namespace c3de::imaging
