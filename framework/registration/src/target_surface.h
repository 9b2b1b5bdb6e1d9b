// SPDX-License-Identifier: Apache-2.0
// Private to registration.
#pragma once

#include <cstdint>
#include <vector>

#include "c3de/collision/aabb_tree.h"
#include "c3de/core/expected.h"
#include "c3de/core/thread_pool.h"
#include "c3de/geometry/triangle_mesh.h"
#include "c3de/registration/surface_samples.h"

namespace c3de::registration {

/// Calls body(begin, end) for parts of [0, n), on the pool if there is one.
void inParallel(ThreadPool *pool, std::size_t n, std::size_t grain,
                const std::function<void(std::size_t, std::size_t)> &body);

/// Where a point meets a surface.
struct Foot {
  Vec3 point{}, normal{};
  double distance = 0.0;  ///< >= 0
  bool isFound = false;
};

/// The surface of a body with two kinds of closest points: exact ones, and near ones from samples in a grid, which take
/// a few nanoseconds.
class TargetSurface {
 public:
  /// Errors (usage): no area, or what AabbTree::build() refuses.
  [[nodiscard]] static Expected<TargetSurface> of(const geometry::TriangleMesh &mesh);
  /// Builds the lookup grid of near().
  void fillGrid(ThreadPool *pool);

  [[nodiscard]] Foot closest(const Vec3 &p, double within_mm) const;
  /// The plane through a sample near the closest one; not found beyond reach_mm(), or before fillGrid().
  [[nodiscard]] Foot near(const Vec3 &p) const;
  [[nodiscard]] const SurfaceSamples &samples() const { return samples_; }
  [[nodiscard]] double reach_mm() const { return reach_mm_; }
  [[nodiscard]] double spacing_mm() const { return spacing_mm_; }    ///< of the samples
  [[nodiscard]] double diagonal_mm() const { return diagonal_mm_; }  ///< of the bounding box
  [[nodiscard]] bool isClosed() const { return tree_.isClosed(); }
  [[nodiscard]] const Vec3 &centre() const { return centre_; }  ///< mean of the samples

 private:
  explicit TargetSurface(collision::AabbTree tree) : tree_(std::move(tree)) {}

  collision::AabbTree tree_;
  SurfaceSamples samples_;
  double reach_mm_ = 0.0, spacing_mm_ = 0.0, diagonal_mm_ = 0.0;
  Vec3 centre_{};
  Vec3 origin_{};
  double cell_mm_ = 1.0;
  std::array<std::size_t, 3> cells_{};
  std::vector<std::uint16_t> nearest_;  ///< index of the sample nearest to the centre of each cell, kNone: beyond reach
};

}  // namespace c3de::registration
