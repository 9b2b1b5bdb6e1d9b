// SPDX-License-Identifier: Apache-2.0
#include "instruments/probe_tool_mesh.h"

#include <cmath>
#include <numbers>

namespace pointbased {
namespace {

constexpr std::uint32_t kAround = 32, kRings = 8;  // per full turn, and from a pole to the widest ring

}  // namespace

std::shared_ptr<PlacedMesh> meshOf(const Services &services, const ProbeTool &tool) {
  auto mesh = std::make_shared<PlacedMesh>();
  const Vec3 axis = tool.path.front().axis.normalized(), u = axis.unitOrthogonal(), v = axis.cross(u);
  const auto add = [&](const Vec3 &normal, double along) {
    mesh->normals.push_back(normal);
    mesh->positions.push_back(tool.path.front().at + along * axis + tool.radius * normal);
  };
  // Rings from the lower pole to the upper one; a capsule has the widest ring twice, one length apart.
  add(-axis, -0.5 * tool.length);
  std::uint32_t rings = 0;
  const auto ring = [&](double latitude, double along) {
    ++rings;
    for (std::uint32_t k = 0; k < kAround; ++k) {
      const double turn = 2.0 * std::numbers::pi * k / kAround;
      add(std::cos(latitude) * (std::cos(turn) * u + std::sin(turn) * v) + std::sin(latitude) * axis, along);
    }
  };
  constexpr double kQuarter = 0.5 * std::numbers::pi;
  for (std::uint32_t r = 1; r <= kRings; ++r)
    ring(kQuarter * (static_cast<double>(r) / kRings - 1.0), -0.5 * tool.length);
  for (std::uint32_t r = tool.length > 0.0 ? 0 : 1; r < kRings; ++r)
    ring(kQuarter * static_cast<double>(r) / kRings, 0.5 * tool.length);
  add(axis, 0.5 * tool.length);

  const auto last = static_cast<std::uint32_t>(mesh->positions.size() - 1);
  const auto at = [](std::uint32_t r, std::uint32_t k) { return 1 + r * kAround + k % kAround; };
  for (std::uint32_t k = 0; k < kAround; ++k) {
    mesh->triangles.push_back({0, at(0, k + 1), at(0, k)});
    for (std::uint32_t r = 0; r + 1 < rings; ++r) {
      mesh->triangles.push_back({at(r, k), at(r, k + 1), at(r + 1, k + 1)});
      mesh->triangles.push_back({at(r, k), at(r + 1, k + 1), at(r + 1, k)});
    }
    mesh->triangles.push_back({at(rings - 1, k), at(rings - 1, k + 1), last});
  }
  mesh->min = mesh->max = mesh->positions.front();
  for (const Vec3 &x : mesh->positions) {
    mesh->min = mesh->min.cwiseMin(x);
    mesh->max = mesh->max.cwiseMax(x);
  }
  for (const auto &[a, b, c] : mesh->triangles)
    mesh->volume += mesh->positions[a].dot(mesh->positions[b].cross(mesh->positions[c])) / 6.0;
  mesh->tree = sdk::orThrow(
      services.collision.create(viewOf(mesh->positions), sdk::rows<std::uint32_t, 3>(std::span(mesh->triangles))));
  return mesh;
}

}  // namespace pointbased
