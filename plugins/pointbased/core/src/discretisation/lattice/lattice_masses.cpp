// SPDX-License-Identifier: Apache-2.0
#include "discretisation/lattice/lattice_masses.h"

#include <numeric>

#include "base/cancellation_poll.h"
#include "discretisation/lattice/lattice_jitter.h"
#include "discretisation/lattice/moment_errors.h"

namespace pointbased::lattice {
namespace {

// Of the mass of a phyxel before the correction: smaller masses shorten the explicit step.
constexpr double kMinMass = 0.55;
// kEvenInSlivers: part of a nearly empty cell fragment that is shared evenly by the corners; it decreases to 0 at a
// filling of kWellFilled. Otherwise corners reached only by a sliver would have almost no mass, and their stiffness
// would limit the explicit step.
constexpr double kEvenInSlivers = 0.5, kWellFilled = 5.0 / 6.0;

// Largest Σ v |g|² d² per mass of a phyxel, d the finest edge: the value at corners of whole cells after the
// correction (2.73 at the corner of a box). Phyxels of cut cells with up to 6 limited the explicit step of their body.
// Next to held material, additional mass costs nothing: it hardly moves.
constexpr double kMaxStiffness = 2.8, kMaxBesideHeld = 2.0;

// Distance of the nodes of the patches in which the remaining errors of moments are corrected, in edges of the coarsest
// cells. In narrower patches too few phyxels can lose mass. Wider patches correct the inertia of a bar as a whole, but
// not of its sections.
constexpr double kPatchSpacing = 6.0;

double evenPart(double share) { return kEvenInSlivers * std::max(0.0, 1.0 - share / kWellFilled); }

// Three corners in a row along an axis, and the amount of a second difference over them, m³.
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
void forPhyxels(const NodeTable &corners, Index node, const Add &add) {
  for (std::uint32_t e = corners.offsets[node]; e < corners.offsets[node + 1]; ++e)
    add(corners.phyxels[e], corners.weights[e]);
}

// Parts adjacent through each face, in cells of the same size.
std::vector<std::array<std::vector<Index>, 6>> neighboursOf(const LatticeCellMap &map) {
  std::vector<std::array<std::vector<Index>, 6>> out(map.parts().size());
  const CellSet &set = map.set();
  for (const FragmentLink &link : map.links()) {
    const CutCellFragment &a = map.parts()[link.a], &b = map.parts()[link.b];
    if (!a.kept || !b.kept || set.cells[a.cell].size != set.cells[b.cell].size) continue;
    out[link.a][link.face].push_back(link.b);
    out[link.b][link.face ^ 1].push_back(link.a);
  }
  return out;
}

// Distributes the excess of every part over rows of three corners: its own two along an axis and the next one of a
// neighbour, each neighbour weighted by its content at the far end.
std::vector<Row3> secondDifferences(const Sharing &sharing, const ParallelFor &parallelFor) {
  const auto neighbours = neighboursOf(sharing.map);
  detail::checkCancelled(parallelFor);
  std::vector<std::array<double, 8>> shares(sharing.contents.size());
  for (std::size_t p = 0; p < shares.size(); ++p)
    if (sharing.map.parts()[p].kept) shares[p] = sharing.contents[p].all.functions();
  std::vector<Row3> rows;
  for (std::size_t p = 0; p < shares.size(); ++p) {
    if (p % detail::kPollInterval == 0) detail::checkCancelled(parallelFor);
    const CutCellFragment &part = sharing.map.parts()[p];
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

// Mass of every phyxel required by the stiffness of its cells: Σ v |g|² d²/most, m³.
class Least {
 public:
  Least(const LatticeCellMap &map, double most) : map_(map), volumes_(map.corners().positions.size(), 0.0) {
    std::int32_t finest = map.set().frame.finest();
    for (const Cell &cell : map.set().cells) finest = std::min(finest, cell.size);
    const double edge = map.set().frame.unit() * finest;
    scale_ = edge * edge / most;
  }
  /// @param gradients  1/m
  void add(const CutCellFragment &part, double volume, const std::array<Vec3, 8> &gradients) {
    row_.clear();
    for (std::size_t j = 0; j < 8; ++j) row_.add(map_.corners(), part.nodes[j], 0.0, gradients[j]);
    for (std::size_t e = 0; e < row_.phyxels.size(); ++e)
      volumes_[row_.phyxels[e]] += scale_ * volume * row_.gradients[e].squaredNorm();
  }
  double operator[](std::size_t i) const { return volumes_[i]; }

 private:
  const LatticeCellMap &map_;
  std::vector<double> volumes_;
  double scale_ = 0.0;
  Row row_;
};

std::array<Vec3, 8> gradientsOf(const Moments &moments, double edge) {
  std::array<Vec3, 8> gradients = moments.gradients();
  for (Vec3 &g : gradients) g /= edge;
  return gradients;
}

// Subtracts the rows, each as far as its ends permit. What remains is added to the errors.
void correctSecondMoments(const NodeTable &corners, std::span<const Row3> rows, const Least &least,
                          std::vector<double> &volumes, MomentErrors &errors, const ParallelFor &parallelFor) {
  std::vector<double> changed, allowed(volumes.size(), 1.0), factors(rows.size());
  detail::CancellationPoll look(parallelFor);
  for (bool settled = false; !settled;) {
    detail::checkCancelled(parallelFor);
    changed = volumes;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      look();
      const Row3 &row = rows[r];
      double factor = 1.0;
      for (const Index end : {row.nodes[0], row.nodes[2]})
        forPhyxels(corners, end, [&](Index i, double) { factor = std::min(factor, allowed[i]); });
      for (std::size_t k = 0; k < 3; ++k)
        forPhyxels(corners, row.nodes[k],
                   [&](Index i, double weight) { changed[i] += (k == 1 ? 2.0 : -1.0) * weight * factor * row.amount; });
      factors[r] = factor;
    }
    settled = true;
    for (std::size_t i = 0; i < changed.size(); ++i)
      if (changed[i] < std::min(volumes[i], std::max(kMinMass * volumes[i], least[i])) * (1.0 - 1e-9)) {
        settled = false;
        allowed[i] = allowed[i] < 0.05 ? 0.0 : 0.8 * allowed[i];
      }
  }
  volumes = std::move(changed);
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (factors[r] < 1.0)
      for (std::size_t k = 0; k < 3; ++k)
        forPhyxels(corners, rows[r].nodes[k], [&](Index i, double weight) {
          errors.add(corners.phyxels[corners.offsets[rows[r].nodes[1]]], i,
                     (k == 1 ? -2.0 : 1.0) * weight * (1.0 - factors[r]) * rows[r].amount);
        });
}

// Gives phyxels that are still too light the missing mass from the middles of rows at whose ends they are. These are
// second differences of opposite sign, so volume and centre are preserved.
void redistributeToLightNodes(const NodeTable &corners, std::span<const Row3> rows, const Least &least,
                              std::vector<double> &volumes, MomentErrors &errors, const ParallelFor &parallelFor) {
  const auto phyxelOf = [&](Index node) {
    return corners.offsets[node + 1] - corners.offsets[node] == 1 ? corners.phyxels[corners.offsets[node]] : kNone;
  };
  std::vector<std::vector<std::array<Index, 2>>> others(volumes.size());  // middle and far end
  detail::CancellationPoll look(parallelFor);
  for (const Row3 &row : rows) {
    look();
    const std::array<Index, 3> at{phyxelOf(row.nodes[0]), phyxelOf(row.nodes[1]), phyxelOf(row.nodes[2])};
    if (at[0] == kNone || at[1] == kNone || at[2] == kNone) continue;
    for (const std::size_t end : {0u, 2u})
      if (volumes[at[end]] < least[at[end]]) others[at[end]].push_back({at[1], at[2 - end]});
  }
  const auto spare = [&](Index i) { return volumes[i] - least[i]; };
  for (std::size_t i = 0; i < others.size(); ++i) {
    std::vector<std::array<Index, 2>> &candidates = others[i];
    std::sort(candidates.begin(), candidates.end());
    candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
    while (volumes[i] < least[i] && !candidates.empty()) {
      const auto best = std::max_element(candidates.begin(), candidates.end(),
                                         [&](const auto &a, const auto &b) { return spare(a[0]) < spare(b[0]); });
      // Half of what the middle has to spare.
      const double given = std::min(least[i] - volumes[i], 0.25 * spare((*best)[0]));
      if (!(given > 0.0)) break;
      volumes[i] += given;
      volumes[(*best)[0]] -= 2.0 * given;
      volumes[(*best)[1]] += given;
      errors.add((*best)[0], static_cast<Index>(i), given);
      errors.add((*best)[0], (*best)[1], given);
      candidates.erase(best);
    }
  }
}

// Connected component of every phyxel: its first phyxel.
std::vector<Index> componentsOf(const LatticeCellMap &map) {
  const NodeTable &corners = map.corners();
  std::vector<Index> parent(corners.positions.size());
  std::iota(parent.begin(), parent.end(), Index{0});
  const auto rootOf = [&](Index i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const CutCellFragment &part : map.parts()) {
    if (!part.kept) continue;
    const Index one = corners.phyxels[corners.offsets[part.nodes[0]]];
    for (const Index node : part.nodes)
      forPhyxels(corners, node, [&](Index i, double) {
        const Index a = rootOf(one), b = rootOf(i);
        parent[std::max(a, b)] = std::min(a, b);
      });
  }
  for (Index i = 0; i < parent.size(); ++i) parent[i] = rootOf(i);
  return parent;
}

// Records a volume at a phyxel as error of a part. The error is divided among all corners of the part, so that it is
// symmetric where the body is.
void addEvenly(MomentErrors &errors, const NodeTable &corners, const CutCellFragment &part, Index phyxel,
               double volume) {
  for (const Index node : part.nodes)
    forPhyxels(corners, node, [&](Index about, double weight) { errors.add(about, phyxel, 0.125 * weight * volume); });
}

}  // namespace

PhyxelVolumes shareVolumes(const LatticeCellMap &map, std::span<const PartContent> contents,
                           const ParallelFor &parallelFor) {
  const NodeTable &corners = map.corners();
  PhyxelVolumes out;
  out.weights.assign(corners.positions.size(), 0.0);
  out.inertial.assign(corners.positions.size(), 0.0);
  const Sharing sharing{map, contents};
  Least least(map, kMaxStiffness), leastFree(map, kMaxBesideHeld);
  std::vector<double> evenFree;  // m³, by phyxel
  MomentErrors errors(corners.positions, componentsOf(map));
  detail::CancellationPoll look(parallelFor);
  for (std::size_t p = 0; p < contents.size(); ++p) {
    look();
    const CutCellFragment &part = map.parts()[p];
    if (!part.kept) continue;
    const double edge = sharing.edge(p);
    std::array<double, 8> functions = contents[p].all.functions();
    std::array<Vec3, 8> gradients = gradientsOf(contents[p].all, edge);
    double volume = sharing.volume(p);
    if (map.distorted(part.cell)) {
      const HexahedronMeans means = meansOf(map.hexahedron(static_cast<Index>(p)));
      functions = means.functions;
      gradients = means.gradients;
      volume = means.volume;
    }
    const Moments &loose = contents[p].free;
    const double freeVolume = loose.share * edge * edge * edge;
    const bool holds = contents[p].all.share - loose.share > 1e-12;
    const std::array<double, 8> freeFunctions = holds && freeVolume > 0.0 ? loose.functions() : functions;
    if (holds) {
      out.held.resize(out.weights.size(), 0.0);
      evenFree.resize(out.weights.size(), 0.0);
    }
    least.add(part, volume, gradients);
    if (!holds)
      leastFree.add(part, volume, gradients);
    else if (contents[p].isFree())
      leastFree.add(part, freeVolume, gradientsOf(loose, edge));
    const double even = evenPart(contents[p].all.share), evenOfFree = evenPart(loose.share);
    for (std::size_t j = 0; j < 8; ++j)
      forPhyxels(corners, part.nodes[j], [&](Index i, double weight) {
        if (even > 0.0) addEvenly(errors, corners, part, i, weight * volume * even * (0.125 - functions[j]));
        out.weights[i] += weight * volume * functions[j];
        out.inertial[i] += weight * volume * ((1.0 - even) * functions[j] + even / 8.0);
        if (!holds) return;
        out.held[i] += weight * (volume * functions[j] - freeVolume * freeFunctions[j]);
        evenFree[i] += weight * freeVolume * evenOfFree / 8.0;
      });
  }
  const std::vector<Row3> rows = secondDifferences(sharing, parallelFor);
  const std::vector<double> uncorrected = out.inertial;
  correctSecondMoments(corners, rows, least, out.inertial, errors, parallelFor);
  detail::checkCancelled(parallelFor);
  redistributeToLightNodes(corners, rows, least, out.inertial, errors, parallelFor);
  std::vector<double> available(out.inertial.size());
  for (std::size_t i = 0; i < available.size(); ++i) {
    double minimum = std::max(kMinMass * uncorrected[i], least[i]);
    if (!out.held.empty() && out.held[i] > 0.0) minimum = std::max({minimum, leastFree[i], evenFree[i]});
    available[i] = std::max(0.0, out.inertial[i] - minimum);
  }
  errors.correct(out.inertial, std::move(available), kPatchSpacing * map.set().frame.spacing, parallelFor);
  if (out.held.empty()) return out;
  out.carried.resize(out.held.size());
  for (std::size_t i = 0; i < out.held.size(); ++i) {
    const double carried = std::clamp(out.held[i] / out.weights[i], 0.0, 1.0) * out.inertial[i];
    out.carried[i] = std::max(0.0, std::min(carried, out.inertial[i] - std::max(leastFree[i], evenFree[i])));
  }
  return out;
}

void addEdgeWeights(const LatticeCellMap &map, std::span<const PartContent> contents, PhyxelVolumes &volumes) {
  if (!map.edges().any()) return;
  const Sharing sharing{map, contents};
  for (std::size_t p = 0; p < contents.size(); ++p) {
    if (!map.parts()[p].kept) continue;
    const Moments &all = contents[p].all, &loose = contents[p].free;
    const double cube = std::pow(sharing.edge(p), 3);
    const EdgeMeans ofAll = edgeMeansOf(all);
    const bool holds = !volumes.held.empty() && all.share - loose.share > 1e-12;
    const EdgeMeans ofFree = holds && loose.share > 0.0 ? edgeMeansOf(loose) : EdgeMeans{};
    map.edges().forPart(static_cast<Index>(p), [&](std::size_t e, Index edge) {
      const double whole = cube * all.share * ofAll.functions.values[e],
                   held = holds ? whole - cube * loose.share * ofFree.functions.values[e] : 0.0;
      for (Index k = map.edges().phyxels.offsets[edge]; k < map.edges().phyxels.offsets[edge + 1]; ++k) {
        const Index phyxel = map.edges().phyxels.indices[k];
        volumes.weights[phyxel] += map.edges().weights[k] * whole;
        if (holds) volumes.held[phyxel] += map.edges().weights[k] * held;
      }
    });
  }
}

}  // namespace pointbased::lattice
