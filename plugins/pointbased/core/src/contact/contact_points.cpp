// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>

#include "contact/contact_skin.h"
#include "pointbased/contact.h"

namespace pointbased {
namespace {

struct VoxelHash {
  std::size_t operator()(const std::array<std::int64_t, 3> &v) const {
    return static_cast<std::size_t>(v[0] * 73856093 ^ v[1] * 19349663 ^ v[2] * 83492791);
  }
};

}  // namespace

SurfacePoints chooseContactPoints(const Surface &surface, double spacing) {
  SurfacePoints out;
  std::unordered_map<std::array<std::int64_t, 3>, std::size_t, VoxelHash> kept;
  const double voxel = 0.5 * spacing;
  const auto add = [&](const Vec3 &x, const Vec3 &normal, double area, Index triangle) {
    const std::array<std::int64_t, 3> key{static_cast<std::int64_t>(std::floor(x[0] / voxel)),
                                          static_cast<std::int64_t>(std::floor(x[1] / voxel)),
                                          static_cast<std::int64_t>(std::floor(x[2] / voxel))};
    const auto [found, isNew] = kept.try_emplace(key, out.positions.size());
    if (isNew) {
      out.positions.push_back(x);
      out.normals.push_back(Vec3::Zero());
      out.areas.push_back(0.0);
      out.triangles.push_back(triangle);
    }
    out.areas[found->second] += area;
    out.normals[found->second] += area * normal;
  };
  // Vertices first, so that they represent their voxel: contact begins at corners and edges.
  for (const int pass : {0, 1})
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
      const auto &corners = surface.triangles[t];
      const Vec3 &a = surface.positions[corners[0]], &b = surface.positions[corners[1]],
                 &c = surface.positions[corners[2]];
      const Vec3 cross = (b - a).cross(c - a);
      const double doubled = cross.norm();
      if (!(doubled > 0.0)) continue;
      const double longest = std::sqrt(std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}));
      const int n = std::max(1, static_cast<int>(std::ceil(longest / (0.5 * spacing) - 1e-9)));
      const double share = 0.5 * doubled / (0.5 * (n + 1) * (n + 2));
      for (int i = 0; i <= n; ++i)
        for (int j = 0; i + j <= n; ++j) {
          const bool vertex = (i == 0 && j == 0) || i == n || j == n;
          if (vertex != (pass == 0)) continue;
          const double s = static_cast<double>(i) / n, r = static_cast<double>(j) / n;
          add(a + s * (b - a) + r * (c - a), cross / doubled, share, static_cast<Index>(t));
        }
    }
  for (std::size_t p = 0; p < out.count(); ++p) {
    const double length = out.normals[p].norm();
    if (length > 1e-12 * out.areas[p]) {
      out.normals[p] /= length;
    } else {
      const auto &corners = surface.triangles[out.triangles[p]];
      out.normals[p] = (surface.positions[corners[1]] - surface.positions[corners[0]])
                           .cross(surface.positions[corners[2]] - surface.positions[corners[0]])
                           .normalized();
    }
  }
  return out;
}

SurfacePoints chooseContactPoints(const Surface &surface, double spacing, std::span<const Index> pieceOf) {
  SurfacePoints all = chooseContactPoints(surface, spacing);
  const auto pieceOfTriangle = [&](std::size_t t) { return pieceOf[surface.triangles[t][0]]; };
  std::map<Index, std::size_t> counts;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) counts.try_emplace(pieceOfTriangle(t), 0);
  for (const Index t : all.triangles) ++counts.at(pieceOfTriangle(t));
  std::erase_if(counts, [](const auto &piece) { return piece.second >= kMinPointsPerPiece; });
  if (counts.empty()) return all;

  // Each small piece is sampled as a separate surface, the remaining pieces as one.
  const auto ofSome = [&](double distance, const auto &isWanted) {
    Surface some{surface.positions, {}};
    std::vector<Index> numbers;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
      if (isWanted(pieceOfTriangle(t))) {
        some.triangles.push_back(surface.triangles[t]);
        numbers.push_back(static_cast<Index>(t));
      }
    SurfacePoints points = chooseContactPoints(some, distance);
    for (Index &t : points.triangles) t = numbers[t];
    return points;
  };
  all = ofSome(spacing, [&](Index piece) { return !counts.contains(piece); });
  for (const auto &[piece, count] : counts) {
    constexpr double kClosest = 1.0 / 16;
    SurfacePoints own;
    for (double part = 0.5; part >= kClosest && own.count() < kMinPointsPerPiece; part *= 0.5)
      own = ofSome(part * spacing, [&, wanted = piece](Index p) { return p == wanted; });
    all.positions.insert(all.positions.end(), own.positions.begin(), own.positions.end());
    all.normals.insert(all.normals.end(), own.normals.begin(), own.normals.end());
    all.areas.insert(all.areas.end(), own.areas.begin(), own.areas.end());
    all.triangles.insert(all.triangles.end(), own.triangles.begin(), own.triangles.end());
  }
  return all;
}

ContactPoints bindContactPoints(SurfacePoints chosen, Interpolation binding, std::span<const Vec3> phyxels,
                                double spacing) {
  ContactPoints out{std::move(binding), std::move(chosen.normals), std::move(chosen.areas), {}};
  out.spacings = detail::spacingsAt(out.binding, phyxels, spacing);
  return out;
}

std::vector<double> detail::spacingsAt(const Interpolation &binding, std::span<const Vec3> phyxels, double spacing) {
  std::vector<double> out(binding.count(), spacing);
  for (std::size_t p = 0; p < binding.count(); ++p) {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (Index e = binding.phyxels.offsets[p]; e < binding.phyxels.offsets[p + 1]; ++e) {
      low = low.cwiseMin(phyxels[binding.phyxels.indices[e]]);
      high = high.cwiseMax(phyxels[binding.phyxels.indices[e]]);
    }
    const double size = (high - low).maxCoeff();
    if (size > 0.0 && size < spacing) out[p] = spacing * std::exp2(-std::round(std::log2(spacing / size)));
  }
  return out;
}

}  // namespace pointbased
