// SPDX-License-Identifier: Apache-2.0
#include "surface/volume_ledger.h"

#include <algorithm>
#include <cmath>

namespace c3de::imaging {
namespace {

constexpr double kMaxOfEdge = 0.25;  // maximum displacement of a vertex per step
constexpr std::size_t kMaxSpreads = 60;

// Vertex adjacency in flat arrays, because accounts are spread repeatedly.
class Ring {
 public:
  explicit Ring(const EditMesh &mesh) : offsets_{0} {
    for (unsigned v = 0; v < mesh.points.size(); ++v) {
      if (mesh.isUsed(v)) mesh.around(v, [&](unsigned h) { neighbours_.push_back(mesh.to(h)); });
      offsets_.push_back(static_cast<unsigned>(neighbours_.size()));
    }
  }
  [[nodiscard]] std::span<const unsigned> of(std::size_t v) const {
    return std::span(neighbours_).subspan(offsets_[v], offsets_[v + 1] - offsets_[v]);
  }
  // Each vertex passes all but a fifth to its neighbours in equal shares; the sum is conserved.
  void diffuse(std::vector<double> &values, std::size_t times) {
    constexpr double kKept = 0.2;
    shares_.resize(values.size());
    for (std::size_t t = 0; t < times; ++t) {
      for (std::size_t v = 0; v < values.size(); ++v) {
        const std::size_t count = of(v).size();
        shares_[v] = count > 0 ? (1.0 - kKept) * values[v] / static_cast<double>(count) : 0.0;
        values[v] *= kKept;
      }
      for (std::size_t v = 0; v < values.size(); ++v)
        for (const unsigned n : of(v)) values[v] += shares_[n];
    }
  }

 private:
  std::vector<unsigned> neighbours_, offsets_;
  std::vector<double> shares_;
};

}  // namespace

void recordMoves(EditMesh &mesh, std::span<const Vec3> before) {
  for (unsigned h = 0; h < mesh.halfEdges(); h += 3) {
    if (!mesh.alive(h)) continue;
    const std::array<unsigned, 3> v{mesh.from(h), mesh.from(h + 1), mesh.from(h + 2)};
    std::array<Vec3, 3> way;
    for (std::size_t c = 0; c < 3; ++c) way[c] = mesh.points[v[c]] - before[v[c]];
    const Vec3 b = before[v[1]] - before[v[0]], c = before[v[2]] - before[v[0]];
    const Vec3 db = way[1] - way[0], dc = way[2] - way[0];
    // Twice the area times the normal, averaged over the displacement.
    const Vec3 mean = cross(b, c) + 0.5 * (cross(b, dc) + cross(db, c)) + (1.0 / 3.0) * cross(db, dc);
    for (std::size_t k = 0; k < 3; ++k) mesh.owed[v[k]] -= dot(way[k], mean) / 6.0;
  }
}

void compensateVolume(EditMesh &mesh, std::span<const double> edges, double reach, int times) {
  Ring ring(mesh);
  // A step to one of six neighbours adds half a squared edge to the variance along each axis of the surface.
  const auto spreads = static_cast<std::size_t>(std::ceil(2.0 * reach * reach));
  std::vector<Vec3> gradients(mesh.points.size());
  std::vector<double> sizes(mesh.points.size());
  std::vector<Vec3> before;
  for (int t = 0; t < times; ++t) {
    ring.diffuse(mesh.owed, std::min(kMaxSpreads, t == 0 ? spreads : spreads / 4 + 1));
    for (unsigned v = 0; v < mesh.points.size(); ++v) {
      Vec3 sum{};
      if (mesh.isUsed(v)) mesh.around(v, [&](unsigned h) { sum = sum + mesh.areaNormal(h); });
      gradients[v] = (1.0 / 6.0) * sum;  // of the volume with respect to the vertex
      sizes[v] = norm(gradients[v]);
    }
    before = mesh.points;
    for (unsigned v = 0; v < mesh.points.size(); ++v) {
      if (!mesh.isUsed(v) || !(sizes[v] > 0.0)) continue;
      double owed = mesh.owed[v], size = sizes[v];
      for (const unsigned n : ring.of(v)) {
        owed += mesh.owed[n];
        size += sizes[n];
      }
      const double most = kMaxOfEdge * edges[mesh.tags[v]];
      mesh.points[v] = before[v] + (std::clamp(owed / size, -most, most) / sizes[v]) * gradients[v];
    }
    recordMoves(mesh, before);
  }
}

}  // namespace c3de::imaging
