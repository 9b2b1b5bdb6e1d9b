// SPDX-License-Identifier: Apache-2.0
#include "solvers/grid_hierarchy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/disjoint_sets.h"
#include "base/expects.h"

namespace pointbased::detail {
namespace {

constexpr std::size_t kCoarsest = 120;  // nodes: few enough for a dense factorisation
constexpr double kWorthwhile = 0.95;    // a coarser level has at most this part of the nodes, otherwise it is the last
constexpr int kMaxLevels = 12;
constexpr Index kMinOfSlab = 200;  // nodes: ten microseconds

using Place = std::array<int, 3>;  // on the grid of the finest cells

// Parts of the body in cells, and their nodes.
struct Cells {
  Csr nodes;
  std::vector<Vec3> centres;  // in cells of the finest level
  std::vector<Place> places;  // of nodes
  [[nodiscard]] std::size_t count() const { return nodes.rows(); }
};

// Checks for cancellation at intervals.
class Watch {
 public:
  explicit Watch(const StopRequest *stop) : stop_(stop) {}
  void look() {
    constexpr std::size_t kEvery = 1024;
    if (++seen_ % kEvery == 0) throwIfStopRequested(stop_);
  }

 private:
  const StopRequest *stop_;
  std::size_t seen_ = 0;
};

Csr transposed(const Csr &rows, std::size_t columns, std::vector<Index> &places);

// Nodes that share a cell with a node, and the node itself: inside a support a phyxel may have no cell.
Csr neighboursIn(const Csr &cells, std::size_t nodes, Watch &watch) {
  std::vector<Index> entries;
  const Csr cellsOf = transposed(cells, nodes, entries);
  Csr out;
  out.indices.reserve(27 * nodes);
  std::vector<Index> seenBy(nodes, ~Index{0});
  for (Index i = 0; i < nodes; ++i) {
    watch.look();
    const auto begin = static_cast<std::ptrdiff_t>(out.indices.size());
    seenBy[i] = i;
    out.indices.push_back(i);
    for (const Index q : cellsOf.row(i))
      for (const Index j : cells.row(q)) {
        if (seenBy[j] == i) continue;
        seenBy[j] = i;
        out.indices.push_back(j);
      }
    std::sort(out.indices.begin() + begin, out.indices.end());
    out.offsets.push_back(static_cast<Index>(out.indices.size()));
  }
  return out;
}

// Distance of every node, in edges, from an end of its connected component.
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
    // Again from the farthest node: more and thinner layers.
    const Index end = queue.back();
    for (const Index j : queue) layer[j] = kUnseen;
    spread(end);
  }
  return layer;
}

// New number of every node; slabs as in GridLevel.
std::vector<Index> numberBySlabs(const Csr &rows, GridLevel &level) {
  const std::size_t n = rows.rows();
  const std::vector<Index> layer = layersOf(rows);
  std::vector<Index> size(*std::max_element(layer.begin(), layer.end()) + 1, 0);
  for (const Index k : layer) ++size[k];
  // Combines layers until they are worth a thread.
  std::vector<Index> slabOf(size.size(), 0), sizes(1, 0);
  for (std::size_t k = 0; k < size.size(); ++k) {
    if (sizes.back() >= kMinOfSlab) sizes.push_back(0);
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
  const auto slab = [&](std::size_t i) { return place[slabOf[layer[i]]]; };
  // Nodes that depend on equally many nodes in a row are consecutive: a sweep has the same result, without a dependency
  // between consecutive nodes.
  std::vector<Index> wait(n, 0), number(n), order(n);
  for (std::size_t i = 0; i < n; ++i)
    for (const Index j : rows.row(i))
      if (j < i && slab(j) == slab(i)) wait[i] = std::max(wait[i], wait[j] + 1);
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](Index i, Index j) { return slab(i) != slab(j) ? slab(i) < slab(j) : wait[i] < wait[j]; });
  for (std::size_t k = 0; k < n; ++k) number[order[k]] = static_cast<Index>(k);
  return number;
}

// Transposes `rows`; `places`: new positions of the entries.
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

// Cells of twice the width, and the coarse nodes that the fine nodes follow.
class Coarsening {
 public:
  Coarsening(const Cells &fine, int width, Watch &watch)
      : fine_(fine), width_(width), watch_(watch), cellsOf_(transposed(fine.nodes, fine.places.size())),
        partOf_(fine.count()) {
    findParts();
    findCorners();
  }

  [[nodiscard]] const std::vector<Index> &partOf() const { return partOf_; }
  [[nodiscard]] const Cells &cells() const { return coarse_; }
  [[nodiscard]] bool keepsWide() const {
    return std::any_of(boxes_.begin(), boxes_.end(), [](const Box &box) { return box.width == 0; });
  }

  // Weights of the trilinear functions of a coarse cell that contains a node.
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
    for (std::size_t q = 0; q < fine_.count(); ++q)  // none: jittered nodes; any coarse cell that has the node
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
    // Cells inside one coarse cell that share a node are merged; cells too wide for it remain separate.
    std::vector<std::uint8_t> isWide(fine_.count());
    std::vector<Place> cell(fine_.count());
    for (std::size_t q = 0; q < fine_.count(); ++q) {
      isWide[q] = widthOf(fine_, q) > width_ ? 1 : 0;
      cell[q] = cellOf(q);
    }
    DisjointSets sets(fine_.count());
    for (std::size_t i = 0; i < cellsOf_.rows(); ++i) {
      watch_.look();
      const auto around = cellsOf_.row(i);
      for (std::size_t a = 0; a < around.size(); ++a)
        for (std::size_t b = a + 1; b < around.size() && isWide[around[a]] == 0; ++b)
          if (isWide[around[b]] == 0 && cell[around[a]] == cell[around[b]]) (void)sets.join(around[a], around[b]);
    }
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

  // Corners at the same position are one node if their parts share a finer node.
  void findCorners() {
    std::vector<std::pair<Index, Index>> neighbours;
    std::vector<Index> around;
    for (std::size_t i = 0; i < cellsOf_.rows(); ++i) {
      watch_.look();
      around.clear();
      for (const Index q : cellsOf_.row(i))
        if (std::find(around.begin(), around.end(), partOf_[q]) == around.end()) around.push_back(partOf_[q]);
      for (const Index a : around)
        for (const Index b : around)
          if (a < b) neighbours.emplace_back(a, b);
    }
    std::sort(neighbours.begin(), neighbours.end());
    neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
    DisjointSets sets(slots_.size());
    for (const auto &[a, b] : neighbours) {
      watch_.look();
      for (Index c = boxes_[a].first; c < boxes_[a].first + boxes_[a].corners; ++c)
        for (Index d = boxes_[b].first; d < boxes_[b].first + boxes_[b].corners; ++d)
          if (slots_[c] == slots_[d]) (void)sets.join(c, d);
    }
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
  Watch &watch_;
  Csr cellsOf_;                // [nodes]
  std::vector<Index> partOf_;  // [cells]
  std::vector<Box> boxes_;     // [parts]
  std::vector<Place> slots_;   // corners of all parts
  std::vector<Index> nodeOf_;  // [slots]
  Cells coarse_;
};

// Cells of the stencils on the grid of the finest cells.
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

// Cells of the next coarser level, with springs: the nodes followed by those of their parts. Their positions are stored
// in the finer level.
Csr coarserCells(GridLevel &fine, const Csr &finer, Watch &watch) {
  Csr out;
  fine.firstPlace.resize(fine.cells.indices.size());
  std::size_t count = 0;
  for (std::size_t e = 0; e < fine.firstPlace.size(); ++e) {
    fine.firstPlace[e] = static_cast<Index>(count);
    count += fine.parents.row(fine.cells.indices[e]).size();
  }
  fine.places.resize(count);
  for (std::size_t Q = 0; Q < finer.rows(); ++Q) {
    watch.look();
    const auto begin = static_cast<std::ptrdiff_t>(out.indices.size());
    for (const Index q : finer.row(Q))
      for (Index e = fine.cells.offsets[q]; e < fine.cells.offsets[q + 1]; ++e) {
        std::size_t at = fine.firstPlace[e];
        for (const Index parent : fine.parents.row(fine.cells.indices[e])) {
          const auto found = std::find(out.indices.begin() + begin, out.indices.end(), parent);
          fine.places[at++] = static_cast<std::uint16_t>(found - out.indices.begin() - begin);
          if (found == out.indices.end()) out.indices.push_back(parent);
        }
      }
    out.offsets.push_back(static_cast<Index>(out.indices.size()));
  }
  return out;
}

Csr renumbered(const Csr &rows, std::span<const Index> number) {
  std::vector<Index> from(rows.rows());
  for (std::size_t i = 0; i < from.size(); ++i) from[number[i]] = static_cast<Index>(i);
  Csr out;
  out.indices.reserve(rows.indices.size());
  for (const Index old : from) {
    const std::size_t begin = out.indices.size();
    for (const Index j : rows.row(old)) out.indices.push_back(number[j]);
    std::sort(out.indices.begin() + static_cast<std::ptrdiff_t>(begin), out.indices.end());
    out.offsets.push_back(static_cast<Index>(out.indices.size()));
  }
  return out;
}

// Arranges rows in groups of eight, and finds the positions of the pairs of every cell in them.
void findSlots(GridLevel &level, Watch &watch) {
  const std::size_t n = level.nodes();
  std::vector<Index> entries;
  level.firstEntry.assign(n, static_cast<Index>(level.cells.indices.size()));
  for (Index e = 0; e < level.cells.indices.size(); ++e) {
    Index &first = level.firstEntry[level.cells.indices[e]];
    first = std::min(first, e);
  }
  const Csr &cells = level.rowCells();
  level.cellOfEntry.resize(cells.indices.size());
  for (std::size_t q = 0; q < cells.rows(); ++q)
    std::fill_n(level.cellOfEntry.begin() + cells.offsets[q], cells.row(q).size(), static_cast<Index>(q));
  level.cellsOf = transposed(cells, n, entries);
  for (std::size_t e = 0; e < entries.size(); ++e) level.cellsOf.indices[entries[e]] = static_cast<Index>(e);
  level.diagonal.resize(n);
  level.eights.assign(1, 0);
  level.slots.reserve(8 * cells.indices.size());
  std::vector<std::uint16_t> place(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    watch.look();
    const auto row = level.rows.row(i);
    const auto before = static_cast<std::size_t>(std::lower_bound(row.begin(), row.end(), i) - row.begin());
    level.diagonal[i] = level.rows.offsets[i] + static_cast<Index>(before);
    const std::size_t begin = level.columns.size();
    const auto fill = [&](std::span<const Index> part) {
      for (const Index j : part) {
        place[j] = static_cast<std::uint16_t>(GridLevel::slotOf(level.columns.size() - begin));
        level.columns.push_back(j);
      }
      while (level.columns.size() % 8 != 0) level.columns.push_back(part.front());
      level.eights.push_back(static_cast<Index>(level.columns.size() / 8));
    };
    fill(row.first(before));
    fill(row.subspan(before + 1));
    POINTBASED_EXPECTS(GridLevel::slotOf(level.columns.size() - begin) <= 0xFFFF, "too many neighbours of a node");
    place[i] = 0;
    level.firstSlot.push_back(level.slots.size());
    for (const Index e : level.cellsOf.row(i))
      for (const Index j : cells.row(level.cellOfEntry[e])) level.slots.push_back(place[j]);
  }
}

}  // namespace

std::shared_ptr<const GridHierarchy> buildGridHierarchy(const StencilSet &stencils, std::span<const Vec3> positions,
                                                        std::span<const Vec3> pointCentres, double spacing,
                                                        const Csr &springs, const StopRequest *stop) {
  if (!stencils.isLattice() || positions.empty()) return nullptr;
  auto out = std::make_shared<GridHierarchy>();
  Watch watch(stop);
  // Coarser lattices need rows no wider than a cell.
  if (!stencils.quadratic.of.empty()) out->trilinear = std::make_unique<StencilSet>(withTrilinearRows(stencils));
  const StencilSet &narrow = out->trilinear ? *out->trilinear : stencils;
  Cells cells = finestCells(narrow, positions, pointCentres, spacing);
  const auto withSprings = [&](Csr rows) {
    for (std::size_t p = 0; p < springs.rows(); ++p) {
      rows.indices.insert(rows.indices.end(), springs.row(p).begin(), springs.row(p).end());
      rows.offsets.push_back(static_cast<Index>(rows.indices.size()));
    }
    return rows;
  };
  Csr all = withSprings(narrow.phyxels), wide;
  if (out->trilinear) wide = withSprings(stencils.phyxels);
  out->springs = springs;
  Csr finer;
  std::size_t nodes = positions.size();
  for (int width = 2;; width *= 2) {
    GridLevel &level = out->levels.emplace_back();
    throwIfStopRequested(stop);
    const Csr pattern = neighboursIn(wide.indices.empty() ? all : wide, nodes, watch);
    const std::vector<Index> number = numberBySlabs(pattern, level);
    throwIfStopRequested(stop);
    level.rows = renumbered(pattern, number);
    level.cells = std::move(all);
    level.wideCells = std::exchange(wide, Csr());
    for (Csr *rows : {&level.cells, &level.wideCells})
      for (Index &i : rows->indices) i = number[i];
    level.finer = std::move(finer);
    findSlots(level, watch);
    renumber(cells, number);
    if (out->levels.size() == 1) {
      out->order.resize(number.size());
      for (std::size_t i = 0; i < number.size(); ++i) out->order[number[i]] = static_cast<Index>(i);
      out->number = number;
    } else {
      GridLevel &before = out->levels[out->levels.size() - 2];
      for (Index &parent : before.parents.indices) parent = number[parent];
      std::vector<Index> places;
      level.children = transposed(before.parents, level.nodes(), places);
      level.childWeights.resize(places.size());
      for (std::size_t e = 0; e < places.size(); ++e) level.childWeights[places[e]] = before.parentWeights[e];
    }
    if (level.nodes() <= kCoarsest || static_cast<int>(out->levels.size()) == kMaxLevels) break;
    const Coarsening coarsening(cells, width, watch);
    nodes = coarsening.cells().places.size();
    if (!coarsening.keepsWide() && static_cast<double>(nodes) > kWorthwhile * static_cast<double>(level.nodes())) break;
    coarsening.parents(level.parents, level.parentWeights);
    Csr coarser;  // [cells]
    for (std::size_t q = 0; q < level.cells.rows(); ++q) {
      const std::size_t spring = coarsening.cells().count() + q - cells.count();
      coarser.indices.push_back(q < cells.count() ? coarsening.partOf()[q] : static_cast<Index>(spring));
      coarser.offsets.push_back(static_cast<Index>(q + 1));
    }
    finer = transposed(coarser, coarsening.cells().count() + springs.rows());
    all = coarserCells(level, finer, watch);
    cells = Cells(coarsening.cells());
  }
  return out;
}

}  // namespace pointbased::detail
