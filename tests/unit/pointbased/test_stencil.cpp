// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>

#include "pointbased/neighborhood.h"
#include "pointbased/stencil.h"
#include "shapes.h"
#include "support/catch.h"

using namespace pointbased;

namespace {

std::vector<Vec3> jitteredLattice(int n, double spacing, double jitter) {
  shapes::Random random(7);
  std::vector<Vec3> points;
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) points.push_back(spacing * (Vec3(x, y, z) + jitter * random.vector()));
  return points;
}

}  // namespace

TEST_CASE("neighbourhoods are symmetric and contain the chosen number") {
  const auto points = jitteredLattice(6, 0.01, 0.3);
  for (const NeighborChoice choice : {NeighborChoice{20, 1.8}, NeighborChoice{0, 2.2}}) {
    const Neighborhoods found = findNeighborhoods(points, choice, 0.01, serialFor());
    std::set<std::pair<Index, Index>> pairs;
    for (Index i = 0; i < points.size(); ++i) {
      const std::size_t count = found.neighbors.offsets[i + 1] - found.neighbors.offsets[i];
      if (choice.count > 0) CHECK(count >= 20);
      for (Index k = found.neighbors.offsets[i]; k < found.neighbors.offsets[i + 1]; ++k) {
        CHECK(found.neighbors.indices[k] != i);
        pairs.insert({i, found.neighbors.indices[k]});
      }
    }
    for (const auto &[i, j] : pairs) CHECK(pairs.count({j, i}) == 1);
  }
}

TEST_CASE("the farthest chosen shell of a lattice keeps a weight") {
  const auto points = jitteredLattice(7, 0.01, 0.0);
  const Neighborhoods found = findNeighborhoods(points, {6, 1.8}, 0.01, serialFor());
  const Index middle = 3 * 49 + 3 * 7 + 3;
  CHECK(found.neighbors.offsets[middle + 1] - found.neighbors.offsets[middle] == 6);
  CHECK(kernelWeight(0.01, found.supportRadii[middle]) > 0.0);
}

TEST_CASE("gradient stencils sum to zero and reproduce affine fields exactly") {
  for (const double scale : {1.0, 1000.0}) {  // metres and millimetres: no cut-off may depend on the unit
    const auto points = jitteredLattice(6, 0.01 * scale, 0.25);
    const Neighborhoods found = findNeighborhoods(points, {26, 1.8}, 0.01 * scale, serialFor());
    const std::vector<double> volumes(points.size(), 1e-6);
    const StencilSet s = buildPhyxelStencils(points, found.neighbors, found.supportRadii, volumes, serialFor());
    for (std::size_t q = 0; q < s.pointCount(); ++q) {
      Vec3 sum = Vec3::Zero();
      Mat3 moment = Mat3::Zero();
      for (Index e = s.phyxels.offsets[q]; e < s.phyxels.offsets[q + 1]; ++e) {
        sum += s.gradients[e];
        moment += points[s.phyxels.indices[e]] * s.gradients[e].transpose();
      }
      CHECK(s.rank[q] == 3);
      CHECK(sum.norm() * 0.01 * scale < 1e-12);
      CHECK((moment - Mat3::Identity()).norm() < 1e-11);
    }
  }
}

TEST_CASE("flat, straight and single neighbourhoods are recognised") {
  std::vector<Vec3> plane, line;
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 6; ++x) plane.push_back(0.01 * Vec3(x, y, 0.3 * x));
  for (int x = 0; x < 9; ++x) line.push_back(0.01 * Vec3(x, 0.5 * x, -x));
  const auto rankOf = [](const std::vector<Vec3> &points) {
    const auto rest = shapes::restState(points, 0.012, {8, 1.8});
    return *std::max_element(rest->stencils.rank.begin(), rest->stencils.rank.end());
  };
  CHECK(rankOf(plane) == 2);
  CHECK(rankOf(line) == 1);
  CHECK(rankOf(std::vector<Vec3>{Vec3(1, 2, 3)}) == 0);
}

TEST_CASE("the gather lists hold every entry once, by phyxel") {
  const auto rest = shapes::restState(shapes::ball(Vec3(0, 0, 0), 0.05), 0.015);
  const StencilSet &s = rest->stencils;
  std::vector<int> seen(s.phyxels.indices.size(), 0);
  for (std::size_t j = 0; j < rest->phyxelCount(); ++j)
    for (Index k = s.entriesOfPhyxel.offsets[j]; k < s.entriesOfPhyxel.offsets[j + 1]; ++k) {
      const Index e = s.entriesOfPhyxel.indices[k];
      CHECK(s.phyxels.indices[e] == j);
      ++seen[e];
    }
  CHECK(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }));
}
