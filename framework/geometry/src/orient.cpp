// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "c3de/geometry/winding_number.h"
#include "clean_up.h"
#include "mesh_edges.h"
#include "wording.h"

namespace c3de::geometry {
namespace {

void flip(Triangle &t) { std::swap(t[1], t[2]); }

double triangleArea(const TriangleMesh &mesh, const Triangle &t) {
  return 0.5 * norm(cross(mesh.vertices[t[1]] - mesh.vertices[t[0]], mesh.vertices[t[2]] - mesh.vertices[t[0]]));
}

/// Triangles that share an edge with no third one, in CSR; empty if all are consistently oriented.
struct Neighbours {
  struct Other {
    unsigned triangle;
    bool agrees;  ///< has the same orientation
  };
  std::vector<std::size_t> begin;
  std::vector<Other> others;
  bool allAgree = true;

  [[nodiscard]] std::span<const Other> of(unsigned t) const {
    return std::span(others).subspan(begin[t], begin[t + 1] - begin[t]);
  }
};

Neighbours neighboursOf(const TriangleMesh &mesh) {
  struct Link {
    unsigned a, b;
    bool agree;
  };
  std::vector<Link> links;
  Neighbours out;
  forEachEdge(sortedSides(mesh.triangles), [&](std::span<const TriangleSide> edge) {
    if (edge.size() != 2 || edge[0].triangle == edge[1].triangle) return;
    const bool agree = edge[0].forward != edge[1].forward;
    out.allAgree &= agree;
    links.push_back({edge[0].triangle, edge[1].triangle, agree});
  });
  if (out.allAgree) return out;
  out.begin.assign(mesh.triangles.size() + 1, 0);
  for (const Link &l : links) ++out.begin[l.a + 1], ++out.begin[l.b + 1];
  for (std::size_t i = 1; i < out.begin.size(); ++i) out.begin[i] += out.begin[i - 1];
  out.others.resize(out.begin.back());
  std::vector<std::size_t> fill(out.begin.begin(), out.begin.end() - 1);
  for (const Link &l : links) {
    out.others[fill[l.a]++] = {l.b, l.agree};
    out.others[fill[l.b]++] = {l.a, l.agree};
  }
  return out;
}

enum Side : signed char { kUnseen = 0, kKeep = 1, kTurn = -1 };

/// A connected patch of triangles, each with the orientation that it needs.
struct Patch {
  std::vector<unsigned> triangles;
  bool isOrientable = true;
  double keepArea = 0.0, turnArea = 0.0;
};

Patch walkPatch(const TriangleMesh &mesh, const Neighbours &neighbours, unsigned seed, std::vector<signed char> &side) {
  Patch patch;
  patch.triangles.assign(1, seed);
  side[seed] = kKeep;
  for (std::size_t i = 0; i < patch.triangles.size(); ++i) {
    const unsigned t = patch.triangles[i];
    (side[t] == kKeep ? patch.keepArea : patch.turnArea) += triangleArea(mesh, mesh.triangles[t]);
    for (const auto [other, agrees] : neighbours.of(t)) {
      const signed char expected = agrees ? side[t] : static_cast<signed char>(-side[t]);
      if (side[other] == kUnseen) {
        side[other] = expected;
        patch.triangles.push_back(other);
      } else if (side[other] != expected) {
        patch.isOrientable = false;
      }
    }
  }
  return patch;
}

/// Traverses edges with two triangles; where a patch can be oriented consistently, flips its smaller part.
void makeConsistent(TriangleMesh &mesh, std::vector<std::string> &repairs) {
  const Neighbours neighbours = neighboursOf(mesh);
  if (neighbours.allAgree) return;
  std::vector<signed char> side(mesh.triangles.size(), kUnseen);
  std::size_t turned = 0, oneSided = 0;
  for (unsigned seed = 0; seed < side.size(); ++seed) {
    if (side[seed] != kUnseen) continue;
    const Patch patch = walkPatch(mesh, neighbours, seed, side);
    if (!patch.isOrientable) {
      ++oneSided;
      continue;
    }
    const signed char toTurn = patch.turnArea <= patch.keepArea ? kTurn : kKeep;
    for (const unsigned t : patch.triangles)
      if (side[t] == toTurn) {
        flip(mesh.triangles[t]);
        ++turned;
      }
  }
  if (turned)
    repairs.push_back(fmt::format("{} oriented opposite to their neighbours {} flipped",
                                  counted(turned, "triangle", "triangles"), wasOrWere(turned)));
  if (oneSided)
    repairs.push_back(fmt::format("{} with a single side (like a Moebius strip) {} left as found",
                                  counted(oneSided, "part", "parts"), wasOrWere(oneSided)));
}

/// A part of the surface connected by edges.
struct Part {
  TriangleMesh mesh;  ///< its triangles with its own vertices
  std::vector<unsigned> triangles;
  Box box;
  Vec3 sample{};  ///< a point of the surface
  double volume_mm3 = 0.0;
  bool bounds = false;  ///< closed, or nearly so: it has an inside
  std::optional<WindingNumber> winding;
};

bool contains(const Box &outer, const Vec3 &p) {
  for (std::size_t k = 0; k < 3; ++k)
    if (p[k] < outer.min[k] || p[k] > outer.max[k]) return false;
  return true;
}

std::vector<Part> splitIntoParts(const TriangleMesh &mesh) {
  const std::vector<TriangleSide> sides = sortedSides(mesh.triangles);
  DisjointSets sets(mesh.triangles.size());
  forEachEdge(sides, [&](std::span<const TriangleSide> edge) {
    for (const TriangleSide &s : edge.subspan(1)) sets.join(edge.front().triangle, s.triangle);
  });
  std::vector<unsigned> group;
  std::vector<Part> parts(sets.number(group));
  for (unsigned t = 0; t < mesh.triangles.size(); ++t) parts[group[t]].triangles.push_back(t);
  std::vector<char> balanced(parts.size(), 1);
  forEachEdge(sides, [&](std::span<const TriangleSide> edge) {
    if (!isBalanced(edge)) balanced[group[edge.front().triangle]] = 0;
  });
  std::vector<unsigned> slot(mesh.vertices.size(), 0xffffffffu);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    Part &part = parts[p];
    double largest = -1.0;
    for (unsigned t : part.triangles) {
      Triangle own{};
      for (std::size_t k = 0; k < 3; ++k) {
        unsigned &s = slot[mesh.triangles[t][k]];
        if (s == 0xffffffffu) {
          s = static_cast<unsigned>(part.mesh.vertices.size());
          part.mesh.vertices.push_back(mesh.vertices[mesh.triangles[t][k]]);
        }
        own[k] = s;
      }
      part.mesh.triangles.push_back(own);
      if (const double area = triangleArea(part.mesh, own); area > largest) {
        largest = area;
        part.sample =
            (1.0 / 3.0) * (part.mesh.vertices[own[0]] + part.mesh.vertices[own[1]] + part.mesh.vertices[own[2]]);
      }
    }
    for (unsigned t : part.triangles)
      for (unsigned v : mesh.triangles[t]) slot[v] = 0xffffffffu;
    part.box = boundingBox(part.mesh);
    part.volume_mm3 = signedVolume(part.mesh);
    part.bounds = balanced[p] != 0;
    if (!part.bounds) {
      const auto holes = findHoles(part.mesh, sortedSides(part.mesh.triangles));
      part.bounds = holeShare(holes, surfaceArea(part.mesh)) <= kMaxHoleShare;
    }
  }
  return parts;
}

void turnOutwards(TriangleMesh &mesh, std::vector<std::string> &repairs) {
  std::vector<Part> parts = splitIntoParts(mesh);
  std::vector<char> outermost(parts.size(), 1), turn(parts.size(), 0);
  std::vector<std::size_t> bounding;
  for (std::size_t j = 0; j < parts.size(); ++j)
    if (parts[j].bounds) bounding.push_back(j);
  // holders[i]: parts that enclose part i
  std::vector<std::vector<std::size_t>> holders(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (std::size_t j : bounding) {
      if (i == j || !contains(parts[j].box, parts[i].sample)) continue;
      if (!parts[j].winding) parts[j].winding.emplace(parts[j].mesh);
      if (std::abs(parts[j].winding->at(parts[i].sample)) > 0.5) {
        holders[i].push_back(j);
        outermost[i] = 0;
      }
    }
  for (std::size_t i = 0; i < parts.size(); ++i) turn[i] = outermost[i] && parts[i].bounds && parts[i].volume_mm3 < 0.0;
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (std::size_t j : holders[i])
      if (outermost[j] && turn[j]) turn[i] = 1;
  std::size_t turnedParts = 0, turnedTriangles = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!turn[i]) continue;
    ++turnedParts;
    turnedTriangles += parts[i].triangles.size();
    for (unsigned t : parts[i].triangles) flip(mesh.triangles[t]);
  }
  if (turnedParts)
    repairs.push_back(
        parts.size() == 1
            ? "the surface was inside out; all triangles were flipped"
            : fmt::format("{} of {} parts of the surface were inside out; their {} triangles were flipped", turnedParts,
                          parts.size(), turnedTriangles));
}

}  // namespace

void orient(TriangleMesh &mesh, std::vector<std::string> &repairs) {
  makeConsistent(mesh, repairs);
  turnOutwards(mesh, repairs);
}

}  // namespace c3de::geometry
