// SPDX-License-Identifier: Apache-2.0
// k-d tree over points owned by the caller; the only file that uses nanoflann.
#pragma once

#include <nanoflann.hpp>

#include "pointbased/types.h"

namespace pointbased {

/// The points must outlive the tree. Queries may run on several threads concurrently.
class PointTree {
 public:
  explicit PointTree(std::span<const Vec3> points) : cloud_{points}, tree_(3, cloud_, {kLeafSize}) {}

  /// Indices and squared distances of the nearest points, nearest first. Returns their number.
  std::size_t nearest(const Vec3 &at, std::size_t count, Index *indices, double *squared) const {
    return tree_.knnSearch(at.data(), count, indices, squared);
  }
  /// All points within the radius, unordered.
  void within(const Vec3 &at, double radius, std::vector<std::pair<Index, double>> &found) const {
    found.clear();
    tree_.radiusSearch(at.data(), radius * radius, found, nanoflann::SearchParams(32, 0.0f, false));
  }

 private:
  struct Cloud {
    std::span<const Vec3> points;

    [[nodiscard]] std::size_t kdtree_get_point_count() const { return points.size(); }
    [[nodiscard]] double kdtree_get_pt(std::size_t i, std::size_t axis) const {
      return points[i][static_cast<Eigen::Index>(axis)];
    }
    template <class Box>
    bool kdtree_get_bbox(Box &) const {
      return false;
    }
  };
  static constexpr std::size_t kLeafSize = 16;

  Cloud cloud_;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3, Index> tree_;
};

}  // namespace pointbased
