// SPDX-License-Identifier: Apache-2.0
#include "surface/edit_mesh.h"

#include <algorithm>

namespace c3de::imaging {
namespace {

// Six times the volume of the tetrahedron between o and the triangle (a, b, c).
double volume6(const Vec3 &o, const Vec3 &a, const Vec3 &b, const Vec3 &c) { return dot(a - o, cross(b - o, c - o)); }

}  // namespace

EditMesh::EditMesh(std::vector<Vec3> points_, std::span<const Triangle> triangles, std::vector<unsigned> twins)
    : points(std::move(points_)), twins_(std::move(twins)) {
  corners_.reserve(3 * triangles.size());
  for (const Triangle &t : triangles) corners_.insert(corners_.end(), t.begin(), t.end());
  splitFans();
  splitDoubleEdges();
}

void EditMesh::splitFans() {
  const std::size_t before = points.size();
  leaving_.assign(before, kNone);
  tags.assign(before, 0);
  owed.assign(before, 0.0);
  std::vector<std::uint8_t> seen(corners_.size(), 0);
  for (unsigned h = 0; h < corners_.size(); ++h) {
    if (seen[h] != 0) continue;
    unsigned v = corners_[h];
    if (leaving_[v] != kNone) {
      points.push_back(points[v]);
      tags.push_back(0);
      owed.push_back(0.0);
      leaving_.push_back(kNone);
      v = static_cast<unsigned>(points.size() - 1);
    }
    leaving_[v] = h;
    unsigned g = h;
    do {
      seen[g] = 1;
      corners_[g] = v;
      g = twins_[previous(g)];
    } while (g != h);
  }
}

void EditMesh::splitDoubleEdges() {
  std::vector<std::array<unsigned, 2>> edges;
  edges.reserve(corners_.size() / 2);
  for (unsigned h = 0; h < corners_.size(); ++h)
    if (h < twins_[h]) edges.push_back({std::min(from(h), to(h)), std::max(from(h), to(h))});
  std::sort(edges.begin(), edges.end());
  for (std::size_t e = 1; e < edges.size(); ++e) {
    if (edges[e] != edges[e - 1]) continue;
    // Its number may have changed with an adjacent edge.
    unsigned found = kNone;
    around(edges[e][0], [&](unsigned h) {
      if (to(h) == edges[e][1]) found = h;
    });
    split(found);
  }
}

std::size_t EditMesh::valence(unsigned v) const {
  std::size_t count = 0;
  around(v, [&](unsigned) { ++count; });
  return count;
}

bool EditMesh::areNeighbours(unsigned a, unsigned b) const {
  bool found = false;
  around(a, [&](unsigned h) { found = found || to(h) == b; });
  return found;
}

Vec3 EditMesh::areaNormal(unsigned h) const {
  const Vec3 &a = points[from(h)];
  return cross(points[to(h)] - a, points[from(previous(h))] - a);
}

unsigned EditMesh::split(unsigned h0) {
  const unsigned g0 = twins_[h0], h1 = next(h0), h2 = previous(h0), g2 = previous(g0);
  const unsigned a = corners_[h0], b = corners_[g0], c = corners_[h2], d = corners_[g2];
  const auto m = static_cast<unsigned>(points.size());
  points.push_back(0.5 * (points[a] + points[b]));
  tags.push_back(tags[a]);
  owed.push_back(0.0);
  const auto n0 = halfEdges(), k0 = n0 + 3;
  corners_.insert(corners_.end(), {m, b, c, b, m, d});
  twins_.resize(corners_.size());
  const unsigned outerB = twins_[h1], outerD = twins_[g2];
  corners_[h1] = m;
  corners_[g0] = m;
  pair(n0, k0);
  pair(h1, n0 + 2);
  pair(g2, k0 + 1);
  pair(n0 + 1, outerB);
  pair(k0 + 2, outerD);
  leaving_.push_back(n0);
  leaving_[b] = n0 + 1;
  leaving_[a] = h0;
  leaving_[c] = h2;
  leaving_[d] = g2;
  return m;
}

bool EditMesh::flip(unsigned h0) {
  const unsigned g0 = twins_[h0], h1 = next(h0), h2 = previous(h0), g1 = next(g0), g2 = previous(g0);
  const unsigned a = corners_[h0], b = corners_[g0], c = corners_[h2], d = corners_[g2];
  if (c == d || valence(a) <= 3 || valence(b) <= 3 || areNeighbours(c, d)) return false;
  const unsigned outerH = twins_[h1], outerG = twins_[g1];
  // The tetrahedron between the old and the new diagonal.
  const double gained = volume6(points[a], points[d], points[b], points[c]) / 6.0;
  owed[c] -= 0.5 * gained;
  owed[d] -= 0.5 * gained;
  // (a, d, c) and (b, c, d).
  corners_[h1] = d;
  corners_[g1] = c;
  pair(h0, outerG);
  pair(g0, outerH);
  pair(h1, g1);
  leaving_[a] = h0;
  leaving_[b] = g0;
  leaving_[c] = h2;
  leaving_[d] = g2;
  return true;
}

bool EditMesh::canCollapse(unsigned h) const {
  const unsigned g = twins_[h], a = from(h), b = to(h), c = from(previous(h)), d = from(previous(g));
  if (c == d) return false;
  std::size_t common = 0;
  around(a, [&](unsigned e) {
    const unsigned n = to(e);
    if (n != b && areNeighbours(n, b)) ++common;
  });
  return common == 2 && valence(c) > 3 && valence(d) > 3;
}

bool EditMesh::collapse(unsigned h0, const Vec3 &at) {
  if (!canCollapse(h0)) return false;
  const unsigned g0 = twins_[h0], h1 = next(h0), h2 = previous(h0), g1 = next(g0), g2 = previous(g0);
  const unsigned a = corners_[h0], b = corners_[g0], c = corners_[h2], d = corners_[g2];
  std::array<unsigned, 64> ring{};
  std::size_t count = 0;
  bool tooMany = false;
  around(b, [&](unsigned h) {
    if (count < ring.size())
      ring[count++] = h;
    else
      tooMany = true;
  });
  if (tooMany) return false;
  // Triangles with a corner at `at` have no volume relative to it: the complete previous volume is recorded.
  double lost = 0.0;
  const auto volumeAt = [&](unsigned h) {
    return volume6(at, points[from(h)], points[to(h)], points[from(previous(h))]) / 6.0;
  };
  around(a, [&](unsigned h) { lost += volumeAt(h); });
  for (std::size_t i = 0; i < count; ++i)
    if (ring[i] != h1 && ring[i] != g0) lost += volumeAt(ring[i]);  // those two are triangles of a as well
  owed[a] += owed[b] + lost;
  for (std::size_t i = 0; i < count; ++i) corners_[ring[i]] = a;
  const unsigned th1 = twins_[h1], th2 = twins_[h2], tg1 = twins_[g1], tg2 = twins_[g2];
  pair(th1, th2);
  pair(tg1, tg2);
  for (const unsigned dead : {h0, h1, h2, g0, g1, g2}) corners_[dead] = kNone;
  leaving_[a] = th2;
  leaving_[c] = th1;
  leaving_[d] = tg1;
  leaving_[b] = kNone;
  points[a] = at;
  return true;
}

geometry::TriangleMesh EditMesh::mesh() const {
  geometry::TriangleMesh out;
  std::vector<unsigned> number(points.size(), kNone);
  for (unsigned v = 0; v < points.size(); ++v) {
    if (!isUsed(v)) continue;
    number[v] = static_cast<unsigned>(out.vertices.size());
    out.vertices.push_back(points[v]);
  }
  for (unsigned h = 0; h < corners_.size(); h += 3)
    if (alive(h)) out.triangles.push_back({number[corners_[h]], number[corners_[h + 1]], number[corners_[h + 2]]});
  return out;
}

}  // namespace c3de::imaging
