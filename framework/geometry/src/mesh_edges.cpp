// SPDX-License-Identifier: Apache-2.0
#include "mesh_edges.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace c3de::geometry {

std::vector<TriangleSide> sortedSides(std::span<const Triangle> triangles) {
  std::vector<TriangleSide> sides;
  sides.reserve(3 * triangles.size());
  for (unsigned t = 0; t < triangles.size(); ++t)
    for (unsigned k = 0; k < 3; ++k) {
      const unsigned a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      if (a != b) sides.push_back({std::min(a, b), std::max(a, b), t, a < b});
    }
  std::sort(sides.begin(), sides.end(), [](const TriangleSide &a, const TriangleSide &b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  return sides;
}

bool isBalanced(std::span<const TriangleSide> edge) {
  const auto forward = std::count_if(edge.begin(), edge.end(), [](const TriangleSide &s) { return s.forward; });
  return 2 * static_cast<std::size_t>(forward) == edge.size();
}

DisjointSets::DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }

unsigned DisjointSets::find(unsigned i) {
  while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
  return i;
}

void DisjointSets::join(unsigned i, unsigned j) {
  i = find(i);
  j = find(j);
  parent_[std::max(i, j)] = std::min(i, j);
}

std::size_t DisjointSets::number(std::vector<unsigned> &group) {
  // The root of a group is its smallest member, so it gets its number before the other members need it.
  group.resize(parent_.size());
  unsigned count = 0;
  for (unsigned i = 0; i < parent_.size(); ++i) group[i] = find(i) == i ? count++ : group[find(i)];
  return count;
}

std::vector<unsigned> firstAtSamePosition(std::span<const Vec3> vertices) {
  std::vector<unsigned> order(vertices.size()), first(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](unsigned a, unsigned b) { return vertices[a] != vertices[b] ? vertices[a] < vertices[b] : a < b; });
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && vertices[order[i]] == vertices[order[i - 1]] ? first[order[i - 1]] : order[i];
  return first;
}

std::vector<Hole> findHoles(const TriangleMesh &mesh, std::span<const TriangleSide> sides) {
  std::vector<TriangleSide> rim;
  forEachEdge(sides, [&](std::span<const TriangleSide> edge) {
    if (edge.size() % 2 == 1) rim.push_back(edge.front());
  });
  if (rim.empty()) return {};
  DisjointSets sets(mesh.vertices.size());
  for (const TriangleSide &s : rim) sets.join(s.low, s.high);
  std::vector<unsigned> group;
  sets.number(group);
  std::vector<std::size_t> holeOf(mesh.vertices.size(), mesh.vertices.size());
  std::vector<Hole> holes;
  for (const TriangleSide &s : rim) {
    std::size_t &h = holeOf[group[s.low]];
    if (h == mesh.vertices.size()) {
      h = holes.size();
      holes.emplace_back();
    }
    Hole &hole = holes[h];
    ++hole.edges;
    hole.perimeter_mm += norm(mesh.vertices[s.high] - mesh.vertices[s.low]);
    hole.centre = hole.centre + mesh.vertices[s.low] + mesh.vertices[s.high];
  }
  for (Hole &hole : holes) hole.centre = (0.5 / static_cast<double>(hole.edges)) * hole.centre;
  for (const TriangleSide &s : rim) {
    Hole &hole = holes[holeOf[group[s.low]]];
    hole.area_mm2 += 0.5 * norm(cross(mesh.vertices[s.low] - hole.centre, mesh.vertices[s.high] - hole.centre));
  }
  std::stable_sort(holes.begin(), holes.end(), [](const Hole &a, const Hole &b) { return a.area_mm2 > b.area_mm2; });
  return holes;
}

double holeShare(std::span<const Hole> holes, double area_mm2) {
  double sum = 0.0;
  for (const Hole &hole : holes) sum += hole.area_mm2;
  return area_mm2 + sum > 0.0 ? sum / (area_mm2 + sum) : 1.0;
}

}  // namespace c3de::geometry
