// SPDX-License-Identifier: Apache-2.0
#include "pointbased/lattice.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <unordered_map>

#include "base/cancellation_poll.h"
#include "base/number_text.h"
#include "discretisation/lattice/cell_map.h"
#include "discretisation/lattice/lattice_constraints.h"
#include "discretisation/lattice/lattice_direction.h"
#include "discretisation/lattice/lattice_jitter.h"
#include "discretisation/lattice/lattice_masses.h"

namespace pointbased {

using namespace lattice;
using detail::number;

namespace {

tl::unexpected<std::string> refuse(const std::string &text) { return tl::unexpected<std::string>(text); }

Result<void> validate(const BodyShape &shape, const LatticeSampling &sampling) {
  if (!(shape.volume > 0.0) || !std::isfinite(shape.volume))
    return refuse("the body has a volume of " + number(shape.volume, 4) + " m³; a finite volume > 0 is needed");
  if (!shape.inside) return refuse("the body cannot tell which points are inside");
  const double extent = (shape.max - shape.min).minCoeff();
  if (!(extent > 0.0) || !shape.min.allFinite() || !shape.max.allFinite())
    return refuse("the bounds of the body have an edge of " + number(extent, 4) +
                  " m; finite bounds with edges > 0 are needed");
  if (!(sampling.spacing >= 0.0) || !std::isfinite(sampling.spacing))
    return refuse("spacing = " + number(sampling.spacing, 4) + " m is not accepted: finite and > 0, or 0 with a count");
  if (sampling.spacing == 0.0 && (sampling.count < 1 || sampling.count > kMaximumPhyxels))
    return refuse("count = " + std::to_string(sampling.count) + " is not accepted: 1 … " +
                  std::to_string(kMaximumPhyxels));
  if (!(sampling.jitter >= 0.0 && sampling.jitter <= 0.3))
    return refuse("jitter = " + number(sampling.jitter, 4) + " is not accepted: 0 … 0.3");
  if (sampling.order == LatticeOrder::quadratic && sampling.jitter > 0.0)
    return refuse("jitter = " + number(sampling.jitter, 4) +
                  " is not accepted with functions of second order, which need regular rows of phyxels: 0");
  if (!(sampling.surfaceSpacing >= 0.0) || !std::isfinite(sampling.surfaceSpacing))
    return refuse("surfaceSpacing = " + number(sampling.surfaceSpacing, 4) + " m is not accepted: finite and >= 0");
  if (sampling.axes && (!((sampling.axes->transpose() * *sampling.axes - Mat3::Identity()).norm() < 1e-9) ||
                        !(sampling.axes->determinant() > 0.0)))
    return refuse("axes are not a rotation");
  const auto check = [](const char *name, std::size_t i, const Region &region) -> Result<void> {
    const Result<void> valid = validate(region);
    return valid ? valid : refuse(std::string(name) + " " + std::to_string(i) + ": " + valid.error());
  };
  for (std::size_t i = 0; i < sampling.refinements.size(); ++i) {
    const Refinement &r = sampling.refinements[i];
    if (!(r.spacing > 0.0) || !std::isfinite(r.spacing))
      return refuse("refinement " + std::to_string(i) + ": spacing = " + number(r.spacing, 4) +
                    " m is not accepted: finite and > 0");
    if (const auto valid = check("refinement", i, r.region); !valid) return valid;
  }
  for (std::size_t i = 0; i < sampling.held.size(); ++i)
    if (const auto valid = check("held region", i, sampling.held[i]); !valid) return valid;
  for (std::size_t i = 0; i < sampling.materials.size(); ++i)
    if (const auto valid = check("material region", i, sampling.materials[i].first); !valid) return valid;
  return {};
}

struct Cut {
  CellSet set;
  PartSet parts;
  NodeTable corners;
};

Result<Cut> cutCells(const BodyShape &shape, const LatticeSampling &sampling, double spacing,
                     const ParallelFor &parallelFor, const SamplingProgress &progress) {
  if (const auto fits = checkSize(shape, sampling, spacing); !fits) return refuse(fits.error());
  auto set = findCells(shape, sampling, spacing, parallelFor, progress);
  if (!set) return refuse(set.error());
  if (set->cells.empty())
    return refuse("no point of the body was found at a spacing of " + number(spacing, 4) +
                  " m: the body is thinner than a tenth of it, or not closed; use a smaller spacing");
  Cut cut;
  cut.set = std::move(*set);
  cut.parts = findParts(cut.set, shape, parallelFor);
  detail::checkCancelled(parallelFor);
  cut.corners = joinCorners(cut.set, cut.parts, parallelFor);
  if (static_cast<double>(cut.corners.positions.size()) > kExpectationSlack * static_cast<double>(kMaximumPhyxels))
    return refuse("a spacing of " + number(spacing, 4) + " m makes " + std::to_string(cut.corners.positions.size()) +
                  " phyxels; at most " + std::to_string(kMaximumPhyxels) + " are accepted: use a larger spacing");
  return cut;
}

// The number of corners decreases in steps as the spacing grows; a few corrections come within some per cent. A cheap
// estimate is corrected first, then the real number.
Result<Cut> cutForCount(const BodyShape &shape, const LatticeSampling &sampling, const ParallelFor &parallelFor,
                        const SamplingProgress &progress) {
  constexpr int kEstimates = 16, kAttempts = 4;
  constexpr double kCloseEnough = 0.03;
  const auto wanted = static_cast<double>(sampling.count);
  double target = wanted;
  double spacing = std::cbrt(shape.volume / wanted);
  std::optional<Cut> best;
  double bestMiss = 1e300;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    double closest = spacing, closestMiss = 1e300, closestCount = target;
    double tooFine = 0.0, tooCoarse = 1e300;
    for (int i = 0; i < kEstimates; ++i) {
      if (const auto fits = checkSize(shape, sampling, spacing); !fits) return refuse(fits.error());
      const auto found = static_cast<double>(estimateCorners(shape, sampling, spacing, parallelFor));
      const double miss = std::abs(found - target);
      if (miss < closestMiss) {
        closestMiss = miss;
        closest = spacing;
        closestCount = std::max(found, 1.0);
      }
      if (miss <= 0.01 * target) break;
      (found > target ? tooFine : tooCoarse) = spacing;
      spacing *= std::cbrt(std::max(found, 1.0) / target);
      // Between two steps the corrections would alternate.
      if (spacing <= tooFine || spacing >= tooCoarse) spacing = 0.5 * (tooFine + tooCoarse);
      if (spacing > 1e299 || tooCoarse - tooFine < 1e-4 * tooFine) break;
    }
    spacing = closest;
    auto cut = cutCells(shape, sampling, spacing, parallelFor, progress);
    if (!cut) return refuse(cut.error());
    const auto found = static_cast<double>(cut->corners.positions.size());
    if (std::abs(found - wanted) < bestMiss) {
      bestMiss = std::abs(found - wanted);
      best = std::move(*cut);
    }
    if (bestMiss <= kCloseEnough * wanted) break;
    target = std::max(1.0, closestCount * wanted / found);
    spacing *= std::cbrt(found / wanted);
  }
  return std::move(*best);
}

std::vector<PartContent> measureParts(const LatticeCellMap &map, const ParallelFor &parallelFor) {
  std::vector<PartContent> contents(map.parts().size());
  parallelFor(contents.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p)
      if (map.parts()[p].kept) contents[p].all = contents[p].free = momentsOf(map.set(), map.parts()[p]);
  });
  return contents;
}

// s_mj: products of the signs of corner j.
Eigen::Vector4d modeSigns(std::size_t corner) {
  const int c = static_cast<int>(corner);
  const double x = cornerSign(c, 0), y = cornerSign(c, 1), z = cornerSign(c, 2);
  return {x * y, x * z, y * z, x * y * z};
}

struct PointGeometry {
  double volume = 0.0;            // m³
  Vec3 centre = Vec3::Zero();     // lattice axes, m
  Vec3 variance = Vec3::Zero();   // m²
  std::array<Vec3, 8> gradients;  // lattice axes, 1/m
  std::array<Eigen::Vector4d, 8> modes;
};

PointGeometry pointOf(const LatticeCellMap &map, Index p, const Moments &content) {
  const CutCellFragment &part = map.parts()[p];
  const Cell &cell = map.set().cells[part.cell];
  const double edge = map.set().edge(cell);
  PointGeometry point;
  std::array<Vec3, 8> corners;
  if (map.distorted(part.cell)) {
    const HexahedronMeans means = meansOf(corners = map.hexahedron(p));
    point.volume = means.volume;
    point.centre = means.centroid;
    point.variance = means.variance;
    point.gradients = means.gradients;
    for (Vec3 &corner : corners) corner -= map.set().centre(cell);
  } else {
    point.volume = content.share * edge * edge * edge;
    point.centre = map.set().centre(cell) + edge * content.centroid();
    point.variance = edge * edge * content.variance();
    point.gradients = content.gradients();
    for (Vec3 &g : point.gradients) g /= edge;
    for (int j = 0; j < 8; ++j)
      corners[static_cast<std::size_t>(j)] = 0.5 * edge * Vec3(cornerSign(j, 0), cornerSign(j, 1), cornerSign(j, 2));
  }
  // Projection of Flanagan and Belytschko: s - mean(s) - g · Σ s X vanishes for affine fields.
  Eigen::Matrix<double, 4, 3> moments = Eigen::Matrix<double, 4, 3>::Zero();
  for (std::size_t j = 0; j < 8; ++j) moments += modeSigns(j) * corners[j].transpose();
  const double plane = 0.5 / (edge * edge), space = 1.0 / (edge * edge * edge);
  Eigen::Vector4d scale = Eigen::Vector4d(plane, plane, plane, space).cwiseProduct(modeFactors(map.set(), part));
  // The mode xyz of a cut part is stabilised as that of a whole cell: by its own variance, corners outside of the body
  // would oscillate.
  scale[3] *= edge * edge / 12.0 / std::max(point.variance.mean(), 1e-3 * edge * edge);
  for (std::size_t j = 0; j < 8; ++j) point.modes[j] = scale.cwiseProduct(modeSigns(j) - moments * point.gradients[j]);
  return point;
}

// Part of a cell fragment that consists of one material.
struct MaterialContent {
  std::uint16_t material = 0;
  Moments moments;
};
// Of the free part of a cell: smaller amounts are assigned to the dominant material.
constexpr double kMinContent = 0.02;
// The same if voxels provide exact amounts: a stiff vessel of this part of a cell is noticeable.
constexpr double kMinByVoxels = 0.005;

// Divides cells among the materials and the held regions.
class MaterialFinder {
 public:
  MaterialFinder(const BodyShape &shape, const LatticeSampling &sampling, const CellSet &set)
      : shape_(shape), sampling_(sampling), set_(set) {}

  // Single material: `free` unchanged.
  [[nodiscard]] std::vector<MaterialContent> contentsIn(const CutCellFragment &part, const Moments &free) const {
    const Cell &cell = set_.cells[part.cell];
    const Vec3 middle = set_.frame.world(set_.centre(cell));
    const double reach = 0.5 * std::sqrt(3.0) * set_.edge(cell);
    const auto cuts = [&](const Region &region) { return std::abs(signedDistance(region, middle)) <= reach; };
    // The last region that contains the whole cell hides those before it.
    std::vector<std::size_t> near;
    std::uint16_t under = 0;
    for (std::size_t i = sampling_.materials.size(); i-- > 0;) {
      const auto &[region, material] = sampling_.materials[i];
      if (cuts(region)) {
        near.push_back(i);
      } else if (signedDistance(region, middle) < 0.0) {
        under = material;
        break;
      }
    }
    if (near.empty()) return {{under, free}};
    std::vector<const Region *> held;
    for (const Region &region : sampling_.held)
      if (cuts(region)) held.push_back(&region);
    std::map<std::uint16_t, Moments> found;
    const auto add = [&](std::uint16_t material, const SampleContent &content) {
      if (content.share > 0.0) found[material].add(content.share / kSamples, content.centre, content.variance);
    };
    for (int s = 0; s < kSamples; ++s) {
      if ((part.samples >> s & 1) == 0) continue;
      SampleContent left = contentOf(set_, cell, s);
      double unfilled = left.share;  // of the small cell, by voxels
      for (const Region *region : held) {
        if (!(left.share > 0.0)) break;
        left = divideHeld(shape_, set_, *region, cell, s, left).outside;
        if (const auto share = voxelShare(set_, *region, cell, s)) unfilled = std::max(0.0, unfilled - *share);
      }
      const auto divided = [&](const Region &region) {
        DividedSample sides = divideSample(set_, region, cell, s, left);
        const auto share = unfilled > 0.0 ? voxelShare(set_, region, cell, s) : std::nullopt;
        if (!share) return sides;
        const double within = std::min(1.0, *share / unfilled);
        sides.inside.share = within * left.share;
        sides.outside.share = (1.0 - within) * left.share;
        unfilled *= 1.0 - within;
        return sides;
      };
      for (const std::size_t i : near) {
        if (!(left.share > 0.0)) break;
        const DividedSample sides = divided(sampling_.materials[i].first);
        add(sampling_.materials[i].second, sides.inside);
        left = sides.outside;
      }
      add(under, left);
    }
    const bool byVoxels = std::any_of(near.begin(), near.end(), [&](std::size_t i) {
      return std::holds_alternative<VoxelRegion>(sampling_.materials[i].first);
    });
    return withoutSlivers(found, under, free, byVoxels ? kMinByVoxels : kMinContent);
  }

 private:
  static std::vector<MaterialContent> withoutSlivers(const std::map<std::uint16_t, Moments> &found, std::uint16_t under,
                                                     const Moments &free, double least) {
    const auto largest = std::max_element(found.begin(), found.end(),
                                          [](const auto &a, const auto &b) { return a.second.share < b.second.share; });
    std::vector<MaterialContent> out;
    for (const auto &[material, moments] : found)
      if (moments.share >= least * free.share) out.push_back({material, moments});
    if (out.size() > 1) return out;
    return {{found.empty() ? under : largest->first, free}};
  }

  const BodyShape &shape_;
  const LatticeSampling &sampling_;
  const CellSet &set_;
};

// Collects points whose cells have hanging corners.
class HangingCellFinder {
 public:
  HangingCellFinder(const NodeTable &corners, HangingCells &out) : corners_(corners), out_(out) {}

  void add(const std::array<Index, 8> &nodes, const PointGeometry &geometry, std::size_t point) {
    HangingCells::Point found;
    found.point = static_cast<Index>(point);
    bool any = false;
    for (std::size_t j = 0; j < nodes.size(); ++j) {
      found.corners[j] = cornerOf(nodes[j]);
      any = any || (found.corners[j] & HangingCells::kHangs) != 0;
    }
    if (!any) return;
    const auto shape = shapeOfRows(geometry.gradients, geometry.modes);
    if (!shape) return;
    found.shape = *shape;
    out_.points.push_back(found);
  }

 private:
  Index cornerOf(Index node) {
    Index only = 0;
    std::size_t count = 0;
    corners_.visit(node, [&](Index phyxel, double) {
      only = phyxel;
      ++count;
    });
    if (count == 1) return only;
    const auto [known, fresh] = rows_.emplace(node, static_cast<Index>(out_.phyxels.rows()));
    if (fresh) {
      corners_.visit(node, [&](Index phyxel, double weight) {
        out_.phyxels.indices.push_back(phyxel);
        out_.weights.push_back(weight);
      });
      out_.phyxels.offsets.push_back(static_cast<Index>(out_.phyxels.indices.size()));
    }
    return HangingCells::kHangs | known->second;
  }

  const NodeTable &corners_;
  HangingCells &out_;
  std::unordered_map<Index, Index> rows_;  // by node
};

// Contents of the free part of every cell, by material.
using MaterialContents = std::vector<std::vector<MaterialContent>>;

MaterialContents findMaterials(const BodyShape &shape, const LatticeSampling &sampling, const LatticeCellMap &map,
                               std::span<const PartContent> contents, const ParallelFor &parallelFor) {
  const MaterialFinder finder(shape, sampling, map.set());
  MaterialContents out(contents.size());
  for (std::size_t p = 0; p < contents.size(); ++p) {
    if (p % detail::kPollInterval == 0) detail::checkCancelled(parallelFor);
    const CutCellFragment &part = map.parts()[p];
    if (!part.kept || !contents[p].isFree()) continue;
    // A cell whose corners have been moved has a single material, the dominant one: its shape is known from the corners
    // only.
    std::vector<MaterialContent> materials{{0, contents[p].free}};
    if (!sampling.materials.empty()) materials = finder.contentsIn(part, contents[p].free);
    if (map.distorted(part.cell))
      materials = {*std::max_element(materials.begin(), materials.end(),
                                     [](const auto &a, const auto &b) { return a.moments.share < b.moments.share; })};
    out[p] = std::move(materials);
  }
  return out;
}

// Edges of cells that the surface or a held region cuts. Cells of several materials keep trilinear functions, as layers
// (laminate.h), and so do cells next to larger ones.
QuadraticEdges edgesOf(const LatticeCellMap &map, std::span<const PartContent> contents,
                       const MaterialContents &materials) {
  constexpr double kWhole = 0.999;
  std::vector<std::uint8_t> taking(contents.size(), 0), cut(contents.size(), 0), excluded(contents.size(), 0);
  std::vector<double> volumes(map.corners().positions.size(), 0.0);
  for (std::size_t p = 0; p < contents.size(); ++p) {
    if (materials[p].empty()) continue;
    taking[p] = 1;
    cut[p] = contents[p].free.share < kWhole ? 1 : 0;
    bool isAside = materials[p].size() > 1;
    const std::array<double, 8> functions = contents[p].free.functions();
    for (std::size_t j = 0; j < 8; ++j) {
      std::size_t phyxels = 0;
      map.corners().visit(map.parts()[p].nodes[j], [&](Index phyxel, double weight) {
        volumes[phyxel] += weight * contents[p].free.share * functions[j];
        ++phyxels;
      });
      isAside = isAside || phyxels != 1;
    }
    excluded[p] = isAside ? 1 : 0;
  }
  return findQuadraticEdges(map.set(), map.parts(), map.corners(), taking, cut, excluded, volumes);
}

// Adds the functions of edges to the row of a point over the corners of its cell.
void addQuadraticPoint(const LatticeCellMap &map, Index p, const Moments &moments, Row &row, StencilSet &stencils) {
  if (!map.edges().any()) return;
  const auto &ofPart = map.edges().ofParts[p];
  if (std::all_of(ofPart.begin(), ofPart.end(), [](Index edge) { return edge == kNone; })) {
    stencils.quadratic.of.push_back(QuadraticPoints::kNone);
    return;
  }
  const double edge = map.set().edge(map.set().cells[map.parts()[p].cell]);
  const Mat3 &axes = map.set().frame.axes;
  const EdgeMeans means = edgeMeansOf(moments);
  QuadraticPoints &quadratic = stencils.quadratic;
  QuadraticPoints::Point point;
  std::array<Vec3, 8> gradients;
  std::array<Eigen::Vector4d, 8> modes;
  for (std::size_t j = 0; j < 8; ++j) {
    gradients[j] = axes.transpose() * row.gradients[j];
    modes[j] = row.modes[j];
    // Second derivatives in place of the modes of a cut cell.
    row.modes[j].head<3>() = means.ofCorners[j] / (edge * edge);
  }
  point.corners = shapeOfRows(gradients, modes).value();
  point.edges = ofPart;
  point.second = moments.second / moments.share;
  point.cubic = moments.cubic / moments.share;
  point.triple = moments.triple / moments.share;
  const Vec3 mixed = moments.mixed / moments.share, centroid = moments.centroid();
  point.covariance << point.second[0], mixed[0], mixed[1], mixed[0], point.second[1], mixed[2], mixed[1], mixed[2],
      point.second[2];
  point.covariance -= centroid * centroid.transpose();
  point.covariance *= edge * edge;
  point.first = static_cast<Index>(quadratic.bends.size());
  map.edges().forPart(p, [&](std::size_t e, Index function) {
    const SecondDerivatives &H = means.second[e];
    const Vec3 bends = Vec3(H[0], H[1], H[2]) / (edge * edge), mixedOnes = Vec3(H[3], H[4], H[5]) / (edge * edge);
    row.add(map.edges(), function, 0.0, axes * means.functions.gradients[e] / edge,
            {mixedOnes[0], mixedOnes[1], mixedOnes[2], 0.0}, bends);
  });
  quadratic.bends.insert(quadratic.bends.end(), row.bends.begin(), row.bends.end());
  quadratic.of.push_back(static_cast<Index>(quadratic.points.size()));
  quadratic.points.push_back(point);
}

void buildPoints(const LatticeSampling &sampling, const LatticeCellMap &map, const MaterialContents &contents,
                 LatticeBody &body, const ParallelFor &parallelFor) {
  StencilSet &stencils = body.stencils;
  const Mat3 &axes = map.set().frame.axes;
  stencils.axes = axes;
  stencils.quadratic.edgePhyxels = map.edges().phyxels;
  stencils.quadratic.edgeWeights = map.edges().weights;
  HangingCellFinder hanging(map.corners(), stencils.hanging);
  Row row;
  for (std::size_t p = 0; p < contents.size(); ++p) {
    if (p % detail::kPollInterval == 0) detail::checkCancelled(parallelFor);
    const CutCellFragment &part = map.parts()[p];
    for (const auto &[material, moments] : contents[p]) {
      const PointGeometry point = pointOf(map, static_cast<Index>(p), moments);
      hanging.add(part.nodes, point, stencils.pointCount());
      row.clear();
      for (std::size_t j = 0; j < 8; ++j)
        row.add(map.corners(), part.nodes[j], 0.0, axes * point.gradients[j], point.modes[j]);
      addQuadraticPoint(map, static_cast<Index>(p), moments, row, stencils);
      stencils.phyxels.indices.insert(stencils.phyxels.indices.end(), row.phyxels.begin(), row.phyxels.end());
      stencils.gradients.insert(stencils.gradients.end(), row.gradients.begin(), row.gradients.end());
      stencils.modes.insert(stencils.modes.end(), row.modes.begin(), row.modes.end());
      stencils.phyxels.offsets.push_back(static_cast<Index>(stencils.phyxels.indices.size()));
      stencils.variances.push_back(point.variance);
      stencils.volumes.push_back(point.volume);
      if (!sampling.materials.empty()) stencils.materials.push_back(material);
      body.pointCentres.push_back(axes * point.centre);
    }
  }
  stencils.phyxels.indices.shrink_to_fit();
  stencils.phyxels.offsets.shrink_to_fit();
  stencils.gradients.shrink_to_fit();
  stencils.modes.shrink_to_fit();
  stencils.variances.shrink_to_fit();
  stencils.volumes.shrink_to_fit();
  body.pointCentres.shrink_to_fit();
  stencils.rank.assign(stencils.volumes.size(), 3);
  stencils.frameOf.assign(stencils.volumes.size(), StencilSet::kNoFrame);
  buildGather(stencils, body.positions.size());
}

// Regions that refine nothing indicate a wrong position or unit.
Result<void> checkRefinements(const BodyShape &shape, const LatticeSampling &sampling, const LatticeCellMap &map) {
  const CellSet &set = map.set();
  for (std::size_t i = 0; i < sampling.refinements.size(); ++i) {
    const Region local = shifted(sampling.refinements[i].region, set.frame.origin);
    const auto meets = [&](const CutCellFragment &part) {
      const Cell &cell = set.cells[part.cell];
      return part.kept &&
             signedDistance(local, set.frame.axes * set.centre(cell)) <= 0.5 * std::sqrt(3.0) * set.edge(cell);
    };
    if (std::any_of(map.parts().begin(), map.parts().end(), meets)) continue;
    const auto point = [](const Vec3 &x) {
      return "(" + number(x[0], 4) + ", " + number(x[1], 4) + ", " + number(x[2], 4) + ")";
    };
    return refuse("refinement " + std::to_string(i) + ": its region meets no part of the body, which spans " +
                  point(shape.min) + " … " + point(shape.max) + " m; accepted: regions that hold some of it");
  }
  return {};
}

// Regions that assign no material indicate a wrong position or unit; voxels are present, however little they contain.
Result<void> checkMaterials(const LatticeSampling &sampling, const StencilSet &stencils) {
  for (std::size_t i = 0; i < sampling.materials.size(); ++i) {
    const auto &[region, material] = sampling.materials[i];
    if (std::holds_alternative<VoxelRegion>(region) ||
        std::find(stencils.materials.begin(), stencils.materials.end(), material) != stencils.materials.end())
      continue;
    return refuse("material region " + std::to_string(i) +
                  " holds no part of the body that can deform: it misses the body, or is smaller than a fiftieth of a "
                  "cell");
  }
  return {};
}

}  // namespace

Result<LatticeBody> fillLattice(const BodyShape &shape, const LatticeSampling &wanted, const ParallelFor &parallelFor,
                                const SamplingProgress &progress) {
  if (const auto valid = validate(shape, wanted); !valid) return refuse(valid.error());
  LatticeSampling sampling = wanted;
  if (!sampling.axes) sampling.axes = latticeDirection(shape, sampling.held);
  const auto stage = [&](double fraction) { return !progress || progress(0.85 * fraction); };
  auto cut = sampling.spacing > 0.0 ? cutCells(shape, sampling, sampling.spacing, parallelFor, stage)
                                    : cutForCount(shape, sampling, parallelFor, stage);
  if (!cut) return refuse(cut.error());

  const auto map =
      std::make_shared<LatticeCellMap>(std::move(cut->set), std::move(cut->parts), std::move(cut->corners));
  if (const auto met = checkRefinements(shape, sampling, *map); !met) return refuse(met.error());
  std::vector<PartContent> contents = measureParts(*map, parallelFor);
  if (progress && !progress(0.88)) return refuse("cancelled");
  const HeldPatches patches = findHeld(shape, sampling, *map, contents, parallelFor);
  if (sampling.jitter > 0.0) jitterPhyxels(*map, contents, sampling.jitter, sampling.seed);
  if (progress && !progress(0.92)) return refuse("cancelled");

  LatticeBody body;
  const Frame &frame = map->set().frame;
  body.origin = frame.origin;
  body.spacing = frame.spacing;
  body.corner = frame.axes * frame.low;
  body.components = map->components();
  body.positions.reserve(map->corners().positions.size());
  for (const Vec3 &local : map->corners().positions) body.positions.push_back(frame.axes * local);
  const MaterialContents materials = findMaterials(shape, sampling, *map, contents, parallelFor);
  if (sampling.order == LatticeOrder::quadratic) map->setEdges(edgesOf(*map, contents, materials));
  PhyxelVolumes shared = shareVolumes(*map, contents, parallelFor);
  addEdgeWeights(*map, contents, shared);
  body.volumes = std::move(shared.inertial);
  body.weightVolumes = std::move(shared.weights);
  body.heldVolumes = std::move(shared.held);
  body.supportVolumes = std::move(shared.carried);
  buildPoints(sampling, *map, materials, body, parallelFor);

  // The counted volume is scaled to the volume of the body.
  double counted = 0.0;
  for (const double v : body.volumes) counted += v;
  body.countedVolume = counted;
  const double scale = shape.volume / counted;
  for (auto *volumes : {&body.volumes, &body.weightVolumes, &body.heldVolumes, &body.supportVolumes})
    for (double &v : *volumes) v *= scale;
  for (double &v : body.stencils.volumes) v *= scale;

  if (const auto good = checkMaterials(sampling, body.stencils); !good) return refuse(good.error());
  auto held = holdLattice(shape, sampling, *map, patches, contents, scale, parallelFor);
  if (!held) return refuse(held.error());
  body.held = std::move(*held);
  map->release();
  body.cells = map;
  if (progress && !progress(1.0)) return refuse("cancelled");
  return body;
}

}  // namespace pointbased
