// SPDX-License-Identifier: Apache-2.0
#include "pointbased/live_support.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "base/expects.h"
#include "body/rest_skin.h"

namespace pointbased {
namespace {

constexpr double kSkinSampling = 0.25;  // spacings
constexpr double kContinues = 0.7;      // cosine of the angle up to which skin continues a patch
// Of the skin around a phyxel: a patch that covers less of it has its edge there. The rest is for different samples.
constexpr double kCovered = 0.85;

Index strongestOf(const Interpolation &binding, std::size_t point) {
  const Index first = binding.phyxels.offsets[point], last = binding.phyxels.offsets[point + 1];
  Index strongest = first;
  for (Index e = first; e < last; ++e)
    if (std::abs(binding.weights[e]) > std::abs(binding.weights[strongest])) strongest = e;
  return binding.phyxels.indices[strongest];
}

// Area of the skin around each phyxel that continues the patch there.
std::map<Index, double> skinAreas(const RestState &rest, std::span<const Vec3> points,
                                  const std::map<Index, Vec3> &normals) {
  BoxRegion around{points.front(), points.front()};
  for (const Vec3 &x : points) {
    around.min = around.min.cwiseMin(x);
    around.max = around.max.cwiseMax(x);
  }
  around.min.array() -= rest.spacing;
  around.max.array() += rest.spacing;
  std::map<Index, double> out;
  const SurfacePoints skin = sampleSurface(detail::skinOf(rest), kSkinSampling * rest.spacing, around);
  if (skin.count() == 0) return out;
  const Interpolation binding = rest.bind(skin.positions, skin.normals);
  for (std::size_t p = 0; p < skin.count(); ++p) {
    const auto normal = normals.find(strongestOf(binding, p));
    if (normal != normals.end() && skin.normals[p].dot(normal->second) > kContinues * normal->second.norm())
      out[normal->first] += skin.areas[p];
  }
  return out;
}

}  // namespace

LiveSupport liveSupport(const RestState &rest, std::span<const Vec3> points, std::span<const Vec3> normals,
                        std::span<const double> areas, std::span<const Vec3> displacements,
                        std::span<const std::uint8_t> held) {
  POINTBASED_EXPECTS(points.size() == areas.size() && points.size() == displacements.size() &&
                         points.size() == normals.size() && held.size() == rest.phyxelCount(),
                     "arrays of equal length");
  LiveSupport out;
  if (points.empty()) return out;
  const Interpolation binding = rest.bind(points, normals);
  std::map<Index, std::vector<std::size_t>> groups;  // by the phyxel that moves a point most
  std::map<Index, Vec3> groupNormals;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const Index strongest = strongestOf(binding, p);
    groups[strongest].push_back(p);
    groupNormals.try_emplace(strongest, Vec3::Zero()).first->second += areas[p] * normals[p];
  }
  std::map<Index, double> skin = skinAreas(rest, points, groupNormals);
  Vec3 moment = Vec3::Zero();
  for (const auto &[phyxel, group] : groups) {
    std::map<Index, double> row;
    double area = 0.0;
    Vec3 offset = Vec3::Zero(), centre = Vec3::Zero();
    for (const std::size_t p : group) {
      area += areas[p];
      offset += areas[p] * displacements[p];
      centre += areas[p] * points[p];
      for (Index e = binding.phyxels.offsets[p]; e < binding.phyxels.offsets[p + 1]; ++e)
        row[binding.phyxels.indices[e]] += areas[p] * binding.weights[e];
    }
    if (std::all_of(row.begin(), row.end(), [&](const auto &entry) { return held[entry.first] != 0; })) continue;
    for (const auto &[j, weight] : row) {
      out.part.rows.indices.push_back(j);
      out.part.weights.push_back(weight / area);
    }
    out.part.rows.offsets.push_back(static_cast<Index>(out.part.rows.indices.size()));
    out.part.areas.push_back(area);
    out.part.stiffness.push_back(area < kCovered * skin[phyxel] ? kEdgePatchStiffness : kPatchStiffness);
    out.part.area += area;
    out.offsets.push_back(offset / area);
    moment += centre;
  }
  if (out.part.area > 0.0) out.part.centroid = moment / out.part.area;
  return out;
}

}  // namespace pointbased
