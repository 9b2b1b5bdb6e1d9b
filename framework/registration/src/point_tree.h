// SPDX-License-Identifier: Apache-2.0
// Private to registration. k-d tree over points owned by the caller; the only file of the module that uses nanoflann.
#pragma once

#include <cstdint>
#include <nanoflann.hpp>
#include <span>
#include <vector>

#include "c3de/core/vec.h"

namespace c3de::registration {

/// The points must outlive the tree. Queries may run on several threads concurrently.
class PointTree {
 public:
  explicit PointTree(std::span<const Vec3> points) : cloud_{points}, tree_(3, cloud_, {kLeafSize}) {}
  PointTree(const PointTree &) = delete;
  PointTree &operator=(const PointTree &) = delete;

  /// Indices and squared distances of the nearest points, nearest first. Returns their number.
  std::size_t nearest(const Vec3 &at, std::size_t count, std::uint32_t *indices, double *squared) const {
    return tree_.knnSearch(at.data(), count, indices, squared);
  }

 private:
  struct Cloud {
    std::span<const Vec3> points;
    [[nodiscard]] std::size_t kdtree_get_point_count() const { return points.size(); }
    [[nodiscard]] double kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i][axis]; }
    template <class Box>
    bool kdtree_get_bbox(Box &) const {
      return false;
    }
  };
  static constexpr std::size_t kLeafSize = 12;

  Cloud cloud_;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3, std::uint32_t> tree_;
};

}  // namespace c3de::registration
