// SPDX-License-Identifier: Apache-2.0
#include "body_builder.h"

#include <cmath>

namespace pointbased {
namespace {

// The queries run inside parallel loops of the solver, where nobody takes an error: they cannot fail for trees and views
// that we made, and if they did, "nothing near" would be a lie, so it stops here.
void mustSucceed(const sdk::Result<void> &result) {
  if (!result) throw sdk::Error(result.failure());
}

BodyShape shapeOf(const Services &services, c3de_handle mesh, const Placement &placement,
                  const std::shared_ptr<PlacedMesh> &surface) {
  BodyShape shape;
  shape.min = surface->min;
  shape.max = surface->max;
  shape.volume = surface->volume;
  const PlacementTransform transform(placement);
  shape.inside = [&services, mesh, transform](std::span<const Vec3> points, std::span<double> inside) {
    std::vector<Vec3> mm;
    mm.reserve(points.size());
    for (const Vec3 &p : points) mm.push_back(transform.millimetres(p));
    mustSucceed(services.meshes.windingNumbers(mesh, viewOf(mm), inside));
  };
  shape.surfaceDistance = [&services, surface](std::span<const Vec3> points, std::span<double> distances) {
    std::vector<c3de_closest> found(points.size());
    const double everywhere = std::numeric_limits<double>::infinity();
    const auto *table = services.collision.table();
    mustSucceed(services.host.check(table->closest(table->ctx, surface->tree.handle(), viewOf(points),
                                                   sdk::scalars(std::span<const double>(&everywhere, 1)), found.data())));
    for (std::size_t i = 0; i < points.size(); ++i) distances[i] = std::abs(found[i].distance);
  };
  return shape;
}

}  // namespace

BuiltBody buildBody(const Services &services, const std::string &name, c3de_handle mesh, const Placement &placement,
                    const ParameterValues &values, const sdk::Progress &progress) {
  const Material material = materialOf(values);
  if (const auto valid = validate(material); !valid) throw sdk::Error(C3DE_E_ARG, name + ": " + valid.error());
  const NeighborChoice choice = neighborChoiceOf(values);
  const auto *meshes = services.meshes.table();
  if (const auto fillable = services.host.check(meshes->check_fillable(meshes->ctx, mesh)); !fillable)
    throw sdk::Error(C3DE_E_FORMAT, fillable.failure().message);
  if (!progress.update(0.0, "placing the surface")) throw sdk::Error(C3DE_E_CANCELLED, "cancelled");

  BuiltBody out;
  out.surface = placeMesh(services, mesh, placement);
  const ParallelFor parallelFor = services.parallelFor();
  const auto cloud = fill(shapeOf(services, mesh, placement, out.surface), samplingOf(values), parallelFor,
                          [&](double fraction) { return progress.update(0.05 + 0.7 * fraction, "filling with phyxels"); });
  if (!cloud)
    throw sdk::Error(cloud.error() == "cancelled" ? C3DE_E_CANCELLED : C3DE_E_ARG, name + ": " + cloud.error());
  if (!progress.update(0.75, "finding neighbourhoods")) throw sdk::Error(C3DE_E_CANCELLED, "cancelled");
  auto rest = buildRestState(*cloud, choice, out.surface->volume, out.surface->positions, out.surface->normals, parallelFor);
  if (!progress.update(0.85, "finding the stable step")) throw sdk::Error(C3DE_E_CANCELLED, "cancelled");
  out.body = std::make_unique<Body>(name, std::move(rest), material, stabilisationOf(values), parallelFor);
  (void)progress.update(1.0, "done");
  return out;
}

sdk::MeshHandle copyMesh(const Services &services, c3de_handle mesh) {
  const auto *table = services.meshes.table();
  c3de_view positions{}, triangles{};
  sdk::orThrow(services.host.check(table->positions(table->ctx, mesh, &positions)));
  sdk::orThrow(services.host.check(table->triangles(table->ctx, mesh, &triangles)));
  return sdk::orThrow(services.meshes.create(positions, triangles));
}

Obstacle buildObstacle(const Services &services, const std::string &name, const std::shared_ptr<PlacedMesh> &mesh,
                       double friction) {
  Obstacle obstacle;
  obstacle.name = name;
  obstacle.friction = friction;
  obstacle.closest = [&services, mesh](std::span<const Vec3> points, std::span<const double> maxDistances,
                                       std::span<SurfacePoint> out) {
    std::vector<c3de_closest> found(points.size());
    const auto *table = services.collision.table();
    mustSucceed(services.host.check(table->closest(table->ctx, mesh->tree.handle(), viewOf(points),
                                                   sdk::scalars(maxDistances), found.data())));
    for (std::size_t i = 0; i < points.size(); ++i)
      out[i] = {Vec3(found[i].normal[0], found[i].normal[1], found[i].normal[2]), found[i].distance};
  };
  obstacle.crossing = [&services, mesh](const Vec3 &from, const Vec3 &to, Vec3 &normal) {
    c3de_ray_hit hit{};
    const auto *table = services.collision.table();
    mustSucceed(services.host.check(table->segments(table->ctx, mesh->tree.handle(), viewOf({&from, 1}), viewOf({&to, 1}), &hit)));
    if (hit.triangle >= mesh->triangles.size()) return -1.0;
    const auto &corners = mesh->triangles[hit.triangle];
    normal = (mesh->positions[corners[1]] - mesh->positions[corners[0]])
                 .cross(mesh->positions[corners[2]] - mesh->positions[corners[0]])
                 .normalized();
    return hit.t;
  };
  return obstacle;
}

}  // namespace pointbased
