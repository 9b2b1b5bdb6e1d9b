// SPDX-License-Identifier: Apache-2.0
#include "skin/skin_tears.h"

#include <algorithm>
#include <limits>
#include <map>
#include <queue>

namespace pointbased::detail {
namespace {

// An edge is torn if Σ |φ_a - φ_b| of its ends exceeds kTorn + kSlope · length / spacing. Two points in a continuous
// field stay below: at most one edge of the eight corners changes. Two points of different pieces have 2.
constexpr double kTorn = 0.75, kSlope = 8.0;
constexpr double kBand = 0.5;            // spacings, on either side
constexpr std::size_t kMaxAround = 256;  // points in a mean, at most; on finer skins the band becomes narrower

struct Way {
  double length;  // m
  Index vertex;
  bool operator>(const Way &other) const {
    return length != other.length ? length > other.length : vertex > other.vertex;
  }
};
using Queue = std::priority_queue<Way, std::vector<Way>, std::greater<>>;

// Edges of the surface, stored from both ends.
Csr edgesOf(const Surface &surface) {
  std::vector<std::array<Index, 2>> pairs;
  for (const auto &t : surface.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      pairs.push_back({t[k], t[(k + 1) % 3]});
      pairs.push_back({t[(k + 1) % 3], t[k]});
    }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  Csr edges;
  edges.offsets.assign(surface.positions.size() + 1, 0);
  for (const auto &[from, to] : pairs) {
    ++edges.offsets[from + 1];
    edges.indices.push_back(to);
  }
  for (std::size_t i = 1; i < edges.offsets.size(); ++i) edges.offsets[i] += edges.offsets[i - 1];
  return edges;
}

double differenceOf(const Interpolation &rows, Index a, Index b) {
  const auto from = [&](Index p) { return rows.phyxels.offsets[p]; };
  const auto weightOf = [&](Index p, Index phyxel) {
    for (Index e = from(p); e < from(p + 1); ++e)
      if (rows.phyxels.indices[e] == phyxel) return rows.weights[e];
    return 0.0;
  };
  double sum = 0.0;
  for (Index e = from(a); e < from(a + 1); ++e) sum += std::abs(rows.weights[e] - weightOf(b, rows.phyxels.indices[e]));
  for (Index e = from(b); e < from(b + 1); ++e) {
    const Index phyxel = rows.phyxels.indices[e];
    const auto own = rows.phyxels.indices.begin();
    if (std::find(own + from(a), own + from(a + 1), phyxel) == own + from(a + 1)) sum += std::abs(rows.weights[e]);
  }
  return sum;
}

// Visits vertices of the skin in the order of their distance along the skin from given starts, the nearest first.
class Walk {
 public:
  Walk(const Surface &surface, const Csr &edges)
      : surface_(surface), edges_(edges), ways_(surface.positions.size(), std::numeric_limits<double>::infinity()) {}

  [[nodiscard]] std::vector<Way> from(std::span<const Index> starts, double reach, std::size_t most) {
    for (const Index start : starts) step({0.0, start});
    std::vector<Way> found;
    while (!queue_.empty() && found.size() < most) {
      const Way way = queue_.top();
      queue_.pop();
      if (way.length > ways_[way.vertex]) continue;
      found.push_back(way);
      for (Index e = edges_.offsets[way.vertex]; e < edges_.offsets[way.vertex + 1]; ++e) {
        const Index next = edges_.indices[e];
        const double length = way.length + (surface_.positions[next] - surface_.positions[way.vertex]).norm();
        if (length < reach) step({length, next});
      }
    }
    queue_ = Queue();
    for (const Index vertex : seen_) ways_[vertex] = std::numeric_limits<double>::infinity();
    seen_.clear();
    return found;
  }

 private:
  void step(const Way &way) {
    if (!(way.length < ways_[way.vertex])) return;
    ways_[way.vertex] = way.length;
    seen_.push_back(way.vertex);
    queue_.push(way);
  }
  const Surface &surface_;
  const Csr &edges_;
  std::vector<double> ways_;
  std::vector<Index> seen_;
  Queue queue_;
};

struct Entry {
  double weight = 0.0;
  Vec3 gradient = Vec3::Zero();
};
using Row = std::map<Index, Entry>;

// Mean of the rows around a point, extrapolated to it along their gradients. Each extrapolated row is exact for affine
// fields, and so is the mean.
Row meanRow(const Interpolation &rows, Index point, std::span<const Way> around) {
  const double reach = around.back().length;
  Row mean;
  double all = 0.0;
  for (const Way &way : around) {
    const double part = reach > 0.0 ? 1.0 - (way.length / reach) * (way.length / reach) : 1.0;
    const double share = part * part;
    all += share;
    const Vec3 arm = rows.positions[point] - rows.positions[way.vertex];
    for (Index e = rows.phyxels.offsets[way.vertex]; e < rows.phyxels.offsets[way.vertex + 1]; ++e) {
      Entry &entry = mean[rows.phyxels.indices[e]];
      entry.weight += share * (rows.weights[e] + rows.gradients[e].dot(arm));
      entry.gradient += share * rows.gradients[e];
    }
  }
  for (auto &[phyxel, entry] : mean) {
    entry.weight /= all;
    entry.gradient /= all;
  }
  return mean;
}

}  // namespace

std::size_t closeTears(const Surface &surface, double spacing, Interpolation &binding) {
  const Csr edges = edgesOf(surface);
  std::vector<Index> ends;
  std::size_t torn = 0;
  for (Index a = 0; a < edges.rows(); ++a) {
    bool here = false;
    for (Index e = edges.offsets[a]; e < edges.offsets[a + 1]; ++e) {
      const Index b = edges.indices[e];
      const double length = (surface.positions[a] - surface.positions[b]).norm();
      if (!(differenceOf(binding, a, b) > kTorn + kSlope * length / spacing)) continue;
      here = true;
      torn += a < b ? 1 : 0;
    }
    if (here) ends.push_back(a);
  }
  if (torn == 0) return 0;

  Walk walk(surface, edges);
  const double band = kBand * spacing;
  std::map<Index, Row> changed;
  for (const Way &way : walk.from(ends, band, surface.positions.size())) {
    const std::vector<Way> around = walk.from(std::span(&way.vertex, 1), band - way.length, kMaxAround);
    if (around.size() > 1) changed.emplace(way.vertex, meanRow(binding, way.vertex, around));
  }

  Interpolation out;
  out.positions = std::move(binding.positions);
  out.phyxels.offsets.assign(1, 0);
  for (Index p = 0; p < out.count(); ++p) {
    if (const auto found = changed.find(p); found != changed.end()) {
      for (const auto &[phyxel, entry] : found->second) {
        out.phyxels.indices.push_back(phyxel);
        out.weights.push_back(entry.weight);
        out.gradients.push_back(entry.gradient);
      }
    } else {
      const auto first = binding.phyxels.offsets[p], last = binding.phyxels.offsets[p + 1];
      out.phyxels.indices.insert(out.phyxels.indices.end(), binding.phyxels.indices.begin() + first,
                                 binding.phyxels.indices.begin() + last);
      out.weights.insert(out.weights.end(), binding.weights.begin() + first, binding.weights.begin() + last);
      out.gradients.insert(out.gradients.end(), binding.gradients.begin() + first, binding.gradients.begin() + last);
    }
    out.phyxels.offsets.push_back(static_cast<Index>(out.phyxels.indices.size()));
  }
  binding = std::move(out);
  return torn;
}

}  // namespace pointbased::detail
