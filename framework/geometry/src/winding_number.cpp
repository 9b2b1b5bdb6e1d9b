// SPDX-License-Identifier: Apache-2.0
#include "c3de/geometry/winding_number.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>

#include "c3de/core/assert.h"
#include "mesh_edges.h"

namespace c3de::geometry {
namespace {

/// A node counts as far if the point is this many radii away. Measured on organs of up to 30 726 triangles: 2.0 gives
/// errors up to 0.009, 2.5 up to 0.0044 at 2 to 4 us per point, 3.0 up to 0.0018 at half as much time again.
constexpr double kFarFactor = 2.5;
constexpr std::size_t kLeafSize = 8;

/// Moments of the vector area dA = n dA about the node's centre p, with y = x - p.
struct Node {
  Vec3 centre{};
  double farDistanceSquared = 0.0;
  Vec3 dipole{};                      ///< integral of dA
  double trace = 0.0;                 ///< integral of y . dA
  std::array<double, 6> quadratic{};  ///< of y_i dA_j, as a form: xx yy zz xy xz yz
  Vec3 linear{};                      ///< of 2 (y . dA) y + (y . y) dA
  std::array<double, 10> cubic{};     ///< of y_i y_j dA_k, as a form: xxx yyy zzz xxy xxz xyy yyz xzz yzz xyz
  std::uint32_t begin = 0, end = 0;   ///< triangles below, in tree order
  std::uint32_t skip = 0;             ///< the next node after this subtree; the first child follows immediately
  bool isLeaf = false;
};

struct Corners {
  Vec3 a, b, c;
};

/// Solid angle of a triangle as seen from a point, by Van Oosterom and Strackee (1983); in [-2 pi, 2 pi]. For a point
/// in the plane of the triangle, up to rounding, it is the mean of both sides, zero.
double solidAngle(const Corners &t, const Vec3 &p) {
  const Vec3 a = t.a - p, b = t.b - p, c = t.c - p;
  const double la = norm(a), lb = norm(b), lc = norm(c);
  const double numerator = dot(a, cross(b, c));
  const double product = la * lb * lc;
  if (!(std::abs(numerator) > 1e-12 * product)) return 0.0;
  const double denominator = product + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  return 2.0 * std::atan2(numerator, denominator);
}

/// @param n  vector area of the triangle  @param c  its centre, relative to the node's
void addMoments(Node &node, const Corners &t, const Vec3 &n, const Vec3 &c) {
  node.dipole = node.dipole + n;
  node.trace += dot(c, n);
  node.quadratic[0] += c[0] * n[0];
  node.quadratic[1] += c[1] * n[1];
  node.quadratic[2] += c[2] * n[2];
  node.quadratic[3] += c[0] * n[1] + c[1] * n[0];
  node.quadratic[4] += c[0] * n[2] + c[2] * n[0];
  node.quadratic[5] += c[1] * n[2] + c[2] * n[1];
  // Mean of y_i y_j over the triangle: (sum over corners of v_i v_j + 9 c_i c_j) / 12.
  std::array<std::array<double, 3>, 3> m{};
  const Vec3 corners[3] = {t.a - node.centre, t.b - node.centre, t.c - node.centre};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      m[i][j] = (corners[0][i] * corners[0][j] + corners[1][i] * corners[1][j] + corners[2][i] * corners[2][j] +
                 9.0 * c[i] * c[j]) /
                12.0;
  const double trace = m[0][0] + m[1][1] + m[2][2];
  for (std::size_t i = 0; i < 3; ++i)
    node.linear[i] += 2.0 * (m[i][0] * n[0] + m[i][1] * n[1] + m[i][2] * n[2]) + trace * n[i];
  node.cubic[0] += m[0][0] * n[0];
  node.cubic[1] += m[1][1] * n[1];
  node.cubic[2] += m[2][2] * n[2];
  node.cubic[3] += m[0][0] * n[1] + 2.0 * m[0][1] * n[0];
  node.cubic[4] += m[0][0] * n[2] + 2.0 * m[0][2] * n[0];
  node.cubic[5] += m[1][1] * n[0] + 2.0 * m[0][1] * n[1];
  node.cubic[6] += m[1][1] * n[2] + 2.0 * m[1][2] * n[1];
  node.cubic[7] += m[2][2] * n[0] + 2.0 * m[0][2] * n[2];
  node.cubic[8] += m[2][2] * n[1] + 2.0 * m[1][2] * n[2];
  node.cubic[9] += 2.0 * (m[0][1] * n[2] + m[0][2] * n[1] + m[1][2] * n[0]);
}

/// Solid angle of a far node: Taylor expansion of d / |d|^3 about the node's centre, up to second order.
double farSolidAngle(const Node &node, const Vec3 &d, double r2) {
  const double x = d[0], y = d[1], z = d[2];
  const double inverse2 = 1.0 / r2, inverse3 = inverse2 / std::sqrt(r2);
  const auto &q = node.quadratic;
  const auto &c = node.cubic;
  const double quadratic = x * (q[0] * x + q[3] * y + q[4] * z) + y * (q[1] * y + q[5] * z) + q[2] * z * z;
  const double cubic = x * x * (c[0] * x + c[3] * y + c[4] * z) + y * y * (c[1] * y + c[5] * x + c[6] * z) +
                       z * z * (c[2] * z + c[7] * x + c[8] * y) + c[9] * x * y * z;
  return inverse3 * (dot(node.dipole, d) + node.trace +
                     inverse2 * (-3.0 * quadratic - 1.5 * dot(node.linear, d) + 7.5 * inverse2 * cubic));
}

}  // namespace

/// Connected triangles with a separate tree. A closed shell contributes nothing outside its box. This avoids sums over
/// single triangles for long triangles, which are never far away for an expansion, and for meshes of many shells.
struct Shell {
  std::uint32_t begin = 0, end = 0;  ///< nodes
  bool isClosed = false;
  Box box;
  [[nodiscard]] bool isOutsideAt(const Vec3 &p) const {
    if (!isClosed) return false;
    for (std::size_t k = 0; k < 3; ++k)
      if (p[k] < box.min[k] || p[k] > box.max[k]) return true;
    return false;
  }
};

struct WindingNumber::Impl {
  std::vector<Corners> triangles;  ///< in tree order
  std::vector<Node> nodes;         ///< depth first, the trees one after the other
  std::vector<Shell> shells;

  void build(std::vector<Corners> &source, std::vector<std::uint32_t> &order, std::size_t begin, std::size_t end);
  double sum(const Vec3 &p) const;
};

void WindingNumber::Impl::build(std::vector<Corners> &source, std::vector<std::uint32_t> &order, std::size_t begin,
                                std::size_t end) {
  const std::size_t self = nodes.size();
  nodes.emplace_back();
  Node node;
  node.begin = static_cast<std::uint32_t>(begin);
  node.end = static_cast<std::uint32_t>(end);
  node.isLeaf = end - begin <= kLeafSize;

  // Centre: the area-weighted mean of the triangles' centres, about which the first moment is small.
  Vec3 low = source[order[begin]].a, high = low;
  double area = 0.0;
  const auto centreOf = [&](std::size_t i) {
    return (1.0 / 3.0) * (source[order[i]].a + source[order[i]].b + source[order[i]].c);
  };
  const auto vectorArea = [&](std::size_t i) {
    const Corners &t = source[order[i]];
    return 0.5 * cross(t.b - t.a, t.c - t.a);
  };
  for (std::size_t i = begin; i < end; ++i) {
    const Corners &t = source[order[i]];
    for (const Vec3 *v : {&t.a, &t.b, &t.c})
      for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], (*v)[k]);
        high[k] = std::max(high[k], (*v)[k]);
      }
    const double weight = norm(vectorArea(i));
    area += weight;
    node.centre = node.centre + weight * centreOf(i);
  }
  node.centre = area > 0.0 ? (1.0 / area) * node.centre : 0.5 * (low + high);

  double radiusSquared = 0.0;
  for (std::size_t i = begin; i < end; ++i) {
    const Corners &t = source[order[i]];
    for (const Vec3 *v : {&t.a, &t.b, &t.c}) {
      const Vec3 d = *v - node.centre;
      radiusSquared = std::max(radiusSquared, dot(d, d));
    }
    addMoments(node, t, vectorArea(i), centreOf(i) - node.centre);
  }
  node.farDistanceSquared = kFarFactor * kFarFactor * radiusSquared;

  if (!node.isLeaf) {
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
    const std::size_t middle = begin + (end - begin) / 2;
    std::nth_element(order.begin() + static_cast<std::ptrdiff_t>(begin),
                     order.begin() + static_cast<std::ptrdiff_t>(middle),
                     order.begin() + static_cast<std::ptrdiff_t>(end), [&](std::uint32_t i, std::uint32_t j) {
                       const double x = source[i].a[axis] + source[i].b[axis] + source[i].c[axis];
                       const double y = source[j].a[axis] + source[j].b[axis] + source[j].c[axis];
                       return x != y ? x < y : i < j;
                     });
    build(source, order, begin, middle);
    build(source, order, middle, end);
  }
  node.skip = static_cast<std::uint32_t>(nodes.size());
  nodes[self] = node;
}

double WindingNumber::Impl::sum(const Vec3 &p) const {
  double total = 0.0;
  for (const Shell &shell : shells) {
    if (shell.isOutsideAt(p)) continue;
    std::size_t i = shell.begin;
    while (i < shell.end) {
      const Node &node = nodes[i];
      const Vec3 d = node.centre - p;
      const double r2 = dot(d, d);
      if (r2 > node.farDistanceSquared) {
        total += farSolidAngle(node, d, r2);
        i = node.skip;
      } else if (node.isLeaf) {
        for (std::uint32_t t = node.begin; t < node.end; ++t) total += solidAngle(triangles[t], p);
        i = node.skip;
      } else {
        ++i;
      }
    }
  }
  return total / (4.0 * std::numbers::pi);
}

namespace {

/// Triangles grouped by tree: one for each closed shell, one for all open parts together, and one for a mesh that is a
/// single shell. @param isClosed  out: of each
std::vector<std::vector<std::uint32_t>> shellsOf(const TriangleMesh &mesh, std::vector<std::uint8_t> &isClosed) {
  constexpr std::size_t kMaxShells = 4096;  // each is visited for each point
  std::vector<std::uint32_t> all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  isClosed.assign(1, 0);
  DisjointSets joined(mesh.vertices.size());
  for (const Triangle &t : mesh.triangles) {
    joined.join(t[0], t[1]);
    joined.join(t[0], t[2]);
  }
  std::vector<std::uint8_t> isOpen(mesh.vertices.size(), 0);
  forEachEdge(sortedSides(mesh.triangles), [&](std::span<const TriangleSide> edge) {
    if (!isBalanced(edge)) isOpen[joined.find(edge.front().low)] = 1;
  });
  constexpr unsigned kNone = 0xffffffffu;
  std::vector<unsigned> shellOf(mesh.vertices.size(), kNone);
  std::vector<std::vector<std::uint32_t>> shells(1);  // the first: open parts
  for (const std::uint32_t t : all) {
    const unsigned root = joined.find(mesh.triangles[t][0]);
    if (shellOf[root] == kNone) {
      shellOf[root] = isOpen[root] != 0 ? 0u : static_cast<unsigned>(shells.size());
      if (isOpen[root] == 0) shells.emplace_back();
    }
    shells[shellOf[root]].push_back(t);
  }
  if (shells.size() - (shells.front().empty() ? 1 : 0) < 2 || shells.size() > kMaxShells) return {std::move(all)};
  isClosed.resize(shells.size(), 1);
  if (shells.front().empty()) {
    shells.erase(shells.begin());
    isClosed.erase(isClosed.begin());
  }
  return shells;
}

}  // namespace

WindingNumber::WindingNumber(const TriangleMesh &mesh) {
  auto impl = std::make_unique<Impl>();
  std::vector<Corners> source;
  source.reserve(mesh.triangles.size());
  for (const Triangle &t : mesh.triangles)
    source.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
  if (!source.empty()) {
    std::vector<std::uint8_t> isClosed;
    auto orders = shellsOf(mesh, isClosed);
    impl->nodes.reserve(source.size());
    impl->triangles.reserve(source.size());
    for (std::size_t s = 0; s < orders.size(); ++s) {
      std::vector<std::uint32_t> &order = orders[s];
      Shell shell;
      shell.isClosed = isClosed[s] != 0;
      shell.box = {source[order.front()].a, source[order.front()].a};
      for (const std::uint32_t t : order)
        for (const Vec3 *v : {&source[t].a, &source[t].b, &source[t].c})
          for (std::size_t k = 0; k < 3; ++k) {
            shell.box.min[k] = std::min(shell.box.min[k], (*v)[k]);
            shell.box.max[k] = std::max(shell.box.max[k], (*v)[k]);
          }
      const auto first = static_cast<std::uint32_t>(impl->triangles.size());
      shell.begin = static_cast<std::uint32_t>(impl->nodes.size());
      impl->build(source, order, 0, order.size());
      shell.end = static_cast<std::uint32_t>(impl->nodes.size());
      for (std::size_t n = shell.begin; n < shell.end; ++n) {
        impl->nodes[n].begin += first;
        impl->nodes[n].end += first;
      }
      for (const std::uint32_t t : order) impl->triangles.push_back(source[t]);
      impl->shells.push_back(shell);
    }
  }
  impl_ = std::move(impl);
}

WindingNumber::~WindingNumber() = default;
WindingNumber::WindingNumber(WindingNumber &&) noexcept = default;
WindingNumber &WindingNumber::operator=(WindingNumber &&) noexcept = default;

double WindingNumber::at(const Vec3 &point_mm) const { return impl_->sum(point_mm); }

void WindingNumber::at(std::span<const Vec3> points_mm, std::span<double> out) const {
  C3DE_ASSERT(points_mm.size() == out.size(), "one result per point");
  for (std::size_t i = 0; i < points_mm.size(); ++i) out[i] = impl_->sum(points_mm[i]);
}

}  // namespace c3de::geometry
