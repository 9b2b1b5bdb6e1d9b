// SPDX-License-Identifier: Apache-2.0
#include "pointbased/sampling.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/cancellation_poll.h"
#include "base/number_text.h"
#include "discretisation/grid_sides.h"
#include "discretisation/lattice/lattice_grid.h"

namespace pointbased {
namespace {

using detail::number;

// Points per axis of the finer lattice inside a cell that the surface cuts. 5³ = 125 determine the volume of each part
// to about one per cent; the sum is exact in any case.
constexpr int kSubdivisions = 5, kPerCell = kSubdivisions * kSubdivisions * kSubdivisions;
constexpr int kOutside = -1;

struct Lattice {
  Vec3 origin;  // centre of cell (0, 0, 0)
  double spacing = 0.0;
  std::array<std::int64_t, 3> n{};

  [[nodiscard]] std::array<std::size_t, 3> counts() const {
    return {static_cast<std::size_t>(n[0]), static_cast<std::size_t>(n[1]), static_cast<std::size_t>(n[2])};
  }
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

// Cells are placed symmetrically about the centre of the bounds, with the outermost layer half a cell inside them. A
// box whose edges are multiples of the spacing is then divided without a remainder.
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
  parallelFor(points.size(), 64, [&](std::size_t begin, std::size_t end) {
    std::vector<double> winding(end - begin);
    shape.inside(points.subspan(begin, end - begin), winding);
    for (std::size_t i = begin; i < end; ++i) flags[i] = winding[i - begin] > 0.5 ? 1 : 0;
  });
  return flags;
}

// The distance of voxels is only approximate.
bool measures(const BodyShape &shape) { return shape.surfaceDistance && !shape.shares; }

// Queries at the centres of all cells.
struct Middles {
  std::vector<Vec3> centres;
  std::vector<double> distances;     // empty: the shape provides no distances
  std::vector<std::uint8_t> inside;  // 0, 1
};

Middles middlesOf(const BodyShape &shape, const Lattice &lattice, const ParallelFor &parallelFor) {
  Middles out;
  out.centres.resize(lattice.cells());
  parallelFor(out.centres.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) out.centres[c] = lattice.centre(c);
  });
  if (shape.surfaceDistance) {
    out.distances.resize(out.centres.size());
    parallelFor(out.centres.size(), 64, [&](std::size_t begin, std::size_t end) {
      shape.surfaceDistance(std::span<const Vec3>(out.centres).subspan(begin, end - begin),
                            std::span<double>(out.distances).subspan(begin, end - begin));
    });
  }
  if (!measures(shape)) {
    out.inside = insideFlags(shape, out.centres, parallelFor);
    return out;
  }
  detail::GridSides sides;
  sides.find(lattice.counts(), lattice.spacing, out.distances, detail::CancellationPoll(parallelFor));
  std::vector<Vec3> asked;
  for (const std::size_t c : sides.deepest()) asked.push_back(out.centres[c]);
  const std::vector<std::uint8_t> answers = insideFlags(shape, asked, parallelFor);
  out.inside.resize(out.centres.size());
  for (std::size_t c = 0; c < out.inside.size(); ++c) out.inside[c] = answers[sides.groups()[c]];
  return out;
}

// Share of each cube of the finer lattice that is inside, cut cell by cut cell.
std::vector<double> partsInside(const BodyShape &shape, std::span<const Vec3> points, double edge,
                                const ParallelFor &parallelFor) {
  std::vector<double> parts(points.size());
  parallelFor(points.size() / kPerCell, 2, [&](std::size_t begin, std::size_t end) {
    const auto some = points.subspan(begin * kPerCell, (end - begin) * kPerCell);
    const auto out = std::span<double>(parts).subspan(begin * kPerCell, some.size());
    if (shape.shares) {
      shape.shares(some, Mat3::Identity(), edge, out, {});
      return;
    }
    if (!shape.surfaceDistance) {
      shape.inside(some, out);
      for (double &part : out) part = part > 0.5 ? 1.0 : 0.0;
      return;
    }
    shape.surfaceDistance(some, out);
    detail::GridSides sides;
    std::vector<Vec3> asked;
    std::vector<std::size_t> askedOf(some.size());
    for (std::size_t at = 0; at < some.size(); at += kPerCell) {
      sides.find({kSubdivisions, kSubdivisions, kSubdivisions}, edge, out.subspan(at, kPerCell));
      for (std::size_t p = 0; p < kPerCell; ++p) askedOf[at + p] = asked.size() + sides.groups()[p];
      for (const std::size_t p : sides.deepest()) asked.push_back(some[at + p]);
    }
    std::vector<double> winding(asked.size());
    shape.inside(asked, winding);
    for (std::size_t p = 0; p < out.size(); ++p) out[p] = winding[askedOf[p]] > 0.5 ? 1.0 : 0.0;
  });
  return parts;
}

std::size_t countInside(const BodyShape &shape, double spacing, const ParallelFor &parallelFor) {
  const std::vector<std::uint8_t> flags = middlesOf(shape, latticeOver(shape, spacing), parallelFor).inside;
  return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), std::uint8_t{1}));
}

// The count decreases in steps as the spacing grows; a few corrections by the cube root come within some per cent.
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

tl::unexpected<std::string> refuse(const std::string &text) { return tl::unexpected<std::string>(text); }

Result<double> spacingOf(const BodyShape &shape, const Sampling &sampling, const ParallelFor &parallelFor) {
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
  const double cells = (extent[0] / spacing + 1.0) * (extent[1] / spacing + 1.0) * (extent[2] / spacing + 1.0);
  const double phyxels = shape.volume / (spacing * spacing * spacing);
  if (phyxels > static_cast<double>(kMaximumPhyxels) || cells > 5e7)
    return refuse("a spacing of " + number(spacing, 4) + " m makes about " + number(phyxels, 4) + " phyxels; at most " +
                  std::to_string(kMaximumPhyxels) + " are accepted: use a larger spacing");
  return spacing;
}

// Divides cut cells among the phyxels. Points of a finer lattice inside the body belong to the nearest phyxel around;
// those without one form a separate phyxel per cell.
class CutCellDivision {
 public:
  CutCellDivision(const BodyShape &shape, const Lattice &lattice, std::span<const int> phyxelOfCell, PhyxelCloud &cloud,
                  const ParallelFor &parallelFor)
      : shape_(shape), lattice_(lattice), phyxelOfCell_(phyxelOfCell), cloud_(cloud), parallelFor_(parallelFor) {}

  [[nodiscard]] double pointVolume() const { return lattice_.spacing * lattice_.spacing * lattice_.spacing / kPerCell; }
  // @return  many points are pending: call divide()
  bool add(std::size_t cell) {
    for (int z = 0; z < kSubdivisions; ++z)
      for (int y = 0; y < kSubdivisions; ++y)
        for (int x = 0; x < kSubdivisions; ++x) {
          const Vec3 offset = (Vec3(x, y, z) + Vec3::Constant(0.5)) / kSubdivisions - Vec3::Constant(0.5);
          points_.push_back(lattice_.centre(cell) + lattice_.spacing * offset);
          cellOfPoint_.push_back(cell);
        }
    constexpr std::size_t kBatch = 2048;
    return points_.size() >= kBatch * kPerCell / 16;
  }
  void divide() {
    const std::vector<double> parts = partsInside(shape_, points_, lattice_.spacing / kSubdivisions, parallelFor_);
    for (std::size_t p = 0; p < points_.size(); ++p) {
      if (!(parts[p] > 0.0)) continue;
      if (const int nearest = nearestPhyxel(cellOfPoint_[p], points_[p]); nearest != kOutside) {
        cloud_.volumes[static_cast<std::size_t>(nearest)] += parts[p] * pointVolume();
        continue;
      }
      if (orphans_.empty() || orphans_.back().cell != cellOfPoint_[p]) orphans_.push_back({cellOfPoint_[p]});
      orphans_.back().sum += parts[p] * points_[p];
      orphans_.back().count += parts[p];
    }
    points_.clear();
    cellOfPoint_.clear();
  }
  // Slivers of less than a fiftieth of a cell are added to the scale of their neighbours; otherwise they would be
  // points of almost no mass.
  void addOrphans() {
    for (const Orphan &orphan : orphans_)
      if (orphan.count >= kPerCell / 50 + 1 || cloud_.positions.empty()) {
        cloud_.positions.push_back(orphan.sum / orphan.count);
        cloud_.volumes.push_back(orphan.count * pointVolume());
      }
  }

 private:
  struct Orphan {
    std::size_t cell = 0;
    Vec3 sum = Vec3::Zero();
    double count = 0.0;  // cubes of the finer lattice
  };

  [[nodiscard]] int nearestPhyxel(std::size_t cellIndex, const Vec3 &point) const {
    const auto cell = static_cast<std::int64_t>(cellIndex);
    const auto &n = lattice_.n;
    const std::int64_t cx = cell % n[0], cy = (cell / n[0]) % n[1], cz = cell / (n[0] * n[1]);
    int nearest = kOutside;
    double nearestSquared = 1e300;
    for (std::int64_t z = std::max<std::int64_t>(0, cz - 1); z <= std::min(n[2] - 1, cz + 1); ++z)
      for (std::int64_t y = std::max<std::int64_t>(0, cy - 1); y <= std::min(n[1] - 1, cy + 1); ++y)
        for (std::int64_t x = std::max<std::int64_t>(0, cx - 1); x <= std::min(n[0] - 1, cx + 1); ++x) {
          const int candidate = phyxelOfCell_[lattice_.index(x, y, z)];
          if (candidate == kOutside) continue;
          const double squared = (cloud_.positions[static_cast<std::size_t>(candidate)] - point).squaredNorm();
          if (squared < nearestSquared) {
            nearestSquared = squared;
            nearest = candidate;
          }
        }
    return nearest;
  }

  const BodyShape &shape_;
  const Lattice &lattice_;
  std::span<const int> phyxelOfCell_;
  PhyxelCloud &cloud_;
  const ParallelFor &parallelFor_;
  std::vector<Vec3> points_;
  std::vector<std::size_t> cellOfPoint_;
  std::vector<Orphan> orphans_;
};

// Sorts along a space-filling curve, so that neighbours are close in memory.
void sortInSpace(PhyxelCloud &cloud, const Lattice &lattice) {
  std::vector<std::pair<std::uint64_t, std::size_t>> curve;
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    const Vec3 q = (cloud.positions[i] - lattice.origin) / lattice.spacing;
    lattice::Cell3 at;
    for (std::size_t c = 0; c < 3; ++c)
      at[c] = static_cast<std::int32_t>(std::clamp(std::round(q[static_cast<int>(c)]) + 1.0, 0.0, 1048575.0));
    curve.emplace_back(lattice::mortonCode(at), i);
  }
  std::sort(curve.begin(), curve.end());
  std::vector<Vec3> positions;
  std::vector<double> volumes;
  for (const auto &[code, i] : curve) {
    positions.push_back(cloud.positions[i]);
    volumes.push_back(cloud.volumes[i]);
  }
  cloud.positions = std::move(positions);
  cloud.volumes = std::move(volumes);
}

void findContactRadii(PhyxelCloud &cloud, const BodyShape &shape, const ParallelFor &parallelFor) {
  cloud.contactRadii.resize(cloud.positions.size());
  if (shape.surfaceDistance) {
    parallelFor(cloud.positions.size(), 64, [&](std::size_t begin, std::size_t end) {
      const auto radii = std::span<double>(cloud.contactRadii).subspan(begin, end - begin);
      shape.surfaceDistance(std::span<const Vec3>(cloud.positions).subspan(begin, end - begin), radii);
      for (double &r : radii) r = std::min(r, 0.5 * cloud.spacing);
    });
  } else {
    for (std::size_t i = 0; i < cloud.volumes.size(); ++i) cloud.contactRadii[i] = 0.5 * std::cbrt(cloud.volumes[i]);
  }
}

}  // namespace

std::size_t automaticCount(double volume, double area) {
  constexpr double kFewest = 1000.0, kMost = 4000.0;
  const double count = 2.0 * area * area * area / (volume * volume);
  return static_cast<std::size_t>(std::isfinite(count) ? std::clamp(count, kFewest, kMost) : kFewest);
}

Result<PhyxelCloud> fill(const BodyShape &shape, const Sampling &sampling, const ParallelFor &parallelFor,
                         const SamplingProgress &progress) {
  const auto shouldContinue = [&](double fraction) { return !progress || progress(fraction); };
  const auto spacing = spacingOf(shape, sampling, parallelFor);
  if (!spacing) return refuse(spacing.error());
  if (!shouldContinue(0.05)) return refuse("cancelled");

  const Lattice lattice = latticeOver(shape, *spacing);
  const std::size_t cells = lattice.cells();
  const Middles middles = middlesOf(shape, lattice, parallelFor);
  if (!shouldContinue(0.35)) return refuse("cancelled");
  // Cells that the surface may cut; all, if the shape provides no distances.
  const double halfDiagonal = 0.5 * std::sqrt(3.0) * *spacing;
  const auto mayBeCut = [&](std::size_t c) {
    return middles.distances.empty() || middles.distances[c] <= halfDiagonal * (1.0 + 1e-9);
  };

  PhyxelCloud cloud;
  cloud.spacing = *spacing;
  std::vector<int> phyxelOfCell(cells, kOutside);
  for (std::size_t c = 0; c < cells; ++c)
    if (middles.inside[c] != 0) {
      phyxelOfCell[c] = static_cast<int>(cloud.positions.size());
      cloud.positions.push_back(middles.centres[c]);
    }
  cloud.volumes.assign(cloud.positions.size(), 0.0);

  CutCellDivision division(shape, lattice, phyxelOfCell, cloud, parallelFor);
  const double pointVolume = division.pointVolume();
  for (std::size_t c = 0; c < cells; ++c) {
    if (!mayBeCut(c)) {
      if (middles.inside[c] != 0) cloud.volumes[static_cast<std::size_t>(phyxelOfCell[c])] += kPerCell * pointVolume;
    } else if (division.add(c)) {
      division.divide();
      if (!shouldContinue(0.35 + 0.6 * static_cast<double>(c) / static_cast<double>(cells))) return refuse("cancelled");
    }
  }
  division.divide();
  division.addOrphans();
  if (cloud.positions.empty())
    return refuse("no point of the body was found at a spacing of " + number(*spacing, 4) +
                  " m: the body is thinner than a fifth of it, or not closed; use a smaller spacing");

  // A phyxel just below the surface may get no point of the finer lattice.
  for (double &v : cloud.volumes) v = std::max(v, pointVolume);
  for (const double v : cloud.volumes) cloud.countedVolume += v;
  for (double &v : cloud.volumes) v *= shape.volume / cloud.countedVolume;
  sortInSpace(cloud, lattice);
  findContactRadii(cloud, shape, parallelFor);
  if (!shouldContinue(1.0)) return refuse("cancelled");
  return cloud;
}

}  // namespace pointbased
