// SPDX-License-Identifier: Apache-2.0
#include "clean_up.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <unordered_map>

#include "mesh_edges.h"
#include "wording.h"

namespace c3de::geometry {
namespace {

double diagonal(const TriangleMesh &mesh) {
  const Box box = boundingBox(mesh);
  return norm(box.max - box.min);
}

/// For every vertex the first one within the tolerance.
std::vector<unsigned> firstNearby(std::span<const Vec3> vertices, const Vec3 &origin, double tolerance) {
  using Cell = std::array<std::int64_t, 3>;
  struct CellHash {
    std::size_t operator()(const Cell &c) const {
      std::uint64_t h = 0;
      for (std::int64_t k : c) h = (h ^ static_cast<std::uint64_t>(k)) * 0x9e3779b97f4a7c15ull;
      return static_cast<std::size_t>(h ^ h >> 32);
    }
  };
  // Cells of four tolerances: a vertex checks the neighbour only when it is close to that side.
  const double size = 4.0 * tolerance;
  std::unordered_multimap<Cell, unsigned, CellHash> cells;
  cells.reserve(vertices.size());
  std::vector<unsigned> first(vertices.size());
  for (unsigned i = 0; i < vertices.size(); ++i) {
    Cell low{}, high{}, own{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = vertices[i][k] - origin[k];
      low[k] = static_cast<std::int64_t>(std::floor((x - tolerance) / size));
      high[k] = static_cast<std::int64_t>(std::floor((x + tolerance) / size));
      own[k] = static_cast<std::int64_t>(std::floor(x / size));
    }
    unsigned found = i;
    for (auto x = low[0]; x <= high[0]; ++x)
      for (auto y = low[1]; y <= high[1]; ++y)
        for (auto z = low[2]; z <= high[2]; ++z) {
          const auto [begin, end] = cells.equal_range(Cell{x, y, z});
          for (auto it = begin; it != end; ++it)
            if (it->second < found && norm(vertices[it->second] - vertices[i]) <= tolerance) found = it->second;
        }
    first[i] = found;
    if (found == i) cells.emplace(own, i);
  }
  return first;
}

}  // namespace

void weldVertices(TriangleMesh &mesh, std::vector<std::string> &repairs) {
  // Equal positions by sorting (almost all of them), then close ones among the remaining vertices.
  std::vector<unsigned> first = firstAtSamePosition(mesh.vertices);
  std::vector<Vec3> distinct;
  std::vector<unsigned> slot(mesh.vertices.size());
  for (unsigned i = 0; i < first.size(); ++i) {
    if (first[i] == i) {
      slot[i] = static_cast<unsigned>(distinct.size());
      distinct.push_back(mesh.vertices[i]);
    } else {
      slot[i] = slot[first[i]];
    }
  }
  const Box box = boundingBox(mesh);
  const double tolerance = kWeldTolerance * norm(box.max - box.min);
  if (tolerance > 0.0) {
    const std::vector<unsigned> near = firstNearby(distinct, box.min, tolerance);
    std::vector<unsigned> compact(distinct.size());
    std::size_t kept = 0;
    for (unsigned i = 0; i < distinct.size(); ++i) {
      if (near[i] == i) {
        compact[i] = static_cast<unsigned>(kept);
        distinct[kept++] = distinct[i];
      } else {
        compact[i] = compact[near[i]];
      }
    }
    distinct.resize(kept);
    for (unsigned &s : slot) s = compact[s];
  }
  const std::size_t welded = mesh.vertices.size() - distinct.size();
  if (welded == 0) return;
  for (Triangle &t : mesh.triangles)
    for (unsigned &v : t) v = slot[v];
  mesh.vertices = std::move(distinct);
  repairs.push_back(
      fmt::format("{} at duplicate positions {} welded", counted(welded, "vertex", "vertices"), wasOrWere(welded)));
}

bool isDegenerate(const TriangleMesh &mesh, const Triangle &t, double diagonal_mm) {
  if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return true;
  const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  const double longest = std::max({norm(b - a), norm(c - b), norm(a - c)});
  return norm(cross(b - a, c - a)) <= kWeldTolerance * diagonal_mm * longest;
}

namespace {

/// Flips the longest side of every triangle on a line; where that is not possible the caller removes the triangle.
std::size_t flipLongestSides(TriangleMesh &mesh, double diagonal_mm) {
  std::size_t flips = 0;
  // A flip can move the degeneracy to the neighbour (a row of corners on one line), hence several rounds.
  for (int round = 0; round < 16; ++round) {
    std::vector<unsigned> flat;
    for (unsigned t = 0; t < mesh.triangles.size(); ++t) {
      const Triangle &corners = mesh.triangles[t];
      if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0] &&
          isDegenerate(mesh, corners, diagonal_mm))
        flat.push_back(t);
    }
    if (flat.empty()) break;
    const std::vector<TriangleSide> sides = sortedSides(mesh.triangles);
    const auto edgeOf = [&](unsigned a, unsigned b) {
      const auto [begin, end] =
          std::equal_range(sides.begin(), sides.end(), TriangleSide{std::min(a, b), std::max(a, b), 0, false},
                           [](const TriangleSide &p, const TriangleSide &q) {
                             return p.low != q.low ? p.low < q.low : p.high < q.high;
                           });
      return std::span<const TriangleSide>(begin, end);
    };
    std::vector<char> touched(mesh.triangles.size(), 0);
    std::size_t flipsNow = 0;
    for (unsigned t : flat) {
      Triangle &own = mesh.triangles[t];
      unsigned k = 0;  // own[k] -> own[k+1] is the longest side, own[k+2] the corner in the middle
      const auto length = [&](unsigned i) { return norm(mesh.vertices[own[(i + 1) % 3]] - mesh.vertices[own[i]]); };
      for (unsigned i = 1; i < 3; ++i)
        if (length(i) > length(k)) k = i;
      const unsigned a = own[k], c = own[(k + 1) % 3], b = own[(k + 2) % 3];
      const auto edge = edgeOf(a, c);
      if (edge.size() != 2) continue;
      const unsigned n = edge[0].triangle == t ? edge[1].triangle : edge[0].triangle;
      if (touched[t] || touched[n] || n == t) continue;
      Triangle &neighbour = mesh.triangles[n];
      unsigned d = a;
      for (unsigned v : neighbour)
        if (v != a && v != c) d = v;
      const bool opposite = edge[0].forward != edge[1].forward;
      if (d == a || d == b || !opposite || !edgeOf(b, d).empty()) continue;
      // own = a c b and neighbour = c a d become a d b and d c b: same outline, side b-d instead of a-c.
      own = {a, d, b};
      neighbour = {d, c, b};
      touched[t] = touched[n] = 1;
      ++flipsNow;
    }
    flips += flipsNow;
    if (flipsNow == 0) break;
  }
  return flips;
}

}  // namespace

void removeDegenerateTriangles(TriangleMesh &mesh, std::vector<std::string> &repairs) {
  const double length = diagonal(mesh);
  const std::size_t all = mesh.triangles.size();
  std::erase_if(mesh.triangles, [](const Triangle &t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  const std::size_t repeated = all - mesh.triangles.size();
  const std::size_t flips = flipLongestSides(mesh, length);
  const std::size_t before = mesh.triangles.size();
  std::erase_if(mesh.triangles, [&](const Triangle &t) { return isDegenerate(mesh, t, length); });
  const std::size_t flat = before - mesh.triangles.size();
  if (repeated)
    repairs.push_back(fmt::format("{} a corner twice {} dropped",
                                  counted(repeated, "triangle that names", "triangles that name"),
                                  wasOrWere(repeated)));
  if (flips)
    repairs.push_back(fmt::format("{} without area (three corners on a line) {} joined with a neighbour",
                                  counted(flips, "triangle", "triangles"), wasOrWere(flips)));
  if (flat)
    repairs.push_back(
        fmt::format("{} without area {} dropped", counted(flat, "triangle", "triangles"), wasOrWere(flat)));
}

/// A triangle, for comparison with others that have the same corners.
struct Copy {
  Triangle sorted;
  unsigned triangle;
  bool even;  ///< has the orientation of the sorted corners
};

/// Difference between the numbers of triangles of either orientation.
int netOf(std::span<const Copy> group) {
  int net = 0;
  for (const Copy &copy : group) net += copy.even ? 1 : -1;
  return net;
}

/// All triangles, ordered so that those with the same corners are adjacent.
std::vector<Copy> sortedCopies(const TriangleMesh &mesh) {
  std::vector<Copy> copies(mesh.triangles.size());
  for (unsigned t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle &c = mesh.triangles[t];
    Triangle s = c;
    std::sort(s.begin(), s.end());
    const bool even =
        (c[0] == s[0] && c[1] == s[1]) || (c[1] == s[0] && c[2] == s[1]) || (c[2] == s[0] && c[0] == s[1]);
    copies[t] = {s, t, even};
  }
  std::sort(copies.begin(), copies.end(), [](const Copy &a, const Copy &b) {
    return a.sorted != b.sorted ? a.sorted < b.sorted : a.triangle < b.triangle;
  });
  return copies;
}

/// Groups of several triangles with the same corners.
std::vector<std::span<const Copy>> groupsOf(std::span<const Copy> copies) {
  std::vector<std::span<const Copy>> groups;
  for (std::size_t begin = 0, end = 0; begin < copies.size(); begin = end) {
    while (end < copies.size() && copies[end].sorted == copies[begin].sorted) ++end;
    if (end - begin > 1) groups.push_back(copies.subspan(begin, end - begin));
  }
  return groups;
}

void removeDuplicateTriangles(TriangleMesh &mesh, std::vector<std::string> &repairs) {
  const std::vector<Copy> all = sortedCopies(mesh);
  const std::vector<std::span<const Copy>> groups = groupsOf(all);
  if (groups.empty()) return;
  std::size_t cancelling = 0;
  for (const auto &group : groups)
    if (netOf(group) == 0) cancelling += group.size();

  const bool twoSided = 2 * cancelling > mesh.triangles.size();
  std::vector<char> drop(mesh.triangles.size(), 0);
  std::size_t copies = 0, opposite = 0;
  for (const auto &group : groups) {
    const int net = netOf(group);
    const Copy *keep = nullptr;
    if (net != 0 || twoSided)
      for (const Copy &copy : group)
        if (!keep && (net == 0 || copy.even == (net > 0))) keep = &copy;
    for (const Copy &copy : group)
      if (&copy != keep) {
        drop[copy.triangle] = 1;
        ++(keep ? copies : opposite);
      }
  }
  std::size_t index = 0;
  std::erase_if(mesh.triangles, [&](const Triangle &) { return drop[index++] != 0; });
  if (copies)
    repairs.push_back(
        twoSided
            ? fmt::format("{} back sides of a surface in which every triangle came twice were dropped", copies)
            : fmt::format("{} {} dropped", counted(copies, "copy of another triangle", "copies of other triangles"),
                          wasOrWere(copies)));
  if (opposite)
    repairs.push_back(fmt::format("{} coincident triangles of opposite orientation were removed", opposite));
}

void removeUnusedVertices(TriangleMesh &mesh, std::vector<std::string> &repairs) {
  constexpr unsigned kUnused = std::numeric_limits<unsigned>::max();
  std::vector<unsigned> slot(mesh.vertices.size(), kUnused);
  for (const Triangle &t : mesh.triangles)
    for (unsigned v : t) slot[v] = 0;
  unsigned kept = 0;
  for (std::size_t v = 0; v < slot.size(); ++v)
    if (slot[v] != kUnused) {
      mesh.vertices[kept] = mesh.vertices[v];
      slot[v] = kept++;
    }
  const std::size_t dropped = mesh.vertices.size() - kept;
  mesh.vertices.resize(kept);
  for (Triangle &t : mesh.triangles)
    for (unsigned &v : t) v = slot[v];
  if (dropped)
    repairs.push_back(
        fmt::format("{} that no triangle uses {} dropped", counted(dropped, "vertex", "vertices"), wasOrWere(dropped)));
}

}  // namespace c3de::geometry
