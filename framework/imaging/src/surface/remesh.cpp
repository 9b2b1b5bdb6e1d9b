// SPDX-License-Identifier: Apache-2.0
#include "surface/remesh.h"

#include <algorithm>
#include <cmath>

#include "surface/volume_ledger.h"

namespace c3de::imaging {
namespace {

constexpr double kLong = 4.0 / 3.0, kShort = 4.0 / 5.0;
constexpr int kRounds = 7, kMaxRounds = 16;
// Cosines: the maximum rotation of a triangle when an edge is collapsed; edges at sharper angles are not flipped.
constexpr double kMaxTurn = 0.5, kSharp = 0.5;

double squared(const EditMesh &mesh, unsigned h) {
  const Vec3 way = mesh.points[mesh.to(h)] - mesh.points[mesh.from(h)];
  return dot(way, way);
}

bool isFirst(const EditMesh &mesh, unsigned h) { return mesh.alive(h) && h < mesh.twin(h); }

// Squared length of an edge in target lengths.
class Measure {
 public:
  explicit Measure(std::span<const double> edges) {
    for (const double e : edges) scale_.push_back(1.0 / (e * e));
  }
  [[nodiscard]] double operator()(const EditMesh &mesh, unsigned h) const {
    return squared(mesh, h) * scale_[mesh.tags[mesh.from(h)]];
  }
  [[nodiscard]] double scaleAt(const EditMesh &mesh, unsigned v) const { return scale_[mesh.tags[v]]; }

 private:
  std::vector<double> scale_;
};

// One pass over the existing edges: edges created in a degenerate part wait for the next round.
std::size_t splitLong(EditMesh &mesh, const Measure &measure) {
  std::size_t count = 0;
  const unsigned end = mesh.halfEdges();
  for (unsigned h = 0; h < end; ++h) {
    if (!isFirst(mesh, h) || measure(mesh, h) <= kLong * kLong) continue;
    mesh.split(h);
    ++count;
  }
  return count;
}

// Whether the triangles around the end of an edge keep their orientation, and no edge becomes too long, when that end
// moves.
bool keepsShape(const EditMesh &mesh, unsigned vertex, unsigned other, const Vec3 &at, double longest) {
  bool good = true;
  mesh.around(vertex, [&](unsigned h) {
    const unsigned b = mesh.to(h), c = mesh.from(EditMesh::previous(h));
    const Vec3 way = mesh.points[b] - at;
    if (b != other && dot(way, way) > longest) good = false;
    if (!good || b == other || c == other) return;
    const Vec3 before = mesh.areaNormal(h), after = cross(way, mesh.points[c] - at);
    const double sizes = norm(before) * norm(after);
    if (!(dot(before, after) > kMaxTurn * sizes) && norm(before) > 0.0) good = false;
  });
  return good;
}

std::size_t collapseShort(EditMesh &mesh, const Measure &measure) {
  std::size_t count = 0;
  for (unsigned h = 0; h < mesh.halfEdges(); ++h) {
    if (!isFirst(mesh, h) || measure(mesh, h) >= kShort * kShort) continue;
    const unsigned a = mesh.from(h), b = mesh.to(h);
    const Vec3 at = 0.5 * (mesh.points[a] + mesh.points[b]);
    const double longest = kLong * kLong / measure.scaleAt(mesh, a);
    if (!mesh.canCollapse(h) || !keepsShape(mesh, a, b, at, longest) || !keepsShape(mesh, b, a, at, longest)) continue;
    count += mesh.collapse(h, at) ? 1 : 0;
  }
  return count;
}

void evenValences(EditMesh &mesh) {
  std::vector<int> valence(mesh.points.size(), 0);
  for (unsigned h = 0; h < mesh.halfEdges(); ++h)
    if (mesh.alive(h)) ++valence[mesh.from(h)];
  const auto off = [&](unsigned v, int change) {
    const int d = valence[v] + change - 6;
    return d * d;
  };
  for (unsigned h = 0; h < mesh.halfEdges(); ++h) {
    if (!isFirst(mesh, h)) continue;
    const unsigned g = mesh.twin(h), a = mesh.from(h), b = mesh.to(h);
    const unsigned c = mesh.from(EditMesh::previous(h)), d = mesh.from(EditMesh::previous(g));
    if (off(a, -1) + off(b, -1) + off(c, 1) + off(d, 1) >= off(a, 0) + off(b, 0) + off(c, 0) + off(d, 0)) continue;
    const Vec3 n0 = mesh.areaNormal(h), n1 = mesh.areaNormal(g), n = n0 + n1;
    if (dot(n0, n1) < kSharp * norm(n0) * norm(n1)) continue;
    const Vec3 &A = mesh.points[a], &B = mesh.points[b], &C = mesh.points[c], &D = mesh.points[d];
    const Vec3 m0 = cross(D - A, C - A), m1 = cross(C - B, D - B);
    if (dot(m0, n) < kSharp * norm(m0) * norm(n) || dot(m1, n) < kSharp * norm(m1) * norm(n)) continue;
    if (!mesh.flip(h)) continue;
    --valence[a];
    --valence[b];
    ++valence[c];
    ++valence[d];
  }
}

struct Neighbourhood {
  Vec3 mean{}, normal{};
};

Neighbourhood lookAround(const EditMesh &mesh, unsigned v) {
  Neighbourhood n;
  double count = 0.0;
  mesh.around(v, [&](unsigned h) {
    n.mean = n.mean + mesh.points[mesh.to(h)];
    n.normal = n.normal + mesh.areaNormal(h);
    count += 1.0;
  });
  n.mean = (1.0 / count) * n.mean;
  return n;
}

void spreadInSurface(EditMesh &mesh) {
  constexpr double kStep = 0.8;
  std::vector<Vec3> moved = mesh.points;
  for (unsigned v = 0; v < moved.size(); ++v) {
    if (!mesh.isUsed(v)) continue;
    const Neighbourhood around = lookAround(mesh, v);
    const double length = norm(around.normal);
    if (!(length > 0.0)) continue;
    const Vec3 n = (1.0 / length) * around.normal, way = around.mean - mesh.points[v];
    moved[v] = mesh.points[v] + kStep * (way - dot(way, n) * n);
  }
  mesh.points.swap(moved);
  recordMoves(mesh, moved);
}

}  // namespace

bool remesh(EditMesh &mesh, std::span<const double> edges, const std::function<bool(double)> &round) {
  const Measure measure(edges);
  int rounds = kRounds;
  for (int r = 0; r < rounds; ++r) {
    while (collapseShort(mesh, measure) > mesh.halfEdges() / 100) {
    }
    // Voxels much larger than the edges require repeated halving.
    if (splitLong(mesh, measure) > mesh.halfEdges() / 20) rounds = std::min(kMaxRounds, r + kRounds);
    evenValences(mesh);
    spreadInSurface(mesh);
    if (!round(static_cast<double>(r + 1) / rounds)) return false;
  }
  return true;
}

void fair(EditMesh &mesh, std::size_t times) {
  constexpr double kIn = 0.5, kOut = -0.53;
  const std::vector<Vec3> before = mesh.points;
  std::vector<Vec3> moved = before;
  for (std::size_t t = 0; t < times; ++t)
    for (const double step : {kIn, kOut}) {
      for (unsigned v = 0; v < moved.size(); ++v)
        if (mesh.isUsed(v)) moved[v] = mesh.points[v] + step * (lookAround(mesh, v).mean - mesh.points[v]);
      mesh.points.swap(moved);
    }
  recordMoves(mesh, before);
}

}  // namespace c3de::imaging
