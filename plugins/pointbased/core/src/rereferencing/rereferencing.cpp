// SPDX-License-Identifier: Apache-2.0
#include "rereferencing/rereferencing.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "base/point_tree.h"
#include "base/polar.h"
#include "base/symmetric_eigen.h"
#include "body/rest_parts.h"
#include "discretisation/interpolation_at.h"
#include "forces/point_loops.h"
#include "pointbased/plasticity.h"
#include "rereferencing/rereferencing_parts.h"

namespace pointbased {

using namespace detail;

namespace {

// Least number of neighbours of a phyxel, however far it has been drawn out: about the shell of a dense packing.
constexpr std::size_t kFewest = 12;
constexpr int kRings = 3;

// Norm of the plastic Hencky strain. With det = 1 the trace of C grows with it, so most points need no eigenvalues.
double flowStrain(const Mat3 &plasticInverse) {
  const Mat3 C = plasticInverse * plasticInverse.transpose();
  if (C.trace() < 3.0 + kWornStrain * kWornStrain) return 0.0;
  const Vec3 h = 0.5 * symmetricEigenvalues(C).array().max(1e-300).log().matrix();
  return Vec3(h.array() - h.mean()).norm();
}

// Phyxels within kRings steps between neighbours, ascending.
void around(const Csr &neighbors, Index i, std::vector<Index> &mark, std::vector<Index> &found) {
  found.assign(1, i);
  mark[i] = i;
  std::size_t begin = 0;
  for (int ring = 0; ring < kRings; ++ring) {
    const std::size_t end = found.size();
    for (; begin < end; ++begin)
      for (Index k = neighbors.offsets[found[begin]]; k < neighbors.offsets[found[begin] + 1]; ++k)
        if (const Index j = neighbors.indices[k]; mark[j] != i) {
          mark[j] = i;
          found.push_back(j);
        }
  }
}

/// Phyxels within the support, and at least the kFewest nearest, among those around in the old reference.
Neighborhoods presentNeighborhoods(const RestState &old, std::span<const Vec3> positions,
                                   const ParallelFor &parallelFor) {
  const std::size_t n = positions.size();
  const std::size_t wanted =
      old.neighborChoice.count > 0 ? static_cast<std::size_t>(old.neighborChoice.count) : kFewest;
  const double support = old.neighborChoice.count > 0 ? 0.0 : old.neighborChoice.support * old.spacing;
  Neighborhoods out;
  out.supportRadii.assign(n, support > 0.0 ? support : old.spacing);
  std::vector<std::vector<Index>> chosen(n);
  runLoop(parallelFor, n, kPointGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Index> mark(n, static_cast<Index>(n)), near;
    std::vector<std::pair<double, Index>> sorted;
    for (std::size_t i = begin; i < end; ++i) {
      around(old.neighbors, static_cast<Index>(i), mark, near);
      sorted.clear();
      for (const Index j : near)
        if (j != i) sorted.emplace_back((positions[j] - positions[i]).norm(), j);
      std::sort(sorted.begin(), sorted.end());
      const double nearest = sorted.empty() ? 0.0 : sorted[std::min(wanted, sorted.size()) - 1].first;
      if (kSupportMargin * nearest > support && nearest > 0.0) out.supportRadii[i] = kSupportMargin * nearest;
      const double reach = std::max(nearest * (1.0 + 1e-9), support);
      for (const auto &[distance, j] : sorted)
        if (distance <= reach) chosen[i].push_back(j);
    }
  });
  std::vector<std::vector<Index>> both = chosen;
  for (std::size_t i = 0; i < n; ++i)
    for (const Index j : chosen[i]) both[j].push_back(static_cast<Index>(i));
  for (std::vector<Index> &row : both) {
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    out.neighbors.indices.insert(out.neighbors.indices.end(), row.begin(), row.end());
    out.neighbors.offsets.push_back(static_cast<Index>(out.neighbors.indices.size()));
  }
  return out;
}

/// Transfers the elastic strain of every point into the strain of the new reference.
std::size_t carryStrain(const Body &body, StencilSet &s, PointHistory &history) {
  const std::size_t points = s.pointCount();
  s.reference.resize(points);
  s.referenceInverse.resize(points);
  history = body.state().history;
  history.plasticBefore.resize(points);
  std::size_t relieved = 0;
  for (std::size_t q = 0; q < points; ++q) {
    const auto [R, V, flat] = elasticPolar(body, q);
    relieved += flat ? 1 : 0;
    s.reference[q] = V;
    s.referenceInverse[q] = V.inverse();
    history.plasticBefore[q] = body.state().history.allFlow(q) * R.transpose();
    history.plasticInverse[q] = Mat3::Identity();
    if (!history.prony.empty()) turn(R, history.prony[q]);
    for (Index e = s.phyxels.offsets[q]; e < s.phyxels.offsets[q + 1]; ++e) s.gradients[e] = V * s.gradients[e];
  }
  return relieved;
}

/// Current points of a load; a dead pressure keeps its first area and direction.
LoadedPart presentLoad(const Load &load, const LoadedPart &part, std::span<const Vec3> displacements,
                       const Binder &bind) {
  LoadedPart out = part;
  std::vector<Vec3> positions(part.points.count()), normals;
  for (std::size_t p = 0; p < positions.size(); ++p) {
    const Mat3 F = gradientAt(part.points, p, displacements);
    positions[p] = part.points.positions[p] + displacementAt(part.points, p, displacements, F);
    const Vec3 area = cofactor(F) * part.areaVectors[p];
    if (load.follower) out.areaVectors[p] = area;
    normals.push_back(area.normalized());
  }
  out.points = bind(positions, normals);
  return out;
}

}  // namespace

ElasticPolar detail::elasticPolar(const Body &body, std::size_t q) {
  const Mat3 Fe = body.gradients()[q] * body.state().history.plasticInverse[q];
  ElasticPolar out;
  if (!(Fe.determinant() > kSmallestFlowRatio)) return out;
  out.R = polar(Fe).R;
  const Mat3 left = Fe * out.R.transpose();
  out.V = 0.5 * (left + left.transpose());
  out.flat = false;
  return out;
}

PresentSkin detail::presentSkin(const Body &body, const ParallelFor &parallelFor) {
  const RestState &rest = body.rest();
  PresentSkin out;
  out.surface.positions.resize(rest.surfels.count());
  out.surface.triangles = rest.skin;
  out.normals.resize(rest.surfelNormals.size());
  updateSurfels(rest.surfels, rest.surfelNormals, rest.positions, body.state().displacements, out.surface.positions,
                out.normals, parallelFor);
  return out;
}

bool needsRereferencing(const Body &body) {
  const PointHistory &history = body.state().history;
  const StencilSet &s = body.rest().stencils;
  if (history.plasticInverse.empty()) return false;
  double worn = 0.0, whole = 0.0;
  for (std::size_t q = 0; q < s.pointCount(); ++q) {
    const Material &material = materialOfPoint(body.constitution(), s, q);
    if (material.law == MaterialLaw::linear) return false;
    whole += s.volumes[q];
    const double strain = flowStrain(history.plasticInverse[q]);
    if (strain > 2.0 * kWornStrain) return true;
    if (strain > kWornStrain) worn += s.volumes[q];
  }
  return worn > kWornShare * whole;
}

Result<Rereferencing> rereferenced(const Body &body, const ParallelFor &parallelFor) {
  const auto refuse = [](const char *text) { return tl::unexpected<std::string>(text); };
  const RestState &old = body.rest();
  const State &state = body.state();
  const std::size_t n = old.phyxelCount();
  if (state.history.plasticInverse.empty()) return refuse("it does not flow");
  if (body.foundation().acts()) return refuse("its surroundings hold it where it was in its first shape");
  if (body.attached()) return refuse("it is attached in its first shape");
  if (old.evaluation == Evaluation::stressPoints) return renewedLattice(body, parallelFor);

  auto rest = std::make_shared<RestState>();
  rest->evaluation = old.evaluation;
  rest->origin = old.origin;
  rest->spacing = old.spacing;
  rest->shapeVolume = old.shapeVolume;
  rest->volumes = old.volumes;
  rest->neighborChoice = old.neighborChoice;
  rest->positions = old.positions;
  rest->referenceShift = old.referenceShift;
  rest->referenceShift.resize(n, Vec3::Zero());
  for (std::size_t i = 0; i < n; ++i) {
    if (!state.displacements[i].allFinite()) return refuse("its state is not finite");
    rest->positions[i] += state.displacements[i];
    rest->referenceShift[i] += state.displacements[i];
  }
  Neighborhoods found = presentNeighborhoods(old, rest->positions, parallelFor);
  rest->stencils =
      buildPhyxelStencils(rest->positions, found.neighbors, found.supportRadii, rest->volumes, parallelFor);
  const auto &rank = rest->stencils.rank;
  if (std::any_of(rank.begin(), rank.end(), [](std::uint8_t r) { return r < 3; }))
    return refuse("the neighbours of a phyxel no longer span space");
  rest->neighbors = std::move(found.neighbors);
  rest->pointCentres = rest->positions;
  rest->components = countComponents(rest->neighbors);
  rest->stencils.materials = old.stencils.materials;
  if (const std::size_t kinds = body.constitution().materials.size(); kinds > 1 && !old.stencils.materials.empty()) {
    rest->materialShares = old.materialShares;
    if (rest->materialShares.empty()) {
      const StencilSet &s = old.stencils;
      rest->materialShares.assign(n * kinds, 0.0);
      for (std::size_t i = 0; i < n; ++i) {
        double volume = 0.0;
        for (Index k = s.entriesOfPhyxel.offsets[i]; k < s.entriesOfPhyxel.offsets[i + 1]; ++k) {
          const Index q = s.pointOfEntry(s.entriesOfPhyxel.indices[k]);
          rest->materialShares[i * kinds + s.materials[q]] += s.volumes[q];
          volume += s.volumes[q];
        }
        for (std::size_t m = 0; m < kinds; ++m) rest->materialShares[i * kinds + m] /= volume;
      }
    }
  }

  Rereferencing out;
  out.relieved = carryStrain(body, rest->stencils, out.state.history);
  out.state.displacements.assign(n, Vec3::Zero());
  out.state.velocities = state.velocities;

  const PresentSkin skin = presentSkin(body, parallelFor);
  bindSkinToCloud(*rest, skin.surface, skin.normals, parallelFor);
  if (rest->skin.empty()) {
    rest->contact = old.contact;
    rest->contact.binding.positions = rest->positions;
  }
  rest->conditions = old.conditions;
  for (std::size_t l = 0; l < old.conditions.loads.size(); ++l)
    rest->conditions.loaded[l] =
        presentLoad(old.conditions.loads[l], old.conditions.loaded[l], state.displacements, rest->bind);
  out.rest = std::move(rest);
  return out;
}

}  // namespace pointbased
