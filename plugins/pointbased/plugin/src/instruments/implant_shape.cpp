// SPDX-License-Identifier: Apache-2.0
#include "instruments/implant_shape.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace pointbased {
namespace {

constexpr std::uint32_t kAround = 32;  // vertices of a full turn
constexpr double kTurn = 2.0 * std::numbers::pi;

/// A surface about the z axis: a pole below, rings at increasing z, a pole above.
/// @param radius  at z and an angle, mm
ImplantSurface revolved(std::span<const double> rings, double below, double above,
                        const std::function<double(double z, double angle)> &radius) {
  ImplantSurface out;
  out.positions_mm.emplace_back(0.0, 0.0, below);
  for (const double z : rings)
    for (std::uint32_t k = 0; k < kAround; ++k) {
      const double angle = kTurn * k / kAround, r = radius(z, angle);
      out.positions_mm.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
    }
  out.positions_mm.emplace_back(0.0, 0.0, above);
  const auto last = static_cast<std::uint32_t>(out.positions_mm.size() - 1);
  const auto at = [](std::uint32_t ring, std::uint32_t k) { return 1 + ring * kAround + k % kAround; };
  const auto n = static_cast<std::uint32_t>(rings.size());
  for (std::uint32_t k = 0; k < kAround; ++k) {
    out.triangles.push_back({0, at(0, k + 1), at(0, k)});
    for (std::uint32_t r = 0; r + 1 < n; ++r) {
      out.triangles.push_back({at(r, k), at(r, k + 1), at(r + 1, k + 1)});
      out.triangles.push_back({at(r, k), at(r + 1, k + 1), at(r + 1, k)});
    }
    out.triangles.push_back({at(n - 1, k), at(n - 1, k + 1), last});
  }
  return out;
}

/// A convex outline between two parallel planes.
/// @param outline  counter-clockwise seen from plane 1
/// @param point    of a vertex of the outline in the planes 0 and 1
ImplantSurface extruded(std::span<const Eigen::Vector2d> outline,
                        const std::function<Vec3(const Eigen::Vector2d &at, int plane)> &point) {
  ImplantSurface out;
  const auto n = static_cast<std::uint32_t>(outline.size());
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d &at : outline) middle += at / n;
  for (const int plane : {0, 1}) {
    for (const Eigen::Vector2d &at : outline) out.positions_mm.push_back(point(at, plane));
    out.positions_mm.push_back(point(middle, plane));
  }
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t a = k, b = (k + 1) % n, up = n + 1;
    out.triangles.push_back({b, a, n});
    out.triangles.push_back({a + up, b + up, n + up});
    out.triangles.push_back({a, b, b + up});
    out.triangles.push_back({a, b + up, a + up});
  }
  return out;
}

ImplantSurface plate(std::span<const double> sizes) {
  const double length = sizes[0], width = sizes[1], thickness = sizes[2];
  const double corner = 0.3 * std::min(length, width);
  std::vector<Eigen::Vector2d> outline;
  constexpr int kQuarter = 6;
  const std::array<Eigen::Vector2d, 4> signs{{{1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};
  for (int side = 0; side < 4; ++side)
    for (int k = 0; k <= kQuarter; ++k) {
      const double angle = 0.25 * kTurn * (side + static_cast<double>(k) / kQuarter);
      outline.emplace_back(signs[side][0] * (0.5 * length - corner) + corner * std::cos(angle),
                           signs[side][1] * (0.5 * width - corner) + corner * std::sin(angle));
    }
  return extruded(
      outline, [&](const Eigen::Vector2d &at, int plane) { return Vec3(at[0], at[1], plane == 0 ? 0.0 : thickness); });
}

/// Full height at one end, none at the other.
ImplantSurface wedge(std::span<const double> sizes) {
  const double length = sizes[0], width = sizes[1], height = sizes[2];
  const std::array<Eigen::Vector2d, 3> outline{{{-0.5 * length, 0.0}, {-0.5 * length, height}, {0.5 * length, 0.0}}};
  return extruded(outline, [&](const Eigen::Vector2d &at, int plane) {
    return Vec3(at[0], (plane == 0 ? -0.5 : 0.5) * width, at[1]);
  });
}

ImplantSurface sphere(std::span<const double> sizes) {
  const double radius = 0.5 * sizes[0];
  constexpr int kRings = kAround / 2;
  std::vector<double> rings;
  for (int k = 1; k < kRings; ++k) rings.push_back(-radius * std::cos(0.5 * kTurn * k / kRings));
  ImplantSurface out = revolved(rings, -radius, radius,
                                [&](double z, double) { return std::sqrt(std::max(radius * radius - z * z, 0.0)); });
  out.contactPlane_mm = -radius;
  return out;
}

/// Below z = 0 the thread, above it the head.
ImplantSurface screw(std::span<const double> sizes) {
  const double length = sizes[0], radius = 0.5 * sizes[1];
  // Proportions of a cortical bone screw: core two thirds, pitch 0.4, head 1.8 diameters.
  const double core = radius / 1.5, pitch = 0.8 * radius, head = 1.8 * radius,
               tip = std::min(2.0 * radius, 0.4 * length);
  constexpr int kPerPitch = 8;
  const double step = pitch / kPerPitch;
  std::vector<double> rings;
  const int shaft = static_cast<int>(std::ceil(length / step));
  for (int k = 1; k < shaft; ++k) rings.push_back(-length * (1.0 - static_cast<double>(k) / shaft));
  // The head: a cylinder with a rounded top.
  const double headHeight = 1.2 * radius;
  constexpr int kHead = 6;
  rings.push_back(-1e-3 * radius);
  for (int k = 0; k < kHead; ++k) rings.push_back(headHeight * k / kHead);
  return revolved(rings, -length, headHeight, [&](double z, double angle) {
    if (z >= 0.0) return head * std::sqrt(1.0 - 0.6 * (z / headHeight) * (z / headHeight));
    const double along = z / pitch - angle / kTurn, phase = along - std::floor(along);
    const double thread = core + (radius - core) * std::max(0.0, 1.0 - 3.0 * std::abs(phase - 0.5));
    return thread * std::min((z + length) / tip, 1.0);
  });
}

double flatUnderside(double, double, std::span<const double>) { return 0.0; }
double sphereUnderside(double x, double y, std::span<const double> sizes) {
  const double radius = 0.5 * sizes[0];
  return radius - std::sqrt(std::max(radius * radius - x * x - y * y, 0.0));
}

constexpr std::array<ImplantSize, 3> kPlateSizes{{{"length", "Length", 40.0, 2.0, 300.0},
                                                  {"width", "Width", 12.0, 2.0, 300.0},
                                                  {"thickness", "Thickness", 3.0, 0.5, 50.0}}};
constexpr std::array<ImplantSize, 2> kScrewSizes{
    {{"length", "Length", 30.0, 5.0, 150.0}, {"diameter", "Diameter", 4.5, 1.0, 15.0}}};
constexpr std::array<ImplantSize, 1> kSphereSizes{{{"diameter", "Diameter", 20.0, 1.0, 300.0}}};
constexpr std::array<ImplantSize, 3> kWedgeSizes{{{"length", "Length", 30.0, 2.0, 300.0},
                                                  {"width", "Width", 20.0, 2.0, 300.0},
                                                  {"height", "Height", 10.0, 0.5, 100.0}}};
constexpr std::array<ImplantShape, 4> kShapes{{{"plate", kPlateSizes, &plate, &flatUnderside},
                                               {"screw", kScrewSizes, &screw, nullptr},
                                               {"sphere", kSphereSizes, &sphere, &sphereUnderside},
                                               {"wedge", kWedgeSizes, &wedge, &flatUnderside}}};

}  // namespace

std::span<const ImplantShape> implantShapes() { return kShapes; }

}  // namespace pointbased
