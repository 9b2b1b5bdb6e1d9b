// SPDX-License-Identifier: Apache-2.0
#include "discretisation/lattice/cut_cell_fragments.h"

#include <bit>
#include <tuple>

#include "base/cancellation_poll.h"
#include "base/disjoint_sets.h"
#include "discretisation/lattice/lattice_samples.h"

namespace pointbased::lattice {
namespace {

// Connected groups of samples in one cell.
struct Groups {
  std::array<std::int8_t, kSamples> of{};  // root sample; kNoSample: none
  [[nodiscard]] int find(int s) const {
    while (of[static_cast<std::size_t>(s)] != s) s = of[static_cast<std::size_t>(s)];
    return s;
  }
  void join(int a, int b) {
    a = find(a);
    b = find(b);
    of[static_cast<std::size_t>(std::max(a, b))] = static_cast<std::int8_t>(std::min(a, b));
  }
};

struct OpenPair {
  Index cell;
  std::int8_t a, b;  // joined if nothing crosses between from and to
  Place from, to;
};

// Pairs of neighbouring samples in different groups, with none or both of them outside.
template <class Decide>
void forOpenPairs(const View &view, const Groups &groups, bool bothInside, const Decide &decide) {
  for (int s = 0; s < kSamples; ++s) {
    if (!view.connects(s)) continue;
    for (int axis = 0; axis < 3; ++axis) {
      if (sampleCoordinate(s, axis) == kSamplesPerAxis - 1) continue;
      const int t = s + (1 << (2 * axis));
      if (!view.connects(t) || (view.inside(s) && view.inside(t)) != bothInside) continue;
      if (groups.find(s) != groups.find(t)) decide(s, t);
    }
  }
}

void groupSamples(const CellSet &set, const BodyShape &shape, std::vector<Groups> &groups,
                  const ParallelFor &parallelFor) {
  const bool asks = static_cast<bool>(shape.crosses);
  std::vector<Index> cut;
  for (std::size_t c = 0; c < set.cells.size(); ++c)
    if (set.cells[c].samples != kNone) cut.push_back(static_cast<Index>(c));

  const auto decideOpen = [&](const std::vector<OpenPair> &open) {
    CrossingQuestions questions(shape, set);
    for (const OpenPair &p : open) questions.add(p.from, p.to);
    const std::vector<std::uint8_t> crosses = questions.ask(parallelFor);
    for (std::size_t i = 0; i < open.size(); ++i)
      if (crosses[i] == 0) groups[set.cells[open[i].cell].samples].join(open[i].a, open[i].b);
  };

  // Samples inside: first the certain pairs, then those that are still separate.
  std::vector<OpenPair> open;
  for (const Index c : cut) {
    const View view = viewOf(set, c);
    Groups &g = groups[set.cells[c].samples];
    for (int s = 0; s < kSamples; ++s)
      g.of[static_cast<std::size_t>(s)] = static_cast<std::int8_t>(view.connects(s) ? s : kNoSample);
    const double near = 1.05 * view.edge / kSamplesPerAxis;
    forOpenPairs(view, g, true, [&](int s, int t) {
      if (!asks || view.depth(s) + view.depth(t) >= near) g.join(s, t);
    });
    forOpenPairs(view, g, true, [&](int s, int t) {
      open.push_back({c, static_cast<std::int8_t>(s), static_cast<std::int8_t>(t), {c, s}, {c, t}});
    });
  }
  if (asks) decideOpen(open);

  // Samples outside join the sample below them, then those that nothing separates from it.
  open.clear();
  for (const Index c : cut) {
    const View view = viewOf(set, c);
    Groups &g = groups[set.cells[c].samples];
    std::array<Place, kSamples> roots{};
    for (int s = 0; s < kSamples; ++s) {
      if (!view.connects(s)) continue;
      const Place root = roots[static_cast<std::size_t>(s)] = rootOf(set, {c, s});
      if (root.found() && root.cell == c) g.join(s, root.sample);
    }
    forOpenPairs(view, g, false, [&](int s, int t) {
      const Place &from = roots[static_cast<std::size_t>(s)], &to = roots[static_cast<std::size_t>(t)];
      const bool same = from.cell == to.cell && from.sample == to.sample;
      if (!asks || !from.found() || !to.found() || same)
        g.join(s, t);
      else
        open.push_back({c, static_cast<std::int8_t>(s), static_cast<std::int8_t>(t), from, to});
    });
  }
  if (asks) decideOpen(open);
}

// Parts of one cell from its groups; samples with too small a share to connect belong to the nearest part.
void addParts(const CellSet &set, std::size_t cell, const Groups *groups, std::vector<CutCellFragment> &parts) {
  if (groups == nullptr) {
    CutCellFragment part;
    part.cell = static_cast<Index>(cell);
    part.samples = ~std::uint64_t{0};
    part.share = 1.0;
    parts.push_back(part);
    return;
  }
  const View view = viewOf(set, cell);
  std::array<int, kSamples> partOf{};
  const std::size_t first = parts.size();
  for (int s = 0; s < kSamples; ++s) {
    partOf[static_cast<std::size_t>(s)] = kNoSample;
    if (!view.connects(s)) continue;
    const int root = groups->find(s);
    if (root == s) {
      partOf[static_cast<std::size_t>(s)] = static_cast<int>(parts.size());
      parts.emplace_back().cell = static_cast<Index>(cell);
    } else {
      partOf[static_cast<std::size_t>(s)] = partOf[static_cast<std::size_t>(root)];
    }
  }
  for (int s = 0; s < kSamples; ++s) {
    const double share = view.share(s);
    if (share <= 0.0) continue;
    int part = partOf[static_cast<std::size_t>(s)];
    if (part == kNoSample) {
      double nearest = 1e300;
      for (int t = 0; t < kSamples; ++t) {
        const double distance = (sampleOffset(t) - sampleOffset(s)).squaredNorm();
        if (partOf[static_cast<std::size_t>(t)] == kNoSample || distance >= nearest) continue;
        nearest = distance;
        part = partOf[static_cast<std::size_t>(t)];
      }
    }
    parts[static_cast<std::size_t>(part)].samples |= std::uint64_t{1} << s;
    parts[static_cast<std::size_t>(part)].share += share / kSamples;
  }
  if (parts.size() == first + 1 && parts[first].share > 1.0 - 1e-9) parts[first].share = 1.0;
}

// Pairs of samples that face each other across face `face` of cell a; b is of the same size or twice as large.
struct FacingSamples {
  std::array<std::array<int, 2>, 16> pairs{};
  double separation = 0.0;  // m
};

FacingSamples facing(const CellSet &set, const Cell &a, const Cell &b, int face) {
  FacingSamples result;
  const int axis = face / 2, up = face % 2;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const bool same = a.size == b.size;
  const double width = set.edge(a) / kSamplesPerAxis;
  result.separation = same ? width : width * std::sqrt(1.5 * 1.5 + 0.5 * 0.5 + 0.5 * 0.5);
  std::size_t next = 0;
  for (int p = 0; p < kSamplesPerAxis; ++p)
    for (int q = 0; q < kSamplesPerAxis; ++q) {
      const int sample = ((up != 0 ? kSamplesPerAxis - 1 : 0) << (2 * axis)) | p << (2 * u) | q << (2 * v);
      const auto other = [&](int along, int at) {
        if (same) return at;
        const std::int32_t shift =
            (a.at[static_cast<std::size_t>(along)] - b.at[static_cast<std::size_t>(along)]) / a.size;
        return (shift * kSamplesPerAxis + at) / 2;
      };
      const int opposite =
          ((up != 0 ? 0 : kSamplesPerAxis - 1) << (2 * axis)) | other(u, p) << (2 * u) | other(v, q) << (2 * v);
      result.pairs[next++] = {sample, opposite};
    }
  return result;
}

// The cell of the same or of twice the size behind a face, or kNone.
Index behind(const CellSet &set, const Cell &cell, int face) {
  const int level = CellIndex::levelOf(cell, set.frame);
  Cell3 k{cell.at[0] / cell.size, cell.at[1] / cell.size, cell.at[2] / cell.size};
  k[static_cast<std::size_t>(face / 2)] += face % 2 != 0 ? 1 : -1;
  const Index same = set.index.find(level, k);
  if (same != kNone) return face % 2 != 0 ? same : kNone;
  if (level == 0 || k[static_cast<std::size_t>(face / 2)] < 0) return kNone;
  return set.index.find(level - 1, {k[0] >> 1, k[1] >> 1, k[2] >> 1});
}

void linkParts(const CellSet &set, const BodyShape &shape, PartSet &result, const ParallelFor &parallelFor) {
  const bool asks = static_cast<bool>(shape.crosses);
  // Fragment of every sample of the cut cells.
  std::vector<std::array<Index, kSamples>> partOf(set.samples.size());
  for (std::size_t p = 0; p < result.parts.size(); ++p) {
    const Index samples = set.cells[result.parts[p].cell].samples;
    if (samples == kNone) continue;
    for (int s = 0; s < kSamples; ++s)
      if ((result.parts[p].samples >> s & 1) != 0) partOf[samples][static_cast<std::size_t>(s)] = static_cast<Index>(p);
  }
  const auto partAt = [&](std::size_t cell, int s) {
    const Index samples = set.cells[cell].samples;
    return samples == kNone ? result.first[cell] : partOf[samples][static_cast<std::size_t>(s)];
  };
  CrossingQuestions questions(shape, set);
  std::vector<FragmentLink> open, found;
  detail::CancellationPoll look(parallelFor);
  for (std::size_t c = 0; c < set.cells.size(); ++c)
    for (int face = 0; face < 6; ++face) {
      look();
      const Index other = behind(set, set.cells[c], face);
      if (other == kNone) continue;
      const View here = viewOf(set, c), there = viewOf(set, other);
      found.clear();
      const auto known = [&](Index a, Index b) {
        return std::any_of(found.begin(), found.end(), [&](const FragmentLink &l) { return l.a == a && l.b == b; });
      };
      if (here.distances == nullptr && there.distances == nullptr && (!asks || set.measured)) {
        result.links.push_back({result.first[c], result.first[other], static_cast<std::uint8_t>(face)});
        continue;
      }
      const FacingSamples samples = facing(set, set.cells[c], set.cells[other], face);
      for (const auto &[s, t] : samples.pairs) {
        if (!here.connects(s) || !there.connects(t)) continue;
        const Index a = partAt(c, s), b = partAt(other, t);
        if (known(a, b)) continue;
        const bool certain =
            !asks || (here.inside(s) && there.inside(t) && here.depth(s) + there.depth(t) >= 1.05 * samples.separation);
        if (certain) {
          found.push_back({a, b, static_cast<std::uint8_t>(face)});
          continue;
        }
        const Place from = rootOf(set, {static_cast<Index>(c), s}), to = rootOf(set, {other, t});
        const bool same = from.cell == to.cell && from.sample == to.sample;
        if (same || !from.found() || !to.found()) found.push_back({a, b, static_cast<std::uint8_t>(face)});
      }
      if (asks)
        for (const auto &[s, t] : samples.pairs) {
          if (!here.connects(s) || !there.connects(t)) continue;
          const Index a = partAt(c, s), b = partAt(other, t);
          if (known(a, b)) continue;
          open.push_back({a, b, static_cast<std::uint8_t>(face)});
          questions.add(rootOf(set, {static_cast<Index>(c), s}), rootOf(set, {other, t}));
        }
      result.links.insert(result.links.end(), found.begin(), found.end());
    }
  if (open.empty()) return;
  const std::vector<std::uint8_t> crosses = questions.ask(parallelFor);
  std::vector<FragmentLink> clear;
  for (std::size_t i = 0; i < open.size(); ++i)
    if (crosses[i] == 0) clear.push_back(open[i]);
  const auto order = [](const FragmentLink &a, const FragmentLink &b) {
    return std::tie(a.a, a.b, a.face) < std::tie(b.a, b.b, b.face);
  };
  std::sort(clear.begin(), clear.end(), order);
  const auto same = [&](const FragmentLink &a, const FragmentLink &b) { return !order(a, b) && !order(b, a); };
  clear.erase(std::unique(clear.begin(), clear.end(), same), clear.end());
  result.links.insert(result.links.end(), clear.begin(), clear.end());
}

// Drops slivers: parts of less than a fiftieth of their cell next to larger ones, and specks of up to two samples that
// are connected to nothing, unless there is nothing else.
void dropSlivers(const CellSet &set, PartSet &result) {
  constexpr double kSliver = 0.02, kSpeck = 2.0 / kSamples;
  DisjointSets sets(result.parts.size());
  for (const FragmentLink &link : result.links) sets.join(link.a, link.b);
  std::vector<double> sum(result.parts.size(), 0.0), largest(result.parts.size(), 0.0);
  std::vector<std::uint8_t> counted(result.parts.size(), 0);
  double largestSum = 0.0;
  for (std::size_t p = 0; p < result.parts.size(); ++p) {
    const Index root = sets.find(static_cast<Index>(p));
    const double edge = set.cells[result.parts[p].cell].size;
    sum[root] += result.parts[p].share * edge * edge * edge;
    largest[root] = std::max(largest[root], result.parts[p].share);
    largestSum = std::max(largestSum, sum[root]);
  }
  for (std::size_t p = 0; p < result.parts.size(); ++p) {
    CutCellFragment &part = result.parts[p];
    const Index root = sets.find(static_cast<Index>(p));
    const double edge = set.cells[part.cell].size;
    const bool speck = sum[root] < kSpeck * edge * edge * edge && sum[root] < largestSum;
    part.kept = !speck && (part.share >= kSliver || largest[root] < kSliver);
    if (part.kept && counted[root] == 0) {
      counted[root] = 1;
      ++result.components;
    }
  }
}

}  // namespace

PartSet findParts(const CellSet &set, const BodyShape &shape, const ParallelFor &parallelFor) {
  std::vector<Groups> groups(set.samples.size());
  groupSamples(set, shape, groups, parallelFor);
  PartSet result;
  result.first.reserve(set.cells.size() + 1);
  detail::CancellationPoll look(parallelFor);
  for (std::size_t c = 0; c < set.cells.size(); ++c) {
    look();
    result.first.push_back(static_cast<Index>(result.parts.size()));
    addParts(set, c, set.cells[c].samples == kNone ? nullptr : &groups[set.cells[c].samples], result.parts);
  }
  result.first.push_back(static_cast<Index>(result.parts.size()));
  linkParts(set, shape, result, parallelFor);
  dropSlivers(set, result);
  return result;
}

}  // namespace pointbased::lattice
