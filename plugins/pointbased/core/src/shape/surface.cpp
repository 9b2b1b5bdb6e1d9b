// SPDX-License-Identifier: Apache-2.0
#include "pointbased/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "shape/occupancy_field.h"

namespace pointbased {
namespace {

// Convex, planar, in order.
using Polygon = std::vector<Vec3>;

// A half-space n·x <= offset.
struct Plane {
  Vec3 normal;  // unit
  double offset;
};

// Clips a convex polygon by a half-space (Sutherland and Hodgman 1974).
void clip(const Polygon &polygon, const Plane &plane, Polygon &out) {
  out.clear();
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 &a = polygon[i], &b = polygon[(i + 1) % n];
    const double da = plane.normal.dot(a) - plane.offset, db = plane.normal.dot(b) - plane.offset;
    if (da <= 0.0) out.push_back(a);
    if ((da < 0.0 && db > 0.0) || (da > 0.0 && db < 0.0)) out.push_back(a + (b - a) * (da / (da - db)));
  }
}

struct Measure {
  double area = 0.0;
  Vec3 centroid = Vec3::Zero();
};

Measure measure(const Polygon &polygon, const Vec3 &normal) {
  Measure m;
  if (polygon.size() < 3) return m;
  const Vec3 &origin = polygon[0];
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    const Vec3 a = polygon[i] - origin, b = polygon[i + 1] - origin;
    const double area = 0.5 * normal.dot(a.cross(b));
    m.area += area;
    m.centroid += area / 3.0 * (a + b);
  }
  m.centroid = m.area > 0.0 ? Vec3(origin + m.centroid / m.area) : origin;
  return m;
}

// The two corners with the largest distance.
std::pair<std::size_t, std::size_t> farthestCorners(const Polygon &polygon) {
  std::pair<std::size_t, std::size_t> corners{0, 0};
  double largest = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
    for (std::size_t j = i + 1; j < polygon.size(); ++j)
      if (const double d = (polygon[i] - polygon[j]).squaredNorm(); d > largest) {
        largest = d;
        corners = {i, j};
      }
  return corners;
}

// Sides of the polygon that replaces the circle cut out of a plane by a sphere. It has the area of the circle; its
// local error is below 1e-3 of the radius.
constexpr int kCircleSides = 64;

// Of the size of the surface: parts of the surface within this distance of the region belong to it. Faces on the border
// are meant to belong, and their coordinates may be rounded.
constexpr double kTolerance = 1e-9;

double toleranceOf(const Surface &surface) {
  if (surface.positions.empty()) return 0.0;
  Vec3 low = surface.positions[0], high = low;
  for (const Vec3 &x : surface.positions) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const double farthest = std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
  return std::max(kTolerance * (high - low).norm(), 4.0 * std::numeric_limits<double>::epsilon() * farthest);
}

class Sampler {
 public:
  Sampler(const Surface &surface, double spacing, const Region &within)
      : within_(within), tolerance_(toleranceOf(surface)),
        spacing_(spacing > 0.0 ? std::max(spacing, tolerance_) : 0.0) {}

  void add(const Vec3 &a, const Vec3 &b, const Vec3 &c, Index triangle) {
    if (outside(a, b, c)) return;
    const Vec3 twice = (b - a).cross(c - a);
    const double length = twice.norm();
    if (!(length > 0.0) || !std::isfinite(length)) return;  // no area, no normal
    normal_ = twice / length;
    triangle_ = triangle;
    polygon_.assign({a, b, c});
    if (!std::holds_alternative<VoxelRegion>(within_) && (!inside(a) || !inside(b) || !inside(c))) {
      cut();
      // A face that only touches the border leaves a strip as wide as the tolerance.
      if (polygon_.size() < 3) return;
      const auto [i, j] = farthestCorners(polygon_);
      if (!(measure(polygon_, normal_).area > 4.0 * tolerance_ * (polygon_[i] - polygon_[j]).norm())) return;
    }
    divide(polygon_);
  }

  [[nodiscard]] SurfacePoints take() { return std::move(points_); }

 private:
  [[nodiscard]] bool inside(const Vec3 &x) const { return signedDistance(within_, x) <= tolerance_; }

  // Conservative test by bounds.
  [[nodiscard]] bool outside(const Vec3 &a, const Vec3 &b, const Vec3 &c) const {
    const Vec3 low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    if (const auto *box = std::get_if<BoxRegion>(&within_))
      return (box->min - high).maxCoeff() > tolerance_ || (low - box->max).maxCoeff() > tolerance_;
    if (const auto *sphere = std::get_if<SphereRegion>(&within_))
      return (low - sphere->centre).cwiseMax(sphere->centre - high).cwiseMax(0.0).norm() > sphere->radius + tolerance_;
    return !inside(a) && !inside(b) && !inside(c) && std::holds_alternative<HalfSpaceRegion>(within_);
  }

  void cutBy(const Plane &plane) {
    clip(polygon_, plane, scratch_);
    polygon_.swap(scratch_);
  }

  void cut() {
    if (const auto *box = std::get_if<BoxRegion>(&within_)) {
      for (int axis = 0; axis < 3; ++axis) {
        cutBy({Vec3::Unit(axis), box->max[axis] + tolerance_});
        cutBy({-Vec3::Unit(axis), -box->min[axis] + tolerance_});
      }
    } else if (const auto *half = std::get_if<HalfSpaceRegion>(&within_)) {
      const Vec3 n = half->normal.normalized();
      cutBy({n, n.dot(half->point) + tolerance_});
    } else if (const auto *sphere = std::get_if<SphereRegion>(&within_)) {
      cutByCircle(*sphere);
    }
  }

  void cutByCircle(const SphereRegion &sphere) {
    const double height = normal_.dot(sphere.centre - polygon_[0]);
    const double radius = sphere.radius + tolerance_;
    const double squared = radius * radius - height * height;
    if (!(squared > 0.0)) {
      polygon_.clear();
      return;
    }
    // Apothem that makes the area of the polygon that of the circle.
    const double half = std::numbers::pi / kCircleSides;
    const double apothem = std::sqrt(squared * half / std::tan(half));
    const Vec3 centre = sphere.centre - height * normal_;
    const Vec3 e1 = normal_.unitOrthogonal(), e2 = normal_.cross(e1);
    for (int k = 0; k < kCircleSides && polygon_.size() >= 3; ++k) {
      const double angle = 2.0 * half * k;
      const Vec3 n = std::cos(angle) * e1 + std::sin(angle) * e2;
      cutBy({n, n.dot(centre) + apothem});
    }
  }

  // Halves the polygon across its longest extent until that is at most the spacing.
  void divide(const Polygon &polygon) {
    const auto [i, j] = farthestCorners(polygon);
    const Vec3 way = polygon[j] - polygon[i];
    const double length = way.norm();
    if (spacing_ > 0.0 && length > spacing_) {
      const Vec3 n = way / length;
      const double middle = n.dot(0.5 * (polygon[i] + polygon[j]));
      Polygon part;
      clip(polygon, {n, middle}, part);
      divide(part);
      clip(polygon, {-n, -middle}, part);
      divide(part);
      return;
    }
    const Measure m = measure(polygon, normal_);
    if (!(m.area > 0.0)) return;
    // Voxels have no faces to clip by: a piece belongs to the voxels behind it.
    if (const auto *filled = std::get_if<VoxelRegion>(&within_);
        filled != nullptr && !inside(m.centroid - 0.5 * filled->voxels->voxel() * normal_))
      return;
    points_.positions.push_back(m.centroid);
    points_.normals.push_back(normal_);
    points_.areas.push_back(m.area);
    points_.triangles.push_back(triangle_);
  }

  const Region &within_;
  double tolerance_;
  double spacing_;  // 0: no subdivision
  Vec3 normal_ = Vec3::Zero();
  Index triangle_ = 0;
  Polygon polygon_, scratch_;
  SurfacePoints points_;
};

}  // namespace

SurfacePoints sampleSurface(const Surface &surface, double spacing, const Region &within) {
  Sampler sampler(surface, spacing, within);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto &[a, b, c] = surface.triangles[t];
    sampler.add(surface.positions[a], surface.positions[b], surface.positions[c], static_cast<Index>(t));
  }
  return sampler.take();
}

}  // namespace pointbased
