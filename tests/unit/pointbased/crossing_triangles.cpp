// SPDX-License-Identifier: Apache-2.0
#include "crossing_triangles.h"

#include <algorithm>

using pointbased::Index;
using pointbased::Vec3;

namespace shapes {
namespace {

using Triangle = std::array<Index, 3>;

double volumeOf(const Vec3 &a, const Vec3 &b, const Vec3 &c, const Vec3 &d) { return (b - a).cross(c - a).dot(d - a); }

// The segment from p to q through the inside of a triangle.
bool passes(const Vec3 &p, const Vec3 &q, const Vec3 &a, const Vec3 &b, const Vec3 &c) {
  const double below = volumeOf(a, b, c, p), above = volumeOf(a, b, c, q);
  if (!(below * above < 0.0)) return false;
  const double u = volumeOf(p, q, a, b), v = volumeOf(p, q, b, c), w = volumeOf(p, q, c, a);
  return (u > 0.0 && v > 0.0 && w > 0.0) || (u < 0.0 && v < 0.0 && w < 0.0);
}

bool cross(const std::array<Vec3, 3> &a, const std::array<Vec3, 3> &b) {
  for (std::size_t k = 0; k < 3; ++k)
    if (passes(a[k], a[(k + 1) % 3], b[0], b[1], b[2]) || passes(b[k], b[(k + 1) % 3], a[0], a[1], a[2])) return true;
  return false;
}

struct Skin {
  std::vector<Vec3> positions;
  const std::vector<Triangle> &triangles;
  [[nodiscard]] std::array<Vec3, 3> at(std::size_t t) const {
    return {positions[triangles[t][0]], positions[triangles[t][1]], positions[triangles[t][2]]};
  }
};

Skin skinOf(pointbased::Simulator &simulator, std::size_t id) {
  std::vector<Vec3> positions, normals;
  simulator.world().surfels(id, positions, normals);
  return {std::move(positions), simulator.body(id)->rest().skin};
}

// Sorted along one axis, so that only neighbouring triangles are tested.
template <class Count>
void forNear(const Skin &a, const Skin &b, const Count &count) {
  struct Span {
    double low, high;
    std::size_t triangle;
  };
  const auto spansOf = [](const Skin &skin) {
    std::vector<Span> spans;
    for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
      const auto x = skin.at(t);
      spans.push_back({std::min({x[0][0], x[1][0], x[2][0]}), std::max({x[0][0], x[1][0], x[2][0]}), t});
    }
    std::sort(spans.begin(), spans.end(), [](const Span &x, const Span &y) { return x.low < y.low; });
    return spans;
  };
  const std::vector<Span> first = spansOf(a), second = spansOf(b);
  for (const Span &one : first)
    for (const Span &other : second) {
      if (other.low > one.high) break;
      if (other.high < one.low) continue;
      count(one.triangle, other.triangle);
    }
}

}  // namespace

std::size_t crossings(pointbased::Simulator &simulator, std::size_t first, std::size_t second) {
  const Skin a = skinOf(simulator, first), b = skinOf(simulator, second);
  std::size_t found = 0;
  forNear(a, b, [&](std::size_t t, std::size_t s) { found += cross(a.at(t), b.at(s)) ? 1 : 0; });
  return found;
}

std::size_t crossings(pointbased::Simulator &simulator, std::size_t body) {
  const Skin skin = skinOf(simulator, body);
  std::size_t found = 0;
  forNear(skin, skin, [&](std::size_t t, std::size_t s) {
    if (t >= s) return;
    for (const Index v : skin.triangles[t])
      if (std::find(skin.triangles[s].begin(), skin.triangles[s].end(), v) != skin.triangles[s].end()) return;
    found += cross(skin.at(t), skin.at(s)) ? 1 : 0;
  });
  return found;
}

}  // namespace shapes
