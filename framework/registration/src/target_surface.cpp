// SPDX-License-Identifier: Apache-2.0
#include "target_surface.h"

#include <algorithm>
#include <cmath>

#include "point_tree.h"

namespace c3de::registration {
namespace {

constexpr std::size_t kSamples = 4096;
constexpr std::uint16_t kNone = 0xffff;
constexpr double kCellsAlongDiagonal = 64.0;
/// Share of the diagonal within which a start may be wrong: what remains is for the iterations.
constexpr double kReach = 0.06;

}  // namespace

void inParallel(ThreadPool *pool, std::size_t n, std::size_t grain,
                const std::function<void(std::size_t, std::size_t)> &body) {
  if (pool != nullptr)
    pool->parallelFor(n, grain, body);
  else
    body(0, n);
}

Expected<TargetSurface> TargetSurface::of(const geometry::TriangleMesh &mesh) {
  auto tree = collision::AabbTree::build(mesh.vertices, mesh.triangles);
  if (!tree) return tl::unexpected(tree.error());
  TargetSurface out(std::move(*tree));
  out.samples_ = sampleSurface(mesh, kSamples);
  if (out.samples_.points.empty())
    return fail(ErrorCode::usage, "the surface of the body has no area; accepted: a closed triangle surface");
  const geometry::Box box = boundingBox(mesh);
  out.diagonal_mm_ = norm(box.max - box.min);
  out.spacing_mm_ = std::sqrt(surfaceArea(mesh) / static_cast<double>(out.samples_.points.size()));
  out.reach_mm_ = std::max(kReach * out.diagonal_mm_, 2.0 * out.spacing_mm_);
  for (const Vec3 &p : out.samples_.points)
    out.centre_ = out.centre_ + (1.0 / static_cast<double>(out.samples_.points.size())) * p;
  out.cell_mm_ = out.diagonal_mm_ / kCellsAlongDiagonal;
  for (std::size_t a = 0; a < 3; ++a) {
    out.origin_[a] = box.min[a] - out.reach_mm_;
    out.cells_[a] = static_cast<std::size_t>(std::ceil((box.max[a] + out.reach_mm_ - out.origin_[a]) / out.cell_mm_));
  }
  return out;
}

void TargetSurface::fillGrid(ThreadPool *pool) {
  const PointTree tree(samples_.points);
  nearest_.assign(cells_[0] * cells_[1] * cells_[2], kNone);
  const double farthest = reach_mm_ + cell_mm_ + spacing_mm_;
  inParallel(pool, cells_[2], 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t z = begin; z < end; ++z)
      for (std::size_t y = 0; y < cells_[1]; ++y)
        for (std::size_t x = 0; x < cells_[0]; ++x) {
          const Vec3 at = origin_ + cell_mm_ * Vec3{static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5,
                                                    static_cast<double>(z) + 0.5};
          std::uint32_t index = 0;
          double squared = 0.0;
          if (tree.nearest(at, 1, &index, &squared) == 1 && squared <= farthest * farthest)
            nearest_[(z * cells_[1] + y) * cells_[0] + x] = static_cast<std::uint16_t>(index);
        }
  });
}

Foot TargetSurface::closest(const Vec3 &p, double within_mm) const {
  const collision::ClosestPoint found = tree_.closest(p, within_mm);
  return {found.point, found.normal, std::abs(found.distance), found.isFound()};
}

Foot TargetSurface::near(const Vec3 &p) const {
  if (nearest_.empty()) return {};
  std::size_t at = 0;
  for (std::size_t a = 3; a-- > 0;) {
    const double x = (p[a] - origin_[a]) / cell_mm_;
    if (!(x >= 0.0 && x < static_cast<double>(cells_[a]))) return {};
    at = at * cells_[a] + static_cast<std::size_t>(x);
  }
  const std::uint16_t index = nearest_[at];
  if (index == kNone) return {};
  const Vec3 &s = samples_.points[index], &n = samples_.normals[index];
  const Vec3 d = p - s;
  const double across = dot(d, n);
  // Half a spacing sideways is still in the cell of the sample; what is beyond counts as distance.
  const double sideways = std::sqrt(std::max(0.0, dot(d, d) - across * across));
  const double beyond = std::max(0.0, sideways - spacing_mm_ - cell_mm_);
  return {p - across * n, n, std::sqrt(across * across + beyond * beyond), true};
}

}  // namespace c3de::registration
