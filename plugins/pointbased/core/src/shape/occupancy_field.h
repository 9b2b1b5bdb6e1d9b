// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/occupancy.h"

namespace pointbased::detail {

/// Queries on an occupancy. Const once built; thread-safe.
class OccupancyField {
 public:
  /// The occupancy must be valid and not empty.
  OccupancyField(const Occupancy &occupancy, const ParallelFor &parallelFor);

  [[nodiscard]] double volume() const { return volume_; }  ///< m³
  /// Bounds of all non-empty voxels, world, m.
  [[nodiscard]] const Vec3 &min() const { return min_; }
  [[nodiscard]] const Vec3 &max() const { return max_; }

  /// Fill of the voxel around a point.
  [[nodiscard]] double fillAt(const Vec3 &x) const;
  [[nodiscard]] double distance(const Vec3 &x) const;
  /// Approximate signed distance to the border, negative inside, without the guarantee of distance().
  [[nodiscard]] double about(const Vec3 &x) const;
  [[nodiscard]] double voxel() const { return spacing_.minCoeff(); }  ///< m, shortest edge
  void shares(std::span<const Vec3> centres, const Mat3 &axes, double edge, std::span<double> out) const;
  [[nodiscard]] bool crosses(const Vec3 &from, const Vec3 &to) const;

 private:
  class Surroundings;

  using Size3 = std::array<std::size_t, 3>;
  struct Level {
    Size3 size{}, block{};  // voxels of the finest level per voxel here
    std::vector<float> fill;
  };

  void crop(const Occupancy &occupancy);
  void measure(const ParallelFor &parallelFor);
  void buildLevels();
  [[nodiscard]] Vec3 indexOf(const Vec3 &x) const { return toIndex_ * (x - origin_); }
  [[nodiscard]] std::size_t offset(std::size_t i, std::size_t j, std::size_t k) const {
    return i + levels_[0].size[0] * (j + levels_[0].size[1] * k);
  }
  [[nodiscard]] double length(const Vec3 &steps) const { return scale_ * steps.cwiseProduct(spacing_).norm(); }
  [[nodiscard]] double alongVoxels(const Level &level, const Vec3 &centre, const Mat3 &cube) const;
  [[nodiscard]] double byPoints(const Level &level, const Vec3 &centre, const Mat3 &cube, int perAxis) const;

  Vec3 origin_ = Vec3::Zero();  // centre of the first stored voxel, which is empty
  Mat3 steps_ = Mat3::Identity(), toIndex_ = Mat3::Identity();
  Vec3 spacing_ = Vec3::Zero();
  double scale_ = 1.0;  // factor of lengths from index differences; < 1 on sheared grids
  double volume_ = 0.0;
  Vec3 min_ = Vec3::Zero(), max_ = Vec3::Zero();
  std::vector<Level> levels_;     // the finest first; with an empty layer around it
  std::vector<float> distances_;  // between centres of voxels; negative in full ones, 0 in partly filled ones
};

}  // namespace pointbased::detail
