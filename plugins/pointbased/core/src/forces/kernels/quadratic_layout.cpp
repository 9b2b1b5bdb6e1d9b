// SPDX-License-Identifier: Apache-2.0
#include "forces/kernels/quadratic_layout.h"

#include <algorithm>

#include "pointbased/engine.h"

namespace pointbased::kernels {
namespace {

// Numbers of one cell, in the order of QuadraticNumber.
std::array<double, kQuadraticNumbers> quadraticNumbers(const StencilSet &s, std::size_t q,
                                                       const QuadraticPoints::Point &point) {
  const CellShape &shape = point.corners;
  const double edge = 0.25 / shape.gradient;
  std::array<double, kQuadraticNumbers> n{};
  n[kTriple] = 2.0 * point.triple / edge;
  const double volume = 4.0 * s.volumes[q] / (edge * edge * kLatticeStabilisation);
  for (int a = 0; a < 3; ++a) {
    const auto k = static_cast<std::size_t>(a);
    n[kSquare + k] = -(1.0 - 4.0 * point.second[a]) / (8.0 * edge);
    for (int side = 0; side < 2; ++side) {
      const int across = (a + 1 + side) % 3;
      // <i> = 2 h f_i
      n[kCubic + 2 * k + static_cast<std::size_t>(side)] =
          -(2.0 * edge * shape.first[across] - 4.0 * point.cubic(a, across)) / (4.0 * edge);
    }
    n[kCovariance + k] = volume * point.covariance(a, a);
  }
  n[kCovariance + 3] = volume * point.covariance(0, 1);
  n[kCovariance + 4] = volume * point.covariance(0, 2);
  n[kCovariance + 5] = volume * point.covariance(1, 2);
  return n;
}

// Edges of the points of a chunk, ascending.
std::vector<Index> edgesOf(const StencilSet &s, std::span<const Index> points) {
  std::vector<Index> out;
  for (const Index q : points)
    for (const Index edge : s.quadratic.find(q)->edges)
      if (edge != QuadraticPoints::kNone) out.push_back(edge);
  std::ranges::sort(out);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

template <class T>
void addRow(const QuadraticPoints &quadratic, Index edge, std::span<const Index> phyxels, QuadraticSlices<T> &out) {
  const std::span<const Index> row = quadratic.edgePhyxels.row(edge);
  const Index first = quadratic.edgePhyxels.offsets[edge];
  for (std::size_t k = 0; k < kOfEdge; ++k) {
    // Rows at an end have three phyxels.
    const Index phyxel = row[k < row.size() ? k : 0];
    out.rows.push_back(static_cast<std::uint16_t>(std::ranges::lower_bound(phyxels, phyxel) - phyxels.begin()));
    out.weights.push_back(static_cast<T>(k < row.size() ? -4.0 * quadratic.edgeWeights[first + k] : 0.0));
  }
}

}  // namespace

CellPlan planQuadraticCells(const StencilSet &s, std::size_t lanes, std::span<const std::uint8_t> suits,
                            std::vector<Index> &others) {
  CellPlan plan;
  std::vector<std::vector<Index>> byMaterial(suits.size());
  for (const Index q : others) {
    const std::size_t material = s.materials.empty() ? 0 : s.materials[q];
    if (s.quadratic.find(q) != nullptr && s.rank[q] == 3 && suits[material] != 0)
      byMaterial[material].push_back(q);
    else
      plan.others.push_back(q);
  }
  others = plan.others;
  for (std::size_t m = 0; m < byMaterial.size(); ++m)
    addSlices(byMaterial[m], static_cast<std::uint16_t>(m), lanes, plan);
  return plan;
}

template <class T>
QuadraticSlices<T> sliceQuadraticCells(const StencilSet &s, const CellPlan &plan, const ParallelFor &parallelFor) {
  constexpr std::size_t kSlice = kLanes<T>;
  QuadraticSlices<T> out;
  out.cells = sliceCells<T>(s, plan, parallelFor);
  out.edges.resize(plan.points.size() * kCellEdges);
  out.numbers.resize(plan.points.size() * kQuadraticNumbers);
  for (std::size_t chunk = 0; chunk < out.cells.chunks(); ++chunk) {
    const std::size_t begin = chunk * kChunkSlices<T>, end = std::min(out.cells.count(), begin + kChunkSlices<T>);
    const std::vector<Index> edges = edgesOf(s, std::span(plan.points).subspan(begin * kSlice, (end - begin) * kSlice));
    const std::span<const Index> phyxels =
        std::span(out.cells.phyxels)
            .subspan(out.cells.firstLocals[chunk], out.cells.firstLocals[chunk + 1] - out.cells.firstLocals[chunk]);
    for (const Index edge : edges) addRow(s.quadratic, edge, phyxels, out);
    out.firstEdges.push_back(static_cast<Index>(out.rows.size() / kOfEdge));
    for (std::size_t slice = begin; slice < end; ++slice)
      for (std::size_t lane = 0; lane < kSlice; ++lane) {
        const Index q = plan.points[slice * kSlice + lane];
        const QuadraticPoints::Point &point = *s.quadratic.find(q);
        for (std::size_t e = 0; e < kCellEdges; ++e) {
          const std::size_t at =
              point.edges[e] == QuadraticPoints::kNone
                  ? edges.size()
                  : static_cast<std::size_t>(std::ranges::lower_bound(edges, point.edges[e]) - edges.begin());
          out.edges[(slice * kCellEdges + e) * kSlice + lane] = static_cast<std::uint16_t>(phyxels.size() + at);
        }
        const std::array<double, kQuadraticNumbers> n = quadraticNumbers(s, q, point);
        for (std::size_t k = 0; k < kQuadraticNumbers; ++k)
          out.numbers[(slice * kQuadraticNumbers + k) * kSlice + lane] =
              static_cast<T>(k >= kCovariance && lane >= plan.used[slice] ? 0.0 : n[k]);
      }
  }
  return out;
}

template QuadraticSlices<float> sliceQuadraticCells<float>(const StencilSet &, const CellPlan &, const ParallelFor &);
template QuadraticSlices<double> sliceQuadraticCells<double>(const StencilSet &, const CellPlan &, const ParallelFor &);

}  // namespace pointbased::kernels
