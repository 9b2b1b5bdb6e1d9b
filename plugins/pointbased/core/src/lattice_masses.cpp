// SPDX-License-Identifier: Apache-2.0
#include "lattice_masses.h"

#include "lattice_jitter.h"

namespace pointbased::lattice {
namespace {

// Of what a phyxel has before the correction: the lighter it were, the shorter the explicit step.
constexpr double kLeastMass = 0.55;
// Of a part that fills hardly anything of its cell half goes to the corners evenly, of one that fills 5/6 of it nothing:
// else corners that only a sliver reaches have hardly a mass, and their stiffness sets the explicit step.
constexpr double kEvenInSlivers = 0.5, kWellFilled = 5.0 / 6.0;

// Three corners in a row along an axis, and what of a second difference goes over them, m³.
struct Row3 {
  std::array<Index, 3> nodes;
  double amount;
};

struct Sharing {
  const LatticeCellMap &map;
  std::span<const PartContent> contents;

  [[nodiscard]] double edge(std::size_t p) const { return map.set().edge(map.set().cells[map.parts()[p].cell]); }
  [[nodiscard]] double volume(std::size_t p) const { return contents[p].all.share * edge(p) * edge(p) * edge(p); }
};

template <class Add>
void forPhyxels(const Corners &corners, Index node, const Add &add) {
  for (std::uint32_t e = corners.offsets[node]; e < corners.offsets[node + 1]; ++e)
    add(corners.phyxels[e], corners.weights[e]);
}

// Parts that the body goes on into through each face, of cells of the same size.
std::vector<std::array<std::vector<Index>, 6>> neighboursOf(const LatticeCellMap &map) {
  std::vector<std::array<std::vector<Index>, 6>> out(map.parts().size());
  const CellSet &set = map.set();
  for (const Link &link : map.links()) {
    const Part &a = map.parts()[link.a], &b = map.parts()[link.b];
    if (!a.kept || !b.kept || set.cells[a.cell].size != set.cells[b.cell].size) continue;
    out[link.a][link.face].push_back(link.b);
    out[link.b][link.face ^ 1].push_back(link.a);
  }
  return out;
}

// The excess of every part over rows of three corners: its own two along an axis and the next one of a neighbour, each
// neighbour by what it has at the far end.
std::vector<Row3> secondDifferences(const Sharing &sharing) {
  const auto neighbours = neighboursOf(sharing.map);
  std::vector<std::array<double, 8>> shares(sharing.contents.size());
  for (std::size_t p = 0; p < shares.size(); ++p)
    if (sharing.map.parts()[p].kept) shares[p] = sharing.contents[p].all.functions();
  std::vector<Row3> rows;
  for (std::size_t p = 0; p < shares.size(); ++p) {
    const Part &part = sharing.map.parts()[p];
    if (!part.kept) continue;
    const Moments &all = sharing.contents[p].all;
    const Vec3 excess = (Vec3::Constant(0.25) - all.second / all.share).cwiseMax(0.0);
    for (int axis = 0; axis < 3; ++axis)
      for (std::size_t low = 0; low < 8; ++low) {
        if ((low >> axis & 1) != 0) continue;
        const std::size_t ends[2] = {low, low | std::size_t{1} << axis};
        const double amount = 0.5 * excess[axis] * sharing.volume(p) * (shares[p][ends[0]] + shares[p][ends[1]]);
        const auto room = [&](Index n, std::size_t up) { return sharing.contents[n].all.share * shares[n][ends[up]]; };
        double rooms = 0.0;
        for (const std::size_t up : {0u, 1u})
          for (const Index n : neighbours[p][2 * static_cast<std::size_t>(axis) + up]) rooms += room(n, up);
        if (!(rooms > 0.0)) continue;
        for (const std::size_t up : {0u, 1u})
          for (const Index n : neighbours[p][2 * static_cast<std::size_t>(axis) + up])
            rows.push_back({{part.nodes[ends[1 - up]], part.nodes[ends[up]], sharing.map.parts()[n].nodes[ends[up]]},
                            amount * room(n, up) / rooms});
      }
  }
  return rows;
}

// Takes the rows off, each as far as its ends can bear it.
void correctSecondMoments(const Corners &corners, std::span<const Row3> rows, std::vector<double> &volumes) {
  std::vector<double> changed, allowed(volumes.size(), 1.0);
  for (bool settled = false; !settled;) {
    changed = volumes;
    for (const Row3 &row : rows) {
      double factor = 1.0;
      for (const Index end : {row.nodes[0], row.nodes[2]})
        forPhyxels(corners, end, [&](Index i, double) { factor = std::min(factor, allowed[i]); });
      for (std::size_t k = 0; k < 3; ++k)
        forPhyxels(corners, row.nodes[k], [&](Index i, double weight) {
          changed[i] += (k == 1 ? 2.0 : -1.0) * weight * factor * row.amount;
        });
    }
    settled = true;
    for (std::size_t i = 0; i < changed.size(); ++i)
      if (changed[i] < kLeastMass * volumes[i] * (1.0 - 1e-9)) {
        settled = false;
        allowed[i] = allowed[i] < 0.05 ? 0.0 : 0.8 * allowed[i];
      }
  }
  volumes = std::move(changed);
}

}  // namespace

PhyxelVolumes shareVolumes(const LatticeCellMap &map, std::span<const PartContent> contents) {
  const Corners &corners = map.corners();
  PhyxelVolumes out;
  out.weights.assign(corners.positions.size(), 0.0);
  out.inertial.assign(corners.positions.size(), 0.0);
  const Sharing sharing{map, contents};
  for (std::size_t p = 0; p < contents.size(); ++p) {
    const Part &part = map.parts()[p];
    if (!part.kept) continue;
    const double edge = sharing.edge(p);
    std::array<double, 8> functions = contents[p].all.functions();
    double volume = sharing.volume(p);
    if (map.distorted(part.cell)) {
      const HexahedronMeans means = meansOf(map.hexahedron(static_cast<Index>(p)));
      functions = means.functions;
      volume = means.volume;
    }
    const Moments &loose = contents[p].free;
    const double freeVolume = loose.share * edge * edge * edge;
    const bool holds = contents[p].all.share - loose.share > 1e-12;
    const std::array<double, 8> freeFunctions = holds && freeVolume > 0.0 ? loose.functions() : functions;
    if (holds) out.held.resize(out.weights.size(), 0.0);
    const double even = kEvenInSlivers * std::max(0.0, 1.0 - contents[p].all.share / kWellFilled);
    for (std::size_t j = 0; j < 8; ++j)
      forPhyxels(corners, part.nodes[j], [&](Index i, double weight) {
        out.weights[i] += weight * volume * functions[j];
        out.inertial[i] += weight * volume * ((1.0 - even) * functions[j] + even / 8.0);
        if (holds) out.held[i] += weight * (volume * functions[j] - freeVolume * freeFunctions[j]);
      });
  }
  correctSecondMoments(corners, secondDifferences(sharing), out.inertial);
  return out;
}

}  // namespace pointbased::lattice
