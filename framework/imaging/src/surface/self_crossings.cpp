// SPDX-License-Identifier: Apache-2.0
#include "surface/self_crossings.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace c3de::imaging {
namespace {

double volume6(const Vec3 &a, const Vec3 &b, const Vec3 &c, const Vec3 &d) { return dot(cross(b - a, c - a), d - a); }

bool goesThrough(const Vec3 &p, const Vec3 &q, const Vec3 &a, const Vec3 &b, const Vec3 &c) {
  const Vec3 n = cross(b - a, c - a);
  if (!(dot(n, p - a) * dot(n, q - a) < 0.0)) return false;
  const double u = volume6(p, q, a, b), v = volume6(p, q, b, c), w = volume6(p, q, c, a);
  return (u > 0.0 && v > 0.0 && w > 0.0) || (u < 0.0 && v < 0.0 && w < 0.0);
}

struct Box {
  Vec3 min, max;
};

class Crossings {
 public:
  explicit Crossings(const EditMesh &mesh) : mesh_(mesh), boxes_(mesh.halfEdges() / 3) {
    double sizes = 0.0;
    std::size_t count = 0;
    for (unsigned t = 0; t < boxes_.size(); ++t) {
      if (!mesh.alive(3 * t)) continue;
      Box &box = boxes_[t];
      box.min = box.max = corner(t, 0);
      for (unsigned c = 1; c < 3; ++c)
        for (std::size_t a = 0; a < 3; ++a) {
          box.min[a] = std::min(box.min[a], corner(t, c)[a]);
          box.max[a] = std::max(box.max[a], corner(t, c)[a]);
        }
      if (count++ == 0) all_ = box;
      for (std::size_t a = 0; a < 3; ++a) {
        all_.min[a] = std::min(all_.min[a], box.min[a]);
        all_.max[a] = std::max(all_.max[a], box.max[a]);
        sizes += box.max[a] - box.min[a];
      }
    }
    edge_ = std::max(sizes / static_cast<double>(3 * std::max<std::size_t>(count, 1)), 1e-300);
    for (std::size_t a = 0; a < 3; ++a)  // 21 bits of the key each
      edge_ = std::max(edge_, (all_.max[a] - all_.min[a]) / 2e6);
  }

  /// @param moved  by vertex; empty: check everywhere
  std::vector<unsigned> find(std::span<const std::uint8_t> moved) {
    // Cells to check, by a hash of their keys: a collision only costs a little time.
    std::vector<std::uint8_t> wanted(moved.empty() ? 0 : std::size_t{1} << kHashBits, 0);
    for (unsigned t = 0; t < boxes_.size() && !moved.empty(); ++t)
      if (mesh_.alive(3 * t) &&
          (moved[mesh_.from(3 * t)] | moved[mesh_.from(3 * t + 1)] | moved[mesh_.from(3 * t + 2)]) != 0)
        forCells(boxes_[t], [&](std::uint64_t key) { wanted[hashOf(key)] = 1; });
    std::vector<std::pair<std::uint64_t, unsigned>> places;
    for (unsigned t = 0; t < boxes_.size(); ++t)
      if (mesh_.alive(3 * t))
        forCells(boxes_[t], [&](std::uint64_t key) {
          if (wanted.empty() || wanted[hashOf(key)] != 0) places.emplace_back(key, t);
        });
    std::sort(places.begin(), places.end());
    std::vector<std::uint8_t> crossed(boxes_.size(), 0);
    for (std::size_t first = 0, end = 0; first < places.size(); first = end) {
      while (end < places.size() && places[end].first == places[first].first) ++end;
      for (std::size_t i = first; i < end; ++i)
        for (std::size_t j = i + 1; j < end; ++j) {
          const unsigned t = places[i].second, o = places[j].second;
          if ((crossed[t] != 0 && crossed[o] != 0) || !overlap(boxes_[t], boxes_[o])) continue;
          if (firstCommonCell(boxes_[t], boxes_[o]) != places[i].first) continue;  // each pair once
          if (edgesGoThrough(t, o) || edgesGoThrough(o, t)) crossed[t] = crossed[o] = 1;
        }
    }
    std::vector<unsigned> out;
    for (unsigned t = 0; t < crossed.size(); ++t)
      if (crossed[t] != 0) out.push_back(3 * t);
    return out;
  }

 private:
  static constexpr int kHashBits = 20;
  [[nodiscard]] static std::size_t hashOf(std::uint64_t key) {
    return static_cast<std::size_t>((key * 0x9e3779b97f4a7c15u) >> (64 - kHashBits));
  }
  [[nodiscard]] const Vec3 &corner(unsigned t, unsigned c) const { return mesh_.points[mesh_.from(3 * t + c)]; }
  [[nodiscard]] static bool overlap(const Box &a, const Box &b) {
    for (std::size_t x = 0; x < 3; ++x)
      if (a.max[x] < b.min[x] || b.max[x] < a.min[x]) return false;
    return true;
  }
  [[nodiscard]] std::uint64_t firstCommonCell(const Box &a, const Box &b) const {
    std::uint64_t key = 0;
    for (std::size_t x = 0; x < 3; ++x)
      key |= static_cast<std::uint64_t>((std::max(a.min[x], b.min[x]) - all_.min[x]) / edge_) << (21 * x);
    return key;
  }
  template <class Visit>
  void forCells(const Box &box, const Visit &visit) const {
    std::array<std::uint64_t, 3> low{}, high{};
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = static_cast<std::uint64_t>((box.min[a] - all_.min[a]) / edge_);
      high[a] = static_cast<std::uint64_t>((box.max[a] - all_.min[a]) / edge_);
    }
    for (std::uint64_t k = low[2]; k <= high[2]; ++k)
      for (std::uint64_t j = low[1]; j <= high[1]; ++j)
        for (std::uint64_t i = low[0]; i <= high[0]; ++i) visit(i | j << 21 | k << 42);
  }
  // Tests the edges of t that share no corner with o.
  [[nodiscard]] bool edgesGoThrough(unsigned t, unsigned o) const {
    std::array<bool, 3> shared{};
    for (unsigned c = 0; c < 3; ++c)
      for (unsigned d = 0; d < 3; ++d) shared[c] = shared[c] || mesh_.from(3 * t + c) == mesh_.from(3 * o + d);
    for (unsigned c = 0; c < 3; ++c)
      if (!shared[c] && !shared[(c + 1) % 3] &&
          goesThrough(corner(t, c), corner(t, (c + 1) % 3), corner(o, 0), corner(o, 1), corner(o, 2)))
        return true;
    return false;
  }

  const EditMesh &mesh_;
  std::vector<Box> boxes_;
  Box all_{};
  double edge_ = 1.0;
};

}  // namespace

std::vector<unsigned> crossedTriangles(const EditMesh &mesh) { return Crossings(mesh).find({}); }
std::vector<unsigned> crossedTriangles(const EditMesh &mesh, std::span<const std::uint8_t> moved) {
  return Crossings(mesh).find(moved);
}

}  // namespace c3de::imaging
