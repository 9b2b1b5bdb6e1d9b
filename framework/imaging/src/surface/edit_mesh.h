// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "c3de/core/vec.h"
#include "c3de/geometry/triangle_mesh.h"

namespace c3de::imaging {

/// A closed, oriented 2-manifold of triangles for editing: half-edge 3 f + c runs from corner c of triangle f to the
/// next one, and has a twin in the neighbouring triangle.
class EditMesh {
 public:
  static constexpr unsigned kNone = 0xffffffffu;

  /// @param twins  [3 triangles] the opposite half-edge along the same edge. Vertices around which triangles form
  ///               several fans become one vertex per fan. Edges with the same end points in two pairs of triangles are
  ///               split, so that no edge has more than two triangles.
  EditMesh(std::vector<Vec3> points, std::span<const Triangle> triangles, std::vector<unsigned> twins);

  std::vector<Vec3> points;    ///< including removed ones
  std::vector<unsigned> tags;  ///< [points] for the caller; split() copies that of one end of the edge
  /// [points] Volume that the mesh is missing there: volume_ledger.h. Includes the changes by flip() and collapse().
  std::vector<double> owed;

  [[nodiscard]] unsigned halfEdges() const { return static_cast<unsigned>(corners_.size()); }
  [[nodiscard]] bool alive(unsigned h) const { return corners_[h] != kNone; }
  [[nodiscard]] bool isUsed(unsigned v) const { return leaving_[v] != kNone; }
  [[nodiscard]] static unsigned next(unsigned h) { return h % 3 == 2 ? h - 2 : h + 1; }
  [[nodiscard]] static unsigned previous(unsigned h) { return h % 3 == 0 ? h + 2 : h - 1; }
  [[nodiscard]] unsigned twin(unsigned h) const { return twins_[h]; }
  [[nodiscard]] unsigned from(unsigned h) const { return corners_[h]; }
  [[nodiscard]] unsigned to(unsigned h) const { return corners_[next(h)]; }

  /// Calls visit(half-edge) for all half-edges that leave a vertex, in circular order.
  template <class Visit>
  void around(unsigned v, const Visit &visit) const {
    const unsigned first = leaving_[v];
    unsigned h = first;
    do {
      visit(h);
      h = twins_[previous(h)];
    } while (h != first);
  }
  [[nodiscard]] std::size_t valence(unsigned v) const;
  [[nodiscard]] bool areNeighbours(unsigned a, unsigned b) const;
  /// Twice the area times the normal of the triangle of a half-edge.
  [[nodiscard]] Vec3 areaNormal(unsigned h) const;

  /// Inserts a vertex at the midpoint of an edge.
  unsigned split(unsigned h);
  /// Replaces an edge by the other diagonal of its two triangles; false: not possible.
  bool flip(unsigned h);
  /// Moves the start of an edge to `at` and removes its end; false: the result would not be a manifold.
  bool collapse(unsigned h, const Vec3 &at);
  [[nodiscard]] bool canCollapse(unsigned h) const;

  [[nodiscard]] geometry::TriangleMesh mesh() const;

 private:
  void splitFans();
  void splitDoubleEdges();
  void pair(unsigned h, unsigned g) {
    twins_[h] = g;
    twins_[g] = h;
  }

  std::vector<unsigned> corners_, twins_, leaving_;
};

}  // namespace c3de::imaging
