// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/volume.h"

#include <algorithm>
#include <cmath>

namespace c3de::imaging {
namespace {

Vec3 axis(const Mat4 &m, int a) {
  const auto c = static_cast<std::size_t>(4 * a);
  return {m[c], m[c + 1], m[c + 2]};
}
double determinant(const Mat4 &m) { return dot(axis(m, 0), cross(axis(m, 1), axis(m, 2))); }

}  // namespace

Vec3 VolumeGeometry::spacing() const {
  return {norm(axis(indexToWorld, 0)), norm(axis(indexToWorld, 1)), norm(axis(indexToWorld, 2))};
}
double VolumeGeometry::voxelVolume() const { return std::abs(determinant(indexToWorld)); }
double VolumeGeometry::handedness() const { return determinant(indexToWorld); }

double VolumeGeometry::shear() const {
  double most = 0.0;
  for (int a = 0; a < 3; ++a) {
    const Vec3 u = axis(indexToWorld, a), v = axis(indexToWorld, (a + 1) % 3);
    most = std::max(most, std::abs(dot(u, v)) / (norm(u) * norm(v)));
  }
  return most;
}

Mat4 affineInverse(const Mat4 &affine) {
  const Vec3 x = axis(affine, 0), y = axis(affine, 1), z = axis(affine, 2), origin = axis(affine, 3);
  const double inverse = 1.0 / determinant(affine);
  const Vec3 rows[3] = {inverse * cross(y, z), inverse * cross(z, x), inverse * cross(x, y)};
  Mat4 m = kIdentity4;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) m[4 * c + r] = rows[r][c];
    m[12 + r] = -dot(rows[r], origin);
  }
  return m;
}

std::optional<std::array<std::size_t, 3>> voxelAt(const VolumeGeometry &grid, const Vec3 &index) {
  std::array<std::size_t, 3> voxel{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double rounded = std::floor(index[a] + 0.5);
    if (!(rounded >= 0.0) || !(rounded < static_cast<double>(grid.size[a]))) return {};
    voxel[a] = static_cast<std::size_t>(rounded);
  }
  return voxel;
}

bool sameGrid(const VolumeGeometry &a, const VolumeGeometry &b, double tolerance) {
  if (a.size != b.size) return false;
  for (unsigned corner = 0; corner < 8; ++corner) {
    Vec3 index{};
    for (std::size_t c = 0; c < 3; ++c) index[c] = (corner >> c & 1u) != 0 ? static_cast<double>(a.size[c] - 1) : 0.0;
    if (norm(a.worldAt(index) - b.worldAt(index)) > tolerance) return false;
  }
  return true;
}

double Volume::value(std::size_t i, std::size_t j, std::size_t k) const {
  const std::size_t at = offset(i, j, k);
  return slope * std::visit([at](const auto &all) { return static_cast<double>(all[at]); }, voxels) + intercept;
}

std::size_t Volume::bytes() const {
  return std::visit([](const auto &all) { return all.size() * sizeof(all[0]); }, voxels) +
         colours.size() * sizeof(Rgba);
}

const char *Volume::scalarTypeName() const {
  static constexpr const char *kNames[] = {"int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"};
  return kNames[voxels.index()];
}

}  // namespace c3de::imaging
