// SPDX-License-Identifier: Apache-2.0
#include "pointbased/live_support.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "base/expects.h"
#include "pointbased/rest_state.h"

namespace pointbased {

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
  for (std::size_t p = 0; p < points.size(); ++p) {
    const Index first = binding.phyxels.offsets[p], last = binding.phyxels.offsets[p + 1];
    Index strongest = first;
    for (Index e = first; e < last; ++e)
      if (std::abs(binding.weights[e]) > std::abs(binding.weights[strongest])) strongest = e;
    groups[binding.phyxels.indices[strongest]].push_back(p);
  }
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
    out.part.area += area;
    out.offsets.push_back(offset / area);
    moment += centre;
  }
  if (out.part.area > 0.0) out.part.centroid = moment / out.part.area;
  return out;
}

}  // namespace pointbased
