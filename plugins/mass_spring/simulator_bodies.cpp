// SPDX-License-Identifier: Apache-2.0
// From a mesh and its parts, supports and loads to a body of the method.
#include <limits>

#include "c3de/sdk/structs.hpp"
#include "scene_input.h"
#include "simulator.h"

namespace mass_spring {
namespace {

using sdk::Error;

constexpr double kMetresPerMillimetre = 1e-3;

// Positions of the mesh in the world, in metres.
Surface readSurface(const Context &context, c3de_handle mesh, const Placement &placement) {
  const auto positions = sdk::orThrow(context.mesh.positions(mesh));
  const auto corners = sdk::orThrow(context.mesh.triangles(mesh));
  Surface surface;
  constexpr double kFar = std::numeric_limits<double>::infinity();
  surface.min = {kFar, kFar, kFar};
  surface.max = {-kFar, -kFar, -kFar};
  for (std::size_t i = 0; i < positions.size(); ++i) {
    surface.vertices.push_back(placement.linear * (kMetresPerMillimetre * vectorOf(positions[i])) + placement.position);
    for (std::size_t a = 0; a < 3; ++a) {
      surface.min[a] = std::min(surface.min[a], surface.vertices.back()[a]);
      surface.max[a] = std::max(surface.max[a], surface.vertices.back()[a]);
    }
  }
  for (std::size_t t = 0; t < corners.size(); ++t) {
    surface.triangles.push_back({corners[t][0], corners[t][1], corners[t][2]});
    const auto &[a, b, c] = surface.triangles.back();
    surface.volume_m3 += dot(surface.vertices[a], cross(surface.vertices[b], surface.vertices[c])) / 6.0;
  }
  return surface;
}

Inside insideOf(const Context &context, c3de_handle mesh, const Placement &placement) {
  return [&context, mesh, placement](const std::vector<Vec3> &points) {
    std::vector<Vec3> inMesh;
    inMesh.reserve(points.size());
    for (const Vec3 &x : points)
      inMesh.push_back((1.0 / kMetresPerMillimetre) * (placement.inverse * (x - placement.position)));
    std::vector<double> winding(points.size());
    sdk::orThrow(context.mesh.windingNumbers(mesh, sdk::rows<double, 3>(inMesh), winding));
    return winding;
  };
}

Part readPart(const c3de_sim_body &in, std::uint64_t i, const Lattice &lattice, const ParameterValues &values) {
  const auto part = sdk::readElement(in.parts, i, in.parts_stride, "part");
  Part made{sdk::readStruct(part.region, "region"), values, {}};
  made.values.set(part.params, part.params_n, part.params_stride);
  for (std::uint64_t k = 0; k < part.params_n; ++k)
    made.own.emplace_back(sdk::text(sdk::readElement(part.params, k, part.params_stride, "parameter").id));
  if (std::none_of(lattice.cells().begin(), lattice.cells().end(),
                   [&](const Lattice::Cell &cell) { return contains(made.region, lattice.centre(cell)); }))
    throw Error(C3DE_E_ARG,
                "the region meets no middle of a cell; the spacing is " + shown(1e3 * lattice.spacing()) + " mm",
                {"part", static_cast<std::uint32_t>(i), {}});
  return made;
}

void addSupport(const c3de_sim_fix &fix, PointBody &physics) {
  const auto region = sdk::readStruct(fix.region, "region");
  Support support;
  support.number = fix.index;
  Vec3 sum{};
  const auto &nodes = physics.points();
  for (std::uint32_t n = 0; n < nodes.size(); ++n) {
    if (!physics.isHeldBy(region, n)) continue;
    if (physics.held()[n] != 0)
      throw Error(C3DE_E_ARG, "a mass of the region is held by another support already", {"fix", fix.index, {}});
    support.nodes.push_back(n);
    sum += nodes[n];
  }
  if (support.nodes.empty())
    throw Error(
        C3DE_E_ARG,
        "the region meets no mass of the lattice, whose spacing is " + shown(1e3 * physics.lattice().spacing()) + " mm",
        {"fix", fix.index, {}});
  if (fix.motion != nullptr)
    support.motion = readMotion(fix.motion, (1.0 / static_cast<double>(support.nodes.size())) * sum, fix.index);
  physics.addSupport(std::move(support));
}

}  // namespace

std::vector<Elasticity> Simulator::materials(const Lattice &lattice, const ParameterValues &values,
                                             const std::vector<Part> &parts) const {
  std::vector<Elasticity> out;
  for (const Lattice::Cell &cell : lattice.cells()) {
    const ParameterValues *of = &values;
    for (const Part &part : parts)
      if (contains(part.region, lattice.centre(cell))) of = &part.values;
    out.push_back(context_.method.material(*of));
  }
  return out;
}

void Simulator::addBody(const c3de_sim_body *body, c3de_handle *out) {
  const auto in = sdk::readStruct(body, "body");
  const std::string name(sdk::text(in.name));
  ParameterValues values(context_.method.body);
  values.set(in.params, in.params_n, in.params_stride);
  if (in.fill != nullptr) throw Error(C3DE_E_UNSUPPORTED, methodText(context_, "fill meshes, not voxels"));
  if (in.refinements_n > 0)
    throw Error(C3DE_E_UNSUPPORTED, "the lattice has one spacing; accepted: no refinement", {"refinement", 0, {}});

  const Placement placement = readPlacement(in.placement);
  const auto *meshes = context_.mesh.table();
  sdk::orThrow(context_.host.check(meshes->check_fillable(meshes->ctx, in.mesh)));
  Surface surface = readSurface(context_, in.mesh, placement);
  const double volume_m3 = surface.volume_m3;
  const double spacing = values.isAuto(C3DE_PARAM_ID_SPACING)
                             ? std::cbrt(std::abs(volume_m3) / values.number(C3DE_PARAM_ID_COUNT))
                             : values.number(C3DE_PARAM_ID_SPACING);
  Lattice lattice(surface, spacing, insideOf(context_, in.mesh, placement), sdk::Progress(in.progress));

  std::vector<Part> parts;
  for (std::uint64_t i = 0; i < in.parts_n; ++i) parts.push_back(readPart(in, i, lattice, values));
  auto ofCells = materials(lattice, values, parts);
  auto made = context_.method.make(std::move(lattice), std::move(surface), std::move(ofCells), values);
  PointBody &physics = *made;
  for (std::uint64_t i = 0; i < in.fixes_n; ++i)
    addSupport(sdk::readElement(in.fixes, i, in.fixes_stride, "fix"), physics);
  for (std::uint64_t i = 0; i < in.loads_n; ++i)
    physics.loads.push_back(readLoad(sdk::readElement(in.loads, i, in.loads_stride, "load"), physics));
  const Vec3 velocity = vectorOf(in.velocity_m_s), angular = vectorOf(in.angular_velocity_rad_s);
  if (!isFinite(velocity) || !isFinite(angular)) throw Error(C3DE_E_ARG, "velocities must be finite");
  physics.setInitialVelocity(velocity, angular);

  std::optional<std::array<float, 3>> colour;
  if (in.colour != nullptr) colour = {in.colour[0], in.colour[1], in.colour[2]};
  auto triangles = std::make_shared<const std::vector<std::array<std::uint32_t, 3>>>(physics.skin().triangles);
  const std::lock_guard lock(mutex_);
  const std::uint64_t id = nextId_++;
  bodies_.emplace(id, Body{name,
                           std::move(values),
                           std::move(parts),
                           colour,
                           std::move(triangles),
                           volume_m3,
                           std::move(made),
                           {},
                           {},
                           {},
                           {},
                           false,
                           {}});
  try {
    (void)stepSize();
  } catch (...) {
    bodies_.erase(id);
    throw;
  }
  resetAll();
  if (out != nullptr) *out = {id};
}

}  // namespace mass_spring
