// SPDX-License-Identifier: Apache-2.0
#include "lattice_grid.h"

#include <cstdio>

namespace pointbased::lattice {

void CellIndex::build(std::span<const Cell> cells, const Frame &frame) {
  levels_ = frame.levels;
  for (std::size_t a = 0; a < 3; ++a) end_[a] = frame.n[a] * frame.finest();
  cells_.clear();
  cells_.reserve(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Cell &cell = cells[i];
    const Cell3 k{cell.at[0] / cell.size, cell.at[1] / cell.size, cell.at[2] / cell.size};
    cells_.emplace(key(levelOf(cell, frame), k), static_cast<Index>(i));
  }
}

int CellIndex::levelOf(const Cell &cell, const Frame &frame) {
  int level = frame.levels;
  for (std::int32_t size = cell.size; size > 1; size /= 2) --level;
  return level;
}

Index CellIndex::find(int level, const Cell3 &k) const {
  const std::int32_t size = std::int32_t{1} << (levels_ - level);
  for (std::size_t a = 0; a < 3; ++a)
    if (k[a] < 0 || k[a] * size >= end_[a]) return kNone;
  const auto found = cells_.find(key(level, k));
  return found == cells_.end() ? kNone : found->second;
}

Index CellIndex::holding(const Cell3 &at) const {
  for (std::size_t a = 0; a < 3; ++a)
    if (at[a] < 0 || at[a] >= end_[a]) return kNone;
  for (int level = levels_; level >= 0; --level) {
    const int shift = levels_ - level;
    const Index cell = find(level, {at[0] >> shift, at[1] >> shift, at[2] >> shift});
    if (cell != kNone) return cell;
  }
  return kNone;
}

std::uint64_t mortonCode(const Cell3 &at) {
  const auto spread = [](std::int32_t value) {
    auto x = static_cast<std::uint64_t>(value) & 0x1fffff;
    x = (x | x << 32) & 0x1f00000000ffffull;
    x = (x | x << 16) & 0x1f0000ff0000ffull;
    x = (x | x << 8) & 0x100f00f00f00f00full;
    x = (x | x << 4) & 0x10c30c30c30c30c3ull;
    x = (x | x << 2) & 0x1249249249249249ull;
    return x;
  };
  return spread(at[0]) | spread(at[1]) << 1 | spread(at[2]) << 2;
}

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

namespace {
constexpr std::size_t kBatch = 4096;

template <class Ask>
void inBatches(const Frame &frame, std::span<const Vec3> local, const Ask &ask) {
  std::vector<Vec3> world;
  for (std::size_t begin = 0; begin < local.size(); begin += kBatch) {
    const std::size_t count = std::min(kBatch, local.size() - begin);
    world.resize(count);
    for (std::size_t i = 0; i < count; ++i) world[i] = frame.world(local[begin + i]);
    ask(std::span<const Vec3>(world), begin);
  }
}
}  // namespace

void Questions::distances(std::span<const Vec3> local, std::span<double> out) const {
  inBatches(frame_, local, [&](std::span<const Vec3> world, std::size_t begin) {
    shape_.surfaceDistance(world, out.subspan(begin, world.size()));
  });
}

void Questions::inside(std::span<const Vec3> local, std::span<std::uint8_t> out) const {
  std::vector<double> winding(std::min(kBatch, local.size()));
  inBatches(frame_, local, [&](std::span<const Vec3> world, std::size_t begin) {
    shape_.inside(world, std::span<double>(winding).first(world.size()));
    for (std::size_t i = 0; i < world.size(); ++i) out[begin + i] = winding[i] > 0.5 ? 1 : 0;
  });
}

Frame frameOver(const BodyShape &shape, const Mat3 &axes, double spacing) {
  Frame frame;
  frame.origin = 0.5 * (shape.min + shape.max);
  frame.axes = axes;
  frame.spacing = spacing;
  // Bounds along the lattice: of the vertices where they are known, else of the box around the body.
  const Vec3 half = axes.transpose().cwiseAbs() * (0.5 * (shape.max - shape.min));
  Vec3 min = -half, max = half;
  if (!axes.isIdentity(0.0) && !shape.surface.positions.empty()) {
    min = Vec3::Constant(1e300);
    max = -min;
    for (const Vec3 &p : shape.surface.positions) {
      const Vec3 q = axes.transpose() * (p - frame.origin);
      min = min.cwiseMin(q);
      max = max.cwiseMax(q);
    }
  }
  for (int a = 0; a < 3; ++a) {
    const double cells = std::max(1.0, std::ceil((max[a] - min[a]) / spacing - 1e-6));
    frame.n[static_cast<std::size_t>(a)] = static_cast<std::int32_t>(std::min(cells, 1e9));
    frame.low[a] = 0.5 * (min[a] + max[a]) - 0.5 * spacing * cells;
  }
  return frame;
}

Result<void> checkSize(const BodyShape &shape, const Mat3 &axes, double spacing) {
  const Frame frame = frameOver(shape, axes, spacing);
  const double cells = static_cast<double>(frame.n[0]) * frame.n[1] * frame.n[2];
  const double phyxels = shape.volume / (spacing * spacing * spacing);
  const std::int32_t most = std::max({frame.n[0], frame.n[1], frame.n[2]});
  if (phyxels > static_cast<double>(kMaximumPhyxels) || cells > 5e7 || most > 500'000)
    return tl::unexpected<std::string>("a spacing of " + number(spacing) + " m makes about " + number(phyxels) +
                                       " phyxels; at most " + std::to_string(kMaximumPhyxels) +
                                       " are accepted: use a larger spacing");
  return {};
}

}  // namespace pointbased::lattice
