// SPDX-License-Identifier: Apache-2.0
// Which corners are one phyxel, and which hang on a larger cell.
#include <map>

#include "base/disjoint_sets.h"
#include "discretisation/lattice/cut_cell_fragments.h"

namespace pointbased::lattice {
namespace {

Index cornerOf(Index part, int corner) { return 8 * part + static_cast<Index>(corner); }

Cell3 placeOf(const Cell &cell, int corner) {
  return {cell.at[0] + cell.size * (corner & 1), cell.at[1] + cell.size * (corner >> 1 & 1),
          cell.at[2] + cell.size * (corner >> 2)};
}

// The corners of a larger cell's edge or face that a place in its middle follows.
struct HangingNodeMasters {
  int count = 0;
  std::array<Index, 4> corners{};
};

// Nodes of part a's face against those of part b, of a cell of the same size or twice as large.
template <class Join, class Hang>
void matchFaces(const CellSet &set, const PartSet &parts, const FragmentLink &link, const Join &join,
                const Hang &hang) {
  const Cell &a = set.cells[parts.parts[link.a].cell], &b = set.cells[parts.parts[link.b].cell];
  const int axis = link.face / 2, up = link.face % 2;
  for (int corner = 0; corner < 8; ++corner) {
    if ((corner >> axis & 1) != up) continue;
    const Cell3 at = placeOf(a, corner);
    // Along each axis of the face the place is an end of the larger edge or its middle.
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

}  // namespace

NodeTable joinCorners(const CellSet &set, PartSet &parts) {
  DisjointSets sets(8 * parts.parts.size());
  std::vector<std::pair<Index, HangingNodeMasters>> hanging;
  for (const FragmentLink &link : parts.links)
    matchFaces(
        set, parts, link, [&](Index a, Index b) { sets.join(a, b); },
        [&](Index corner, const HangingNodeMasters &masters) { hanging.emplace_back(corner, masters); });

  // A corner that hangs on two larger cells joins their corners: the body goes on around their common edge.
  std::unordered_map<Index, HangingNodeMasters> mastersOf;
  for (bool joined = true; joined;) {
    joined = false;
    mastersOf.clear();
    for (const auto &[corner, masters] : hanging) {
      const auto [found, isNew] = mastersOf.emplace(sets.find(corner), masters);
      if (isNew) continue;
      for (int i = 0; i < masters.count; ++i)
        for (int j = 0; j < found->second.count; ++j) {
          const Index a = masters.corners[static_cast<std::size_t>(i)];
          const Index b = found->second.corners[static_cast<std::size_t>(j)];
          if (placeOf(set.cells[parts.parts[a / 8].cell], static_cast<int>(a % 8)) ==
              placeOf(set.cells[parts.parts[b / 8].cell], static_cast<int>(b % 8)))
            joined = sets.join(a, b) || joined;
        }
    }
  }

  // Nodes of what is kept, and those they hang on, in the order of their places.
  std::vector<Index> nodeOf(8 * parts.parts.size(), kNone);  // by root
  std::vector<Index> roots;
  const auto use = [&](const auto &self, Index corner) -> void {
    const Index root = sets.find(corner);
    if (nodeOf[root] != kNone) return;
    nodeOf[root] = 0;
    roots.push_back(root);
    const auto found = mastersOf.find(root);
    if (found == mastersOf.end()) return;
    for (int i = 0; i < found->second.count; ++i) self(self, found->second.corners[static_cast<std::size_t>(i)]);
  };
  for (std::size_t p = 0; p < parts.parts.size(); ++p)
    if (parts.parts[p].kept)
      for (int corner = 0; corner < 8; ++corner) use(use, cornerOf(static_cast<Index>(p), corner));
  const auto codeOf = [&](Index root) {
    return mortonCode(placeOf(set.cells[parts.parts[root / 8].cell], static_cast<int>(root % 8)));
  };
  std::vector<std::pair<std::uint64_t, Index>> order;
  order.reserve(roots.size());
  for (const Index root : roots) order.emplace_back(codeOf(root), root);
  std::sort(order.begin(), order.end());

  NodeTable corners;
  std::vector<Index> phyxelOf(order.size(), kNone);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Index root = order[i].second;
    nodeOf[root] = static_cast<Index>(i);
    if (mastersOf.contains(root)) continue;
    phyxelOf[i] = static_cast<Index>(corners.positions.size());
    corners.positions.push_back(
        set.frame.place(placeOf(set.cells[parts.parts[root / 8].cell], static_cast<int>(root % 8))));
  }
  std::map<Index, double> row;
  const auto addTo = [&](const auto &self, Index root, double weight) -> void {
    const auto found = mastersOf.find(root);
    if (found == mastersOf.end()) {
      row[phyxelOf[nodeOf[root]]] += weight;
      return;
    }
    for (int i = 0; i < found->second.count; ++i)
      self(self, sets.find(found->second.corners[static_cast<std::size_t>(i)]), weight / found->second.count);
  };
  for (const auto &[code, root] : order) {
    if (const Index phyxel = phyxelOf[nodeOf[root]]; phyxel != kNone) {
      corners.phyxels.push_back(phyxel);
      corners.weights.push_back(1.0);
    } else {
      row.clear();
      addTo(addTo, root, 1.0);
      for (const auto &[p, weight] : row) {
        corners.phyxels.push_back(p);
        corners.weights.push_back(weight);
      }
    }
    corners.offsets.push_back(static_cast<std::uint32_t>(corners.phyxels.size()));
  }
  for (std::size_t p = 0; p < parts.parts.size(); ++p)
    for (int corner = 0; corner < 8; ++corner) {
      const Index root = sets.find(cornerOf(static_cast<Index>(p), corner));
      parts.parts[p].nodes[static_cast<std::size_t>(corner)] = nodeOf[root];
    }
  return corners;
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
