// SPDX-License-Identifier: Apache-2.0
#include "discretisation/lattice/cell_map.h"

#include <Eigen/LU>

#include "discretisation/lattice/lattice_moments.h"

namespace pointbased::lattice {
namespace {

constexpr int kMaximumRings = 6;
// A point of a surface searches for its part an eighth of an edge inside. A point of a part is within half a diagonal
// of a small cell of one of its samples, 0.2165 edges; a point moved out of its cell is up to an eighth farther.
constexpr double kInwards = 0.125;
constexpr double kReachOfSample = 0.23 + kInwards;
// Samples of its part are behind the point, except those of a sliver, which may be up to half a small cell in front of
// it.
constexpr double kBehind = 0.0;
constexpr double kInFront = 0.13;
// Up to this distance outside of its cell, in edges, a point is interpolated by the trilinear functions themselves.
constexpr double kFarthestContinued = 0.5;

struct Inverse {
  Vec3 place = Vec3::Zero();  // edges from the centre
  double outside = 0.0;       // distance outside of the cell, edges
};

struct Trilinear {
  std::array<double, 8> functions;
  std::array<Vec3, 8> gradients;  // along the edges
  Vec3 x = Vec3::Zero();
  Mat3 jacobian = Mat3::Zero();  // ∂x/∂ξ
};

Trilinear mapAt(const std::array<Vec3, 8> &hexahedron, const Vec3 &place) {
  Trilinear t{trilinear(place), trilinearGradients(place)};
  for (std::size_t j = 0; j < 8; ++j) {
    t.x += t.functions[j] * hexahedron[j];
    t.jacobian += hexahedron[j] * t.gradients[j].transpose();
  }
  return t;
}

// Newton's method, limited to the surroundings of the cell, where the map is one-to-one.
Inverse invert(const std::array<Vec3, 8> &hexahedron, const Vec3 &x) {
  constexpr double kFarthest = 0.75;
  Inverse result;
  bool found = false;
  for (int i = 0; i < 16 && !found; ++i) {
    const Trilinear t = mapAt(hexahedron, result.place);
    const Vec3 step = t.jacobian.inverse() * (x - t.x);
    result.place = (result.place + step).cwiseMax(-kFarthest).cwiseMin(kFarthest);
    found = step.cwiseAbs().maxCoeff() < 1e-12;
  }
  result.outside = found ? std::max(0.0, result.place.cwiseAbs().maxCoeff() - 0.5) : 1.0;
  return result;
}

}  // namespace

void Row::clear() {
  phyxels.clear();
  weights.clear();
  gradients.clear();
  modes.clear();
  bends.clear();
}

void Row::addTo(Index phyxel, double weight, const Vec3 &gradient, const Eigen::Vector4d &mode, const Vec3 &bend) {
  std::size_t at = 0;
  while (at < phyxels.size() && phyxels[at] != phyxel) ++at;
  if (at == phyxels.size()) {
    phyxels.push_back(phyxel);
    weights.push_back(weight);
    gradients.push_back(gradient);
    modes.push_back(mode);
    bends.push_back(bend);
  } else {
    weights[at] += weight;
    gradients[at] += gradient;
    modes[at] += mode;
    bends[at] += bend;
  }
}

void Row::add(const NodeTable &corners, Index node, double weight, const Vec3 &gradient, const Eigen::Vector4d &mode) {
  corners.visit(node, [&](Index phyxel, double part) {
    addTo(phyxel, part * weight, part * gradient, part * mode, Vec3::Zero());
  });
}

void Row::add(const QuadraticEdges &edges, Index edge, double weight, const Vec3 &gradient, const Eigen::Vector4d &mode,
              const Vec3 &bend) {
  for (Index e = edges.phyxels.offsets[edge]; e < edges.phyxels.offsets[edge + 1]; ++e) {
    const double part = edges.weights[e];
    addTo(edges.phyxels.indices[e], part * weight, part * gradient, part * mode, part * bend);
  }
}

LatticeCellMap::LatticeCellMap(CellSet &&set, PartSet &&parts, NodeTable &&corners)
    : set_(std::move(set)), parts_(std::move(parts)), corners_(std::move(corners)) {}

void LatticeCellMap::release() {
  set_.samples.clear();
  set_.samples.shrink_to_fit();
  set_.cells.shrink_to_fit();
  parts_.links.clear();
  parts_.links.shrink_to_fit();
  parts_.parts.shrink_to_fit();
  if (distorted_.empty()) corners_.compact();
}

void LatticeCellMap::move(std::vector<Vec3> positions, std::vector<std::uint8_t> distorted) {
  corners_.positions = std::move(positions);
  distorted_ = std::move(distorted);
}

std::array<Vec3, 8> LatticeCellMap::hexahedron(Index part) const {
  std::array<Vec3, 8> result;
  for (std::size_t j = 0; j < 8; ++j)
    result[j] = corners_.positions[corners_.phyxels[corners_.offsets[parts_.parts[part].nodes[j]]]];
  return result;
}

// Squared distance from `within` to the nearest sample that is not in front of the surface.
double LatticeCellMap::squaredDistance(const CutCellFragment &part, const Target &target) const {
  const Cell &cell = set_.cells[part.cell];
  const double edge = set_.edge(cell);
  const Vec3 place = (target.within - set_.centre(cell)) / edge;
  if (part.samples == ~std::uint64_t{0} && target.outward.isZero(0.0)) {
    double sum = 0.0;
    for (int a = 0; a < 3; ++a) {
      const double sample = std::clamp(std::floor((place[a] + 0.5) * kSamplesPerAxis), 0.0, kSamplesPerAxis - 1.0);
      const double nearest = (sample + 0.5) / kSamplesPerAxis - 0.5;
      sum += (place[a] - nearest) * (place[a] - nearest);
    }
    return sum * edge * edge;
  }
  const Vec3 at = (target.at - set_.centre(cell)) / edge;
  double best = 1e300;
  for (int s = 0; s < kSamples; ++s) {
    if ((part.samples >> s & 1) == 0) continue;
    const Vec3 sample = sampleOffset(s);
    if ((sample - at).dot(target.outward) <= target.inFront) best = std::min(best, (place - sample).squaredNorm());
  }
  return best * edge * edge;
}

void LatticeCellMap::nearestIn(std::size_t firstCell, std::size_t lastCell, const Target &target, double &best,
                               Index &part) const {
  for (std::size_t c = firstCell; c < lastCell; ++c) {
    const double half = 0.5 * set_.edge(set_.cells[c]);
    const Vec3 beyond = ((target.within - set_.centre(set_.cells[c])).cwiseAbs() - Vec3::Constant(half)).cwiseMax(0.0);
    if (beyond.squaredNorm() >= best) continue;
    for (Index p = parts_.first[c]; p < parts_.first[c + 1]; ++p) {
      if (!parts_.parts[p].kept) continue;
      const double squared = squaredDistance(parts_.parts[p], target);
      if (squared >= best) continue;
      best = squared;
      part = p;
    }
  }
}

Index LatticeCellMap::nearestPart(const Target &target) const {
  const Frame &frame = set_.frame;
  Cell3 middle{};
  int most = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    const double at = std::floor((target.within[axis] - frame.low[axis]) / frame.spacing);
    middle[a] = static_cast<std::int32_t>(std::clamp(at, 0.0, static_cast<double>(frame.n[a] - 1)));
    most = std::max(most, static_cast<int>(frame.n[a]));
  }
  double best = 1e300;
  Index part = kNone;
  const std::uint64_t codesPerCell = std::uint64_t{1} << (3 * frame.levels);
  const auto look = [&](const Cell3 &k) {
    for (std::size_t a = 0; a < 3; ++a)
      if (k[a] < 0 || k[a] >= frame.n[a]) return;
    const std::int32_t finest = frame.finest();
    const std::uint64_t code = mortonCode({k[0] * finest, k[1] * finest, k[2] * finest});
    const std::span<const std::uint64_t> codes = set_.index.codes();
    const auto begin = std::lower_bound(codes.begin(), codes.end(), code);
    const auto end = std::lower_bound(begin, codes.end(), code + codesPerCell);
    nearestIn(static_cast<std::size_t>(begin - codes.begin()), static_cast<std::size_t>(end - codes.begin()), target,
              best, part);
  };
  const int rings = std::min(most, kMaximumRings);
  for (int ring = 0; ring <= rings; ++ring) {
    // Parts in this ring are at least this far away.
    const double reach = frame.spacing * std::max(0, ring - 1);
    if (part != kNone && reach * reach > best) return part;
    for (int z = -ring; z <= ring; ++z)
      for (int y = -ring; y <= ring; ++y) {
        const bool shell = std::abs(z) == ring || std::abs(y) == ring;
        for (int x = -ring; x <= ring; x += shell ? 1 : 2 * ring) look({middle[0] + x, middle[1] + y, middle[2] + z});
      }
  }
  if (part != kNone && (rings == most || best <= std::pow(frame.spacing * rings, 2))) return part;
  // Far from all parts: the nearest one, on either side.
  const Target anywhere{target.at, Vec3::Zero(), target.at, 0.0};
  best = 1e300;
  nearestIn(0, set_.cells.size(), anywhere, best, part);
  if (part != kNone) return part;
  // So far that squared distances overflow.
  for (part = 0; !parts_.parts[part].kept;) ++part;
  return part;
}

Index LatticeCellMap::partOf(const Vec3 &local, const Vec3 &outward) const {
  const Frame &frame = set_.frame;
  const auto cellAt = [&](const Vec3 &at) {
    const Vec3 units = ((at - frame.low) / frame.unit()).array().floor();
    if (!(units.cwiseAbs().maxCoeff() < 1e9)) return kNone;
    return set_.index.holding({static_cast<std::int32_t>(units[0]), static_cast<std::int32_t>(units[1]),
                               static_cast<std::int32_t>(units[2])});
  };
  // Of two cells that share the point, the one behind it.
  const Index cell = cellAt(local - 1e-6 * frame.unit() * outward);
  const double edge = cell == kNone ? frame.unit() : set_.edge(set_.cells[cell]);
  Target target{local, outward, local - kInwards * edge * outward, kBehind};
  const auto inCell = [&] {
    double best = kReachOfSample * kReachOfSample * edge * edge;
    Index part = kNone;
    nearestIn(cell, cell + 1, target, best, part);
    return part;
  };
  if (cell != kNone)
    if (const Index part = inCell(); part != kNone) return part;
  const Index behind = nearestPart(target);
  if (cell == kNone) return behind;
  // A sliver in the cell of the point is preferred, unless it belongs to the other side of a gap.
  target.inFront = kInFront;
  const Index sliver = inCell();
  return sliver != kNone && shareCorner(sliver, behind) ? sliver : behind;
}

double LatticeCellMap::outsideOf(Index part, const Vec3 &local) const {
  const Cell &cell = set_.cells[parts_.parts[part].cell];
  return ((local - set_.centre(cell)) / set_.edge(cell)).cwiseAbs().maxCoeff() - 0.5;
}

bool LatticeCellMap::shareCorner(Index a, Index b) const {
  const auto &first = parts_.parts[a].nodes, &second = parts_.parts[b].nodes;
  return std::any_of(first.begin(), first.end(),
                     [&](Index node) { return std::find(second.begin(), second.end(), node) != second.end(); });
}

void LatticeCellMap::functionsAt(Index part, const Vec3 &local, std::array<double, 8> &functions,
                                 std::array<Vec3, 8> &gradients) const {
  const Cell &cell = set_.cells[parts_.parts[part].cell];
  if (!distorted(parts_.parts[part].cell)) {
    const double edge = set_.edge(cell);
    const Vec3 place = (local - set_.centre(cell)) / edge;
    const bool far = place.cwiseAbs().maxCoeff() > 0.5 + kFarthestContinued;
    // Products of three coordinates grow with the cube of the distance; far from the cell the functions are
    // extrapolated linearly.
    const Vec3 within = far ? Vec3(place.cwiseMax(-0.5).cwiseMin(0.5)) : place;
    functions = trilinear(within);
    gradients = trilinearGradients(within);
    if (far)
      for (std::size_t j = 0; j < 8; ++j) functions[j] += gradients[j].dot(place - within);
    for (Vec3 &g : gradients) g /= edge;
    return;
  }
  const std::array<Vec3, 8> corners = hexahedron(part);
  const Trilinear t = mapAt(corners, invert(corners, local).place);
  const Mat3 inverse = t.jacobian.inverse();
  // Far from the cell the functions are extrapolated linearly.
  for (std::size_t j = 0; j < 8; ++j) {
    gradients[j] = inverse.transpose() * t.gradients[j];
    functions[j] = t.functions[j] + gradients[j].dot(local - t.x);
  }
}

EdgeFunctions LatticeCellMap::edgeFunctionsAt(Index part, const Vec3 &local) const {
  const Cell &cell = set_.cells[parts_.parts[part].cell];
  const double edge = set_.edge(cell);
  EdgeFunctions out = lattice::edgeFunctionsAt((local - set_.centre(cell)) / edge);
  for (Vec3 &g : out.gradients) g /= edge;
  return out;
}

// Faces of distorted cells have moved: the neighbour may contain the point instead.
Index LatticeCellMap::neighbourHolding(Index part, const Vec3 &local) const {
  const Cell &cell = set_.cells[parts_.parts[part].cell];
  double least = invert(hexahedron(part), local).outside;
  if (least <= 1e-9) return part;
  const int level = CellIndex::levelOf(cell, set_.frame);
  const Cell3 k{cell.at[0] / cell.size, cell.at[1] / cell.size, cell.at[2] / cell.size};
  for (int c = 0; c < 27; ++c) {
    const Index other = set_.index.find(level, {k[0] + c % 3 - 1, k[1] + c / 3 % 3 - 1, k[2] + c / 9 - 1});
    if (other == kNone || !distorted(other)) continue;
    const double outside = invert(hexahedron(parts_.first[other]), local).outside;
    if (outside >= least) continue;
    least = outside;
    part = parts_.first[other];
  }
  return part;
}

Interpolation LatticeCellMap::bind(std::span<const Vec3> points, std::span<const Vec3> normals,
                                   const ParallelFor &parallelFor) const {
  const Mat3 &axes = set_.frame.axes;
  std::vector<Index> parts(points.size());
  Interpolation result;
  result.positions.assign(points.begin(), points.end());
  result.phyxels.offsets.assign(points.size() + 1, 0);
  const auto fill = [&](std::size_t p, Row &row) {
    std::array<double, 8> functions{};
    std::array<Vec3, 8> gradients;
    functionsAt(parts[p], axes.transpose() * points[p], functions, gradients);
    row.clear();
    for (std::size_t j = 0; j < 8; ++j)
      row.add(corners_, parts_.parts[parts[p]].nodes[j], functions[j], axes * gradients[j]);
    if (!edges_.any()) return;
    const EdgeFunctions ofEdges = edgeFunctionsAt(parts[p], axes.transpose() * points[p]);
    edges_.forPart(parts[p], [&](std::size_t e, Index edge) {
      row.add(edges_, edge, ofEdges.values[e], axes * ofEdges.gradients[e]);
    });
  };
  parallelFor(points.size(), 64, [&](std::size_t begin, std::size_t end) {
    Row row;
    for (std::size_t p = begin; p < end; ++p) {
      const Vec3 local = axes.transpose() * points[p];
      parts[p] = partOf(local, normals.empty() ? Vec3(Vec3::Zero()) : Vec3(axes.transpose() * normals[p]));
      if (const double outside = outsideOf(parts[p], local); outside > kFarthestContinued) {
        // The part below the point has been dropped as a speck: the nearest of all parts, rather than one far behind
        // it.
        const Index near = nearestPart({local, Vec3::Zero(), local, 0.0});
        if (outsideOf(near, local) < outside) parts[p] = near;
      }
      if (distorted(parts_.parts[parts[p]].cell)) parts[p] = neighbourHolding(parts[p], local);
      row.clear();
      for (const Index node : parts_.parts[parts[p]].nodes) row.add(corners_, node, 0.0, Vec3::Zero());
      edges_.forPart(parts[p], [&](std::size_t, Index edge) { row.add(edges_, edge, 0.0, Vec3::Zero()); });
      result.phyxels.offsets[p + 1] = static_cast<Index>(row.phyxels.size());
    }
  });
  for (std::size_t p = 0; p < points.size(); ++p) result.phyxels.offsets[p + 1] += result.phyxels.offsets[p];
  result.phyxels.indices.resize(result.phyxels.offsets.back());
  result.weights.resize(result.phyxels.offsets.back());
  result.gradients.resize(result.phyxels.offsets.back());
  parallelFor(points.size(), 64, [&](std::size_t begin, std::size_t end) {
    Row row;
    for (std::size_t p = begin; p < end; ++p) {
      fill(p, row);
      const Index first = result.phyxels.offsets[p];
      for (std::size_t e = 0; e < row.phyxels.size(); ++e) {
        result.phyxels.indices[first + e] = row.phyxels[e];
        result.weights[first + e] = row.weights[e];
        result.gradients[first + e] = row.gradients[e];
      }
    }
  });
  return result;
}

}  // namespace pointbased::lattice
