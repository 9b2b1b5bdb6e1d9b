// SPDX-License-Identifier: Apache-2.0
#include "implicit_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

namespace c3de::tools {
namespace {

Vec3 gradient(const ImplicitFunction &f, const Vec3 &p) {
  constexpr double kStep = 1e-3;
  Vec3 g{};
  for (std::size_t k = 0; k < 3; ++k) {
    Vec3 low = p, high = p;
    low[k] -= kStep;
    high[k] += kStep;
    g[k] = (f(high) - f(low)) / (2.0 * kStep);
  }
  return g;
}

/// Newton steps along the gradient.
Vec3 projected(const ImplicitFunction &f, Vec3 p) {
  for (int i = 0; i < 8; ++i) {
    const Vec3 g = gradient(f, p);
    const double g2 = dot(g, g);
    if (g2 < 1e-12) break;
    p = p - (f(p) / g2) * g;
  }
  return p;
}

/// Cell corners and cell centres of a grid: a body-centred lattice, whose tetrahedra are all alike and well shaped.
class Lattice {
 public:
  Lattice(const ImplicitFunction &f, const geometry::Box &box, double spacing) : origin_(box.min), spacing_(spacing) {
    for (std::size_t k = 0; k < 3; ++k) cells_[k] = static_cast<int>(std::ceil((box.max[k] - box.min[k]) / spacing));
    corners_ = static_cast<std::size_t>(cells_[0] + 1) * static_cast<std::size_t>(cells_[1] + 1) *
               static_cast<std::size_t>(cells_[2] + 1);
    const std::size_t centres =
        static_cast<std::size_t>(cells_[0]) * static_cast<std::size_t>(cells_[1]) * static_cast<std::size_t>(cells_[2]);
    values_.resize(corners_ + centres);
    positions_.resize(values_.size());
    for (int i = 0; i <= cells_[0]; ++i)
      for (int j = 0; j <= cells_[1]; ++j)
        for (int k = 0; k <= cells_[2]; ++k) {
          set(f, corner({i, j, k}), {1.0 * i, 1.0 * j, 1.0 * k});
          if (i < cells_[0] && j < cells_[1] && k < cells_[2]) set(f, centre({i, j, k}), {i + 0.5, j + 0.5, k + 0.5});
        }
  }

  using Cell = std::array<int, 3>;
  [[nodiscard]] const Cell &cells() const { return cells_; }
  [[nodiscard]] std::size_t corner(const Cell &c) const {
    return (static_cast<std::size_t>(c[0]) * static_cast<std::size_t>(cells_[1] + 1) + static_cast<std::size_t>(c[1])) *
               static_cast<std::size_t>(cells_[2] + 1) +
           static_cast<std::size_t>(c[2]);
  }
  [[nodiscard]] std::size_t centre(const Cell &c) const {
    return corners_ +
           (static_cast<std::size_t>(c[0]) * static_cast<std::size_t>(cells_[1]) + static_cast<std::size_t>(c[1])) *
               static_cast<std::size_t>(cells_[2]) +
           static_cast<std::size_t>(c[2]);
  }
  [[nodiscard]] double value(std::size_t node) const { return values_[node]; }
  [[nodiscard]] const Vec3 &position(std::size_t node) const { return positions_[node]; }

 private:
  void set(const ImplicitFunction &f, std::size_t node, const Vec3 &index) {
    positions_[node] = origin_ + spacing_ * index;
    const double v = f(positions_[node]);
    values_[node] = v == 0.0 ? 1e-12 : v;  // every node is on one side, so the result is a manifold
  }

  Vec3 origin_;
  double spacing_;
  Cell cells_{};
  std::size_t corners_ = 0;
  std::vector<double> values_;
  std::vector<Vec3> positions_;
};

class Marcher {
 public:
  explicit Marcher(const Lattice &lattice) : lattice_(lattice) {}
  void tetrahedron(const std::array<std::size_t, 4> &nodes);
  geometry::TriangleMesh mesh;

 private:
  unsigned crossing(std::size_t a, std::size_t b);
  void triangle(unsigned a, unsigned b, unsigned c, const Vec3 &outwards);

  const Lattice &lattice_;
  std::map<std::pair<std::size_t, std::size_t>, unsigned> crossings_;
};

unsigned Marcher::crossing(std::size_t a, std::size_t b) {
  const auto [it, isNew] = crossings_.try_emplace(std::minmax(a, b), static_cast<unsigned>(mesh.vertices.size()));
  if (isNew) {
    // Not at the very ends: two crossings must never coincide.
    const double s = std::clamp(lattice_.value(a) / (lattice_.value(a) - lattice_.value(b)), 0.05, 0.95);
    mesh.vertices.push_back((1.0 - s) * lattice_.position(a) + s * lattice_.position(b));
  }
  return it->second;
}

void Marcher::triangle(unsigned a, unsigned b, unsigned c, const Vec3 &outwards) {
  const Vec3 n = cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]);
  if (dot(n, outwards) >= 0.0)
    mesh.triangles.push_back({a, b, c});
  else
    mesh.triangles.push_back({a, c, b});
}

void Marcher::tetrahedron(const std::array<std::size_t, 4> &nodes) {
  std::vector<std::size_t> inside, outside;
  Vec3 insideCentre{}, outsideCentre{};
  for (std::size_t n : nodes) {
    const bool isInside = lattice_.value(n) < 0.0;
    (isInside ? inside : outside).push_back(n);
    (isInside ? insideCentre : outsideCentre) = (isInside ? insideCentre : outsideCentre) + lattice_.position(n);
  }
  if (inside.empty() || outside.empty()) return;
  const Vec3 outwards = (1.0 / static_cast<double>(outside.size())) * outsideCentre -
                        (1.0 / static_cast<double>(inside.size())) * insideCentre;
  if (inside.size() == 2) {
    const unsigned a = crossing(inside[0], outside[0]), b = crossing(inside[0], outside[1]);
    const unsigned c = crossing(inside[1], outside[1]), d = crossing(inside[1], outside[0]);
    triangle(a, b, c, outwards);
    triangle(a, c, d, outwards);
    return;
  }
  const std::size_t apex = inside.size() == 1 ? inside[0] : outside[0];
  const auto &base = inside.size() == 1 ? outside : inside;
  triangle(crossing(apex, base[0]), crossing(apex, base[1]), crossing(apex, base[2]), outwards);
}

void marchLattice(const Lattice &lattice, Marcher &marcher) {
  // Two centres on either side of a cell face, and the four sides of that face: four tetrahedra.
  const auto &cells = lattice.cells();
  for (int i = 0; i < cells[0]; ++i)
    for (int j = 0; j < cells[1]; ++j)
      for (int k = 0; k < cells[2]; ++k)
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const Lattice::Cell cell{i, j, k};
          Lattice::Cell next = cell;
          if (++next[axis] >= cells[axis]) continue;
          const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
          std::array<std::size_t, 4> face{};
          for (std::size_t c = 0; c < 4; ++c) {
            Lattice::Cell corner = next;
            corner[u] += c == 1 || c == 2;
            corner[v] += c == 2 || c == 3;
            face[c] = lattice.corner(corner);
          }
          for (std::size_t c = 0; c < 4; ++c)
            marcher.tetrahedron({lattice.centre(cell), lattice.centre(next), face[c], face[(c + 1) % 4]});
        }
}

/// Every vertex moves towards the area-weighted centre of its triangles, within the tangent plane, and back onto f = 0.
void smoothTangentially(const ImplicitFunction &f, geometry::TriangleMesh &mesh) {
  std::vector<Vec3> sum(mesh.vertices.size(), Vec3{});
  std::vector<double> weight(mesh.vertices.size(), 0.0);
  for (const Triangle &t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const double area = norm(cross(b - a, c - a));
    for (unsigned v : t) {
      sum[v] = sum[v] + (area / 3.0) * (a + b + c);
      weight[v] += area;
    }
  }
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3 p = mesh.vertices[v], g = gradient(f, p);
    Vec3 move = (1.0 / weight[v]) * sum[v] - p;
    move = move - (dot(move, g) / dot(g, g)) * g;
    mesh.vertices[v] = projected(f, p + 0.7 * move);
  }
}

}  // namespace

geometry::TriangleMesh polygonise(const ImplicitFunction &f, const geometry::Box &box, double spacing,
                                  int smoothingRounds) {
  const Lattice lattice(f, box, spacing);
  Marcher marcher(lattice);
  marchLattice(lattice, marcher);
  geometry::TriangleMesh mesh = std::move(marcher.mesh);
  for (Vec3 &v : mesh.vertices) v = projected(f, v);
  for (int i = 0; i < smoothingRounds; ++i) smoothTangentially(f, mesh);
  return mesh;
}

double worstTriangleQuality(const geometry::TriangleMesh &mesh) {
  double worst = 1.0;
  for (const Triangle &t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const double x = norm(b - a), y = norm(c - b), z = norm(a - c);
    const double doubleArea = norm(cross(b - a, c - a));
    // 2 r / R with r = 2 area / perimeter and R = x y z / (4 area)
    worst = std::min(worst, 4.0 * doubleArea * doubleArea / ((x + y + z) * x * y * z));
  }
  return worst;
}

}  // namespace c3de::tools
