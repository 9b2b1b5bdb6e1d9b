// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/point_fields.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "base/field_reader.h"
#include "c3de/scene/simulation.h"
#include "c3de/session/simulator_access.h"

namespace c3de::session {
namespace {

// Half the diagonal of a cell of points is 0.87 spacings: tissue stretched by two thirds is still covered.
constexpr double kReach = 1.5;     // spacings
constexpr double kOutside = 0.01;  // fraction of the tissue beyond either end of a range

std::vector<std::pair<c3de_handle, c3de_sim_body_info>> bodiesOf(const c3de_simulator_v1 *table,
                                                                 c3de_object *simulator) {
  std::vector<std::pair<c3de_handle, c3de_sim_body_info>> bodies;
  c3de_handle body{};
  for (std::uint64_t i = 0; table->body_at(simulator, i, &body) >= 0 && body.v != 0; ++i) {
    c3de_sim_body_info info{};
    info.size = sizeof info;
    if (table->body_info(simulator, body, &info) >= 0 && info.points <= kMaxPoints) bodies.emplace_back(body, info);
  }
  return bodies;
}

/// The range of all values except a hundredth at either end; 0, 0 if empty.
std::pair<double, double> rangeOf(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return {0.0, 0.0};
  const auto beyond = static_cast<std::size_t>(kOutside * static_cast<double>(values.size()));
  const auto low = values.begin() + static_cast<std::ptrdiff_t>(beyond),
             high = values.end() - 1 - static_cast<std::ptrdiff_t>(beyond);
  std::nth_element(values.begin(), low, values.end());
  const double least = *low;
  std::nth_element(values.begin(), high, values.end());
  return {least, *high};
}

}  // namespace

std::vector<PointField> pointFields(const c3de_simulator_v1 *table, c3de_object *simulator) {
  std::vector<PointField> all;
  for (const auto &[body, info] : bodiesOf(table, simulator))
    for (const FieldReader::Field &field :
         FieldReader(table, simulator, body, C3DE_SIM_ON_POINTS, info.points).fields()) {
      if (field.components != 1 || field.name == C3DE_SIM_FIELD_MASS || field.name == C3DE_SIM_FIELD_VOLUME) continue;
      PointField one{field.name, field.unit};
      if (std::find(all.begin(), all.end(), one) == all.end()) all.push_back(std::move(one));
    }
  return all;
}

void addFields(const c3de_simulator_v1 *table, c3de_object *simulator, const RequestedFields &wanted,
               imaging::DisplacementGrid &grid) {
  if (!wanted.any) return;
  const std::vector<PointField> offered = pointFields(table, simulator);
  const auto chosen = wanted.name.empty() ? offered.begin()
                                          : std::find_if(offered.begin(), offered.end(), [&](const PointField &field) {
                                              return field.name == wanted.name;
                                            });
  imaging::MaterialPoints points;
  std::vector<double> values;
  for (const auto &[body, info] : bodiesOf(table, simulator)) {
    const FieldReader reader(table, simulator, body, C3DE_SIM_ON_POINTS, info.points);
    const auto now = reader.read(C3DE_SIM_FIELD_POSITION, 3), volumes = reader.read(C3DE_SIM_FIELD_VOLUME, 1);
    if (!now) continue;
    auto own = chosen == offered.end() ? std::nullopt : reader.read(chosen->name, 1);
    for (std::size_t i = 0; i < info.points; ++i) {
      // Where sampling is coarser than elsewhere, a point represents more volume.
      const double edge_m = std::max(info.spacing_m, volumes ? std::cbrt(std::max((*volumes)[i], 0.0)) : 0.0);
      points.at_mm.push_back(scene::kMillimetresPerMetre * Vec3{(*now)[3 * i], (*now)[3 * i + 1], (*now)[3 * i + 2]});
      points.reach_mm.push_back(kReach * scene::kMillimetresPerMetre * edge_m);
    }
    if (!own) own.emplace(info.points, std::numeric_limits<double>::quiet_NaN());
    values.insert(values.end(), own->begin(), own->end());
  }
  imaging::TissueField ratio{imaging::kVolumeRatio, "1", imaging::volumeRatios(grid)};
  std::tie(ratio.low, ratio.high) = rangeOf({ratio.values.begin(), ratio.values.end()});
  grid.fields.push_back(std::move(ratio));
  if (chosen == offered.end()) return;
  imaging::TissueField field{chosen->name, chosen->unit, imaging::scatterToGrid(grid.geometry, points, values)};
  std::tie(field.low, field.high) = rangeOf(values);
  grid.fields.push_back(std::move(field));
}

}  // namespace c3de::session
