// SPDX-License-Identifier: Apache-2.0
#include "discretisation/lattice/lattice_jitter.h"

#include <Eigen/LU>

namespace pointbased::lattice {
namespace {

// SplitMix64 of a counter: the same numbers on every machine.
double randomOf(std::uint64_t seed, std::uint64_t counter) {
  std::uint64_t z = seed * 0x9e3779b97f4a7c15ull + (counter + 1) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ z >> 27) * 0x94d049bb133111ebull;
  z ^= z >> 31;
  return static_cast<double>(z >> 11) / static_cast<double>(1ull << 52) - 1.0;
}

}  // namespace

void jitterPhyxels(LatticeCellMap &map, std::span<const PartContent> contents, double jitter, std::uint64_t seed) {
  const CellSet &set = map.set();
  const NodeTable &corners = map.corners();
  std::vector<std::uint8_t> fullCells(corners.positions.size(), 0), others(corners.positions.size(), 0);
  for (std::size_t p = 0; p < map.parts().size(); ++p) {
    const CutCellFragment &part = map.parts()[p];
    if (!part.kept) continue;
    const bool full = set.cells[part.cell].samples == kNone && set.cells[part.cell].size == set.frame.finest() &&
                      !contents[p].touched;
    for (const Index node : part.nodes)
      for (std::uint32_t e = corners.offsets[node]; e < corners.offsets[node + 1]; ++e)
        if (full)
          ++fullCells[corners.phyxels[e]];
        else
          others[corners.phyxels[e]] = 1;
  }
  std::vector<Vec3> positions = corners.positions;
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (fullCells[i] == 8 && others[i] == 0)
      for (int a = 0; a < 3; ++a)
        positions[i][a] += jitter * set.frame.spacing * randomOf(seed, 3 * i + static_cast<std::size_t>(a));
  std::vector<std::uint8_t> distorted(set.cells.size(), 0);
  for (const CutCellFragment &part : map.parts()) {
    if (!part.kept) continue;
    for (const Index node : part.nodes)
      for (std::uint32_t e = corners.offsets[node]; e < corners.offsets[node + 1]; ++e)
        if (fullCells[corners.phyxels[e]] == 8 && others[corners.phyxels[e]] == 0) distorted[part.cell] = 1;
  }
  map.move(std::move(positions), std::move(distorted));
}

HexahedronMeans meansOf(const std::array<Vec3, 8> &corners) {
  HexahedronMeans means;
  means.gradients.fill(Vec3::Zero());
  Vec3 second = Vec3::Zero();
  const double at = 0.5 / std::sqrt(3.0);
  for (int g = 0; g < 8; ++g) {
    const Vec3 place = at * Vec3(cornerSign(g, 0), cornerSign(g, 1), cornerSign(g, 2));
    const std::array<double, 8> functions = trilinear(place);
    const std::array<Vec3, 8> gradients = trilinearGradients(place);
    Vec3 x = Vec3::Zero();
    Mat3 jacobian = Mat3::Zero();
    for (std::size_t j = 0; j < 8; ++j) {
      x += functions[j] * corners[j];
      jacobian += corners[j] * gradients[j].transpose();
    }
    const double volume = 0.125 * jacobian.determinant();
    const Mat3 inverse = jacobian.inverse().transpose();
    means.volume += volume;
    means.centroid += volume * x;
    second += volume * x.cwiseAbs2();
    for (std::size_t j = 0; j < 8; ++j) {
      means.functions[j] += volume * functions[j];
      means.gradients[j] += volume * (inverse * gradients[j]);
    }
  }
  means.centroid /= means.volume;
  means.variance = (second / means.volume - means.centroid.cwiseAbs2()).cwiseMax(0.0);
  for (std::size_t j = 0; j < 8; ++j) {
    means.functions[j] /= means.volume;
    means.gradients[j] /= means.volume;
  }
  return means;
}

}  // namespace pointbased::lattice
