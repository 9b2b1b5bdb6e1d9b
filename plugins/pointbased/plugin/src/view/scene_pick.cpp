// SPDX-License-Identifier: Apache-2.0
#include "view/scene_pick.h"

#include <Eigen/LU>
#include <cmath>

namespace pointbased {
namespace {

Vec3 towardsEye(const Vec3 &a, const Vec3 &b, const Vec3 &c, const PickRay &ray) {
  const Vec3 normal = (b - a).cross(c - a).normalized();
  return normal.dot(ray.direction) > 0.0 ? Vec3(-normal) : normal;
}

}  // namespace

std::optional<Vec3> PickRay::onScreenPlane(const Vec3 &point) const {
  const double along = direction.dot(view);
  if (std::abs(along) < 1e-9) return std::nullopt;
  const double t = (point - origin).dot(view) / along;
  if (t <= 0.0) return std::nullopt;
  return origin + t * direction;
}

std::optional<PickRay> rayOf(const Services &services, c3de_handle node, const c3de_event &event) {
  const auto matrix = services.scene.worldFromNode(node);
  if (!matrix) return std::nullopt;
  const Eigen::Matrix4d nodeFromWorld = Eigen::Map<const Eigen::Matrix4d>(matrix->data()).inverse();
  const Mat3 turn = nodeFromWorld.topLeftCorner<3, 3>();
  return PickRay{(nodeFromWorld * Vec3(event.ray_origin_mm).homogeneous()).head<3>(),
                 (turn * Vec3(event.ray_direction)).normalized(), (turn * Vec3(event.view_direction)).normalized()};
}

std::optional<PickedSurface> pick(const Services &services, const Snapshot &snapshot, const PickRay &ray) {
  std::optional<PickedSurface> nearest;
  for (const BodySnapshot &body : snapshot.bodies) {
    const std::optional<c3de_handle> tree = presentTree(services, *body.surface, viewOf(body.surfels));
    if (!tree) continue;
    const auto hit = services.collision.ray(*tree, toArray(ray.origin), toArray(ray.direction));
    if (!hit || hit->triangle >= body.surface->triangles.size() || (nearest && nearest->t <= hit->t)) continue;
    const auto &corners = body.surface->triangles[hit->triangle];
    nearest = PickedSurface{&body,
                            nullptr,
                            hit->triangle,
                            hit->t,
                            ray.origin + hit->t * ray.direction,
                            towardsEye(vectorOf(body.surfels[corners[0]]), vectorOf(body.surfels[corners[1]]),
                                       vectorOf(body.surfels[corners[2]]), ray)};
  }
  for (const ObstacleSnapshot &obstacle : snapshot.obstacles) {
    // Its tree is in the frame at rest.
    const RigidMotion &motion = obstacle.motion;
    const Mat3 back = motion.rotation.transpose();
    const PickRay atRest{back * (ray.origin - motion.centre - motion.displacement) + motion.centre,
                         back * ray.direction, back * ray.view};
    const auto hit =
        services.collision.ray(obstacle.mesh->tree.handle(), toArray(atRest.origin), toArray(atRest.direction));
    if (!hit || hit->triangle >= obstacle.mesh->triangles.size() || (nearest && nearest->t <= hit->t)) continue;
    const auto &corners = obstacle.mesh->triangles[hit->triangle];
    const Vec3 normal = towardsEye(obstacle.mesh->positions[corners[0]], obstacle.mesh->positions[corners[1]],
                                   obstacle.mesh->positions[corners[2]], atRest);
    nearest = PickedSurface{
        nullptr, &obstacle, hit->triangle, hit->t, ray.origin + hit->t * ray.direction, motion.rotation * normal};
  }
  return nearest;
}

Skins::Skins(const Services &services, const Snapshot &snapshot) : services_(services) {
  for (const BodySnapshot &body : snapshot.bodies)
    if (presentTree(services, *body.surface, viewOf(body.surfels))) bodies_.push_back(&body);
}

std::vector<const BodySnapshot *> Skins::bodiesAt(const Vec3 &place) const {
  std::vector<const BodySnapshot *> all;
  for (const BodySnapshot *body : bodies_)
    if (closestOn(services_, body->surface->pickTree.handle(), place).distance < 0.0) all.push_back(body);
  return all;
}

NearSkin Skins::nearestSkin(const Vec3 &place) const {
  NearSkin near;
  for (const BodySnapshot *body : bodies_) {
    const c3de_closest closest = closestOn(services_, body->surface->pickTree.handle(), place);
    if (!std::isfinite(closest.distance) || (near.body && near.distance <= closest.distance)) continue;
    const Vec3 way = place - Vec3::Map(closest.point);
    const double length = way.norm();
    near = {
        body, closest.distance,
        length > 1e-9 ? Vec3((closest.distance < 0.0 ? -1.0 : 1.0) / length * way) : Vec3(Vec3::Map(closest.normal))};
  }
  return near;
}

}  // namespace pointbased
