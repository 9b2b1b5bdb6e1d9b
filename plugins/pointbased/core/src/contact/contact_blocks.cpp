// SPDX-License-Identifier: Apache-2.0
// Contacts of the points of a body. Blocks of points out of reach of all obstacles are skipped.
#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <type_traits>

#include "contact/contact_search.h"
#include "discretisation/interpolation_at.h"
#include "discretisation/lattice/lattice_grid.h"

namespace pointbased {

using namespace detail;

namespace {

using Blocks = ContactState::Blocks;

// kBlock: points that are skipped together. More: fewer tests, but more points per block that comes near.
// kChunk: phyxels that share one bound of their travel. More: fewer bounds, but coarser ones.
// kClearanceSafety: of the free distance of a block, part that is used, so that rounding cannot bring a point nearer.
constexpr std::size_t kBlock = 16, kChunk = 16;
constexpr double kClearanceSafety = 1.0 - 1e-9;

std::size_t blocksOf(std::size_t count, std::size_t size) { return (count + size - 1) / size; }

// Orders points along a space-filling curve.
// @param width  size of a cell of the curve, m
std::vector<Index> mortonOrder(std::span<const Vec3> points, double width) {
  Vec3 low = points.front();
  for (const Vec3 &x : points) low = low.cwiseMin(x);
  constexpr double kMaxPlaces = (1 << 20) - 1;
  std::vector<std::uint64_t> codes(points.size());
  for (std::size_t p = 0; p < points.size(); ++p) {
    lattice::Cell3 at;
    for (int a = 0; a < 3; ++a)
      at[static_cast<std::size_t>(a)] =
          static_cast<std::int32_t>(std::min(kMaxPlaces, std::floor((points[p][a] - low[a]) / width)));
    codes[p] = lattice::mortonCode(at);
  }
  std::vector<Index> order(points.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return codes[a] < codes[b]; });
  return order;
}

// Groups points into blocks and stores which chunks of phyxels carry each. The gain of a block bounds the travel of its
// points if no phyxel moves by more than 1 / its largest influence: the largest Σ |φ|/maxInfluence.
void buildBlocks(const Interpolation &binding, std::span<const float> maxInfluence, Blocks &blocks) {
  blocks.chunks = Csr{};
  blocks.gains.clear();
  blocks.maxInfluence.clear();
  for (const float l : maxInfluence) blocks.maxInfluence.insert(blocks.maxInfluence.end(), 3, l);
  Vec3 low = binding.positions.front(), high = low;
  for (const Vec3 &x : binding.positions) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  // Points cover a surface: about as many cells along its length as the root of their number.
  const double width =
      std::max((high - low).maxCoeff() / (1.0 + std::sqrt(static_cast<double>(binding.count()))), 1e-300);
  const std::vector<Index> order = mortonOrder(binding.positions, width);
  blocks.points = Csr{};
  blocks.points.indices = order;
  std::vector<Index> row;
  for (std::size_t begin = 0; begin < binding.count(); begin += kBlock) {
    row.clear();
    // Points of lower rank also rotate with F.
    double gain = binding.rank.empty() ? 1.0 : std::numeric_limits<double>::infinity();
    for (std::size_t k = begin; k < std::min(binding.count(), begin + kBlock); ++k) {
      const Index p = order[k];
      double sum = 0.0;
      for (Index e = binding.phyxels.offsets[p]; e < binding.phyxels.offsets[p + 1]; ++e) {
        const Index j = binding.phyxels.indices[e];
        if (binding.weights[e] != 0.0)
          sum += std::abs(binding.weights[e]) / (maxInfluence.empty() ? 1.0 : static_cast<double>(maxInfluence[j]));
        row.push_back(static_cast<Index>(j / kChunk));
      }
      gain = std::max(gain, sum);
    }
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    blocks.chunks.indices.insert(blocks.chunks.indices.end(), row.begin(), row.end());
    blocks.chunks.offsets.push_back(static_cast<Index>(blocks.chunks.indices.size()));
    blocks.gains.push_back(gain);
    blocks.points.offsets.push_back(static_cast<Index>(std::min(binding.count(), begin + kBlock)));
  }
}

// Largest component of displacement × largest influence over each chunk, compared in whole registers. √3 times it
// bounds every length.
// @param travels  travels(n, i): x y z x y z of the n phyxels from i on
template <class Travel>
void computeChunkTravel(std::size_t count, std::span<const float> maxInfluence, const Travel &travels,
                        std::vector<double> &out) {
  using Four = Eigen::Array<double, 12, 1>;
  using FourFloats = Eigen::Array<float, 12, 1>;
  out.resize(blocksOf(count, kChunk));
  for (std::size_t c = 0; c < out.size(); ++c) {
    const std::size_t end = std::min(count, (c + 1) * kChunk);
    Four most = Four::Zero();
    std::size_t i = c * kChunk;
    for (; i + 4 <= end; i += 4) {
      const Four travel = travels(std::integral_constant<int, 4>(), i).abs();
      most = most.max(maxInfluence.empty()
                          ? travel
                          : Four(travel * Eigen::Map<const FourFloats>(maxInfluence.data() + 3 * i).cast<double>()));
    }
    double largest = most.maxCoeff();
    for (; i < end; ++i)
      largest = std::max(largest, travels(std::integral_constant<int, 1>(), i).abs().maxCoeff() *
                                      (maxInfluence.empty() ? 1.0 : static_cast<double>(maxInfluence[3 * i])));
    out[c] = std::sqrt(3.0) * largest;
  }
}

// Travel of phyxels since the last search and in this step, by chunks.
void updateChunkTravel(const CarriedPoints &body, double dt, Blocks &blocks) {
  const auto at = [](auto n, std::span<const Vec3> field, std::size_t i) {
    return Eigen::Map<const Eigen::Array<double, 3 * decltype(n)::value, 1>>(field[i].data());
  };
  const std::span<const Vec3> now = body.displacements, before = blocks.displacementsAtSearch, v = body.velocities;
  const auto travelSince = [&](auto n, std::size_t i) { return (at(n, now, i) - at(n, before, i)).eval(); };
  const auto stepTravel = [&](auto n, std::size_t i) { return (dt * at(n, v, i)).eval(); };
  computeChunkTravel(now.size(), blocks.maxInfluence, travelSince, blocks.chunkTravelSince);
  computeChunkTravel(v.size(), blocks.maxInfluence, stepTravel, blocks.chunkStepTravel);
  std::copy_n(now.data()->data(), 3 * now.size(), blocks.displacementsAtSearch.data()->data());
}

double maxOf(std::span<const Index> chunks, std::span<const double> travels) {
  double largest = 0.0;
  for (const Index c : chunks) largest = std::max(largest, travels[c]);
  return largest;
}

// Largest travel of a point within `reach` of `centre` relative to a moving obstacle.
double obstacleTravelBound(const RigidMotion &from, const RigidMotion &to, const Vec3 &centre, double reach) {
  const double arm = (centre - to.centre - to.displacement).norm() + reach;
  return (to.rotation - from.rotation).norm() * arm + (to.displacement - from.displacement).norm() +
         2.0 * (to.centre - from.centre).norm();
}

// Largest travel of obstacles relative to any point of the body, m: since the last search, and in this step.
struct ObstacleTravel {
  double sinceSearch = 0.0, inStep = 0.0;
};
ObstacleTravel computeObstacleTravel(std::span<const Obstacle> obstacles, double time, double dt,
                                     const CarriedPoints &body, Blocks &blocks) {
  ObstacleTravel travels;
  if (std::none_of(obstacles.begin(), obstacles.end(), [](const Obstacle &o) { return static_cast<bool>(o.motion); }))
    return travels;
  // Bounding sphere of all points, centred at the first.
  const Vec3 &first = body.displacements.front();
  double squaredRadius = 0.0;
  for (const Vec3 &u : body.displacements) squaredRadius = std::max(squaredRadius, (u - first).squaredNorm());
  const double gain = *std::max_element(blocks.gains.begin(), blocks.gains.end());
  const double reach = blocks.size + 2.0 * gain * std::sqrt(squaredRadius);
  const Vec3 centre = body.origin + body.points.binding.positions.front() + first;
  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    if (!obstacles[o].motion) continue;
    const RigidMotion now = obstacles[o].motion(time);
    travels.sinceSearch =
        std::max(travels.sinceSearch, obstacleTravelBound(blocks.motionsAtSearch[o], now, centre, reach));
    travels.inStep = std::max(travels.inStep, obstacleTravelBound(now, obstacles[o].motion(time + dt), centre, reach));
    blocks.motionsAtSearch[o] = now;
  }
  return travels;
}

// Distance that a point may travel before it has to be tested again.
double clearanceOf(const ContactState &memory, std::span<const Obstacle> obstacles, const WorldBox &box,
                   const QueryPoints &queryPoints, std::size_t k) {
  double clearance = std::numeric_limits<double>::infinity();
  const Vec3 &x = queryPoints.positions[k];
  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    if (!obstacles[o].closest || !obstacles[o].actsOn(queryPoints.point(k))) continue;
    const ContactState::ClearanceCache &cached = memory.clearance[o][queryPoints.point(k)];
    const Vec3 at = obstacles[o].motion ? toRestFrame(memory.blocks.motionsAtSearch[o], x) : x;
    clearance = std::min(clearance, std::min(cached.distance, cached.reach) - (at - cached.at).norm());
  }
  if (box.enabled) clearance = std::min({clearance, (x - box.min).minCoeff(), (box.max - x).minCoeff()});
  return clearance - queryPoints.radius(k) - memory.margin;
}

// After a change of the scene every point is tested once.
void prepareBlocks(std::span<const Obstacle> obstacles, const WorldBox &box, double time, double margin,
                   const CarriedPoints &body, ContactState &memory) {
  const Interpolation &binding = body.points.binding;
  Blocks &blocks = memory.blocks;
  const std::size_t count = blocksOf(binding.count(), kBlock);
  if (blocks.gains.size() != count) buildBlocks(binding, body.maxInfluence, blocks);
  const bool sameBox = box.enabled == blocks.box.enabled && box.min == blocks.box.min && box.max == blocks.box.max;
  const bool finite =
      std::all_of(blocks.travels.begin(), blocks.travels.end(), [](double travel) { return std::isfinite(travel); });
  if (finite && blocks.travelLimits.size() == binding.count() &&
      blocks.displacementsAtSearch.size() == body.displacements.size() && sameBox && blocks.margin == margin &&
      memory.clearance.size() == obstacles.size())
    return;
  // Points that only disabled obstacles act on are tested as well, so that stored results of these obstacles are
  // cleared.
  blocks.travelLimits.assign(binding.count(), -1.0);
  for (std::size_t p = 0; p < binding.count(); ++p)
    if (!box.enabled &&
        std::none_of(obstacles.begin(), obstacles.end(), [p](const Obstacle &o) { return o.actsOn(p); }))
      blocks.travelLimits[p] = std::numeric_limits<double>::infinity();
  blocks.travels.assign(count, 0.0);
  blocks.blockTravelLimits.assign(count, -1.0);
  blocks.displacementsAtSearch.assign(body.displacements.begin(), body.displacements.end());
  blocks.size = 0.0;
  for (const Vec3 &X : binding.positions) blocks.size = std::max(blocks.size, (X - binding.positions.front()).norm());
  blocks.motionsAtSearch.assign(obstacles.size(), RigidMotion{});
  for (std::size_t o = 0; o < obstacles.size(); ++o)
    if (obstacles[o].motion) blocks.motionsAtSearch[o] = obstacles[o].motion(time);
  blocks.box = box;
  blocks.margin = margin;
}

}  // namespace

void findContacts(std::span<const Obstacle> obstacles, const WorldBox &box, double time, double dt, double margin,
                  const CarriedPoints &body, ContactState &memory, const ParallelFor &parallelFor) {
  const Interpolation &binding = body.points.binding;
  const std::size_t n = body.points.count();
  Blocks &blocks = memory.blocks;
  prepareBlocks(obstacles, box, time, margin, body, memory);
  updateChunkTravel(body, dt, blocks);
  const ObstacleTravel obstacleMotion = computeObstacleTravel(obstacles, time, dt, body, blocks);

  blocks.checkedBits.assign(n / 64 + 1, 0);
  blocks.checkedBlocks.clear();
  for (std::size_t b = 0; b < blocks.travels.size(); ++b) {
    const std::span<const Index> chunks = blocks.chunks.row(b);
    blocks.travels[b] += blocks.gains[b] * maxOf(chunks, blocks.chunkTravelSince) + obstacleMotion.sinceSearch;
    const double travel =
        blocks.travels[b] + blocks.gains[b] * maxOf(chunks, blocks.chunkStepTravel) + obstacleMotion.inStep;
    // NaN is tested, so that the guard detects it.
    if (travel < blocks.blockTravelLimits[b]) continue;
    blocks.checkedBlocks.push_back(static_cast<Index>(b));
    for (const Index p : blocks.points.row(b))
      if (!(travel < blocks.travelLimits[p])) blocks.checkedBits[p / 64] |= std::uint64_t{1} << p % 64;
  }
  // In ascending order, which is the order of the contacts.
  blocks.checkedPoints.clear();
  for (std::size_t word = 0; word < blocks.checkedBits.size(); ++word)
    for (std::uint64_t bits = blocks.checkedBits[word]; bits != 0; bits &= bits - 1)
      blocks.checkedPoints.push_back(static_cast<Index>(64 * word + static_cast<std::size_t>(std::countr_zero(bits))));
  if (blocks.checkedPoints.empty()) {
    std::swap(memory.previous, memory.active);
    memory.active.clear();
    memory.margin = margin;
    memory.searchTime = time;
    return;
  }
  blocks.positions.resize(blocks.checkedPoints.size());
  blocks.velocities.resize(blocks.checkedPoints.size());
  const auto computeStates = [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Index p = blocks.checkedPoints[k];
      const Mat3 F = rankOf(binding, p) < 3 ? gradientAt(binding, p, body.displacements) : Mat3(Mat3::Identity());
      blocks.positions[k] = body.origin + binding.positions[p] + displacementAt(binding, p, body.displacements, F);
      blocks.velocities[k] = fieldAt(binding, p, body.velocities);
    }
  };
  parallelFor(blocks.checkedPoints.size(), 128, std::cref(computeStates));
  const QueryPoints queryPoints{blocks.checkedPoints, blocks.positions, blocks.velocities, body.points.radii};
  searchContacts(obstacles, box, time, dt, margin, n, queryPoints, memory, parallelFor);

  for (std::size_t k = 0; k < queryPoints.count(); ++k)
    blocks.travelLimits[queryPoints.point(k)] = kClearanceSafety * clearanceOf(memory, obstacles, box, queryPoints, k);
  for (const Index b : blocks.checkedBlocks) {
    double minLimit = std::numeric_limits<double>::infinity();
    for (const Index p : blocks.points.row(b)) {
      // Limits of the points just tested count from their current travel.
      if ((blocks.checkedBits[p / 64] >> p % 64 & 1) != 0) blocks.travelLimits[p] += blocks.travels[b];
      minLimit = std::min(minLimit, blocks.travelLimits[p]);
    }
    blocks.blockTravelLimits[b] = minLimit;
  }
}

}  // namespace pointbased
