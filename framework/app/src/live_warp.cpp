// SPDX-License-Identifier: Apache-2.0
#include "live_warp.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "organ.h"
#include "simulator_access.h"

namespace c3de::app {
namespace {

constexpr double kMostPoints = 96.0;
// Room for the bodies to move, of their size.
constexpr double kRoom = 0.15;
// Between two displacements while it plays.
constexpr double kLeastMilliseconds = 50.0;

}  // namespace

imaging::VolumeGeometry gridAround(const c3de_simulator_v0 *table, c3de_object *simulator, double rim_mm) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3 low{kInfinity, kInfinity, kInfinity}, high = -1.0 * low;
  double spacing_mm = kInfinity;
  c3de_handle body{};
  for (std::uint64_t i = 0; table->body_at(simulator, i, &body) >= 0 && body.v != 0; ++i) {
    c3de_sim_body_info info{};
    info.size = sizeof info;
    if (table->body_info(simulator, body, &info) < 0) continue;
    spacing_mm = std::min(spacing_mm, info.spacing_m * scene::kMillimetresPerMetre);
    for (const Vec3 &x : surfelPositions(simulator, body))
      for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], x[a] * scene::kMillimetresPerMetre);
        high[a] = std::max(high[a], x[a] * scene::kMillimetresPerMetre);
      }
  }
  imaging::VolumeGeometry grid;
  grid.size = {0, 0, 0};
  if (!(low[0] <= high[0]) || !std::isfinite(spacing_mm)) return grid;
  double longest = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double room = rim_mm + spacing_mm + kRoom * (high[a] - low[a]);
    low[a] -= room;
    high[a] += room;
    longest = std::max(longest, high[a] - low[a]);
  }
  const double step = std::max(0.5 * spacing_mm, longest / (kMostPoints - 1.0));
  for (std::size_t a = 0; a < 3; ++a) {
    grid.size[a] = static_cast<std::size_t>(std::ceil((high[a] - low[a]) / step)) + 1;
    grid.indexToWorld[5 * a] = step;
    grid.indexToWorld[12 + a] = low[a];
  }
  return grid;
}

bool readDisplacement(const c3de_simulator_v0 *table, c3de_object *simulator, double rim_mm,
                      imaging::DisplacementGrid &grid) {
  if (!servesFills(table) || grid.geometry.voxelCount() == 0) return false;
  grid.xyz_mm.resize(3 * grid.geometry.voxelCount());
  const c3de_sim_grid asked = toAbi(grid.geometry);
  if (table->displacement(simulator, &asked, rim_mm / scene::kMillimetresPerMetre, grid.xyz_mm.data()) < 0)
    return false;
  for (float &u : grid.xyz_mm) u *= static_cast<float>(scene::kMillimetresPerMetre);
  return true;
}

void LiveWarp::begin() {
  ++serial_;
  const std::lock_guard lock(mutex_);
  newest_.reset();
}

void LiveWarp::want(bool wanted, double rim_mm) {
  rim_mm_ = rim_mm;
  wanted_ = wanted;
}

void LiveWarp::whenPublished(const scene::Simulation &simulation) {
  if (!wanted_) return;
  const auto from = std::chrono::steady_clock::now();
  const std::chrono::duration<double, std::milli> since = from - last_;
  behind_ = simulation.state().mode == C3DE_SIM_PLAYING && since.count() < std::max(kLeastMilliseconds, 5.0 * milliseconds_);
  if (behind_) return;
  const double rim = rim_mm_;
  const std::uint64_t serial = serial_;
  if (gridSerial_ != serial || gridRim_mm_ != rim) {
    grid_ = gridAround(simulation.table(), simulation.object(), rim);
    gridSerial_ = serial;
    gridRim_mm_ = rim;
  }
  auto grid = std::make_shared<imaging::DisplacementGrid>();
  grid->geometry = grid_;
  if (!readDisplacement(simulation.table(), simulation.object(), rim, *grid)) return;
  last_ = std::chrono::steady_clock::now();
  milliseconds_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - from).count();
  const std::lock_guard lock(mutex_);
  if (serial == serial_) newest_ = std::move(grid);
}

std::shared_ptr<const imaging::DisplacementGrid> LiveWarp::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(newest_, nullptr);
}

}  // namespace c3de::app
