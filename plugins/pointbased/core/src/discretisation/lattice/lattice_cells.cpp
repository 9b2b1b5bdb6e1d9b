// SPDX-License-Identifier: Apache-2.0
// Finds the cells of the lattice that contain part of the body, and refines them.
#include <numbers>

#include "base/number_text.h"
#include "discretisation/lattice/lattice_samples.h"

namespace pointbased {
namespace {

// Edge of the largest cells with at most this size, by halving.
double halvedTo(double spacing, double wanted) {
  return spacing / std::exp2(std::max(0.0, std::ceil(std::log2(spacing / wanted) - 1e-6)));
}

}  // namespace

double finestSpacing(const LatticeSampling &sampling, double spacing) {
  double finest = spacing;
  for (const Refinement &r : sampling.refinements) finest = std::min(finest, halvedTo(spacing, r.spacing));
  if (sampling.surfaceSpacing > 0.0) finest = std::min(finest, halvedTo(spacing, sampling.surfaceSpacing));
  if (!sampling.finer.places.empty()) finest = std::min(finest, halvedTo(spacing, sampling.finer.spacing));
  return finest;
}

FinerCells::Place FinerCells::placeOf(const Vec3 &x) const {
  constexpr double kMost = 1e9;
  const Vec3 at = axes.transpose() * (x - corner) / edge;
  Place place{};
  for (int a = 0; a < 3; ++a)
    place[static_cast<std::size_t>(a)] = static_cast<std::int32_t>(std::clamp(std::floor(at[a]), -kMost, kMost));
  return place;
}

bool FinerCells::holds(const Vec3 &x) const { return std::binary_search(places.begin(), places.end(), placeOf(x)); }

}  // namespace pointbased

namespace pointbased::lattice {
namespace {

enum class State : std::uint8_t { kEmpty, kFull, kCut, kSplit, kUnknown };

using detail::number;

// Nodes of a refined surface, per node that the surface adds to a lattice of this spacing everywhere. It includes the
// coarser cells that grading adds inside.
constexpr double kLayersOfSurface = 2.2;

const double kHalfDiagonal = 0.5 * std::numbers::sqrt3 * (1.0 + 1e-9);  // of a cell of edge 1

std::vector<std::uint8_t> farFromSurface(const Questions &ask, std::span<const Vec3> centres, double edge,
                                         const ParallelFor &parallelFor) {
  std::vector<std::uint8_t> far(centres.size(), 0);
  if (!ask.measures()) return far;
  parallelFor(centres.size(), 64, [&](std::size_t begin, std::size_t end) {
    std::vector<double> distances(end - begin);
    ask.distances(centres.subspan(begin, end - begin), distances);
    for (std::size_t i = begin; i < end; ++i) far[i] = distances[i - begin] > kHalfDiagonal * edge ? 1 : 0;
  });
  return far;
}

// Coarsest cells are numbered with x fastest.
Cell3 baseCell(const Frame &frame, std::size_t i) {
  const auto nx = static_cast<std::size_t>(frame.n[0]), ny = static_cast<std::size_t>(frame.n[1]);
  return Cell3{static_cast<std::int32_t>(i % nx), static_cast<std::int32_t>(i / nx % ny),
               static_cast<std::int32_t>(i / (nx * ny))};
}

// Centre of a coarsest cell, in edges from the corner of the lattice.
Vec3 baseCentre(const Frame &frame, std::size_t i) {
  const Cell3 k = baseCell(frame, i);
  return Vec3(k[0], k[1], k[2]) + Vec3::Constant(0.5);
}

// States of the coarsest cells, by number. Two neighbours that are both farther from the surface than half a diagonal
// are on the same side of it, so one query per connected group is sufficient.
Result<std::vector<State>> scan(const Questions &ask, const Frame &frame, const ParallelFor &parallelFor,
                                const SamplingProgress &progress) {
  const auto nx = static_cast<std::size_t>(frame.n[0]), ny = static_cast<std::size_t>(frame.n[1]),
             nz = static_cast<std::size_t>(frame.n[2]);
  const std::size_t total = nx * ny * nz;
  const auto centre = [&](std::size_t i) { return Vec3(frame.low + frame.spacing * baseCentre(frame, i)); };
  std::vector<State> states(total, State::kCut);
  if (!ask.measures()) return states;
  constexpr std::size_t kChunk = 1u << 16;
  std::vector<Vec3> centres;
  for (std::size_t begin = 0; begin < total; begin += kChunk) {
    const std::size_t count = std::min(kChunk, total - begin);
    centres.resize(count);
    for (std::size_t i = 0; i < count; ++i) centres[i] = centre(begin + i);
    const std::vector<std::uint8_t> far = farFromSurface(ask, centres, frame.spacing, parallelFor);
    for (std::size_t i = 0; i < count; ++i)
      if (far[i] != 0) states[begin + i] = State::kUnknown;
    if (progress && !progress(0.9 * static_cast<double>(begin + count) / static_cast<double>(total)))
      return tl::unexpected<std::string>("cancelled");
  }
  std::vector<std::size_t> stack;
  for (std::size_t seed = 0; seed < total; ++seed) {
    if (states[seed] != State::kUnknown) continue;
    const Vec3 point = centre(seed);
    std::uint8_t inside = 0;
    ask.inside({&point, 1}, {&inside, 1});
    const State state = inside != 0 ? State::kFull : State::kEmpty;
    states[seed] = state;
    stack.assign(1, seed);
    while (!stack.empty()) {
      const std::size_t i = stack.back();
      stack.pop_back();
      const auto visit = [&](std::size_t j) {
        if (states[j] != State::kUnknown) return;
        states[j] = state;
        stack.push_back(j);
      };
      const std::size_t x = i % nx, y = i / nx % ny, z = i / (nx * ny);
      if (x > 0) visit(i - 1);
      if (x + 1 < nx) visit(i + 1);
      if (y > 0) visit(i - nx);
      if (y + 1 < ny) visit(i + nx);
      if (z > 0) visit(i - nx * ny);
      if (z + 1 < nz) visit(i + nx * ny);
    }
  }
  return states;
}

// Octree as one map per level; absent nodes are empty.
class Tree {
 public:
  Tree(const Questions &ask, const Frame &frame, const ParallelFor &parallelFor)
      : ask_(ask), frame_(frame), parallelFor_(parallelFor), nodes_(static_cast<std::size_t>(frame.levels) + 1) {}

  using Nodes = std::unordered_map<std::uint64_t, State>;
  [[nodiscard]] Nodes &level(int l) { return nodes_[static_cast<std::size_t>(l)]; }
  [[nodiscard]] static Cell3 place(std::uint64_t key) {
    return {static_cast<std::int32_t>(key >> 40 & 0xfffff), static_cast<std::int32_t>(key >> 20 & 0xfffff),
            static_cast<std::int32_t>(key & 0xfffff)};
  }
  [[nodiscard]] double edge(int l) const { return frame_.spacing / static_cast<double>(std::int64_t{1} << l); }
  [[nodiscard]] Vec3 centre(int l, const Cell3 &k) const {
    return frame_.low + edge(l) * (Vec3(k[0], k[1], k[2]) + Vec3::Constant(0.5));
  }
  [[nodiscard]] std::size_t size() const {
    std::size_t count = 0;
    for (const Nodes &nodes : nodes_) count += nodes.size();
    return count;
  }

  void split(int l, std::vector<Cell3> cells) {
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    std::vector<Cell3> open;
    for (const Cell3 &k : cells) {
      State &state = level(l).at(CellIndex::key(l, k));
      for (int c = 0; c < 8; ++c) {
        const Cell3 child{2 * k[0] + (c & 1), 2 * k[1] + (c >> 1 & 1), 2 * k[2] + (c >> 2)};
        if (state == State::kFull)
          level(l + 1).emplace(CellIndex::key(l + 1, child), State::kFull);
        else
          open.push_back(child);
      }
      state = State::kSplit;
    }
    std::vector<Vec3> centres(open.size());
    for (std::size_t i = 0; i < open.size(); ++i) centres[i] = centre(l + 1, open[i]);
    const std::vector<std::uint8_t> far = farFromSurface(ask_, centres, edge(l + 1), parallelFor_);
    std::vector<std::uint8_t> inside(open.size());
    parallelFor_(open.size(), 64, [&](std::size_t begin, std::size_t end) {
      std::vector<Vec3> points;
      for (std::size_t i = begin; i < end; ++i)
        if (far[i] != 0) points.push_back(centres[i]);
      std::vector<std::uint8_t> answers(points.size());
      ask_.inside(points, answers);
      for (std::size_t i = begin, a = 0; i < end; ++i)
        if (far[i] != 0) inside[i] = answers[a++];
    });
    for (std::size_t i = 0; i < open.size(); ++i)
      if (far[i] == 0)
        level(l + 1).emplace(CellIndex::key(l + 1, open[i]), State::kCut);
      else if (inside[i] != 0)
        level(l + 1).emplace(CellIndex::key(l + 1, open[i]), State::kFull);
  }

  // Splits cells next to cells of less than half their edge. Returns whether any cell was split.
  bool grade() {
    bool any = false;
    for (int l = frame_.levels; l >= 2; --l) {
      std::vector<std::vector<Cell3>> tooLarge(static_cast<std::size_t>(l));
      for (const auto &[key, state] : level(l)) {
        const Cell3 k = place(key);
        for (int c = 0; c < 27; ++c) {
          Cell3 q{(k[0] + c % 3 - 1) >> 1, (k[1] + c / 3 % 3 - 1) >> 1, (k[2] + c / 9 - 1) >> 1};
          if (q[0] < 0 || q[1] < 0 || q[2] < 0) continue;
          if (level(l - 1).contains(CellIndex::key(l - 1, q))) continue;
          for (int coarser = l - 2; coarser >= 0; --coarser) {
            for (std::int32_t &a : q) a >>= 1;
            const auto found = level(coarser).find(CellIndex::key(coarser, q));
            if (found == level(coarser).end()) continue;
            if (found->second != State::kSplit) tooLarge[static_cast<std::size_t>(coarser)].push_back(q);
            break;
          }
        }
      }
      for (int coarser = 0; coarser < l; ++coarser)
        if (!tooLarge[static_cast<std::size_t>(coarser)].empty()) {
          split(coarser, std::move(tooLarge[static_cast<std::size_t>(coarser)]));
          any = true;
        }
    }
    return any;
  }

 private:
  const Questions &ask_;
  const Frame &frame_;
  const ParallelFor &parallelFor_;
  std::vector<Nodes> nodes_;
};

// Whether a cell and a region have a common point: decided by spheres in most cases, otherwise by points of the cell.
bool meets(const Region &region, const Frame &frame, const Vec3 &centre, double edge) {
  const double distance = signedDistance(region, frame.world(centre));
  if (distance <= 0.5 * edge * (1.0 - 1e-6)) return true;
  if (distance > kHalfDiagonal * edge) return false;
  for (int x = -2; x <= 2; ++x)
    for (int y = -2; y <= 2; ++y)
      for (int z = -2; z <= 2; ++z)
        if (signedDistance(region, frame.world(centre + 0.25 * (1.0 - 1e-6) * edge * Vec3(x, y, z))) <= 0.0)
          return true;
  return false;
}

int levelsNeeded(const LatticeSampling &sampling, double spacing) {
  return static_cast<int>(std::lround(std::log2(spacing / finestSpacing(sampling, spacing))));
}

std::string tooMany() {
  return "the refined lattice has too many cells for " + std::to_string(kMaximumPhyxels) +
         " phyxels: use a larger spacing in refinements or surfaceSpacing";
}

// Share of a cell that is inside a region.
double partIn(const Region &region, const Frame &frame, const Vec3 &centre, double edge) {
  const double distance = signedDistance(region, frame.world(centre));
  if (std::abs(distance) > kHalfDiagonal * edge) return distance < 0.0 ? 1.0 : 0.0;
  int in = 0;
  for (int s = 0; s < kSamples; ++s)
    in += signedDistance(region, frame.world(centre + edge * sampleOffset(s))) <= 0.0 ? 1 : 0;
  return static_cast<double>(in) / kSamples;
}

// Estimates the size of the refined lattice before its octree takes time and memory: finer cells in the parts of coarse
// cells covered by a refinement, and along the surface.
Result<void> checkRefined(const BodyShape &shape, const LatticeSampling &sampling, const Frame &frame,
                          std::span<const State> states, const ParallelFor &parallelFor) {
  std::vector<double> expected(states.size(), 0.0);
  parallelFor(states.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (states[i] == State::kEmpty) continue;
      const Vec3 centre = frame.low + frame.spacing * baseCentre(frame, i);
      const double share = states[i] == State::kFull ? 1.0 : 0.5;
      for (const Refinement &r : sampling.refinements) {
        const double cells = std::pow(frame.spacing / halvedTo(frame.spacing, r.spacing), 3);
        expected[i] = std::max(expected[i], share * partIn(r.region, frame, centre, frame.spacing) * cells);
      }
    }
  });
  double total = 0.0, finest = frame.spacing;
  for (const double cells : expected) total += cells;
  for (const Refinement &r : sampling.refinements) finest = std::min(finest, halvedTo(frame.spacing, r.spacing));
  // Coarse cells that contain little of the body are overestimated: the limit is a body that is as fine everywhere.
  total = std::min(total, expectedCorners(shape, finest));
  if (sampling.surfaceSpacing > 0.0 && sampling.surfaceSpacing < frame.spacing)
    total = std::max(
        total, kLayersOfSurface * expectedSurfaceCorners(shape, halvedTo(frame.spacing, sampling.surfaceSpacing)));
  if (total <= static_cast<double>(kMaximumPhyxels)) return {};
  return tl::unexpected<std::string>("refinements or surface_spacing make about " + number(total, 3) +
                                     " phyxels; at most " + std::to_string(kMaximumPhyxels) +
                                     " are accepted: use a larger spacing there");
}

/// A cell that contains part of the body, not yet sampled.
struct Leaf {
  Cell cell;
  State state = State::kEmpty;
};

std::vector<Leaf> coarsestLeaves(const Frame &frame, std::span<const State> states) {
  std::vector<Leaf> leaves;
  for (std::size_t i = 0; i < states.size(); ++i)
    if (states[i] != State::kEmpty) leaves.push_back({Cell{baseCell(frame, i), 1, kNone}, states[i]});
  return leaves;
}

// Cells of a level that are coarser than required by the surface, a refinement or the list of finer cells.
std::vector<Cell3> cellsToSplit(Tree &tree, int level, const LatticeSampling &sampling, const Frame &frame) {
  std::vector<Cell3> split;
  for (const auto &[key, state] : tree.level(level)) {
    const double edge = tree.edge(level);
    bool wanted =
        state == State::kCut && sampling.surfaceSpacing > 0.0 && edge > sampling.surfaceSpacing * (1.0 + 1e-6);
    for (const Refinement &r : sampling.refinements) {
      if (wanted) break;
      wanted = edge > r.spacing * (1.0 + 1e-6) && meets(r.region, frame, tree.centre(level, Tree::place(key)), edge);
    }
    if (!wanted && !sampling.finer.places.empty() && edge > sampling.finer.spacing * (1.0 + 1e-6))
      wanted = sampling.finer.holds(frame.world(tree.centre(level, Tree::place(key))));
    if (wanted) split.push_back(Tree::place(key));
  }
  return split;
}

// Leaves of an octree over the coarsest cells.
Result<std::vector<Leaf>> octreeLeaves(const Questions &ask, const Frame &frame, const LatticeSampling &sampling,
                                       std::span<const State> states, const ParallelFor &parallelFor) {
  Tree tree(ask, frame, parallelFor);
  for (std::size_t i = 0; i < states.size(); ++i)
    if (states[i] != State::kEmpty) tree.level(0).emplace(CellIndex::key(0, baseCell(frame, i)), states[i]);
  for (int l = 0; l < frame.levels; ++l) {
    std::vector<Cell3> split = cellsToSplit(tree, l, sampling, frame);
    if (tree.size() + 8 * split.size() > 4 * kMaximumPhyxels) return tl::unexpected(tooMany());
    tree.split(l, std::move(split));
  }
  while (tree.grade())
    if (tree.size() > 8 * kMaximumPhyxels) return tl::unexpected(tooMany());
  std::vector<Leaf> leaves;
  for (int l = 0; l <= frame.levels; ++l)
    for (const auto &[key, state] : tree.level(l)) {
      if (state == State::kSplit) continue;
      const std::int32_t size = std::int32_t{1} << (frame.levels - l);
      const Cell3 k = Tree::place(key);
      leaves.push_back({Cell{{k[0] * size, k[1] * size, k[2] * size}, size, kNone}, state});
    }
  return leaves;
}

// Samples of the leaves that the surface may cut, in their order. Error: cancelled.
Result<std::vector<Samples>> sampleCut(const Questions &ask, const CellSet &set, std::span<const Leaf> leaves,
                                       const ParallelFor &parallelFor, const SamplingProgress &progress) {
  std::vector<Cell> cut;
  for (const Leaf &leaf : leaves)
    if (leaf.state == State::kCut) cut.push_back(leaf.cell);
  std::vector<Samples> samples(cut.size());
  constexpr std::size_t kChunk = 4096;
  for (std::size_t begin = 0; begin < cut.size(); begin += kChunk) {
    const std::size_t count = std::min(kChunk, cut.size() - begin);
    sampleCells(ask, set, std::span<const Cell>(cut).subspan(begin, count),
                std::span<Samples>(samples).subspan(begin, count), parallelFor);
    if (progress && !progress(static_cast<double>(begin + count) / static_cast<double>(cut.size())))
      return tl::unexpected<std::string>("cancelled");
  }
  return samples;
}

// Keeps leaves that contain part of the body, with their samples if they are cut.
void keepFilled(std::span<const Leaf> leaves, std::span<const Samples> samples, CellSet &set) {
  std::size_t next = 0;
  for (const Leaf &leaf : leaves) {
    Cell cell = leaf.cell;
    if (leaf.state == State::kCut) {
      const Samples &distances = samples[next++];
      const double width = set.edge(cell) / kSamplesPerAxis;
      bool any = false, all = true;
      for (const double d : distances) {
        const double share = shareOf(d, width);
        any = any || share > kConnectingShare;
        all = all && share == 1.0;
      }
      if (!any) continue;
      if (!all) {
        cell.samples = static_cast<Index>(set.samples.size());
        set.samples.push_back(distances);
      }
    }
    set.cells.push_back(cell);
  }
}

}  // namespace

Result<CellSet> findCells(const BodyShape &shape, const LatticeSampling &sampling, double spacing,
                          const ParallelFor &parallelFor, const SamplingProgress &progress) {
  CellSet set;
  set.frame = frameOver(shape, sampling, spacing);
  set.frame.levels = levelsNeeded(sampling, spacing);
  const Frame &frame = set.frame;
  const std::int32_t most = std::max({frame.n[0], frame.n[1], frame.n[2]});
  if (frame.levels > 15 || (static_cast<std::int64_t>(most) << frame.levels) >= (1 << 20))
    return tl::unexpected(tooMany());
  const Questions ask(shape, frame);
  set.measured = ask.measures();

  const auto states = scan(ask, frame, parallelFor, [&](double f) { return !progress || progress(0.4 * f); });
  if (!states) return tl::unexpected(states.error());
  Result<std::vector<Leaf>> leaves;
  if (frame.levels == 0) {
    leaves = coarsestLeaves(frame, *states);
  } else {
    if (const auto fits = checkRefined(shape, sampling, frame, *states, parallelFor); !fits)
      return tl::unexpected(fits.error());
    leaves = octreeLeaves(ask, frame, sampling, *states, parallelFor);
    if (!leaves) return tl::unexpected(leaves.error());
  }
  std::sort(leaves->begin(), leaves->end(),
            [](const Leaf &a, const Leaf &b) { return mortonCode(a.cell.at) < mortonCode(b.cell.at); });

  const auto samples =
      sampleCut(ask, set, *leaves, parallelFor, [&](double f) { return !progress || progress(0.4 + 0.6 * f); });
  if (!samples) return tl::unexpected(samples.error());
  keepFilled(*leaves, *samples, set);
  set.index.build(set.cells, frame);
  return set;
}

std::size_t estimateCorners(const BodyShape &shape, const LatticeSampling &sampling, double spacing,
                            const ParallelFor &parallelFor) {
  const Frame frame = frameOver(shape, sampling, spacing);
  const Questions ask(shape, frame);
  const auto states = scan(ask, frame, parallelFor, {});
  // For a cut cell, eight points decide whether it contains a hundredth of the body.
  const auto nx = static_cast<std::size_t>(frame.n[0]), ny = static_cast<std::size_t>(frame.n[1]);
  std::vector<std::size_t> cut;
  std::vector<std::uint8_t> holds(states->size(), 0);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < states->size(); ++i) {
    if ((*states)[i] == State::kFull) holds[i] = 1;
    if ((*states)[i] != State::kCut) continue;
    cut.push_back(i);
    for (int c = 0; c < 8; ++c)
      points.push_back(frame.low + spacing * (baseCentre(frame, i) +
                                              0.25 * Vec3(cornerSign(c, 0), cornerSign(c, 1), cornerSign(c, 2))));
  }
  std::vector<double> distances(points.size(), 0.0);
  std::vector<std::uint8_t> inside(points.size());
  parallelFor(points.size(), 64, [&](std::size_t begin, std::size_t end) {
    const auto some = std::span<const Vec3>(points).subspan(begin, end - begin);
    if (ask.measures()) ask.distances(some, std::span<double>(distances).subspan(begin, end - begin));
    ask.inside(some, std::span<std::uint8_t>(inside).subspan(begin, end - begin));
  });
  for (std::size_t i = 0; i < cut.size(); ++i) {
    double share = 0.0;
    for (std::size_t c = 8 * i; c < 8 * i + 8; ++c)
      share += ask.measures()
                   ? std::clamp(0.5 + (inside[c] != 0 ? distances[c] : -distances[c]) / (0.5 * spacing), 0.0, 1.0)
                   : static_cast<double>(inside[c]);
    holds[cut[i]] = share > 0.08 ? 1 : 0;
  }
  const std::size_t cx = nx + 1, cy = ny + 1;
  std::vector<std::uint8_t> corners(cx * cy * (static_cast<std::size_t>(frame.n[2]) + 1), 0);
  for (std::size_t i = 0; i < holds.size(); ++i)
    if (holds[i] != 0)
      for (std::size_t c = 0; c < 8; ++c)
        corners[(i % nx + (c & 1)) + cx * ((i / nx % ny + (c >> 1 & 1)) + cy * (i / (nx * ny) + (c >> 2)))] = 1;
  return static_cast<std::size_t>(std::count(corners.begin(), corners.end(), std::uint8_t{1}));
}

}  // namespace pointbased::lattice
