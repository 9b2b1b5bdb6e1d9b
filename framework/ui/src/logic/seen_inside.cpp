// SPDX-License-Identifier: Apache-2.0
#include "logic/seen_inside.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "c3de/imaging/volume.h"

namespace c3de::ui {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kTouching_mm = 1e-3;  // a slice in the plane of a cut, where the ray starts

/// Distance to a convex polygon.
double distanceTo(const std::vector<Vec3> &corners, const Vec3 &normal, const render::Ray &ray) {
  const double along = dot(ray.direction, normal);
  if (corners.size() < 3 || along == 0.0) return kNever;
  const double t = dot(corners.front() - ray.origin, normal) / along;
  if (!(t >= -kTouching_mm)) return kNever;
  const Vec3 at = ray.origin + t * ray.direction;
  bool isLeft = false, isRight = false;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 &a = corners[i], &b = corners[(i + 1) % corners.size()];
    const double side = dot(cross(b - a, at - a), normal);
    isLeft = isLeft || side > 0.0;
    isRight = isRight || side < 0.0;
  }
  return isLeft && isRight ? kNever : std::max(t, 0.0);
}

/// @source  Möller and Trumbore, Fast, minimum storage ray-triangle intersection, 1997
/// Distance to a mesh; kNever if the ray does not hit it.
double distanceTo(const render::MeshView &mesh, const render::Ray &ray) {
  // Transform into the space of the mesh, in which ray parameters remain the same.
  const Mat4 back = imaging::affineInverse(mesh.worldFromProxy);
  const Vec3 origin = transformPoint(back, ray.origin);
  const Vec3 way = transformPoint(back, ray.origin + ray.direction) - origin;
  const auto corner = [&](std::uint32_t i) {
    const render::Vec3f &p = mesh.positions[i];
    return Vec3{p[0], p[1], p[2]};
  };
  double nearest = kNever;
  for (const auto &triangle : mesh.triangles) {
    const Vec3 a = corner(triangle[0]), ab = corner(triangle[1]) - a, ac = corner(triangle[2]) - a;
    const Vec3 p = cross(way, ac), q = cross(origin - a, ab);
    const double det = dot(ab, p);
    if (det == 0.0 || (det < 0.0 && !mesh.material.twoSided)) continue;
    const double u = dot(origin - a, p) / det, v = dot(way, q) / det, t = dot(ac, q) / det;
    if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0) nearest = std::min(nearest, t);
  }
  return nearest;
}

}  // namespace

std::optional<double> seenInside(const render::Renderer &renderer, const render::ImageScene &scene,
                                 const render::GridGeometry *place, const render::Ray &ray) {
  double inside = kNever, before = kNever;
  for (std::size_t i = 0; place != nullptr && i < scene.slices.size(); ++i) {
    const render::SliceInSpace &slice = scene.slices[i];
    const std::vector<Vec3> corners =
        render::cutPolygon(render::sliceOutline(*place, slice.point, slice.normal), scene.cuts);
    inside = std::min(inside, distanceTo(corners, slice.normal, ray));
  }
  renderer.forEachMesh([&](const render::MeshView &mesh) {
    if (mesh.material.colour[3] < 1.0f) return;
    double &nearest = mesh.material.isInside ? inside : before;
    nearest = std::min(nearest, distanceTo(mesh, ray));
  });
  return inside < before ? std::optional(inside) : std::nullopt;
}

std::optional<double> nearestSurface(const render::Renderer &renderer, const render::Ray &ray) {
  double nearest = kNever;
  renderer.forEachMesh([&](const render::MeshView &mesh) { nearest = std::min(nearest, distanceTo(mesh, ray)); });
  return nearest < kNever ? std::optional(nearest) : std::nullopt;
}

}  // namespace c3de::ui
