// SPDX-License-Identifier: Apache-2.0
#include "solvers/grid_hierarchy.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/disjoint_sets.h"

namespace pointbased::detail {
namespace {

constexpr std::size_t kCoarsest = 120;  // nodes: few enough for a dense factorisation
constexpr double kWorthwhile = 0.95;    // a coarser level has at most this part of the nodes, or it is the last
constexpr int kMostLevels = 12;
constexpr Index kLeastOfSlab = 200;  // nodes: ten microseconds

using Place = std::array<int, 3>;  // on the grid of the finest cells

// Parts of the body in cells, and their nodes.
struct Cells {
  Csr nodes;
  std::vector<Vec3> centres;  // in cells of the finest level
  std::vector<Place> places;  // of nodes
  [[nodiscard]] std::size_t count() const { return nodes.rows(); }
};

Csr neighboursIn(const Csr &cells, const Csr &springs, std::size_t nodes) {
  std::vector<std::vector<Index>> rows(nodes);
  for (Index i = 0; i < nodes; ++i) rows[i].push_back(i);  // amid a support a phyxel may have no cell
  for (const Csr *groups : {&cells, &springs})
    for (std::size_t q = 0; q < groups->rows(); ++q) {
      const auto group = groups->row(q);
      for (const Index a : group) rows[a].insert(rows[a].end(), group.begin(), group.end());
    }
  Csr out;
  for (std::vector<Index> &row : rows) {
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    out.indices.insert(out.indices.end(), row.begin(), row.end());
    out.offsets.push_back(static_cast<Index>(out.indices.size()));
  }
  return out;
}

// Of every node the distance in edges from an end of its connected part.
std::vector<Index> layersOf(const Csr &rows) {
  constexpr Index kUnseen = ~Index{0};
  std::vector<Index> layer(rows.rows(), kUnseen), queue;
  const auto spread = [&](Index from) {
    queue.assign(1, from);
    layer[from] = 0;
    for (std::size_t k = 0; k < queue.size(); ++k)
      for (const Index j : rows.row(queue[k])) {
        if (layer[j] != kUnseen) continue;
        layer[j] = layer[queue[k]] + 1;
        queue.push_back(j);
      }
  };
  for (Index i = 0; i < rows.rows(); ++i) {
    if (layer[i] != kUnseen) continue;
    spread(i);
    // Once more from what is farthest: more and thinner layers.
    const Index end = queue.back();
    for (const Index j : queue) layer[j] = kUnseen;
    spread(end);
  }
  return layer;
}

// New number of every node; slabs as GridLevel's.
std::vector<Index> numberBySlabs(const Csr &rows, GridLevel &level) {
  const std::size_t n = rows.rows();
  const std::vector<Index> layer = layersOf(rows);
  std::vector<Index> size(*std::max_element(layer.begin(), layer.end()) + 1, 0);
  for (const Index k : layer) ++size[k];
  // Layers together until they are worth a thread's while.
  std::vector<Index> slabOf(size.size(), 0), sizes(1, 0);
  for (std::size_t k = 0; k < size.size(); ++k) {
    if (sizes.back() >= kLeastOfSlab) sizes.push_back(0);
    slabOf[k] = static_cast<Index>(sizes.size() - 1);
    sizes.back() += size[k];
  }
  const std::size_t slabs = sizes.size();
  level.firstHalf = (slabs + 1) / 2;
  std::vector<Index> place(slabs), begin(slabs, 0);
  for (std::size_t s = 0; s < slabs; ++s) place[s] = static_cast<Index>(s / 2 + (s % 2 == 0 ? 0 : level.firstHalf));
  for (std::size_t s = 0; s < slabs; ++s) begin[place[s]] = sizes[s];
  level.slabs.assign(1, 0);
  for (const Index k : begin) level.slabs.push_back(level.slabs.back() + k);
  std::vector<Index> next(level.slabs.begin(), level.slabs.end() - 1), number(n);
  for (std::size_t i = 0; i < n; ++i) number[i] = next[place[slabOf[layer[i]]]]++;
  return number;
}

// `rows` by columns; where their entries have gone to.
Csr transposed(const Csr &rows, std::size_t columns, std::vector<Index> &places) {
  Csr t;
  t.offsets.assign(columns + 1, 0);
  for (const Index j : rows.indices) ++t.offsets[j + 1];
  for (std::size_t j = 0; j < columns; ++j) t.offsets[j + 1] += t.offsets[j];
  std::vector<Index> next(t.offsets.begin(), t.offsets.end() - 1);
  t.indices.resize(rows.indices.size());
  places.resize(rows.indices.size());
  for (std::size_t i = 0; i < rows.rows(); ++i)
    for (Index e = rows.offsets[i]; e < rows.offsets[i + 1]; ++e) {
      places[e] = next[rows.indices[e]]++;
      t.indices[places[e]] = static_cast<Index>(i);
    }
  return t;
}

Csr transposed(const Csr &rows, std::size_t columns) {
  std::vector<Index> places;
  return transposed(rows, columns, places);
}

void renumber(Cells &cells, std::span<const Index> number) {
  std::vector<Place> places(cells.places.size());
  for (std::size_t i = 0; i < places.size(); ++i) places[number[i]] = cells.places[i];
  cells.places = std::move(places);
  for (Index &i : cells.nodes.indices) i = number[i];
}

int widthOf(const Cells &cells, std::size_t q) {
  int low = 1 << 30, high = -(1 << 30);
  for (const Index i : cells.nodes.row(q)) {
    low = std::min(low, cells.places[i][0]);
    high = std::max(high, cells.places[i][0]);
  }
  return high - low;
}

// Cells of twice the width, and what of them the nodes follow.
class Coarsening {
 public:
  Coarsening(const Cells &fine, int width)
      : fine_(fine), width_(width), cellsOf_(transposed(fine.nodes, fine.places.size())), partOf_(fine.count()) {
    findParts();
    findCorners();
  }

  [[nodiscard]] const Cells &cells() const { return coarse_; }
  [[nodiscard]] bool keepsWide() const {
    return std::any_of(boxes_.begin(), boxes_.end(), [](const Box &box) { return box.width == 0; });
  }

  // Trilinear functions of a cell that a node lies in.
  void parents(Csr &out, std::vector<float> &weights) const {
    const std::size_t n = fine_.places.size();
    std::vector<Index> partOfNode(n, 0);
    std::vector<std::uint8_t> isFound(n, 0);
    for (std::size_t q = 0; q < fine_.count(); ++q)
      for (const Index i : fine_.nodes.row(q)) {
        const Index part = partOf_[q];
        if (isFound[i] != 0 || !isIn(part, fine_.places[i])) continue;
        partOfNode[i] = part;
        isFound[i] = 1;
      }
    for (std::size_t q = 0; q < fine_.count(); ++q)  // none: jittered ones; any that has it
      for (const Index i : fine_.nodes.row(q)) {
        if (isFound[i] != 0) continue;
        partOfNode[i] = partOf_[q];
        isFound[i] = 1;
      }
    out = Csr();
    weights.clear();
    for (std::size_t i = 0; i < n; ++i) {
      if (isFound[i] != 0) addParents(partOfNode[i], fine_.places[i], out, weights);
      out.offsets.push_back(static_cast<Index>(out.indices.size()));
    }
  }

 private:
  struct Box {
    Place low{};
    int width = 0;    // 0: the corners are the nodes of one finer cell
    Index first = 0;  // its corners in slots_
    Index corners = 8;
  };

  [[nodiscard]] Place cellOf(std::size_t q) const {
    Place out;
    for (std::size_t k = 0; k < 3; ++k) {
      const double at = fine_.centres[q][static_cast<Eigen::Index>(k)];
      out[k] = static_cast<int>(std::floor(at / width_)) * width_;
    }
    return out;
  }

  void findParts() {
    // Cells of one coarse cell that share a node belong together; those too wide for it stay alone.
    std::vector<std::uint8_t> isWide(fine_.count());
    std::vector<Place> cell(fine_.count());
    for (std::size_t q = 0; q < fine_.count(); ++q) {
      isWide[q] = widthOf(fine_, q) > width_ ? 1 : 0;
      cell[q] = cellOf(q);
    }
    DisjointSets sets(fine_.count());
    for (std::size_t i = 0; i < cellsOf_.rows(); ++i)
      for (const Index a : cellsOf_.row(i))
        for (const Index b : cellsOf_.row(i))
          if (a < b && isWide[a] == 0 && isWide[b] == 0 && cell[a] == cell[b]) (void)sets.join(a, b);
    std::vector<Index> number(fine_.count(), 0);
    for (std::size_t q = 0; q < fine_.count(); ++q) {
      const Index root = sets.find(static_cast<Index>(q));
      if (root == q) {
        number[q] = static_cast<Index>(boxes_.size());
        addBox(q, isWide[q] != 0, cell[q]);
      }
      partOf_[q] = number[root];
    }
  }

  void addBox(std::size_t q, bool isWide, const Place &low) {
    Box box;
    box.first = static_cast<Index>(slots_.size());
    if (isWide) {
      for (const Index i : fine_.nodes.row(q)) slots_.push_back(fine_.places[i]);
      box.corners = static_cast<Index>(fine_.nodes.row(q).size());
      coarse_.centres.push_back(fine_.centres[q]);
    } else {
      box.low = low;
      box.width = width_;
      for (int c = 0; c < 8; ++c)
        slots_.push_back({low[0] + (c & 1) * width_, low[1] + (c >> 1 & 1) * width_, low[2] + (c >> 2) * width_});
      coarse_.centres.push_back(Vec3(low[0], low[1], low[2]) + Vec3::Constant(0.5 * width_));
    }
    boxes_.push_back(box);
  }

  // Corners at one place are one node where their parts share a finer node.
  void findCorners() {
    std::vector<std::pair<Index, Index>> neighbours;
    for (std::size_t i = 0; i < cellsOf_.rows(); ++i)
      for (const Index a : cellsOf_.row(i))
        for (const Index b : cellsOf_.row(i))
          if (partOf_[a] < partOf_[b]) neighbours.emplace_back(partOf_[a], partOf_[b]);
    std::sort(neighbours.begin(), neighbours.end());
    neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
    DisjointSets sets(slots_.size());
    for (const auto &[a, b] : neighbours)
      for (Index c = boxes_[a].first; c < boxes_[a].first + boxes_[a].corners; ++c)
        for (Index d = boxes_[b].first; d < boxes_[b].first + boxes_[b].corners; ++d)
          if (slots_[c] == slots_[d]) (void)sets.join(c, d);
    nodeOf_.resize(slots_.size());
    for (Index c = 0; c < slots_.size(); ++c) {
      const Index root = sets.find(c);
      if (root == c) {
        nodeOf_[c] = static_cast<Index>(coarse_.places.size());
        coarse_.places.push_back(slots_[c]);
      } else {
        nodeOf_[c] = nodeOf_[root];
      }
    }
    for (const Box &box : boxes_) {
      for (Index c = box.first; c < box.first + box.corners; ++c) coarse_.nodes.indices.push_back(nodeOf_[c]);
      coarse_.nodes.offsets.push_back(static_cast<Index>(coarse_.nodes.indices.size()));
    }
  }

  [[nodiscard]] bool isIn(Index part, const Place &at) const {
    const Box &box = boxes_[part];
    if (box.width == 0) return true;
    for (std::size_t k = 0; k < 3; ++k)
      if (at[k] < box.low[k] || at[k] > box.low[k] + box.width) return false;
    return true;
  }

  void addParents(Index part, const Place &at, Csr &out, std::vector<float> &weights) const {
    const Box &box = boxes_[part];
    if (box.width == 0) {
      for (Index c = box.first; c < box.first + box.corners; ++c)
        if (slots_[c] == at) {
          out.indices.push_back(nodeOf_[c]);
          weights.push_back(1.0F);
          return;
        }
      return;
    }
    for (Index c = 0; c < 8; ++c) {
      double weight = 1.0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double x = static_cast<double>(at[k] - box.low[k]) / box.width;
        weight *= (c >> k & 1U) != 0 ? x : 1.0 - x;
      }
      if (std::abs(weight) < 1e-6) continue;
      out.indices.push_back(nodeOf_[box.first + c]);
      weights.push_back(static_cast<float>(weight));
    }
  }

  const Cells &fine_;
  int width_;
  Csr cellsOf_;                // [nodes]
  std::vector<Index> partOf_;  // [cells]
  std::vector<Box> boxes_;     // [parts]
  std::vector<Place> slots_;   // corners of all parts
  std::vector<Index> nodeOf_;  // [slots]
  Cells coarse_;
};

// Cells of the stencils on the grid of the finest ones.
Cells finestCells(const StencilSet &s, std::span<const Vec3> positions, std::span<const Vec3> centres, double spacing) {
  std::vector<Vec3> local(positions.size());
  Vec3 base = Vec3::Constant(1e300);
  for (std::size_t i = 0; i < local.size(); ++i) {
    local[i] = s.axes.transpose() * positions[i];
    base = base.cwiseMin(local[i]);
  }
  double finest = spacing;
  for (std::size_t q = 0; q < s.pointCount(); ++q) {
    double low = 1e300, high = -1e300;
    for (const Index i : s.phyxels.row(q)) {
      low = std::min(low, local[i][0]);
      high = std::max(high, local[i][0]);
    }
    while (high - low < 0.7 * finest && finest > 1e-3 * spacing) finest *= 0.5;
  }
  Cells out;
  out.nodes = s.phyxels;
  for (const Vec3 &x : local) {
    const Vec3 at = (x - base) / finest;
    out.places.push_back({static_cast<int>(std::lround(at[0])), static_cast<int>(std::lround(at[1])),
                          static_cast<int>(std::lround(at[2]))});
  }
  for (const Vec3 &x : centres) out.centres.emplace_back((s.axes.transpose() * x - base) / finest);
  return out;
}

// Entries of all pairs of each group.
void findSlots(const Csr &groups, std::span<const Index> number, const GridLevel &finest,
               std::vector<std::size_t> &pairs, std::vector<Index> &slots) {
  for (std::size_t q = 0; q < groups.rows(); ++q) {
    pairs.push_back(slots.size());
    for (const Index a : groups.row(q)) {
      const auto row = finest.rows.row(number[a]);
      for (const Index b : groups.row(q))
        slots.push_back(finest.rows.offsets[number[a]] +
                        static_cast<Index>(std::lower_bound(row.begin(), row.end(), number[b]) - row.begin()));
    }
  }
}

// What P^T A P couples, which is more than cells do where large ones meet small ones.
Csr coupledBy(const GridLevel &fine, const Csr &children) {
  Csr out;
  std::vector<Index> row;
  for (std::size_t I = 0; I < children.rows(); ++I) {
    row.assign(1, static_cast<Index>(I));
    for (const Index i : children.row(I))
      for (const Index j : fine.rows.row(i)) {
        const auto of = fine.parents.row(j);
        row.insert(row.end(), of.begin(), of.end());
      }
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    out.indices.insert(out.indices.end(), row.begin(), row.end());
    out.offsets.push_back(static_cast<Index>(out.indices.size()));
  }
  return out;
}

Csr renumbered(const Csr &rows, std::span<const Index> number) {
  std::vector<Index> from(rows.rows());
  for (std::size_t i = 0; i < from.size(); ++i) from[number[i]] = static_cast<Index>(i);
  Csr out;
  for (const Index old : from) {
    const std::size_t begin = out.indices.size();
    for (const Index j : rows.row(old)) out.indices.push_back(number[j]);
    std::sort(out.indices.begin() + static_cast<std::ptrdiff_t>(begin), out.indices.end());
    out.offsets.push_back(static_cast<Index>(out.indices.size()));
  }
  return out;
}

void findDiagonal(GridLevel &level) {
  level.diagonal.resize(level.nodes());
  for (std::size_t i = 0; i < level.nodes(); ++i) {
    const auto row = level.rows.row(i);
    level.diagonal[i] =
        level.rows.offsets[i] + static_cast<Index>(std::lower_bound(row.begin(), row.end(), i) - row.begin());
  }
}

}  // namespace

std::shared_ptr<const GridHierarchy> buildGridHierarchy(const StencilSet &stencils, std::span<const Vec3> positions,
                                                        std::span<const Vec3> pointCentres, double spacing,
                                                        const Csr &springs) {
  if (!stencils.isLattice() || positions.empty()) return nullptr;
  auto out = std::make_shared<GridHierarchy>();
  Cells cells = finestCells(stencils, positions, pointCentres, spacing);
  Csr pattern = neighboursIn(cells.nodes, springs, positions.size());
  out->springs = springs;
  std::vector<Index> number;
  for (int width = 2;; width *= 2) {
    GridLevel &level = out->levels.emplace_back();
    number = numberBySlabs(pattern, level);
    level.rows = renumbered(pattern, number);
    findDiagonal(level);
    renumber(cells, number);
    if (out->levels.size() == 1) {
      out->order.resize(number.size());
      for (std::size_t i = 0; i < number.size(); ++i) out->order[number[i]] = static_cast<Index>(i);
      out->number = number;
      findSlots(stencils.phyxels, number, level, out->pairs, out->slots);
      findSlots(springs, number, level, out->springPairs, out->springSlots);
    } else {
      GridLevel &finer = out->levels[out->levels.size() - 2];
      for (Index &parent : finer.parents.indices) parent = number[parent];
      std::vector<Index> places;
      level.children = transposed(finer.parents, level.nodes(), places);
      level.childWeights.resize(places.size());
      for (std::size_t e = 0; e < places.size(); ++e) level.childWeights[places[e]] = finer.parentWeights[e];
    }
    if (level.nodes() <= kCoarsest || static_cast<int>(out->levels.size()) == kMostLevels) break;
    const Coarsening coarsening(cells, width);
    const std::size_t coarser = coarsening.cells().places.size();
    if (!coarsening.keepsWide() && static_cast<double>(coarser) > kWorthwhile * static_cast<double>(level.nodes()))
      break;
    coarsening.parents(level.parents, level.parentWeights);
    pattern = coupledBy(level, transposed(level.parents, coarser));
    cells = Cells(coarsening.cells());
  }
  return out;
}

}  // namespace pointbased::detail
