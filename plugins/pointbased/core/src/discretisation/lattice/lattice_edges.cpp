// SPDX-License-Identifier: Apache-2.0
#include "discretisation/lattice/lattice_edges.h"

#include <unordered_map>
#include <unordered_set>

namespace pointbased::lattice {
namespace {

// Phyxels with less than this part of the largest volume among the four nearest to an edge are left out. Steps are as
// long with 0.01 to 0.15; the torque of an oblique beam of three cells is best below 0.05.
constexpr double kMinVolumeShare = 0.02;

std::uint64_t pairOf(Index a, Index b) { return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b); }

// Axes of an edge, and the signs of its side along the other two.
struct EdgeFrame {
  int a, b, c;
  double sb, sc;
  explicit EdgeFrame(std::size_t edge)
      : a(static_cast<int>(edge / 4)), b((a + 1) % 3), c((a + 2) % 3), sb((edge & 1) != 0 ? 1.0 : -1.0),
        sc((edge & 2) != 0 ? 1.0 : -1.0) {}
};

// mixed[i + j - 1] of Moments belongs to axes i and j, as do the last three of SecondDerivatives.
std::size_t mixedIndex(int i, int j) { return static_cast<std::size_t>(i + j - 1); }

// Neighbours of every phyxel along the edges of the lattice.
class Rows {
 public:
  explicit Rows(std::size_t phyxels) : next_(6 * phyxels) {}

  void add(Index low, Index high, std::size_t axis, std::int32_t size) {
    set(low, 2 * axis + 1, high, size);
    set(high, 2 * axis, low, size);
  }
  /// Next phyxel on that side of an edge of this length, or kNone.
  [[nodiscard]] Index next(Index from, std::size_t axis, bool up, std::int32_t size) const {
    const Next &known = next_[6 * std::size_t{from} + 2 * axis + (up ? 1 : 0)];
    return known.size == size ? known.phyxel : kNone;
  }

 private:
  struct Next {
    Index phyxel = kNone;
    std::int32_t size = 0;  // 0: none, -1: several
  };
  void set(Index from, std::size_t side, Index to, std::int32_t size) {
    Next &known = next_[6 * std::size_t{from} + side];
    if (known.size == 0)
      known = {to, size};
    else if (known.phyxel != to || known.size != size)
      known = {kNone, -1};
  }
  std::vector<Next> next_;
};

// Phyxels of a part's corners; kNone where a corner hangs.
std::array<Index, 8> phyxelsOf(const NodeTable &corners, const CutCellFragment &part) {
  std::array<Index, 8> out{};
  for (std::size_t j = 0; j < 8; ++j) {
    std::size_t count = 0;
    corners.visit(part.nodes[j], [&](Index phyxel, double) {
      out[j] = phyxel;
      ++count;
    });
    if (count != 1) out[j] = kNone;
  }
  return out;
}

// Pairs of phyxels with a hanging corner between them.
std::unordered_set<std::uint64_t> pairsAroundHanging(const NodeTable &corners) {
  std::unordered_set<std::uint64_t> out;
  std::vector<Index> row;
  for (Index node = 0; node + 1 < corners.offsets.size(); ++node) {
    row.clear();
    corners.visit(node, [&](Index phyxel, double) { row.push_back(phyxel); });
    for (std::size_t i = 0; i < row.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) out.insert(pairOf(row[i], row[j]));
  }
  return out;
}

// First phyxels of parabolas, the nearest to the edge first.
constexpr std::array<std::size_t, 4> kParabolas{1, 2, 0, 3};

// Six phyxels in a row, the edge between the third and the fourth; kNone where the row ends.
using EdgeRow = std::array<Index, 6>;

// Coefficients of the function of the edge; false: there are none.
bool addCoefficients(const EdgeRow &row, std::span<const double> volumes, QuadraticEdges &out) {
  double most = 0.0;
  for (std::size_t k = 1; k < 5; ++k)
    if (row[k] != kNone) most = std::max(most, volumes[row[k]]);
  // Whether there are three phyxels from k on, each with enough volume.
  const auto isFilled = [&](std::size_t k) {
    return row[k] != kNone && row[k + 1] != kNone && row[k + 2] != kNone &&
           std::min({volumes[row[k]], volumes[row[k + 1]], volumes[row[k + 2]]}) >= kMinVolumeShare * most;
  };
  const auto add = [&](Index phyxel, double weight) {
    out.phyxels.indices.push_back(phyxel);
    out.weights.push_back(weight);
  };
  if (isFilled(1) && isFilled(2)) {
    add(row[1], -1.0 / 16.0);
    add(row[2], 1.0 / 16.0);
    add(row[3], 1.0 / 16.0);
    add(row[4], -1.0 / 16.0);
  } else {
    const auto found = std::find_if(kParabolas.begin(), kParabolas.end(), isFilled);
    if (found == kParabolas.end()) return false;
    add(row[*found], -1.0 / 8.0);
    add(row[*found + 1], 2.0 / 8.0);
    add(row[*found + 2], -1.0 / 8.0);
  }
  out.phyxels.offsets.push_back(static_cast<Index>(out.phyxels.indices.size()));
  return true;
}

}  // namespace

EdgeFunctions edgeFunctionsAt(const Vec3 &place) {
  const Vec3 at = place.cwiseMax(-0.5).cwiseMin(0.5);
  EdgeFunctions out;
  for (std::size_t e = 0; e < kEdges; ++e) {
    const EdgeFrame f(e);
    const double x = 1.0 - 4.0 * at[f.a] * at[f.a], y = 0.5 + f.sb * at[f.b], z = 0.5 + f.sc * at[f.c];
    Vec3 &g = out.gradients[e];
    g[f.a] = -8.0 * at[f.a] * y * z;
    g[f.b] = x * f.sb * z;
    g[f.c] = x * y * f.sc;
    out.values[e] = x * y * z + g.dot(place - at);
  }
  return out;
}

EdgeMeans edgeMeansOf(const Moments &m) {
  EdgeMeans out;
  const Vec3 first = m.first / m.share, mixed = m.mixed / m.share, second = m.second / m.share;
  const Mat3 cubic = m.cubic / m.share;
  const Vec3 quartic = m.quartic / m.share;
  const double triple = m.triple / m.share;
  for (std::size_t e = 0; e < kEdges; ++e) {
    const EdgeFrame f(e);
    const auto ab = static_cast<Eigen::Index>(mixedIndex(f.a, f.b)),
               ac = static_cast<Eigen::Index>(mixedIndex(f.a, f.c)),
               bc = static_cast<Eigen::Index>(mixedIndex(f.b, f.c));
    const double side = 0.25 + 0.5 * (f.sb * first[f.b] + f.sc * first[f.c]) + f.sb * f.sc * mixed[bc];
    const double squares =
        0.25 * second[f.a] + 0.5 * (f.sb * cubic(f.a, f.b) + f.sc * cubic(f.a, f.c)) + f.sb * f.sc * quartic[f.a];
    out.functions.values[e] = side - 4.0 * squares;
    const double offB = 0.5 * first[f.a] + f.sc * mixed[ac], offC = 0.5 * first[f.a] + f.sb * mixed[ab];
    Vec3 &g = out.functions.gradients[e];
    g[f.a] = -8.0 * (0.25 * first[f.a] + 0.5 * (f.sb * mixed[ab] + f.sc * mixed[ac]) + f.sb * f.sc * triple);
    g[f.b] = f.sb * (0.5 - 2.0 * second[f.a] + f.sc * (first[f.c] - 4.0 * cubic(f.a, f.c)));
    g[f.c] = f.sc * (0.5 - 2.0 * second[f.a] + f.sb * (first[f.b] - 4.0 * cubic(f.a, f.b)));
    SecondDerivatives &H = out.second[e];
    H[static_cast<std::size_t>(f.a)] = -8.0 * side;
    H[3 + static_cast<std::size_t>(ab)] = -8.0 * f.sb * offB;
    H[3 + static_cast<std::size_t>(ac)] = -8.0 * f.sc * offC;
    H[3 + static_cast<std::size_t>(bc)] = f.sb * f.sc * (1.0 - 4.0 * second[f.a]);
  }
  for (int j = 0; j < 8; ++j) {
    const Vec3 s(cornerSign(j, 0), cornerSign(j, 1), cornerSign(j, 2));
    const double all = s[0] * s[1] * s[2];
    out.ofCorners[static_cast<std::size_t>(j)] = {
        0.5 * s[0] * s[1] + all * first[2], 0.5 * s[0] * s[2] + all * first[1], 0.5 * s[1] * s[2] + all * first[0]};
  }
  return out;
}

QuadraticEdges findQuadraticEdges(const CellSet &set, std::span<const CutCellFragment> parts, const NodeTable &corners,
                                  std::span<const std::uint8_t> taking, std::span<const std::uint8_t> wanted,
                                  std::span<const std::uint8_t> excluded, std::span<const double> volumes) {
  const std::unordered_set<std::uint64_t> hanging = pairsAroundHanging(corners);
  Rows rows(corners.positions.size());
  struct Known {
    bool isWanted = false, isExcluded = false;
    std::int32_t size = 0;
    Index row = kNone;
  };
  std::unordered_map<std::uint64_t, Known> known;
  const auto forEdges = [&](const auto &visit) {
    for (std::size_t p = 0; p < parts.size(); ++p) {
      if (taking[p] == 0) continue;
      const std::array<Index, 8> phyxels = phyxelsOf(corners, parts[p]);
      for (std::size_t e = 0; e < kEdges; ++e) {
        const CellEdge edge = edgeOfCell(e);
        if (phyxels[edge.low] != kNone && phyxels[edge.high] != kNone)
          visit(p, e, edge.axis, phyxels[edge.low], phyxels[edge.high]);
      }
    }
  };
  forEdges([&](std::size_t p, std::size_t, std::size_t axis, Index low, Index high) {
    const std::int32_t size = set.cells[parts[p].cell].size;
    Known &edge = known[pairOf(low, high)];
    edge.isExcluded = edge.isExcluded || excluded[p] != 0 || (edge.size != 0 && edge.size != size);
    edge.isWanted = edge.isWanted || wanted[p] != 0;
    edge.size = size;
    rows.add(low, high, axis, size);
  });
  QuadraticEdges out;
  out.ofParts.resize(parts.size());
  for (auto &edges : out.ofParts) edges.fill(kNone);
  forEdges([&](std::size_t p, std::size_t e, std::size_t axis, Index low, Index high) {
    Known &edge = known[pairOf(low, high)];
    if (!edge.isWanted || edge.isExcluded || hanging.contains(pairOf(low, high))) return;
    if (edge.row == kNone) {
      const auto next = [&](Index from, bool up) {
        return from == kNone ? kNone : rows.next(from, axis, up, edge.size);
      };
      const Index before = next(low, false), after = next(high, true);
      const auto row = static_cast<Index>(out.phyxels.rows());
      if (!addCoefficients({next(before, false), before, low, high, after, next(after, true)}, volumes, out)) return;
      edge.row = row;
    }
    out.ofParts[p][e] = edge.row;
  });
  if (out.phyxels.rows() == 0) return {};
  return out;
}

}  // namespace pointbased::lattice
