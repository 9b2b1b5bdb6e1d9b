// SPDX-License-Identifier: Apache-2.0
#include "base/placed_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "c3de/sdk/structs.hpp"

namespace pointbased {

Placement readPlacement(const c3de_sim_placement *placement) {
  Placement out;
  if (placement == nullptr) return out;
  const c3de_sim_placement in = sdk::readStruct(placement, "placement");
  if (in.flags & C3DE_SIM_PLACED_BY_MATRIX) {
    const Eigen::Matrix4d matrix = Eigen::Map<const Eigen::Matrix4d>(in.matrix);
    const Mat3 linear = matrix.topLeftCorner<3, 3>();
    const double scale = std::cbrt(linear.determinant());
    // Accuracy of a rotation in single precision with six printed digits.
    constexpr double kTolerance = 1e-5;
    if (!matrix.allFinite() || !(scale > 0.0) || matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1) ||
        (linear.transpose() * linear / (scale * scale) - Mat3::Identity()).cwiseAbs().maxCoeff() > kTolerance)
      throw sdk::Error(C3DE_E_ARG,
                       "matrix: not a rotation times one scale above 0 with a displacement, last row 0 0 0 1");
    return {matrix.topRightCorner<3, 1>(), Eigen::Quaterniond(Mat3(linear / scale)).normalized().toRotationMatrix(),
            scale};
  }
  const Vec3 angles = Vec3(in.rotation_deg) * (EIGEN_PI / 180.0);
  out.position = Vec3(in.position_m);
  out.scale = in.scale == 0.0 ? 1.0 : in.scale;
  out.rotation = (Eigen::AngleAxisd(angles[2], Vec3::UnitZ()) * Eigen::AngleAxisd(angles[1], Vec3::UnitY()) *
                  Eigen::AngleAxisd(angles[0], Vec3::UnitX()))
                     .toRotationMatrix();
  if (!out.position.allFinite() || !out.rotation.allFinite() || !std::isfinite(out.scale) || out.scale < 0.0)
    throw sdk::Error(C3DE_E_ARG, "position, rotation and scale must be finite, scale > 0");
  return out;
}

PlacementTransform::PlacementTransform(const Placement &p) : position_(p.position) {
  linear_ = p.scale * p.rotation;
  inverse_ = p.rotation.transpose() / p.scale;
}

std::shared_ptr<PlacedMesh> placeMesh(const Services &services, c3de_handle mesh, const Placement &placement) {
  const auto positions = sdk::orThrow(services.meshes.positions(mesh));
  const auto triangles = sdk::orThrow(services.meshes.triangles(mesh));
  const auto info = sdk::orThrow(services.meshes.info(mesh));
  const PlacementTransform transform(placement);

  auto placed = std::make_shared<PlacedMesh>();
  placed->positions.reserve(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i)
    placed->positions.push_back(transform.metres(Vec3(positions[i][0], positions[i][1], positions[i][2])));
  placed->normals.assign(positions.size(), Vec3::Zero());
  placed->triangles.reserve(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const std::array<std::uint32_t, 3> corners{triangles[t][0], triangles[t][1], triangles[t][2]};
    placed->triangles.push_back(corners);
    const Vec3 &a = placed->positions[corners[0]], &b = placed->positions[corners[1]],
               &c = placed->positions[corners[2]];
    const Vec3 area = (b - a).cross(c - a);
    for (const std::uint32_t v : corners) placed->normals[v] += area;
  }
  for (Vec3 &n : placed->normals) {
    const double length = n.norm();
    n = length > 0.0 ? Vec3(n / length) : Vec3::UnitZ();
  }
  placed->min = Vec3::Constant(1e300);
  placed->max = Vec3::Constant(-1e300);
  for (const Vec3 &x : placed->positions) {
    placed->min = placed->min.cwiseMin(x);
    placed->max = placed->max.cwiseMax(x);
  }
  const double scale = (placement.scale == 0.0 ? 1.0 : placement.scale) * kMetresPerMillimetre;
  placed->volume = std::abs(info.volume_mm3) * scale * scale * scale;
  placed->tree = sdk::orThrow(
      services.collision.create(viewOf(placed->positions), sdk::rows<std::uint32_t, 3>(std::span(placed->triangles))));
  return placed;
}

std::optional<c3de_handle> presentTree(const Services &services, const PlacedMesh &mesh, c3de_view positions) {
  if (!mesh.pickTree) {
    auto made = services.collision.create(positions, sdk::rows<std::uint32_t, 3>(std::span(mesh.triangles)));
    if (!made) return std::nullopt;
    mesh.pickTree = std::move(*made);
  } else if (!services.collision.refit(mesh.pickTree.handle(), positions)) {
    return std::nullopt;
  }
  return mesh.pickTree.handle();
}

c3de_closest closestOn(const Services &services, c3de_handle tree, const Vec3 &point) {
  c3de_closest found{};
  const double everywhere = std::numeric_limits<double>::infinity();
  const auto *table = services.collision.table();
  sdk::orThrow(services.host.check(table->closest(table->ctx, tree, viewOf({&point, 1}),
                                                  sdk::scalars(std::span<const double>(&everywhere, 1)), &found)));
  return found;
}

c3de_closest closestOn(const Services &services, const PlacedMesh &mesh, const Vec3 &point) {
  return closestOn(services, mesh.tree.handle(), point);
}

double distanceOff(const Services &services, const PlacedMesh &mesh, const Vec3 &point) {
  // Far away, distances cannot be squared; the distance to the box is sufficient there.
  const Vec3 beyond = (mesh.min - point).cwiseMax(point - mesh.max).cwiseMax(0.0);
  if (beyond.maxCoeff() > 1e3 * (mesh.max - mesh.min).norm()) return beyond.stableNorm();
  return std::max(0.0, closestOn(services, mesh, point).distance);
}

double areaOf(const PlacedMesh &mesh) {
  double doubled = 0.0;
  for (const auto &[a, b, c] : mesh.triangles)
    doubled += (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]).norm();
  return 0.5 * doubled;
}

std::string shortNumber(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

}  // namespace pointbased
