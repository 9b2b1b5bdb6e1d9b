// SPDX-License-Identifier: Apache-2.0
#include "pointbased/sampling.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/number_text.h"
#include "discretisation/lattice/lattice_grid.h"

namespace pointbased {
namespace {

using detail::number;

// Points per axis of the finer lattice inside a cell that the surface cuts: 5³ = 125 give each part's volume to about
// one per cent; the sum is exact in any case.
constexpr int kSubdivisions = 5;
constexpr int kOutside = -1;

struct Lattice {
  Vec3 origin;  // centre of cell (0, 0, 0)
  double spacing = 0.0;
  std::array<std::int64_t, 3> n{};

  [[nodiscard]] std::size_t cells() const { return static_cast<std::size_t>(n[0] * n[1] * n[2]); }
  [[nodiscard]] std::size_t index(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return static_cast<std::size_t>((z * n[1] + y) * n[0] + x);
  }
  [[nodiscard]] Vec3 centre(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return origin + spacing * Vec3(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
  }
  [[nodiscard]] Vec3 centre(std::size_t cell) const {
    const auto i = static_cast<std::int64_t>(cell);
    return centre(i % n[0], (i / n[0]) % n[1], i / (n[0] * n[1]));
  }
};

// Cells are placed symmetrically about the middle of the bounds, with the outermost layer half a cell inside them, so a
// box whose edges are multiples of the spacing is divided without a remainder.
Lattice latticeOver(const BodyShape &shape, double spacing) {
  Lattice lattice;
  lattice.spacing = spacing;
  const Vec3 middle = 0.5 * (shape.min + shape.max);
  for (int a = 0; a < 3; ++a) {
    const double extent = shape.max[a] - shape.min[a];
    lattice.n[static_cast<std::size_t>(a)] =
        std::max<std::int64_t>(1, std::llround(std::ceil(extent / spacing - 1e-6)));
    lattice.origin[a] = middle[a] - 0.5 * spacing * static_cast<double>(lattice.n[static_cast<std::size_t>(a)] - 1);
  }
  return lattice;
}

std::vector<std::uint8_t> insideFlags(const BodyShape &shape, std::span<const Vec3> points,
                                      const ParallelFor &parallelFor) {
  std::vector<std::uint8_t> flags(points.size());
  parallelFor(points.size(), 256, [&](std::size_t begin, std::size_t end) {
    std::vector<double> winding(end - begin);
    shape.inside(points.subspan(begin, end - begin), winding);
    for (std::size_t i = begin; i < end; ++i) flags[i] = winding[i - begin] > 0.5 ? 1 : 0;
  });
  return flags;
}

// What of cubes of the finer lattice is inside.
std::vector<double> partsInside(const BodyShape &shape, std::span<const Vec3> points, double edge,
                                const ParallelFor &parallelFor) {
  std::vector<double> parts(points.size());
  parallelFor(points.size(), 256, [&](std::size_t begin, std::size_t end) {
    const auto some = points.subspan(begin, end - begin);
    const auto out = std::span<double>(parts).subspan(begin, end - begin);
    if (shape.shares) {
      shape.shares(some, Mat3::Identity(), edge, out, {});
      return;
    }
    shape.inside(some, out);
    for (double &part : out) part = part > 0.5 ? 1.0 : 0.0;
  });
  return parts;
}

std::size_t countInside(const BodyShape &shape, double spacing, const ParallelFor &parallelFor) {
  const Lattice lattice = latticeOver(shape, spacing);
  std::vector<Vec3> centres(lattice.cells());
  for (std::size_t c = 0; c < centres.size(); ++c) centres[c] = lattice.centre(c);
  const std::vector<std::uint8_t> flags = insideFlags(shape, centres, parallelFor);
  return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), std::uint8_t{1}));
}

// The count falls in jumps as the spacing grows; a few corrections by the cube root come within some per cent.
double spacingForCount(const BodyShape &shape, std::size_t count, const ParallelFor &parallelFor) {
  double spacing = std::cbrt(shape.volume / static_cast<double>(count));
  double best = spacing;
  double bestMiss = 1e300;
  for (int attempt = 0; attempt < 6; ++attempt) {
    const std::size_t found = countInside(shape, spacing, parallelFor);
    const double miss = std::abs(static_cast<double>(found) - static_cast<double>(count));
    if (miss < bestMiss) {
      bestMiss = miss;
      best = spacing;
    }
    if (miss <= 0.005 * static_cast<double>(count)) break;
    spacing *= std::cbrt(std::max<double>(static_cast<double>(found), 0.2) / static_cast<double>(count));
  }
  return best;
}

}  // namespace

std::size_t automaticCount(double volume, double area) {
  constexpr double kFewest = 1000.0, kMost = 4000.0;
  const double count = 2.0 * area * area * area / (volume * volume);
  return static_cast<std::size_t>(std::isfinite(count) ? std::clamp(count, kFewest, kMost) : kFewest);
}

Result<PhyxelCloud> fill(const BodyShape &shape, const Sampling &sampling, const ParallelFor &parallelFor,
                         const SamplingProgress &progress) {
  const auto refuse = [](const std::string &text) { return tl::unexpected<std::string>(text); };
  const auto shouldContinue = [&](double fraction) { return !progress || progress(fraction); };
  if (!(shape.volume > 0.0) || !std::isfinite(shape.volume))
    return refuse("the body has a volume of " + number(shape.volume, 4) + " m³; a finite volume > 0 is needed");
  if (!(sampling.spacing >= 0.0) || !std::isfinite(sampling.spacing))
    return refuse("spacing = " + number(sampling.spacing, 4) + " m is not accepted: finite and > 0, or 0 with a count");
  if (sampling.spacing == 0.0 && (sampling.count < 1 || sampling.count > kMaximumPhyxels))
    return refuse("count = " + std::to_string(sampling.count) + " is not accepted: 1 … " +
                  std::to_string(kMaximumPhyxels));

  const double spacing =
      sampling.spacing > 0.0 ? sampling.spacing : spacingForCount(shape, sampling.count, parallelFor);
  const Vec3 extent = shape.max - shape.min;
  const double cellsWanted = (extent[0] / spacing + 1.0) * (extent[1] / spacing + 1.0) * (extent[2] / spacing + 1.0);
  if (shape.volume / (spacing * spacing * spacing) > static_cast<double>(kMaximumPhyxels) || cellsWanted > 5e7)
    return refuse("a spacing of " + number(spacing, 4) + " m makes about " +
                  number(shape.volume / (spacing * spacing * spacing), 4) + " phyxels; at most " +
                  std::to_string(kMaximumPhyxels) + " are accepted: use a larger spacing");
  if (!shouldContinue(0.05)) return refuse("cancelled");

  // Which cells are inside, by their centres; which are cut, by a neighbour that differs or by the distance.
  const Lattice lattice = latticeOver(shape, spacing);
  const std::size_t cells = lattice.cells();
  std::vector<Vec3> centres(cells);
  for (std::size_t c = 0; c < cells; ++c) centres[c] = lattice.centre(c);
  const std::vector<std::uint8_t> inside = insideFlags(shape, centres, parallelFor);
  if (!shouldContinue(0.2)) return refuse("cancelled");

  PhyxelCloud cloud;
  cloud.spacing = spacing;
  std::vector<int> phyxelOfCell(cells, kOutside);
  for (std::size_t c = 0; c < cells; ++c)
    if (inside[c]) {
      phyxelOfCell[c] = static_cast<int>(cloud.positions.size());
      cloud.positions.push_back(centres[c]);
    }

  std::vector<std::uint8_t> cut(cells, 1);
  if (shape.surfaceDistance) {
    std::vector<double> distances(cells);
    parallelFor(cells, 256, [&](std::size_t begin, std::size_t end) {
      shape.surfaceDistance(std::span<const Vec3>(centres).subspan(begin, end - begin),
                            std::span<double>(distances).subspan(begin, end - begin));
    });
    const double halfDiagonal = 0.5 * std::sqrt(3.0) * spacing;
    for (std::size_t c = 0; c < cells; ++c) cut[c] = distances[c] <= halfDiagonal * (1.0 + 1e-9) ? 1 : 0;
  }
  if (!shouldContinue(0.35)) return refuse("cancelled");

  // Points of the finer lattice that lie in the body go to the nearest phyxel around; those that find none start a
  // phyxel of their own per cell.
  constexpr int kPerCell = kSubdivisions * kSubdivisions * kSubdivisions;
  const double partVolume = spacing * spacing * spacing / kPerCell;
  cloud.volumes.assign(cloud.positions.size(), 0.0);
  struct Orphan {
    Vec3 sum = Vec3::Zero();
    double count = 0.0;  // cubes of the finer lattice
  };
  std::vector<std::pair<std::size_t, Orphan>> orphans;
  constexpr std::size_t kBatch = 2048;
  std::vector<Vec3> points;
  std::vector<std::size_t> cellOfPoint;
  const auto flush = [&]() {
    const std::vector<double> parts = partsInside(shape, points, spacing / kSubdivisions, parallelFor);
    for (std::size_t p = 0; p < points.size(); ++p) {
      if (!(parts[p] > 0.0)) continue;
      const auto cell = static_cast<std::int64_t>(cellOfPoint[p]);
      const std::int64_t cx = cell % lattice.n[0], cy = (cell / lattice.n[0]) % lattice.n[1],
                         cz = cell / (lattice.n[0] * lattice.n[1]);
      int nearest = kOutside;
      double nearestSquared = 1e300;
      for (std::int64_t z = std::max<std::int64_t>(0, cz - 1); z <= std::min(lattice.n[2] - 1, cz + 1); ++z)
        for (std::int64_t y = std::max<std::int64_t>(0, cy - 1); y <= std::min(lattice.n[1] - 1, cy + 1); ++y)
          for (std::int64_t x = std::max<std::int64_t>(0, cx - 1); x <= std::min(lattice.n[0] - 1, cx + 1); ++x) {
            const int candidate = phyxelOfCell[lattice.index(x, y, z)];
            if (candidate == kOutside) continue;
            const double squared = (cloud.positions[static_cast<std::size_t>(candidate)] - points[p]).squaredNorm();
            if (squared < nearestSquared) {
              nearestSquared = squared;
              nearest = candidate;
            }
          }
      if (nearest != kOutside) {
        cloud.volumes[static_cast<std::size_t>(nearest)] += parts[p] * partVolume;
        continue;
      }
      if (orphans.empty() || orphans.back().first != cellOfPoint[p]) orphans.push_back({cellOfPoint[p], {}});
      orphans.back().second.sum += parts[p] * points[p];
      orphans.back().second.count += parts[p];
    }
    points.clear();
    cellOfPoint.clear();
  };
  for (std::size_t c = 0; c < cells; ++c) {
    if (!cut[c]) {
      if (inside[c]) cloud.volumes[static_cast<std::size_t>(phyxelOfCell[c])] += kPerCell * partVolume;
      continue;
    }
    for (int z = 0; z < kSubdivisions; ++z)
      for (int y = 0; y < kSubdivisions; ++y)
        for (int x = 0; x < kSubdivisions; ++x) {
          const Vec3 offset = (Vec3(x, y, z) + Vec3::Constant(0.5)) / kSubdivisions - Vec3::Constant(0.5);
          points.push_back(centres[c] + spacing * offset);
          cellOfPoint.push_back(c);
        }
    if (points.size() >= kBatch * kPerCell / 16) {
      flush();
      if (!shouldContinue(0.35 + 0.6 * static_cast<double>(c) / static_cast<double>(cells))) return refuse("cancelled");
    }
  }
  flush();
  // Slivers of less than a fiftieth of a cell join their neighbours' scale instead of becoming points of almost no
  // mass.
  for (const auto &[cell, orphan] : orphans)
    if (orphan.count >= kPerCell / 50 + 1 || cloud.positions.empty()) {
      cloud.positions.push_back(orphan.sum / orphan.count);
      cloud.volumes.push_back(orphan.count * partVolume);
    }
  if (cloud.positions.empty())
    return refuse("no point of the body was found at a spacing of " + number(spacing, 4) +
                  " m: the body is thinner than a fifth of it, or not closed; use a smaller spacing");

  // A phyxel that sits right under the surface can end up without any point of the finer lattice.
  for (double &v : cloud.volumes) v = std::max(v, partVolume);
  double total = 0.0;
  for (const double v : cloud.volumes) total += v;
  for (double &v : cloud.volumes) v *= shape.volume / total;

  // Along a space-filling curve, so that neighbours are near in memory.
  std::vector<std::pair<std::uint64_t, std::size_t>> curve;
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    const Vec3 q = (cloud.positions[i] - lattice.origin) / spacing;
    lattice::Cell3 at;
    for (std::size_t c = 0; c < 3; ++c)
      at[c] = static_cast<std::int32_t>(std::clamp(std::round(q[static_cast<int>(c)]) + 1.0, 0.0, 1048575.0));
    curve.emplace_back(lattice::mortonCode(at), i);
  }
  std::sort(curve.begin(), curve.end());
  std::vector<std::size_t> order;
  for (const auto &[code, i] : curve) order.push_back(i);
  PhyxelCloud sorted;
  sorted.spacing = spacing;
  sorted.countedVolume = total;
  for (const std::size_t i : order) {
    sorted.positions.push_back(cloud.positions[i]);
    sorted.volumes.push_back(cloud.volumes[i]);
  }
  sorted.contactRadii.resize(order.size());
  if (shape.surfaceDistance) {
    shape.surfaceDistance(sorted.positions, sorted.contactRadii);
    for (double &r : sorted.contactRadii) r = std::min(r, 0.5 * spacing);
  } else {
    for (std::size_t i = 0; i < order.size(); ++i) sorted.contactRadii[i] = 0.5 * std::cbrt(sorted.volumes[i]);
  }
  if (!shouldContinue(1.0)) return refuse("cancelled");
  return sorted;
}

}  // namespace pointbased
