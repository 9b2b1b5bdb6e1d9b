// SPDX-License-Identifier: Apache-2.0
// Voxel bodies, with the geometry that makes each of them difficult.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "c3de/imaging/volume.h"

namespace phantoms {

using namespace c3de;
using c3de::imaging::Mask;
using c3de::imaging::VolumeGeometry;

inline VolumeGeometry grid(std::array<std::size_t, 3> size, Vec3 spacing = {1.0, 1.0, 1.0}) {
  VolumeGeometry g;
  g.size = size;
  for (std::size_t a = 0; a < 3; ++a) g.indexToWorld[4 * a + a] = spacing[a];
  return g;
}

/// Rotated about two axes and moved; left-handed if requested.
inline VolumeGeometry oblique(std::array<std::size_t, 3> size, Vec3 spacing, bool leftHanded = false) {
  const double a = 0.4, b = 0.9;
  const Vec3 x{std::cos(a), std::sin(a), 0.0};
  const Vec3 y{-std::sin(a) * std::cos(b), std::cos(a) * std::cos(b), std::sin(b)};
  Vec3 z = cross(x, y);
  if (leftHanded) z = -1.0 * z;
  VolumeGeometry g;
  g.size = size;
  const Vec3 axes[3] = {spacing[0] * x, spacing[1] * y, spacing[2] * z};
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t r = 0; r < 3; ++r) g.indexToWorld[4 * c + r] = axes[c][r];
  g.indexToWorld[12] = -120.0;
  g.indexToWorld[13] = 45.0;
  g.indexToWorld[14] = 900.0;
  return g;
}

inline Vec3 centreOf(const VolumeGeometry &g) {
  return g.worldAt({0.5 * static_cast<double>(g.size[0] - 1), 0.5 * static_cast<double>(g.size[1] - 1),
                    0.5 * static_cast<double>(g.size[2] - 1)});
}

/// Voxels whose centre (relative to the centre of the grid, mm) is inside.
inline Mask where(const VolumeGeometry &g, const std::function<bool(const Vec3 &)> &inside) {
  Mask mask{g, std::vector<std::uint8_t>(g.voxelCount())};
  const Vec3 centre = centreOf(g);
  std::size_t at = 0;
  for (std::size_t k = 0; k < g.size[2]; ++k)
    for (std::size_t j = 0; j < g.size[1]; ++j)
      for (std::size_t i = 0; i < g.size[0]; ++i)
        mask.voxels[at++] =
            inside(g.worldAt({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}) - centre) ? 1
                                                                                                                 : 0;
  return mask;
}

inline Mask ball(const VolumeGeometry &g, double radius) {
  return where(g, [radius](const Vec3 &x) { return dot(x, x) <= radius * radius; });
}

/// Tubes that start at `root` and divide three times, turning in space; the widest 8 mm thick, the thinnest 2, each 24
/// mm long.
inline std::function<bool(const Vec3 &)> vesselTree(const Vec3 &root, const Vec3 &along) {
  struct Tube {
    Vec3 from, to;
    double radius;
  };
  std::vector<Tube> tubes;
  const std::function<void(const Vec3 &, const Vec3 &, double, int)> grow = [&](const Vec3 &from, const Vec3 &way,
                                                                                double radius, int level) {
    const Vec3 to = from + 24.0 * way;
    tubes.push_back({from, to, radius});
    if (level == 3) return;
    const Vec3 helper = std::abs(way[level % 3]) < 0.8
                            ? Vec3{level % 3 == 0 ? 1.0 : 0.0, level % 3 == 1 ? 1.0 : 0.0, level % 3 == 2 ? 1.0 : 0.0}
                            : Vec3{0.6, 0.64, 0.48};
    const Vec3 across = cross(way, helper);
    for (const double side : {-0.7, 0.7}) {
      const Vec3 turned = way + (side / norm(across)) * across;
      grow(to, (1.0 / norm(turned)) * turned, radius * 0.63, level + 1);
    }
  };
  grow(root, (1.0 / norm(along)) * along, 4.0, 0);
  return [tubes](const Vec3 &x) {
    for (const Tube &tube : tubes) {
      const Vec3 way = tube.to - tube.from;
      const double t = std::min(1.0, std::max(0.0, dot(x - tube.from, way) / dot(way, way)));
      if (norm(x - tube.from - t * way) <= tube.radius) return true;
    }
    return false;
  };
}

/// The same with random directions, lengths and numbers of branches. Tubes start at `root`, the widest with radius
/// `widest`, the thinnest with `thinnest`; they divide four times at most, about 18 mm each.
inline std::function<bool(const Vec3 &)> randomTree(std::uint64_t seed, double widest, double thinnest);

/// Voxels [min, max) of the index.
inline Mask box(const VolumeGeometry &g, std::array<std::size_t, 3> min, std::array<std::size_t, 3> max) {
  Mask mask{g, std::vector<std::uint8_t>(g.voxelCount(), 0)};
  for (std::size_t k = min[2]; k < max[2]; ++k)
    for (std::size_t j = min[1]; j < max[1]; ++j)
      for (std::size_t i = min[0]; i < max[0]; ++i) mask.voxels[i + g.size[0] * (j + g.size[1] * k)] = 1;
  return mask;
}

inline void set(Mask &mask, std::array<std::size_t, 3> at, bool to = true) {
  mask.voxels[at[0] + mask.geometry.size[0] * (at[1] + mask.geometry.size[1] * at[2])] = to ? 1 : 0;
}
inline bool get(const Mask &mask, std::array<std::size_t, 3> at) {
  return mask.voxels[at[0] + mask.geometry.size[0] * (at[1] + mask.geometry.size[1] * at[2])] != 0;
}

/// Whole numbers that are the same on every machine.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed) {}
  std::uint32_t operator()(std::uint32_t below) {
    state_ = state_ * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<std::uint32_t>((state_ >> 33) % below);
  }

 private:
  std::uint64_t state_;
};

inline std::function<bool(const Vec3 &)> randomTree(std::uint64_t seed, double widest, double thinnest) {
  struct Tube {
    Vec3 from, to;
    double radius;
  };
  std::vector<Tube> tubes;
  Dice dice(seed);
  const auto number = [&](double low, double high) { return low + (high - low) * dice(1001) / 1000.0; };
  constexpr int kLevels = 4;
  const std::function<void(const Vec3 &, const Vec3 &, int)> grow = [&](const Vec3 &from, const Vec3 &way, int level) {
    const Vec3 to = from + number(13.0, 23.0) * way;
    tubes.push_back({from, to, widest * std::pow(thinnest / widest, static_cast<double>(level) / kLevels)});
    if (level == kLevels) return;
    const std::uint32_t branches = 1 + (dice(3) > 0 ? 1 : 0);
    for (std::uint32_t b = 0; b < branches; ++b) {
      const Vec3 turned = way + Vec3{number(-0.9, 0.9), number(-0.9, 0.9), number(-0.9, 0.9)};
      grow(to, (1.0 / norm(turned)) * turned, level + 1);
    }
  };
  const Vec3 first{number(0.5, 1.0), number(-0.6, 0.6), number(-0.6, 0.6)};
  grow({-44.0, 0.0, 0.0}, (1.0 / norm(first)) * first, 0);
  return [tubes](const Vec3 &x) {
    return std::any_of(tubes.begin(), tubes.end(), [&](const Tube &tube) {
      const Vec3 way = tube.to - tube.from;
      const double t = std::min(1.0, std::max(0.0, dot(x - tube.from, way) / dot(way, way)));
      return norm(x - tube.from - t * way) <= tube.radius;
    });
  };
}

}  // namespace phantoms
