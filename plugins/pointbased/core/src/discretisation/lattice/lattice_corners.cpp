// SPDX-License-Identifier: Apache-2.0
// Merges corners to phyxels, and finds the corners that hang on a larger cell.
#include <map>

#include "base/cancellation_poll.h"
#include "base/disjoint_sets.h"
#include "discretisation/lattice/cut_cell_fragments.h"

namespace pointbased::lattice {
namespace {

Index cornerOf(Index part, int corner) { return 8 * part + static_cast<Index>(corner); }

Cell3 placeOf(const Cell &cell, int corner) {
  return {cell.at[0] + cell.size * (corner & 1), cell.at[1] + cell.size * (corner >> 1 & 1),
          cell.at[2] + cell.size * (corner >> 2)};
}

// Corners of the edge or face of a larger cell that a hanging node at its centre follows.
struct HangingNodeMasters {
  int count = 0;
  std::array<Index, 4> corners{};
};

// Matches nodes of the face of part a with those of part b, whose cell is of the same size or twice as large.
template <class Join, class Hang>
void matchFaces(const CellSet &set, const PartSet &parts, const FragmentLink &link, const Join &join,
                const Hang &hang) {
  const Cell &a = set.cells[parts.parts[link.a].cell], &b = set.cells[parts.parts[link.b].cell];
  const int axis = link.face / 2, up = link.face % 2;
  for (int corner = 0; corner < 8; ++corner) {
    if ((corner >> axis & 1) != up) continue;
    const Cell3 at = placeOf(a, corner);
    // Along each axis of the face the position is an end of the larger edge or its midpoint.
    int fixed = (1 - up) << axis;
    std::array<int, 2> middle{};
    int middles = 0;
    for (int along = 0; along < 3; ++along) {
      if (along == axis) continue;
      const std::int32_t offset = at[static_cast<std::size_t>(along)] - b.at[static_cast<std::size_t>(along)];
      if (offset == b.size)
        fixed |= 1 << along;
      else if (offset != 0)
        middle[static_cast<std::size_t>(middles++)] = along;
    }
    if (middles == 0) {
      join(cornerOf(link.a, corner), cornerOf(link.b, fixed));
      continue;
    }
    HangingNodeMasters masters;
    for (int m = 0; m < 1 << middles; ++m) {
      int master = fixed;
      for (int i = 0; i < middles; ++i)
        if ((m >> i & 1) != 0) master |= 1 << middle[static_cast<std::size_t>(i)];
      masters.corners[static_cast<std::size_t>(masters.count++)] = cornerOf(link.b, master);
    }
    hang(cornerOf(link.a, corner), masters);
  }
}

/// The corners of all fragments, joined where the body continues.
class CornerJoiner {
 public:
  CornerJoiner(const CellSet &set, const PartSet &parts, const ParallelFor &parallelFor)
      : set_(set), parts_(parts), look_(parallelFor), sets_(8 * parts.parts.size()),
        nodeOf_(8 * parts.parts.size(), kNone) {}

  void join() {
    std::vector<std::pair<Index, HangingNodeMasters>> hanging;
    for (const FragmentLink &link : parts_.links) {
      look_();
      matchFaces(
          set_, parts_, link, [&](Index a, Index b) { sets_.join(a, b); },
          [&](Index corner, const HangingNodeMasters &masters) { hanging.emplace_back(corner, masters); });
    }
    // A corner that hangs on two larger cells joins their corners: the body continues around their common edge.
    for (bool joined = true; joined;) {
      joined = false;
      mastersOf_.clear();
      for (const auto &[corner, masters] : hanging) {
        const auto [found, isNew] = mastersOf_.emplace(sets_.find(corner), masters);
        if (!isNew) joined = joinMasters(masters, found->second) || joined;
      }
    }
  }

  // Numbers the nodes of kept fragments, and those they hang on, in the order of their positions.
  void number() {
    for (std::size_t p = 0; p < parts_.parts.size(); ++p) {
      look_();
      if (parts_.parts[p].kept)
        for (int corner = 0; corner < 8; ++corner) use(cornerOf(static_cast<Index>(p), corner));
    }
    std::vector<std::pair<std::uint64_t, Index>> order;
    order.reserve(nodes_.size());
    for (const Index root : nodes_) order.emplace_back(mortonCode(placeOfCorner(root)), root);
    std::sort(order.begin(), order.end());
    for (std::size_t i = 0; i < order.size(); ++i) {
      nodes_[i] = order[i].second;
      nodeOf_[nodes_[i]] = static_cast<Index>(i);
    }
  }

  [[nodiscard]] Index node(Index corner) { return nodeOf_[sets_.find(corner)]; }

  // Phyxels are the nodes that do not hang.
  NodeTable table() {
    NodeTable out;
    std::vector<Index> phyxelOf(nodes_.size(), kNone);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (mastersOf_.contains(nodes_[i])) continue;
      phyxelOf[i] = static_cast<Index>(out.positions.size());
      out.positions.push_back(set_.frame.place(placeOfCorner(nodes_[i])));
    }
    std::map<Index, double> row;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      look_();
      row.clear();
      addTo(row, phyxelOf, nodes_[i], 1.0);
      for (const auto &[phyxel, weight] : row) {
        out.phyxels.push_back(phyxel);
        out.weights.push_back(weight);
      }
      out.offsets.push_back(static_cast<std::uint32_t>(out.phyxels.size()));
    }
    return out;
  }

 private:
  [[nodiscard]] Cell3 placeOfCorner(Index corner) const {
    return placeOf(set_.cells[parts_.parts[corner / 8].cell], static_cast<int>(corner % 8));
  }

  bool joinMasters(const HangingNodeMasters &some, const HangingNodeMasters &others) {
    bool joined = false;
    for (int i = 0; i < some.count; ++i)
      for (int j = 0; j < others.count; ++j) {
        const Index a = some.corners[static_cast<std::size_t>(i)], b = others.corners[static_cast<std::size_t>(j)];
        if (placeOfCorner(a) == placeOfCorner(b)) joined = sets_.join(a, b) || joined;
      }
    return joined;
  }

  void use(Index corner) {
    const Index root = sets_.find(corner);
    if (nodeOf_[root] != kNone) return;
    nodeOf_[root] = 0;
    nodes_.push_back(root);
    const auto found = mastersOf_.find(root);
    if (found == mastersOf_.end()) return;
    for (int i = 0; i < found->second.count; ++i) use(found->second.corners[static_cast<std::size_t>(i)]);
  }

  void addTo(std::map<Index, double> &row, std::span<const Index> phyxelOf, Index root, double weight) {
    const auto found = mastersOf_.find(root);
    if (found == mastersOf_.end()) {
      row[phyxelOf[nodeOf_[root]]] += weight;
      return;
    }
    const HangingNodeMasters &masters = found->second;
    for (int i = 0; i < masters.count; ++i)
      addTo(row, phyxelOf, sets_.find(masters.corners[static_cast<std::size_t>(i)]), weight / masters.count);
  }

  const CellSet &set_;
  const PartSet &parts_;
  detail::CancellationPoll look_;
  DisjointSets sets_;
  std::unordered_map<Index, HangingNodeMasters> mastersOf_;  // by root
  std::vector<Index> nodeOf_;                                // by root
  std::vector<Index> nodes_;                                 // root of each node
};

}  // namespace

NodeTable joinCorners(const CellSet &set, PartSet &parts, const ParallelFor &parallelFor) {
  CornerJoiner joiner(set, parts, parallelFor);
  joiner.join();
  joiner.number();
  for (std::size_t p = 0; p < parts.parts.size(); ++p)
    for (int corner = 0; corner < 8; ++corner)
      parts.parts[p].nodes[static_cast<std::size_t>(corner)] = joiner.node(cornerOf(static_cast<Index>(p), corner));
  return joiner.table();
}

void NodeTable::compact() {
  positions.clear();
  positions.shrink_to_fit();
  for (std::size_t row = 0; row + 1 < offsets.size(); ++row)
    if (offsets[row + 1] != row + 1 || phyxels[row] != row) return;
  std::vector<std::uint32_t>().swap(offsets);
  std::vector<Index>().swap(phyxels);
  std::vector<double>().swap(weights);
}

}  // namespace pointbased::lattice
