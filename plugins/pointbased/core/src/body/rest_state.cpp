// SPDX-License-Identifier: Apache-2.0
#include "pointbased/rest_state.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/cancellation_poll.h"
#include "base/disjoint_sets.h"
#include "body/rest_parts.h"
#include "skin/skin_tears.h"

namespace pointbased {
namespace {

// Calls visit(row) for every phyxel with those that share a stencil with it, ascending.
template <class Visit>
void forNeighbours(const StencilSet &stencils, std::size_t phyxels, const Visit &visit,
                   const ParallelFor &parallelFor = serialFor()) {
  std::vector<Index> row;
  detail::CancellationPoll look(parallelFor);
  for (std::size_t i = 0; i < phyxels; ++i) {
    look();
    row.clear();
    for (Index k = stencils.entriesOfPhyxel.offsets[i]; k < stencils.entriesOfPhyxel.offsets[i + 1]; ++k) {
      const Index q = stencils.pointOfEntry(stencils.entriesOfPhyxel.indices[k]);
      for (Index e = stencils.phyxels.offsets[q]; e < stencils.phyxels.offsets[q + 1]; ++e)
        if (stencils.phyxels.indices[e] != i) row.push_back(stencils.phyxels.indices[e]);
    }
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    visit(row);
  }
}

class NeighbourCounter {
 public:
  void add(std::size_t count) {
    counted_.min = rows_ == 0 ? count : std::min(counted_.min, count);
    counted_.max = std::max(counted_.max, count);
    sum_ += count;
    ++rows_;
  }
  [[nodiscard]] Neighbours counted() const {
    Neighbours out = counted_;
    if (rows_ > 0) out.mean = static_cast<double>(sum_) / static_cast<double>(rows_);
    return out;
  }

 private:
  Neighbours counted_;
  std::size_t rows_ = 0, sum_ = 0;
};

}  // namespace

std::size_t detail::countComponents(const Csr &neighbors) {
  std::vector<std::uint8_t> seen(neighbors.rows(), 0);
  std::vector<Index> open;
  std::size_t components = 0;
  for (Index start = 0; start < neighbors.rows(); ++start) {
    if (seen[start]) continue;
    ++components;
    seen[start] = 1;
    open.push_back(start);
    while (!open.empty()) {
      const Index i = open.back();
      open.pop_back();
      for (Index k = neighbors.offsets[i]; k < neighbors.offsets[i + 1]; ++k) {
        const Index j = neighbors.indices[k];
        if (!seen[j]) {
          seen[j] = 1;
          open.push_back(j);
        }
      }
    }
  }
  return components;
}

namespace {

// Removes pairs whose connecting segment leaves the body: two lobes with a gap between them remain separate.
void dropInvisiblePairs(const BodyShape &shape, std::span<const Vec3> world, Csr &neighbors,
                        const ParallelFor &parallelFor) {
  if (!shape.crosses) return;
  std::vector<Vec3> from, to;
  std::vector<std::uint8_t> crosses;
  for (Index i = 0; i < neighbors.rows(); ++i)
    for (Index k = neighbors.offsets[i]; k < neighbors.offsets[i + 1]; ++k)
      if (neighbors.indices[k] > i) {
        from.push_back(world[i]);
        to.push_back(world[neighbors.indices[k]]);
      }
  crosses.resize(from.size());
  parallelFor(from.size(), 64, [&](std::size_t begin, std::size_t end) {
    shape.crosses(std::span<const Vec3>(from).subspan(begin, end - begin),
                  std::span<const Vec3>(to).subspan(begin, end - begin),
                  std::span<std::uint8_t>(crosses).subspan(begin, end - begin));
  });
  std::vector<std::vector<Index>> kept(neighbors.rows());
  detail::CancellationPoll look(parallelFor);
  std::size_t pair = 0;
  for (Index i = 0; i < neighbors.rows(); ++i) {
    look();
    // Smaller indices have been added already, ascending.
    for (const Index j : neighbors.row(i))
      if (j > i && !crosses[pair++]) {
        kept[i].push_back(j);
        kept[j].push_back(i);
      }
  }
  Csr out;
  for (const std::vector<Index> &row : kept) {
    out.indices.insert(out.indices.end(), row.begin(), row.end());
    out.offsets.push_back(static_cast<Index>(out.indices.size()));
  }
  neighbors = std::move(out);
}

Surface shiftedSurface(const Surface &surface, const Vec3 &origin) {
  Surface out = surface;
  for (Vec3 &x : out.positions) x -= origin;
  return out;
}

}  // namespace

void detail::bindSkinToCloud(RestState &rest, const Surface &local, std::span<const Vec3> normals,
                             const ParallelFor &parallelFor) {
  rest.bind = [positions = rest.positions, parallelFor](std::span<const Vec3> points, std::span<const Vec3>) {
    return bindToCloud(points, positions, parallelFor);
  };
  rest.surfels = Surfels(rest.bind(local.positions, normals));
  rest.surfelNormals.assign(normals.begin(), normals.end());
  rest.skin = local.triangles;
  if (local.triangles.empty()) return;
  SurfacePoints chosen = chooseContactPoints(local, rest.spacing);
  Interpolation binding = rest.bind(chosen.positions, chosen.normals);
  rest.contact = bindContactPoints(std::move(chosen), std::move(binding), rest.positions, rest.spacing);
}

namespace {

// Skin, contact and binder of a cloud; `rest` must already contain positions.
void bindCloud(RestState &rest, const PhyxelCloud &cloud, const Surface &local, std::span<const Vec3> normals,
               const ParallelFor &parallelFor) {
  detail::bindSkinToCloud(rest, local, normals, parallelFor);
  if (!local.triangles.empty()) return;
  // Without a surface, phyxels collide as balls.
  const std::size_t n = rest.positions.size();
  rest.contact.binding.positions = rest.positions;
  for (std::size_t i = 0; i < n; ++i) {
    rest.contact.binding.phyxels.indices.push_back(static_cast<Index>(i));
    rest.contact.binding.phyxels.offsets.push_back(static_cast<Index>(i + 1));
    const double radius = i < cloud.contactRadii.size() ? cloud.contactRadii[i] : 0.5 * rest.spacing;
    rest.contact.areas.push_back(radius * radius);
    rest.contact.radii.push_back(radius);
  }
  rest.contact.binding.weights.assign(n, 1.0);
  rest.contact.binding.gradients.assign(n, Vec3::Zero());
  rest.contact.normals.assign(n, Vec3::UnitZ());
}

std::shared_ptr<RestState> restOfCloud(const PhyxelCloud &cloud, const NeighborChoice &choice, double shapeVolume,
                                       const Surface &surface, std::span<const Vec3> normals, const BodyShape *shape,
                                       const ParallelFor &parallelFor) {
  auto rest = std::make_shared<RestState>();
  rest->evaluation = Evaluation::phyxels;
  rest->spacing = cloud.spacing;
  rest->shapeVolume = shapeVolume;
  rest->countedVolume = cloud.countedVolume;
  rest->volumes = cloud.volumes;
  rest->neighborChoice = choice;
  if (!cloud.positions.empty()) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3 &x : cloud.positions) sum += x - cloud.positions[0];
    rest->origin = cloud.positions[0] + sum / static_cast<double>(cloud.positions.size());
  }
  rest->positions.reserve(cloud.positions.size());
  for (const Vec3 &x : cloud.positions) rest->positions.push_back(x - rest->origin);
  Neighborhoods found = findNeighborhoods(rest->positions, choice, cloud.spacing, parallelFor);
  if (shape) dropInvisiblePairs(*shape, cloud.positions, found.neighbors, parallelFor);
  rest->stencils =
      buildPhyxelStencils(rest->positions, found.neighbors, found.supportRadii, rest->volumes, parallelFor);
  rest->neighbors = std::move(found.neighbors);
  rest->pointCentres = rest->positions;
  rest->components = detail::countComponents(rest->neighbors);
  bindCloud(*rest, cloud, shiftedSurface(surface, rest->origin), normals, parallelFor);
  return rest;
}

// Connected piece of each vertex of the skin, identified by its first phyxel.
std::vector<Index> piecesOf(const RestState &rest) {
  const Csr &rows = rest.stencils.phyxels;
  DisjointSets sets(rest.phyxelCount());
  for (std::size_t q = 0; q < rows.rows(); ++q)
    for (Index e = rows.offsets[q]; e < rows.offsets[q + 1]; ++e)
      (void)sets.join(rows.indices[rows.offsets[q]], rows.indices[e]);
  std::vector<Index> pieces;
  for (const CellPoint &place : rest.surfels.cellPoints()) {
    const Interpolation &own = rest.surfels.rows();
    pieces.push_back(sets.find(place.frame == Surfels::kRow ? own.phyxels.indices[own.phyxels.offsets[place.phyxels[0]]]
                                                            : place.phyxels[0]));
  }
  return pieces;
}

tl::unexpected<std::string> refused(const std::string &text) { return tl::unexpected<std::string>(text); }

std::string numbered(const char *what, std::size_t number, const std::string &text) {
  return std::string(what) + " " + std::to_string(number) + ": " + text;
}

// Reports regions that are far off (a wrong unit) before minutes of building.
Result<void> checkRegions(const BodyShape &shape, const BodyRecipe &recipe) {
  const double reach = 1.5 * (shape.max - shape.min).norm();
  const auto check = [&](const char *what, std::size_t number, const Region &region) -> Result<void> {
    if (const auto good = validate(region); !good) return refused(numbered(what, number, good.error()));
    if (signedDistance(region, 0.5 * (shape.min + shape.max)) <= reach) return {};
    return refused(numbered(what, number, "the region meets no part of the body; move or enlarge it until it does"));
  };
  for (std::size_t i = 0; i < recipe.fixes.size(); ++i)
    if (auto good = check("fix", i, recipe.fixes[i].region); !good) return good;
  for (std::size_t i = 0; i < recipe.loads.size(); ++i)
    if (auto good = check("load", i, recipe.loads[i].region); !good) return good;
  return {};
}

// Binds surfels and contact points to the cells.
void bindSkin(const BodyShape &shape, const LatticeSampling &sampling, std::span<const Vec3> surfelNormals,
              RestState &rest) {
  const Surface local = shiftedSurface(shape.surface, rest.origin);
  Interpolation skin = rest.bind(local.positions, surfelNormals);
  (void)detail::closeTears(local, rest.spacing, skin);
  rest.surfels = Surfels(skin);
  rest.surfelNormals.assign(surfelNormals.begin(), surfelNormals.end());
  rest.skin = local.triangles;
  if (local.triangles.empty()) return;
  // As fine as the finest cells that were requested: these are meant for contact, cells refined for their error are
  // not.
  LatticeSampling touched = sampling;
  touched.finer = {};
  const double finest = finestSpacing(touched, rest.spacing);
  SurfacePoints chosen =
      rest.components > 1 ? chooseContactPoints(local, finest, piecesOf(rest)) : chooseContactPoints(local, finest);
  Interpolation binding = rest.bind(chosen.positions, chosen.normals);
  rest.contact = bindContactPoints(std::move(chosen), std::move(binding), rest.positions, rest.spacing);
}

// @param held  out: regions held by the fixes
Result<std::shared_ptr<RestState>> restOfLattice(const BodyShape &shape, const BodyRecipe &recipe,
                                                 std::span<const Vec3> surfelNormals, const ParallelFor &parallelFor,
                                                 const SamplingProgress &progress,
                                                 std::vector<ConstrainedRegion> &held) {
  LatticeSampling sampling = recipe.sampling;
  sampling.held.clear();
  for (const Fix &fix : recipe.fixes) sampling.held.push_back(fix.region);
  auto filled = fillLattice(shape, sampling, parallelFor, progress);
  if (!filled) return refused(filled.error());
  LatticeBody &body = *filled;
  auto rest = std::make_shared<RestState>();
  rest->evaluation = Evaluation::stressPoints;
  rest->origin = body.origin;
  rest->spacing = body.spacing;
  rest->latticeCorner = body.corner;
  rest->sampling = recipe.sampling;
  rest->reshape = recipe.reshape;
  rest->shapeVolume = shape.volume;
  rest->countedVolume = body.countedVolume;
  rest->positions = std::move(body.positions);
  rest->volumes = std::move(body.volumes);
  rest->weightVolumes = std::move(body.weightVolumes);
  rest->heldVolumes = std::move(body.heldVolumes);
  rest->supportVolumes = std::move(body.supportVolumes);
  rest->stencils = std::move(body.stencils);
  rest->pointCentres = std::move(body.pointCentres);
  rest->components = body.components;
  NeighbourCounter counter;
  forNeighbours(
      rest->stencils, rest->positions.size(), [&](std::span<const Index> row) { counter.add(row.size()); },
      parallelFor);
  rest->latticeNeighbours = counter.counted();
  compactRows(rest->stencils);
  detail::checkCancelled(parallelFor);
  held = std::move(body.held);
  rest->bind = [cells = body.cells, parallelFor](std::span<const Vec3> points, std::span<const Vec3> normals) {
    return cells->bind(points, normals, parallelFor);
  };
  bindSkin(shape, sampling, surfelNormals, *rest);
  rest->maxInfluence = maxInfluencesOf(*rest);
  return rest;
}

// @param held  out: regions held by the fixes
Result<std::shared_ptr<RestState>> restOfFilledCloud(const BodyShape &shape, const BodyRecipe &recipe,
                                                     std::span<const Vec3> surfelNormals,
                                                     const ParallelFor &parallelFor, const SamplingProgress &progress,
                                                     std::vector<ConstrainedRegion> &held) {
  const auto cloud = fill(shape, {recipe.sampling.spacing, recipe.sampling.count}, parallelFor, progress);
  if (!cloud) return refused(cloud.error());
  const std::shared_ptr<RestState> rest =
      restOfCloud(*cloud, recipe.neighbors, shape.volume, shape.surface, surfelNormals, &shape, parallelFor);
  if (!recipe.sampling.materials.empty()) {
    rest->stencils.materials.assign(rest->pointCount(), 0);
    for (const auto &[region, material] : recipe.sampling.materials) {
      const Region here = shifted(region, rest->origin);
      for (std::size_t q = 0; q < rest->pointCount(); ++q)
        if (contains(here, rest->pointCentres[q])) rest->stencils.materials[q] = material;
    }
  }
  const Surface local = shiftedSurface(shape.surface, rest->origin);
  for (std::size_t i = 0; i < recipe.fixes.size(); ++i) {
    auto part = holdCloud(shifted(recipe.fixes[i].region, rest->origin), rest->positions, rest->volumes, rest->spacing,
                          local, parallelFor);
    if (!part) return refused(numbered("fix", i, part.error()));
    held.push_back(std::move(*part));
  }
  return rest;
}

}  // namespace

std::shared_ptr<const RestState> buildRestState(const PhyxelCloud &cloud, const NeighborChoice &choice,
                                                double shapeVolume, const Surface &surface,
                                                std::span<const Vec3> surfelNormals, const ParallelFor &parallelFor) {
  return restOfCloud(cloud, choice, shapeVolume, surface, surfelNormals, nullptr, parallelFor);
}

Result<std::shared_ptr<const RestState>> buildRestState(const BodyShape &shape, const BodyRecipe &recipe,
                                                        std::span<const Vec3> surfelNormals,
                                                        const ParallelFor &parallelFor,
                                                        const SamplingProgress &progress) {
  if (const auto good = checkRegions(shape, recipe); !good) return refused(good.error());
  const bool isLattice = recipe.evaluation == Evaluation::stressPoints;
  const SamplingProgress filling = [&progress, share = isLattice ? 0.85 : 0.7](double f) {
    return !progress || progress(share * f);
  };
  BoundaryConditions conditions{recipe.fixes, {}, recipe.loads, {}};
  const auto build = isLattice ? restOfLattice : restOfFilledCloud;
  auto built = build(shape, recipe, surfelNormals, parallelFor, filling, conditions.held);
  if (!built) return refused(built.error());
  const std::shared_ptr<RestState> rest = std::move(*built);
  if (progress && !progress(0.9)) return refused("cancelled");

  for (std::size_t i = 0; i < recipe.loads.size(); ++i) {
    auto loaded = loadOn(recipe.loads[i], *rest, shape.surface);
    if (!loaded) return refused(numbered("load", i, loaded.error()));
    conditions.loaded.push_back(std::move(*loaded));
  }
  rest->conditions = std::move(conditions);
  if (progress && !progress(1.0)) return refused("cancelled");
  return std::shared_ptr<const RestState>(rest);
}

Result<LoadedPart> loadOn(const Load &load, const RestState &rest, const Surface &surface) {
  if (const auto good = validate(load.region); !good) return refused(good.error());
  Load here = load;
  here.region = shifted(load.region, rest.origin);
  return loadedPart(here, shiftedSurface(surface, rest.origin), rest.spacing, rest.bind, rest.pointCentres,
                    rest.stencils.volumes);
}

std::vector<float> maxInfluencesOf(const RestState &rest) {
  // The magnitude |g| at a corner of a whole cell with edge d is √3/(4 d).
  const double whole = std::sqrt(3.0) / (4.0 * rest.spacing);
  std::vector<double> most(rest.phyxelCount(), 0.0);
  const StencilSet &s = rest.stencils;
  for (std::size_t q = 0; q < s.pointCount(); ++q) {
    const GradientRows gradients(s, q);
    for (Index e = s.phyxels.offsets[q]; e < s.phyxels.offsets[q + 1]; ++e) {
      double &own = most[s.phyxels.indices[e]];
      own = std::max(own, std::min(1.0, gradients[e].norm() / whole));
    }
  }
  const Interpolation &points = rest.contact.binding;
  for (Index p = 0; p < points.count(); ++p)
    for (Index e = points.phyxels.offsets[p]; e < points.phyxels.offsets[p + 1]; ++e) {
      double &own = most[points.phyxels.indices[e]];
      own = std::max(own, std::abs(points.weights[e]));
    }
  std::vector<float> out(most.size());
  std::transform(most.begin(), most.end(), out.begin(), [](double x) {
    // never less than |φ| by rounding
    return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity());
  });
  return out;
}

Csr neighboursOf(const RestState &rest) {
  if (rest.evaluation == Evaluation::phyxels) return rest.neighbors;
  Csr out;
  out.offsets.reserve(rest.phyxelCount() + 1);
  forNeighbours(rest.stencils, rest.phyxelCount(), [&](std::span<const Index> row) {
    out.indices.insert(out.indices.end(), row.begin(), row.end());
    out.offsets.push_back(static_cast<Index>(out.indices.size()));
  });
  return out;
}

Neighbours countNeighbours(const RestState &rest) {
  if (rest.evaluation == Evaluation::stressPoints) return rest.latticeNeighbours;
  NeighbourCounter counter;
  for (std::size_t i = 0; i < rest.neighbors.rows(); ++i)
    counter.add(rest.neighbors.offsets[i + 1] - rest.neighbors.offsets[i]);
  return counter.counted();
}

void phyxelMeans(const RestState &rest, std::span<const Mat3> pointValues, std::span<Mat3> out) {
  if (rest.evaluation == Evaluation::phyxels) {
    std::copy(pointValues.begin(), pointValues.end(), out.begin());
    return;
  }
  const StencilSet &s = rest.stencils;
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i) {
    Mat3 sum = Mat3::Zero();
    double volume = 0.0;
    for (Index k = s.entriesOfPhyxel.offsets[i]; k < s.entriesOfPhyxel.offsets[i + 1]; ++k) {
      const Index entry = s.entriesOfPhyxel.indices[k], q = s.pointOfEntry(entry);
      if (!s.isCorner(entry, q)) continue;
      sum += s.volumes[q] * pointValues[q];
      volume += s.volumes[q];
    }
    out[i] = volume > 0.0 ? Mat3(sum / volume) : Mat3(Mat3::Zero());
  }
}

void phyxelGradients(const RestState &rest, std::span<const Mat3> pointGradients, std::span<Mat3> out) {
  phyxelMeans(rest, pointGradients, out);
  const Csr &entries = rest.stencils.entriesOfPhyxel;
  if (rest.evaluation == Evaluation::phyxels) return;
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i)
    if (entries.offsets[i] == entries.offsets[i + 1]) out[i] = Mat3::Identity();
}

}  // namespace pointbased
