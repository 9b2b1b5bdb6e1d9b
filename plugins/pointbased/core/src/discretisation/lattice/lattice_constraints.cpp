// SPDX-License-Identifier: Apache-2.0
#include "discretisation/lattice/lattice_constraints.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "base/disjoint_sets.h"
#include "discretisation/lattice/lattice_samples.h"
#include "shape/occupancy_field.h"

namespace pointbased::lattice {
namespace {

constexpr double kSmall = 1.0 / kSamplesPerAxis;
// Rows with less weight than this on phyxels that are not held themselves are redundant.
constexpr double kLoose = 0.05;
// Largest variance, edges², of a border that is held by a single mean: a little more than 1/12, that of a border along
// the lattice.
constexpr double kLongBorder = 0.09;
// kAll: a small cell filled by voxels to this part, minus kNearlyNone of it, counts as full: shares are not more
// accurate. kAllOfPart: a part of a cell whose sum is filled to this contains nothing free: slivers of it would be
// connected to nothing.
constexpr double kAll = 0.97, kNearlyNone = 0.03, kAllOfPart = 0.95;
// Cosine of the angle up to which surface continues a held face.
constexpr double kContinues = 0.7;
// Of the surface of a part: a smaller covered share does not hold corners; a smaller uncovered one is no edge.
constexpr double kCovered = 0.2, kUncovered = 0.03;
// Of the volume of a region that acts as a surface: parts that are no thin layers, next to its edge.
constexpr double kThick = 0.4;
// Mean normal of a flat face, of unit normals. The cap of an ellipsoid, whose rim is no edge in a face, has 0.95.
constexpr double kFlat = 0.97;
// Of all free material: an unconnected piece smaller than this is a loose bit.
constexpr double kLooseBit = 0.01;

// Cut of one small cell by a region, with a planar border.
struct RegionCut {
  double distance = 0.0;       // of the centre of the small cell, m
  Vec3 normal = Vec3::Zero();  // lattice axes
  double share = 0.0;          // of the small cell, inside the region
};

RegionCut cutOf(const CellSet &set, const Region &region, const Cell &cell, int sample) {
  RegionCut cut;
  const double edge = set.edge(cell);
  const Vec3 x = set.frame.world(set.centre(cell) + edge * sampleOffset(sample));
  cut.distance = signedDistance(region, x);
  cut.share = shareOf(cut.distance, kSmall * edge);
  cut.normal = set.frame.axes.transpose() * borderNormal(region, x);
  return cut;
}

// Content of a small cell on both sides of the border of a region. If border and surface are parallel, they are ends of
// intervals on one line. Otherwise each removes the same share of the remainder of the other.
DividedSample divide(const SampleContent &content, const Vec3 &middle, const RegionCut &cut) {
  DividedSample result{content, content};
  const double along = content.normal.dot(cut.normal);
  if (content.share < 1.0 && std::abs(along) < 0.7) {
    const auto keep = [&](SampleContent &side, double share, const Vec3 &towards) {
      side.share *= share;
      side.centre += 0.5 * (1.0 - share) * kSmall * towards;
      side.variance =
          (side.variance - kSmall * kSmall / 12.0 * (1.0 - share * share) * towards.cwiseAbs2()).cwiseMax(0.0);
    };
    keep(result.inside, cut.share, -cut.normal);
    keep(result.outside, 1.0 - cut.share, cut.normal);
    result.border = content.share;
    return result;
  }
  const double low = along < 0.0 ? 0.5 - content.share : -0.5, high = low + content.share, at = cut.share - 0.5;
  const auto interval = [&](double from, double to) {
    SampleContent side;
    side.share = std::max(0.0, to - from);
    side.centre = middle + 0.5 * (from + to) * kSmall * cut.normal;
    side.variance = kSmall * kSmall / 12.0 * (Vec3::Ones() - (1.0 - side.share * side.share) * cut.normal.cwiseAbs2());
    return side;
  };
  result.inside = interval(low, std::min(high, at));
  result.outside = interval(std::max(low, at), high);
  result.border = at >= low && at <= high ? 1.0 : 0.0;
  return result;
}

// A box thinner than a layer that acts as a surface contains no volume, wherever it is in a cell.
bool isSheet(const Region &region, double edge) {
  const auto *box = std::get_if<BoxRegion>(&region);
  return box != nullptr && (box->max - box->min).minCoeff() < kThinLayer * edge;
}

// Whether a region contains no part of a cell (> 0), all of it (< 0), or has to be measured (0).
int sideOf(const CellSet &set, const Region &region, const Cell &cell) {
  const double distance = signedDistance(region, set.frame.world(set.centre(cell)));
  const double reach = 1.4 * set.edge(cell);  // half a diagonal, and one of a small cell
  return distance > reach ? 1 : distance < -reach ? -1 : 0;
}

// Whether a gap separates a small cell outside of held voxels from them.
bool isBeyondGap(const BodyShape &shape, const CellSet &set, const VoxelRegion &held, const Cell &cell,
                 const SampleContent &content, const Vec3 &middle, const RegionCut &cut) {
  if (!(cut.distance > 0.0) || !shape.crosses) return false;
  const Vec3 from = set.frame.world(set.centre(cell) + set.edge(cell) * content.centre);
  const Vec3 border = set.frame.world(set.centre(cell) + set.edge(cell) * middle - cut.distance * cut.normal);
  const Vec3 to = border - 0.5 * held.voxels->voxel() * (set.frame.axes * cut.normal);
  std::uint8_t crosses = 0;
  shape.crosses(std::span<const Vec3>(&from, 1), std::span<const Vec3>(&to, 1), std::span<std::uint8_t>(&crosses, 1));
  return crosses != 0;
}

// As divide(), but voxels determine their filling and end at gaps. Planes would leave free slivers next to the surface
// of held voxels, and would hold across gaps thinner than a small cell.
DividedSample divideByRegion(const BodyShape &shape, const CellSet &set, const Region &region, const Cell &cell,
                             int sample, const SampleContent &content, const RegionCut &cut) {
  const Vec3 middle = sampleOffset(sample);
  const auto *voxels = std::get_if<VoxelRegion>(&region);
  if (voxels == nullptr || !(content.share > 0.0)) return divide(content, middle, cut);
  if (*voxelShare(set, region, cell, sample) >= kAll * content.share - kNearlyNone) {
    DividedSample all = divide(content, middle, cut);
    all.inside = content;
    all.outside.share = 0.0;
    if (content.share < kAll) all.border = 0.0;
    return all;
  }
  DividedSample result = divide(content, middle, cut);
  if (isBeyondGap(shape, set, *voxels, cell, content, middle, cut)) {
    result.outside = content;
    result.inside.share = result.border = 0.0;
  }
  return result;
}

// Sums over the samples of the part.
HeldPatch measureVolume(const BodyShape &shape, const CellSet &set, const CutCellFragment &part, const Moments &all,
                        const Region &region) {
  HeldPatch patch;
  const Cell &cell = set.cells[part.cell];
  const int side = sideOf(set, region, cell);
  if (side > 0) return patch;
  if (side < 0) {
    patch.held = all;
    return patch;
  }
  // Samples with too small a share to connect belong to the nearest part, even beyond a gap.
  const View view = viewOf(set, part.cell);
  const bool connects = std::holds_alternative<VoxelRegion>(region);
  const double edge = set.edge(cell), width = kSmall * edge;
  for (int s = 0; s < kSamples; ++s) {
    if ((part.samples >> s & 1) == 0) continue;
    const SampleContent content = contentOf(set, cell, s);
    if (content.share <= 0.0) continue;
    const RegionCut cut = cutOf(set, region, cell, s);
    const DividedSample divided = divideByRegion(shape, set, region, cell, s, content, cut);
    if (divided.inside.share > 0.0)
      patch.held.add(divided.inside.share / kSamples, divided.inside.centre, divided.inside.variance);
    // The border as a smeared delta function, one small cell wide along its normal. A border between two cells belongs
    // to the outer one, which can deform.
    const double reach = 0.5 * cut.normal.lpNorm<1>();
    const double layers = cut.distance / width - 1e-3;
    if (!(layers > -reach && layers <= reach) || divided.border <= 0.0 || (connects && !view.connects(s))) continue;
    const double area = divided.border * width * width / (2.0 * reach);
    const double off = cut.distance / edge + cut.normal.dot(content.centre - sampleOffset(s));
    patch.borderArea += area;
    patch.border.push_back({content.centre - off * cut.normal, area});
  }
  return patch;
}

// A layer between the border and a surface parallel to it, or a surface without a border inside the part.
bool isThin(const HeldPatch &patch, const Moments &all, double edge) {
  if (!(patch.borderArea > 0.0)) return patch.surfaceArea > 0.0 && patch.held.share < 1e-3 * all.share;
  return patch.facingArea > 0.5 * patch.borderArea &&
         patch.held.share * edge * edge * edge < kThinLayer * edge * patch.facingArea;
}

// Whether most of what a region holds are thin layers at a flat face.
bool actsAsSurface(const CellSet &set, const LatticeCellMap &map, const std::vector<HeldPatch> &patches) {
  double all = 0.0, thick = 0.0, area = 0.0;
  Vec3 areaVector = Vec3::Zero();
  for (const HeldPatch &patch : patches) {
    const double volume = patch.held.share * std::pow(set.edge(set.cells[map.parts()[patch.part].cell]), 3);
    all += volume;
    if (!patch.thin) thick += volume;
    area += patch.surfaceArea;
    areaVector += patch.surfaceNormal;
  }
  return !(thick > kThick * all) && areaVector.norm() > kFlat * area;
}

Moments freeMoments(const BodyShape &shape, const CellSet &set, const CutCellFragment &part,
                    std::span<const Region *const> regions) {
  Moments moments;
  const Cell &cell = set.cells[part.cell];
  double all = 0.0, byVoxels = 0.0;
  for (int s = 0; s < kSamples; ++s) {
    if ((part.samples >> s & 1) == 0) continue;
    SampleContent content = contentOf(set, cell, s);
    all += content.share;
    for (const Region *region : regions) {
      if (const auto share = voxelShare(set, *region, cell, s)) byVoxels += std::min(*share, content.share);
      const RegionCut cut = cutOf(set, *region, cell, s);
      content = divideByRegion(shape, set, *region, cell, s, content, cut).outside;
    }
    if (content.share > 0.0) moments.add(content.share / kSamples, content.centre, content.variance);
  }
  return byVoxels < kAllOfPart * all ? moments : Moments{};
}

// Samples of the surface within a region, with the part of each.
struct LocatedSamples {
  SurfacePoints points;
  std::vector<Index> parts;
  std::vector<Vec3> local;  // lattice axes, from the origin of the frame, m
};

LocatedSamples locateSurface(const BodyShape &shape, const Region &region, const LatticeCellMap &map,
                             const ParallelFor &parallelFor) {
  const Frame &frame = map.set().frame;
  LocatedSamples out{sampleSurface(shape.surface, kSmall * frame.unit(), region), {}, {}};
  out.parts.resize(out.points.count());
  out.local.resize(out.points.count());
  parallelFor(out.points.count(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      out.local[i] = frame.axes.transpose() * (out.points.positions[i] - frame.origin);
      out.parts[i] = map.partOf(out.local[i], frame.axes.transpose() * out.points.normals[i]);
    }
  });
  return out;
}

void addSurface(const BodyShape &shape, const Region &region, const LatticeCellMap &map, std::vector<Index> &slots,
                std::vector<HeldPatch> &patches, const ParallelFor &parallelFor) {
  if (shape.surface.triangles.empty()) return;
  const Frame &frame = map.set().frame;
  const auto [points, parts, local] = locateSurface(shape, region, map, parallelFor);
  for (std::size_t i = 0; i < points.count(); ++i) {
    if (slots[parts[i]] == kNone) {
      slots[parts[i]] = static_cast<Index>(patches.size());
      patches.emplace_back().part = parts[i];
    }
    HeldPatch &patch = patches[slots[parts[i]]];
    std::array<double, 8> functions{};
    std::array<Vec3, 8> gradients;
    map.functionsAt(parts[i], local[i], functions, gradients);
    patch.surfaceArea += points.areas[i];
    patch.surfaceCentre += points.areas[i] * local[i];
    patch.surfaceNormal += points.areas[i] * (frame.axes.transpose() * points.normals[i]);
    PatchFunctions all{};
    std::copy(functions.begin(), functions.end(), all.begin());
    if (!map.distorted(map.parts()[parts[i]].cell)) {
      const EdgeFunctions ofEdges = map.edgeFunctionsAt(parts[i], local[i]);
      std::copy(ofEdges.values.begin(), ofEdges.values.end(), all.begin() + 8);
    }
    for (std::size_t j = 0; j < all.size(); ++j) patch.surface[j] += points.areas[i] * all[j];
    if (borderNormal(region, points.positions[i]).dot(points.normals[i]) > -0.5) continue;
    patch.facingArea += points.areas[i];
    for (std::size_t j = 0; j < all.size(); ++j) patch.facing[j] += points.areas[i] * all[j];
  }
}

template <class Visit>
void forPhyxels(const LatticeCellMap &map, Index part, const Visit &visit) {
  const NodeTable &corners = map.corners();
  for (const Index node : map.parts()[part].nodes)
    for (std::uint32_t e = corners.offsets[node]; e < corners.offsets[node + 1]; ++e) visit(corners.phyxels[e]);
}

// Surface that continues held faces beyond the edge of region r, in the parts of their corners, and that no other region
// holds.
void addUncovered(const BodyShape &shape, std::span<const Region> regions, std::size_t r, const LatticeCellMap &map,
                  std::vector<Index> &slots, std::vector<HeldPatch> &patches, const ParallelFor &parallelFor) {
  const Frame &frame = map.set().frame;
  std::vector<Vec3> normals(map.corners().positions.size(), Vec3::Zero());  // of held faces, by phyxel
  BoxRegion around{Vec3::Constant(1e300), Vec3::Constant(-1e300)};
  for (const HeldPatch &patch : patches) {
    if (!(patch.surfaceArea > 0.0)) continue;
    forPhyxels(map, patch.part, [&](Index i) {
      normals[i] += patch.surfaceNormal;
      const Vec3 at = frame.world(map.corners().positions[i]);
      around.min = around.min.cwiseMin(at);
      around.max = around.max.cwiseMax(at);
    });
  }
  if (!(around.min.array() <= around.max.array()).all()) return;
  around.min.array() -= frame.spacing;
  around.max.array() += frame.spacing;
  const auto [points, parts, local] = locateSurface(shape, around, map, parallelFor);
  const auto isHeldByAnother = [&](const Vec3 &x) {
    for (std::size_t other = 0; other < regions.size(); ++other)
      if (other != r && contains(regions[other], x) && !contains(regions[r], x)) return true;
    return false;
  };
  for (std::size_t i = 0; i < points.count(); ++i) {
    const Vec3 normal = frame.axes.transpose() * points.normals[i];
    const Index part = parts[i];
    if (isHeldByAnother(points.positions[i])) continue;
    Vec3 held = Vec3::Zero();
    forPhyxels(map, part, [&](Index phyxel) { held += normals[phyxel]; });
    if (!(normal.dot(held) > kContinues * held.norm())) continue;
    if (slots[part] == kNone) {
      slots[part] = static_cast<Index>(patches.size());
      patches.emplace_back().part = part;
    }
    patches[slots[part]].uncoveredArea += points.areas[i];
  }
  for (HeldPatch &patch : patches) patch.uncoveredArea = std::max(0.0, patch.uncoveredArea - patch.surfaceArea);
}

// Rows and phyxels of one region.
class Holder {
 public:
  Holder(const BodyShape &shape, const Region &region, const LatticeCellMap &map, const std::vector<HeldPatch> &patches,
         std::span<const PartContent> contents, std::span<const std::uint8_t> movable)
      : shape_(shape), region_(region), map_(map), patches_(patches), contents_(contents), movable_(movable) {}

  ConstrainedRegion hold(double scale) {
    measure(scale);
    findPhyxels();
    for (const HeldPatch &patch : patches_) {
      if (hasBorder(patch))
        addBorder(patch);
      else if (patch.thin && patch.borderArea > 0.0)
        addRow(patch, patch.facingArea, patch.facing);
      else if (patch.thin)
        addRow(patch, patch.surfaceArea, patch.surface);
    }
    return std::move(result_);
  }

 private:
  [[nodiscard]] double edgeOf(const HeldPatch &patch) const {
    return map_.set().edge(map_.set().cells[map_.parts()[patch.part].cell]);
  }
  // Share of the surface of a part, along a held face, that the region covers; 1: it has no edge here.
  [[nodiscard]] static double coveredShare(const HeldPatch &patch) {
    const double all = patch.surfaceArea + patch.uncoveredArea;
    return patch.uncoveredArea > kUncovered * all ? patch.surfaceArea / all : 1.0;
  }
  // If all of a part is held, its corners are held.
  [[nodiscard]] bool hasBorder(const HeldPatch &patch) const {
    return !patch.thin && contents_[patch.part].isFree() && patch.borderArea > 0.0;
  }

  void measure(double scale) {
    Vec3 sum = Vec3::Zero(), surface = Vec3::Zero();
    double thick = 0.0;
    for (const HeldPatch &patch : patches_) {
      const double edge = edgeOf(patch), cube = edge * edge * edge;
      result_.volume += scale * cube * patch.held.share;
      result_.area += patch.surfaceArea;
      surface += patch.surfaceCentre;
      if (patch.thin || !(patch.held.share > 0.0)) continue;
      thick += cube * patch.held.share;
      const Vec3 centre = map_.set().centre(map_.set().cells[map_.parts()[patch.part].cell]);
      sum += cube * (patch.held.share * centre + edge * patch.held.first);
    }
    const Mat3 &axes = map_.set().frame.axes;
    // Slivers of volume next to a held face do not determine its position.
    const double cell = map_.set().frame.spacing * map_.set().frame.spacing * map_.set().frame.spacing;
    const bool hasVolume =
        thick > 1e-3 * cell && (result_.area <= 0.0 || thick > 1e-3 * result_.area * map_.set().frame.spacing);
    if (hasVolume)
      result_.centroid = axes * (sum / thick);
    else if (result_.area > 0.0)
      result_.centroid = axes * (surface / result_.area);
  }

  void findPhyxels() {
    const std::size_t n = map_.corners().positions.size();
    std::vector<std::uint8_t> candidate(n, 0), onThin(n, 0);
    held_.assign(n, 0);
    for (const HeldPatch &patch : patches_) {
      if (patch.thin)
        forPhyxels(map_, patch.part, [&](Index i) { onThin[i] = 1; });
      else if (!contents_[patch.part].isFree() && patch.held.share > 0.0)
        forPhyxels(map_, patch.part, [&](Index i) { candidate[i] = 1; });
    }
    for (std::size_t i = 0; i < n; ++i) held_[i] = candidate[i] != 0 && movable_[i] == 0 ? 1 : 0;
    // On a held surface, or in a held layer so thin that it acts as a surface; not where the border cuts the cell.
    for (const HeldPatch &patch : patches_)
      if (hasBorder(patch)) forPhyxels(map_, patch.part, [&](Index i) { onThin[i] = 0; });
    // Nor at the edge of the region, up to which the rows hold (kEdgePatchStiffness).
    isAtEdge_.assign(n, 0);
    for (const HeldPatch &patch : patches_)
      if (coveredShare(patch) < kCovered) forPhyxels(map_, patch.part, [&](Index i) { isAtEdge_[i] = 1; });
    for (std::size_t i = 0; i < n; ++i)
      if (isAtEdge_[i] != 0) onThin[i] = 0;
    const Frame &frame = map_.set().frame;
    std::vector<Index> asked;
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 &local = map_.corners().positions[i];
      if (onThin[i] == 0 || signedDistance(region_, frame.world(local)) > 1e-9 * frame.spacing) continue;
      asked.push_back(static_cast<Index>(i));
      points.push_back(local);
    }
    if (!points.empty()) {
      const Questions ask(shape_, frame);
      std::vector<std::uint8_t> inside(points.size());
      std::vector<double> distances(points.size(), 1e300);
      ask.inside(points, inside);
      if (ask.measures()) ask.distances(points, distances);
      for (std::size_t k = 0; k < asked.size(); ++k)
        if (inside[k] != 0 || distances[k] < 1e-3 * frame.spacing) held_[asked[k]] = 1;
    }
    for (std::size_t i = 0; i < n; ++i)
      if (held_[i] != 0) result_.phyxels.push_back(static_cast<Index>(i));
  }

  // One row for the border in a cell, or one for each half of it, divided along its longest direction. A border through
  // the edges of a cell is longer than the cell. Where a lobe is no wider than that, a single mean would act as a
  // hinge.
  void addBorder(const HeldPatch &patch) {
    Vec3 middle = Vec3::Zero();
    Mat3 spread = Mat3::Zero();
    for (const BorderPiece &piece : patch.border) {
      middle += piece.area / patch.borderArea * piece.place;
      spread += piece.area / patch.borderArea * piece.place * piece.place.transpose();
    }
    spread -= middle * middle.transpose();
    const Eigen::SelfAdjointEigenSolver<Mat3> extent(spread);
    const bool two = extent.eigenvalues()[2] > kLongBorder;
    std::array<double, 2> areas{};
    std::array<PatchFunctions, 2> functions{};
    for (const BorderPiece &piece : patch.border) {
      const std::size_t half = two && extent.eigenvectors().col(2).dot(piece.place - middle) > 0.0 ? 1 : 0;
      const std::array<double, 8> there = trilinear(piece.place);
      areas[half] += piece.area;
      for (std::size_t j = 0; j < 8; ++j) functions[half][j] += piece.area * there[j];
      const EdgeFunctions ofEdges = edgeFunctionsAt(piece.place);
      for (std::size_t e = 0; e < kEdges; ++e) functions[half][8 + e] += piece.area * ofEdges.values[e];
    }
    for (const std::size_t half : {0u, 1u})
      if (areas[half] > 0.0) addRow(patch, areas[half], functions[half]);
  }

  void addRow(const HeldPatch &patch, double area, const PatchFunctions &functions) {
    const double edge = edgeOf(patch);
    if (!(area > 1e-6 * edge * edge)) return;
    row_.clear();
    for (std::size_t j = 0; j < 8; ++j)
      row_.add(map_.corners(), map_.parts()[patch.part].nodes[j], functions[j] / area, Vec3::Zero());
    map_.edges().forPart(patch.part, [&](std::size_t e, Index row) {
      row_.add(map_.edges(), row, functions[8 + e] / area, Vec3::Zero());
    });
    double loose = 0.0;
    for (std::size_t e = 0; e < row_.phyxels.size(); ++e)
      if (held_[row_.phyxels[e]] == 0) loose += std::abs(row_.weights[e]);
    if (loose < kLoose) return;
    for (std::size_t e = 0; e < row_.phyxels.size(); ++e) {
      result_.rows.indices.push_back(row_.phyxels[e]);
      result_.weights.push_back(row_.weights[e]);
    }
    result_.rows.offsets.push_back(static_cast<Index>(result_.rows.indices.size()));
    result_.areas.push_back(area);
    bool isEdge = coveredShare(patch) < 1.0;
    forPhyxels(map_, patch.part, [&](Index i) { isEdge = isEdge || isAtEdge_[i] != 0; });
    result_.stiffness.push_back(isEdge ? kEdgePatchStiffness : kPatchStiffness);
  }

  const BodyShape &shape_;
  const Region &region_;
  const LatticeCellMap &map_;
  const std::vector<HeldPatch> &patches_;
  std::span<const PartContent> contents_;
  std::span<const std::uint8_t> movable_;  // phyxels adjacent to free material
  std::vector<std::uint8_t> held_, isAtEdge_;
  ConstrainedRegion result_;
  Row row_;
};

}  // namespace

namespace {

// Pieces of tissue that nothing connects to held voxels would be unconstrained: they are held.
void constrainIslands(const LatticeSampling &sampling, const LatticeCellMap &map, std::vector<PartContent> &contents,
                      HeldPatches &patches) {
  const auto region = std::find_if(sampling.held.begin(), sampling.held.end(),
                                   [](const Region &held) { return std::holds_alternative<VoxelRegion>(held); });
  if (region == sampling.held.end()) return;
  const auto isFree = [&](Index p) { return map.parts()[p].kept && contents[p].isFree(); };
  DisjointSets pieces(contents.size());
  for (const FragmentLink &link : map.links())
    if (isFree(link.a) && isFree(link.b)) pieces.join(link.a, link.b);
  std::vector<double> volumes(contents.size(), 0.0);
  double all = 0.0;
  for (Index p = 0; p < contents.size(); ++p) {
    if (!isFree(p)) continue;
    const double volume = contents[p].free.share * std::pow(map.set().cells[map.parts()[p].cell].size, 3);
    volumes[pieces.find(p)] += volume;
    all += volume;
  }
  std::vector<std::uint8_t> hangs(contents.size(), 0);
  for (const std::vector<HeldPatch> &held : patches)
    for (const HeldPatch &patch : held)
      if (patch.thin || patch.borderArea > 0.0) hangs[pieces.find(patch.part)] = 1;
  std::vector<HeldPatch> &held = patches[static_cast<std::size_t>(region - sampling.held.begin())];
  for (Index p = 0; p < contents.size(); ++p) {
    const Index piece = pieces.find(p);
    if (!isFree(p) || hangs[piece] != 0 || !(volumes[piece] < kLooseBit * all)) continue;
    auto patch = std::find_if(held.begin(), held.end(), [&](const HeldPatch &one) { return one.part == p; });
    if (patch == held.end()) patch = held.insert(held.end(), HeldPatch{});
    patch->part = p;
    patch->held = contents[p].all;
    contents[p].free = Moments{};
    contents[p].touched = true;
  }
}

}  // namespace

HeldPatches findHeld(const BodyShape &shape, const LatticeSampling &sampling, const LatticeCellMap &map,
                     std::vector<PartContent> &contents, const ParallelFor &parallelFor) {
  HeldPatches result(sampling.held.size());
  if (result.empty()) return result;
  const CellSet &set = map.set();
  std::vector<std::vector<const Region *>> holding(map.parts().size());
  std::vector<std::uint8_t> whole(map.parts().size(), 0);  // held, even if part of it is free
  for (std::size_t r = 0; r < sampling.held.size(); ++r) {
    const Region &region = sampling.held[r];
    std::vector<HeldPatch> measured(map.parts().size());
    parallelFor(measured.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p)
        if (map.parts()[p].kept && !isSheet(region, set.edge(set.cells[map.parts()[p].cell])))
          measured[p] = measureVolume(shape, set, map.parts()[p], contents[p].all, region);
    });
    std::vector<Index> slots(map.parts().size(), kNone);
    for (std::size_t p = 0; p < measured.size(); ++p) {
      if (!(measured[p].held.share > 0.0) && !(measured[p].borderArea > 0.0)) continue;
      slots[p] = static_cast<Index>(result[r].size());
      result[r].push_back(measured[p]);
      result[r].back().part = static_cast<Index>(p);
    }
    addSurface(shape, region, map, slots, result[r], parallelFor);
    for (HeldPatch &patch : result[r]) {
      contents[patch.part].touched = true;
      patch.thin = isThin(patch, contents[patch.part].all, set.edge(set.cells[map.parts()[patch.part].cell]));
      if (!patch.thin && patch.held.share > 0.0) holding[patch.part].push_back(&region);
      // The remainder would be connected to nothing.
      if (std::holds_alternative<VoxelRegion>(region) && patch.border.empty() &&
          patch.held.share > 0.5 * contents[patch.part].all.share)
        whole[patch.part] = 1;
    }
    if (actsAsSurface(set, map, result[r])) addUncovered(shape, sampling.held, r, map, slots, result[r], parallelFor);
  }
  parallelFor(contents.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p)
      if (whole[p] != 0)
        contents[p].free = Moments{};
      else if (!holding[p].empty())
        contents[p].free = freeMoments(shape, set, map.parts()[p], holding[p]);
  });
  constrainIslands(sampling, map, contents, result);
  return result;
}

DividedSample divideHeld(const BodyShape &shape, const CellSet &set, const Region &region, const Cell &cell, int sample,
                         const SampleContent &content) {
  return divideByRegion(shape, set, region, cell, sample, content, cutOf(set, region, cell, sample));
}

DividedSample divideSample(const CellSet &set, const Region &region, const Cell &cell, int sample,
                           const SampleContent &content) {
  return divide(content, sampleOffset(sample), cutOf(set, region, cell, sample));
}

std::optional<double> voxelShare(const CellSet &set, const Region &region, const Cell &cell, int sample) {
  const auto *filled = std::get_if<VoxelRegion>(&region);
  if (filled == nullptr) return std::nullopt;
  const double edge = set.edge(cell);
  const Vec3 x = set.frame.world(set.centre(cell) + edge * sampleOffset(sample)) + filled->offset;
  double share = 0.0;
  filled->voxels->shares(std::span<const Vec3>(&x, 1), set.frame.axes, kSmall * edge, std::span<double>(&share, 1));
  return share;
}

Result<std::vector<ConstrainedRegion>> holdLattice(const BodyShape &shape, const LatticeSampling &sampling,
                                                   const LatticeCellMap &map, const HeldPatches &patches,
                                                   std::span<const PartContent> contents, double scale,
                                                   const ParallelFor &) {
  std::vector<ConstrainedRegion> result;
  if (patches.empty()) return result;
  std::vector<std::uint8_t> movable(map.corners().positions.size(), 0);
  for (std::size_t p = 0; p < contents.size(); ++p)
    if (map.parts()[p].kept && contents[p].isFree())
      forPhyxels(map, static_cast<Index>(p), [&](Index i) { movable[i] = 1; });
  std::vector<std::uint8_t> taken(movable.size(), 0);
  for (std::size_t r = 0; r < patches.size(); ++r) {
    ConstrainedRegion part = Holder(shape, sampling.held[r], map, patches[r], contents, movable).hold(scale);
    // A phyxel held by two regions follows the first.
    std::erase_if(part.phyxels, [&](Index i) { return taken[i] != 0; });
    for (const Index i : part.phyxels) taken[i] = 1;
    if (part.empty())
      return tl::unexpected("fix " + std::to_string(r) +
                            ": the region meets no part of the body; move or enlarge it until it does");
    result.push_back(std::move(part));
  }
  return result;
}

}  // namespace pointbased::lattice
