// SPDX-License-Identifier: Apache-2.0
#include "lattice.h"

#include <limits>
#include <map>

#include "scene_input.h"

namespace mass_spring {
namespace {

constexpr std::int64_t kMaxCells = 4000000;  // of the box around the body
constexpr std::size_t kMaxTriangles = 200000;
constexpr int kSamples = 3;  // along each edge of a cell, for the part of it that is filled

}  // namespace

Lattice::Lattice(const Surface &surface, double spacing_m, const Inside &inside, const sdk::Progress &progress)
    : spacing_(spacing_m) {
  double boxed = 1.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double cells = std::max(1.0, std::ceil((surface.max[a] - surface.min[a]) / spacing_ - 1e-6));
    boxed *= cells;
    if (!(boxed <= static_cast<double>(kMaxCells)))
      throw sdk::Error(C3DE_E_ARG, "sampling.spacing = " + shown(spacing_) + " m makes more than " +
                                       std::to_string(kMaxCells) + " cells around the body; accepted: a larger one");
    counts_[a] = static_cast<std::int64_t>(cells);
    origin_[a] = 0.5 * (surface.min[a] + surface.max[a] - cells * spacing_);
  }
  cellAt_.assign(static_cast<std::size_t>(boxed), -1);
  const auto [nx, ny, nz] = counts_;
  std::map<std::int64_t, std::uint32_t> nodeAt;
  std::vector<Vec3> points;
  for (std::int64_t k = 0; k < nz; ++k)
    for (std::int64_t j = 0; j < ny; ++j) {
      if (!progress.update(static_cast<double>(k * ny + j) / static_cast<double>(nz * ny), "filling the body"))
        throw sdk::Error(C3DE_E_CANCELLED, "cancelled");
      points.clear();
      for (std::int64_t i = 0; i < nx; ++i)
        for (int s = 0; s < kSamples * kSamples * kSamples; ++s) {
          const std::array<double, 3> at{static_cast<double>(i) + (s % kSamples + 0.5) / kSamples,
                                         static_cast<double>(j) + (s / kSamples % kSamples + 0.5) / kSamples,
                                         static_cast<double>(k) + (s / kSamples / kSamples + 0.5) / kSamples};
          points.push_back(origin_ + spacing_ * at);
        }
      const std::vector<double> winding = inside(points);
      for (std::int64_t i = 0; i < nx; ++i) {
        constexpr std::size_t kPerCell = kSamples * kSamples * kSamples;
        std::size_t filled = 0;
        for (std::size_t s = 0; s < kPerCell; ++s)
          filled += winding[static_cast<std::size_t>(i) * kPerCell + s] > 0.5 ? 1u : 0u;
        if (filled == 0) continue;
        Cell cell;
        cell.low = origin_ + spacing_ * Vec3{double(i), double(j), double(k)};
        cell.filled = static_cast<double>(filled) / static_cast<double>(kPerCell);
        for (std::int64_t corner = 0; corner < 8; ++corner) {
          const std::int64_t x = i + (corner & 1), y = j + (corner >> 1 & 1), z = k + (corner >> 2);
          const auto [node, isNew] =
              nodeAt.try_emplace((z * (ny + 1) + y) * (nx + 1) + x, static_cast<std::uint32_t>(nodes_.size()));
          if (isNew) nodes_.push_back(origin_ + spacing_ * Vec3{double(x), double(y), double(z)});
          cell.nodes[static_cast<std::size_t>(corner)] = node->second;
        }
        cellAt_[static_cast<std::size_t>((k * ny + j) * nx + i)] = static_cast<std::int32_t>(cells_.size());
        cells_.push_back(cell);
      }
    }
  if (cells_.empty())
    throw sdk::Error(C3DE_E_ARG, "sampling.spacing = " + shown(spacing_) +
                                     " m finds nothing of the body; accepted: at most its thickness");
}

double Lattice::distance(const Cell &cell, const Vec3 &point) const {
  Vec3 beyond{};
  for (std::size_t a = 0; a < 3; ++a)
    beyond[a] = std::max({cell.low[a] - point[a], point[a] - cell.low[a] - spacing_, 0.0});
  return length(beyond);
}

Bound Lattice::bind(const Vec3 &point, double *off) const {
  const Cell *nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  const auto consider = [&](const Cell &cell) {
    if (const double d = distance(cell, point); d < least) {
      least = d;
      nearest = &cell;
    }
  };
  std::array<std::int64_t, 3> at{};
  for (std::size_t a = 0; a < 3; ++a)
    at[a] = static_cast<std::int64_t>(
        std::clamp(std::floor((point[a] - origin_[a]) / spacing_), 0.0, static_cast<double>(counts_[a] - 1)));
  for (std::int64_t n = 0; n < 27; ++n) {
    const std::int64_t i = at[0] + n % 3 - 1, j = at[1] + n / 3 % 3 - 1, k = at[2] + n / 9 - 1;
    if (i < 0 || j < 0 || k < 0 || i >= counts_[0] || j >= counts_[1] || k >= counts_[2]) continue;
    const std::int32_t cell = cellAt_[static_cast<std::size_t>((k * counts_[1] + j) * counts_[0] + i)];
    if (cell >= 0) consider(cells_[static_cast<std::size_t>(cell)]);
  }
  if (nearest == nullptr)
    for (const Cell &cell : cells_) consider(cell);
  if (off != nullptr) *off = least;
  Bound bound;
  bound.nodes.assign(nearest->nodes.begin(), nearest->nodes.end());
  bound.weights.resize(8);
  const Vec3 t = (1.0 / spacing_) * (point - nearest->low);
  for (std::size_t corner = 0; corner < 8; ++corner)
    bound.weights[corner] = ((corner & 1) != 0 ? t[0] : 1.0 - t[0]) * ((corner & 2) != 0 ? t[1] : 1.0 - t[1]) *
                            ((corner & 4) != 0 ? t[2] : 1.0 - t[2]);
  return bound;
}

Surface refined(Surface surface, double longest_m) {
  for (;;) {
    double longest = 0.0;
    for (const auto &t : surface.triangles)
      for (std::size_t e = 0; e < 3; ++e)
        longest = std::max(longest, length(surface.vertices[t[e]] - surface.vertices[t[(e + 1) % 3]]));
    if (longest <= longest_m || 4 * surface.triangles.size() > kMaxTriangles) return surface;
    // Every triangle into four, so that no cracks open.
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [found, isNew] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(surface.vertices.size()));
      if (isNew) surface.vertices.push_back(0.5 * (surface.vertices[a] + surface.vertices[b]));
      return found->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    finer.reserve(4 * surface.triangles.size());
    for (const auto &[a, b, c] : surface.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    surface.triangles = std::move(finer);
  }
}

}  // namespace mass_spring
