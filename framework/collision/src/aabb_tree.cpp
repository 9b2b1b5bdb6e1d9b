// SPDX-License-Identifier: Apache-2.0
#include "c3de/collision/aabb_tree.h"

// utility.h first: BVH_model.h uses its fit() without including it.
#include <fcl/math/bv/utility.h>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/detail/primitive_shape_algorithm/triangle_distance.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "surface_topology.h"
#include "triangle_queries.h"

namespace c3de::collision {
namespace {

using Model = fcl::BVHModel<fcl::AABBd>;
using Bounds = fcl::AABBd;

/// Relative tolerance of distances when a box is skipped, so that rounding in the box test never determines which of
/// two equally close triangles is found: a refitted tree returns the same result as a rebuilt one.
constexpr double kPruneTolerance = 1.0 + 1e-12;

Vec3 toVec3(const fcl::Vector3d &v) { return {v[0], v[1], v[2]}; }

bool isFinite(const Vec3 &v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }

Expected<void> checkVertices(std::span<const Vec3> vertices) {
  // Squares of lengths and products of three of them must stay finite.
  constexpr double kLimit = 1e60;
  for (std::size_t v = 0; v < vertices.size(); ++v)
    for (std::size_t k = 0; k < 3; ++k)
      if (!(std::abs(vertices[v][k]) <= kLimit))
        return fail(ErrorCode::input,
                    fmt::format("box tree: {} coordinate {} of vertex {} is not finite or beyond 1e60; "
                                "finite lengths are accepted",
                                "xyz"[k], vertices[v][k], v));
  return {};
}

Expected<std::unique_ptr<Model>> makeModel(const std::vector<fcl::Vector3d> &vertices,
                                           const std::vector<fcl::Triangle> &triangles) {
  auto model = std::make_unique<Model>();
  int status = model->beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size()));
  if (status >= 0) status = model->addSubModel(vertices, triangles);
  if (status >= 0) status = model->endModel();
  if (status < 0)
    return fail(ErrorCode::internal, fmt::format("box tree: FCL refused to build it (status {})", status));
  return model;
}

/// Depth-first stack; the tree of a pathological mesh may be deeper than the array.
template <class T>
class Stack {
 public:
  void push(const T &value) {
    if (size_ < small_.size())
      small_[size_] = value;
    else
      large_.push_back(value);
    ++size_;
  }
  bool pop(T &value) {
    if (size_ == 0) return false;
    --size_;
    if (size_ < small_.size()) {
      value = small_[size_];
    } else {
      value = large_.back();
      large_.pop_back();
    }
    return true;
  }

 private:
  std::array<T, 96> small_;
  std::vector<T> large_;
  std::size_t size_ = 0;
};

double squaredDistance(const Bounds &box, const Vec3 &p) {
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) {
    const double d =
        std::max({box.min_[k] - p[static_cast<std::size_t>(k)], 0.0, p[static_cast<std::size_t>(k)] - box.max_[k]});
    sum += d * d;
  }
  return sum;
}

/// Slab test, widened by the rounding error of the triangle test so that it never hides a hit.
class SlabTest {
 public:
  SlabTest(const Vec3 &origin, const Vec3 &direction, const Bounds &root) : origin_(origin) {
    double extent = 0.0;
    for (int k = 0; k < 3; ++k)
      extent = std::max(
          {extent, std::abs(root.min_[k]), std::abs(root.max_[k]), std::abs(origin[static_cast<std::size_t>(k)])});
    pad_ = 64.0 * std::numeric_limits<double>::epsilon() * extent;
    for (std::size_t k = 0; k < 3; ++k) inverse_[k] = direction[k] != 0.0 ? 1.0 / direction[k] : 0.0;
  }
  /// @param enter  out: where the ray enters the box, >= tMin
  bool hits(const Bounds &box, double tMin, double tMax, double &enter) const {
    double t0 = tMin, t1 = tMax;
    for (std::size_t k = 0; k < 3; ++k) {
      const double low = box.min_[static_cast<int>(k)] - pad_ - origin_[k],
                   high = box.max_[static_cast<int>(k)] + pad_ - origin_[k];
      if (inverse_[k] == 0.0) {
        if (low > 0.0 || high < 0.0) return false;
        continue;
      }
      const double a = low * inverse_[k], b = high * inverse_[k];
      t0 = std::max(t0, std::min(a, b));
      t1 = std::min(t1, std::max(a, b));
    }
    enter = t0;
    return t0 <= t1;
  }

 private:
  Vec3 origin_, inverse_{};
  double pad_ = 0.0;
};

}  // namespace

struct AabbTree::Impl {
  std::vector<Triangle> triangles;
  SurfaceTopology topology;
  std::vector<fcl::Vector3d> positions;
  std::vector<fcl::Triangle> fclTriangles;
  std::unique_ptr<Model> model;

  Impl(std::size_t vertexCount, std::span<const Triangle> t)
      : triangles(t.begin(), t.end()), topology(vertexCount, t) {}

  [[nodiscard]] Vec3 corner(std::uint32_t triangle, std::size_t k) const {
    return toVec3(model->vertices[triangles[triangle][k]]);
  }
  [[nodiscard]] Vec3 unitNormal(std::uint32_t triangle) const;
  [[nodiscard]] Vec3 pseudonormal(std::uint32_t triangle, Feature feature) const;
  [[nodiscard]] RayHit firstHit(const Vec3 &origin, const Vec3 &direction, double tMax, double slack) const;
};

AabbTree::AabbTree(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
AabbTree::AabbTree(AabbTree &&) noexcept = default;
AabbTree &AabbTree::operator=(AabbTree &&) noexcept = default;
AabbTree::~AabbTree() = default;

Expected<AabbTree> AabbTree::build(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
  constexpr std::size_t kMaxTriangles = std::size_t{1} << 29;  // FCL numbers the 2 n - 1 nodes with an int
  if (triangles.empty()) return fail(ErrorCode::input, "box tree: no triangles; at least one is expected");
  if (triangles.size() > kMaxTriangles || vertices.size() > 3 * kMaxTriangles)
    return fail(ErrorCode::input, fmt::format("box tree: {} triangles and {} vertices; up to {} and {} are accepted",
                                              triangles.size(), vertices.size(), kMaxTriangles, 3 * kMaxTriangles));
  if (auto ok = checkVertices(vertices); !ok) return tl::unexpected(ok.error());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (unsigned v : triangles[t])
      if (v >= vertices.size())
        return fail(ErrorCode::input,
                    fmt::format("box tree: triangle {} names vertex {}; there are {} vertices, 0 to {} are accepted", t,
                                v, vertices.size(), static_cast<long long>(vertices.size()) - 1));
  auto impl = std::make_unique<Impl>(vertices.size(), triangles);
  impl->positions.reserve(vertices.size());
  for (const Vec3 &v : vertices) impl->positions.emplace_back(v[0], v[1], v[2]);
  impl->fclTriangles.reserve(triangles.size());
  for (const Triangle &t : triangles) impl->fclTriangles.emplace_back(t[0], t[1], t[2]);
  auto model = makeModel(impl->positions, impl->fclTriangles);
  if (!model) return tl::unexpected(model.error());
  impl->model = std::move(*model);
  return AabbTree(std::move(impl));
}

Expected<void> AabbTree::refit(std::span<const Vec3> vertices) {
  if (vertices.size() != impl_->positions.size())
    return fail(ErrorCode::input,
                fmt::format("box tree: refit with {} positions; the tree has {} vertices, as many are expected",
                            vertices.size(), impl_->positions.size()));
  if (auto ok = checkVertices(vertices); !ok) return ok;
  for (std::size_t v = 0; v < vertices.size(); ++v)
    impl_->positions[v] = fcl::Vector3d(vertices[v][0], vertices[v][1], vertices[v][2]);
  // Replace, not update: an update keeps the previous positions and computes boxes around both.
  Model &model = *impl_->model;
  int status = model.beginReplaceModel();
  if (status >= 0) status = model.replaceSubModel(impl_->positions);
  if (status >= 0) status = model.endReplaceModel(true, true);
  if (status < 0)
    return fail(ErrorCode::internal, fmt::format("box tree: FCL refused to refit it (status {})", status));
  return {};
}

void AabbTree::rebuild() {
  // The input was accepted before, so this can only fail for lack of memory, which throws.
  if (auto model = makeModel(impl_->positions, impl_->fclTriangles)) impl_->model = std::move(*model);
}

RayHit AabbTree::Impl::firstHit(const Vec3 &origin, const Vec3 &direction, double tMax, double slack) const {
  RayHit best;
  const bool isZero = direction[0] == 0.0 && direction[1] == 0.0 && direction[2] == 0.0;
  if (!isFinite(origin) || !isFinite(direction) || isZero || !(tMax >= 0.0)) return best;
  const WatertightRay ray(origin, direction);
  const SlabTest slab(origin, direction, model->getBV(0).bv);
  struct Entry {
    int node;
    double enter;
  };
  Stack<Entry> stack;
  double limit = tMax + slack;
  Entry entry{0, 0.0};
  if (!slab.hits(model->getBV(0).bv, -slack, limit, entry.enter)) return best;
  stack.push(entry);
  while (stack.pop(entry)) {
    if (entry.enter > limit) continue;
    const auto &node = model->getBV(entry.node);
    if (node.isLeaf()) {
      const auto triangle = static_cast<std::uint32_t>(node.primitiveId());
      WatertightRay::Hit hit;
      if (!ray.intersect(corner(triangle, 0), corner(triangle, 1), corner(triangle, 2), hit)) continue;
      if (!(hit.t >= -slack && hit.t <= limit)) continue;
      // Of triangles hit at the same position, the one with the smallest index: the result does not depend on the tree.
      if (best.isHit() && hit.t == best.t && triangle > best.triangle) continue;
      best = {hit.t, triangle, hit.bary};
      limit = hit.t;
      continue;
    }
    Entry left{node.leftChild(), 0.0}, right{node.rightChild(), 0.0};
    const bool hitsLeft = slab.hits(model->getBV(left.node).bv, -slack, limit, left.enter);
    const bool hitsRight = slab.hits(model->getBV(right.node).bv, -slack, limit, right.enter);
    if (hitsLeft && hitsRight && left.enter <= right.enter) std::swap(left, right);
    // The closer one is now in `right` and is popped first.
    if (hitsLeft && hitsRight) {
      stack.push(left);
      stack.push(right);
    } else if (hitsLeft) {
      stack.push(left);
    } else if (hitsRight) {
      stack.push(right);
    }
  }
  if (best.isHit()) best.t = std::clamp(best.t, 0.0, tMax);
  return best;
}

RayHit AabbTree::ray(const Vec3 &origin, const Vec3 &direction, double tMax) const {
  return impl_->firstHit(origin, direction, tMax, 0.0);
}

RayHit AabbTree::segment(const Vec3 &from, const Vec3 &to) const {
  // An end on the surface counts, whichever way it was rounded.
  return impl_->firstHit(from, to - from, 1.0, 1e-12);
}

Vec3 AabbTree::Impl::unitNormal(std::uint32_t triangle) const {
  const Vec3 a = corner(triangle, 0), b = corner(triangle, 1), c = corner(triangle, 2);
  const Vec3 n = cross(b - a, c - a);
  const double length = norm(n);
  return length > 0.0 ? (1.0 / length) * n : Vec3{};
}

Vec3 AabbTree::Impl::pseudonormal(std::uint32_t triangle, Feature feature) const {
  const Vec3 own = unitNormal(triangle);
  if (feature == Feature::face) return own;
  // Baerentzen and Aanaes, Signed Distance Computation Using the Angle Weighted Pseudonormal, TVCG 2005: at an edge the
  // sum of the two face normals, at a vertex the sum weighted by the angles of the faces there.
  const Triangle &corners = triangles[triangle];
  Vec3 sum{};
  if (feature == Feature::edgeAB || feature == Feature::edgeBC || feature == Feature::edgeCA) {
    const std::size_t k = feature == Feature::edgeAB ? 0 : feature == Feature::edgeBC ? 1 : 2;
    const unsigned a = corners[k], b = corners[(k + 1) % 3];
    for (std::uint32_t t : topology.trianglesAt(a))
      if (triangles[t][0] == b || triangles[t][1] == b || triangles[t][2] == b) sum = sum + unitNormal(t);
  } else {
    const unsigned v = corners[feature == Feature::cornerA ? 0 : feature == Feature::cornerB ? 1 : 2];
    for (std::uint32_t t : topology.trianglesAt(v)) {
      const std::size_t k = triangles[t][0] == v ? 0 : triangles[t][1] == v ? 1 : 2;
      const Vec3 e = corner(t, (k + 1) % 3) - corner(t, k), f = corner(t, (k + 2) % 3) - corner(t, k);
      const double angle = std::atan2(norm(cross(e, f)), dot(e, f));
      sum = sum + angle * unitNormal(t);
    }
  }
  const double length = norm(sum);
  return length > 1e-9 ? (1.0 / length) * sum : own;
}

ClosestPoint AabbTree::closest(const Vec3 &point, double maxDistance) const {
  ClosestPoint result;
  if (!isFinite(point) || !(maxDistance >= 0.0)) return result;
  const Model &model = *impl_->model;
  struct Entry {
    int node;
    double distanceSquared;
  };
  Stack<Entry> stack;
  TrianglePoint best;
  best.distanceSquared = maxDistance * maxDistance;
  Entry entry{0, squaredDistance(model.getBV(0).bv, point)};
  stack.push(entry);
  while (stack.pop(entry)) {
    if (entry.distanceSquared > best.distanceSquared * kPruneTolerance) continue;
    const auto &node = model.getBV(entry.node);
    if (node.isLeaf()) {
      const auto triangle = static_cast<std::uint32_t>(node.primitiveId());
      const TrianglePoint here =
          closestOnTriangle(point, impl_->corner(triangle, 0), impl_->corner(triangle, 1), impl_->corner(triangle, 2));
      const bool isNearer = here.distanceSquared < best.distanceSquared;
      const bool isEqual = here.distanceSquared == best.distanceSquared;
      if (isNearer || (isEqual && triangle < result.triangle)) {
        best = here;
        result.triangle = triangle;
      }
      continue;
    }
    Entry left{node.leftChild(), squaredDistance(model.getBV(node.leftChild()).bv, point)};
    Entry right{node.rightChild(), squaredDistance(model.getBV(node.rightChild()).bv, point)};
    if (left.distanceSquared < right.distanceSquared) std::swap(left, right);
    stack.push(left);
    stack.push(right);  // the closer one is popped first
  }
  if (!result.isFound()) return result;

  result.point = best.point;
  result.bary = best.bary;
  result.distance = std::sqrt(best.distanceSquared);
  result.normal = impl_->pseudonormal(result.triangle, best.feature);
  const Vec3 offset = point - best.point;
  if (dot(result.normal, result.normal) == 0.0)  // only for a triangle without area
    result.normal = result.distance > 0.0 ? (1.0 / result.distance) * offset : Vec3{0.0, 0.0, 1.0};
  else if (impl_->topology.isClosed() && dot(offset, result.normal) < 0.0)
    result.distance = -result.distance;
  return result;
}

void AabbTree::sphere(const Vec3 &centre, double radius, std::vector<std::uint32_t> &out) const {
  out.clear();
  if (!isFinite(centre) || !(radius >= 0.0)) return;
  const double radiusSquared = radius * radius;
  const Model &model = *impl_->model;
  Stack<int> stack;
  int index = 0;
  stack.push(index);
  while (stack.pop(index)) {
    const auto &node = model.getBV(index);
    if (squaredDistance(node.bv, centre) > radiusSquared * kPruneTolerance) continue;
    if (!node.isLeaf()) {
      stack.push(node.leftChild());
      stack.push(node.rightChild());
      continue;
    }
    const auto triangle = static_cast<std::uint32_t>(node.primitiveId());
    if (closestOnTriangle(centre, impl_->corner(triangle, 0), impl_->corner(triangle, 1), impl_->corner(triangle, 2))
            .distanceSquared <= radiusSquared)
      out.push_back(triangle);
  }
  std::sort(out.begin(), out.end());
}

namespace {

/// Between the boxes, along the axes where they do not overlap.
double squaredGap(const fcl::AABBd &a, const fcl::AABBd &b) {
  const fcl::Vector3d gap = (a.min_ - b.max_).cwiseMax(b.min_ - a.max_).cwiseMax(0.0);
  return gap.squaredNorm();
}

bool sharesVertex(const Triangle &a, const Triangle &b) {
  return std::any_of(a.begin(), a.end(), [&](std::uint32_t v) { return std::find(b.begin(), b.end(), v) != b.end(); });
}

}  // namespace

void AabbTree::pairs(const AabbTree &other, double distance, std::vector<std::array<std::uint32_t, 2>> &out) const {
  out.clear();
  if (!(distance >= 0.0)) return;
  const bool isSame = &other == this;
  const Model &a = *impl_->model, &b = *other.impl_->model;
  const auto cornersOf = [](const Impl &impl, std::uint32_t triangle, fcl::Vector3d(&corners)[3]) {
    for (std::size_t k = 0; k < 3; ++k) corners[k] = impl.model->vertices[impl.triangles[triangle][k]];
  };
  Stack<std::array<int, 2>> stack;
  std::array<int, 2> at{0, 0};
  stack.push(at);
  while (stack.pop(at)) {
    const auto &first = a.getBV(at[0]), &second = b.getBV(at[1]);
    if (squaredGap(first.bv, second.bv) > distance * distance * kPruneTolerance) continue;
    // The larger one is split.
    const bool divideFirst = !first.isLeaf() && (second.isLeaf() || first.bv.size() >= second.bv.size());
    if (divideFirst) {
      stack.push({first.leftChild(), at[1]});
      stack.push({first.rightChild(), at[1]});
      continue;
    }
    if (!second.isLeaf()) {
      stack.push({at[0], second.leftChild()});
      stack.push({at[0], second.rightChild()});
      continue;
    }
    const auto i = static_cast<std::uint32_t>(first.primitiveId()),
               j = static_cast<std::uint32_t>(second.primitiveId());
    if (isSame && (i >= j || sharesVertex(impl_->triangles[i], impl_->triangles[j]))) continue;
    fcl::Vector3d s[3], t[3], p, q;
    cornersOf(*impl_, i, s);
    cornersOf(*other.impl_, j, t);
    // For degenerate triangles it may be NaN; such a pair is reported rather than missed.
    if (!(fcl::detail::TriangleDistance<double>::triDistance(s, t, p, q) > distance)) out.push_back({i, j});
  }
  std::sort(out.begin(), out.end());
}

bool AabbTree::isClosed() const { return impl_->topology.isClosed(); }
std::size_t AabbTree::triangleCount() const { return impl_->triangles.size(); }
std::size_t AabbTree::vertexCount() const { return impl_->positions.size(); }

}  // namespace c3de::collision
