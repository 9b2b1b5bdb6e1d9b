// SPDX-License-Identifier: Apache-2.0
#include "instruments/grab_patch.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "pointbased/types.h"

namespace pointbased {
namespace {

constexpr double kMinRadius = 2.0;  // spacings: a patch of a few phyxels at any sampling
// The pull is limited to this multiple of E r². It strains the held patch by several hundred per cent at most, however
// far the target is moved away.
constexpr double kMaxPull = 4.0;
constexpr double kNeighbourhood = 1.8;  // spacings, around the nearest phyxel: the corners of the neighbouring cells

// Spacings: merging voxels leaves positions at borders that belong to no tissue.
constexpr double kTissueTolerance = 0.1;

Vec3 positionOf(const Body &body, Index i) {
  return body.rest().origin + body.rest().positions[i] + body.state().displacements[i];
}

Grab withSpring(Grab grab, double radius, const PinchSettings &settings, double youngsModulus) {
  grab.frequency = 2.0 * EIGEN_PI * settings.frequency_hz;
  grab.dampingRatio = settings.dampingRatio;
  grab.maxForce = kMaxPull * youngsModulus * radius * radius;
  if (settings.largestForce > 0.0) grab.maxForce = std::min(grab.maxForce, settings.largestForce);
  return grab;
}

double radiusOf(const RestState &rest, const PinchSettings &settings) {
  return std::max(1e-3 * settings.radius_mm, kMinRadius * rest.spacing);
}

// A support holds the continuum of a lattice, but the phyxels of a cloud.
bool isHeldByFix(const RestState &rest, const Vec3 &at, std::size_t nearest) {
  Vec3 X = rest.origin + at;  // in the first reference
  if (!rest.referenceShift.empty()) X -= rest.referenceShift[nearest];
  if (std::any_of(rest.conditions.fixes.begin(), rest.conditions.fixes.end(),
                  [&](const Fix &fix) { return contains(fix.region, X); }))
    return true;
  return !rest.stencils.isLattice() &&
         std::any_of(rest.conditions.held.begin(), rest.conditions.held.end(), [&](const ConstrainedRegion &part) {
           return std::binary_search(part.phyxels.begin(), part.phyxels.end(), static_cast<Index>(nearest));
         });
}

}  // namespace

Grab patchAround(const RestState &rest, const Vec3 &at, double radius) {
  Grab grab;
  double sum = 0.0;
  const std::vector<double> &shares = rest.weightVolumes.empty() ? rest.volumes : rest.weightVolumes;
  std::vector<std::uint8_t> held(rest.phyxelCount(), 0);
  for (const ConstrainedRegion &part : rest.conditions.held)
    for (const Index i : part.phyxels) held[i] = 1;
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i) {
    if (held[i]) continue;
    // Weighted by its share of a load on material that no support holds.
    const double share = shares[i] - (rest.heldVolumes.empty() ? 0.0 : rest.heldVolumes[i]);
    const double weight = share * kernelWeight((rest.positions[i] - at).norm(), radius);
    if (weight <= 0.0) continue;
    grab.phyxels.push_back(static_cast<Index>(i));
    grab.weights.push_back(weight);
    sum += weight;
  }
  for (double &w : grab.weights) w /= sum;
  return grab;
}

Grab patchAround(const RestState &rest, const Vec3 &at, double radius, std::size_t surfel) {
  Grab grab = patchAround(rest, at, radius);
  if (!grab.phyxels.empty()) return grab;
  const Interpolation binding = rest.surfels.expanded(surfel, rest.positions);
  grab.phyxels = binding.phyxels.indices;
  grab.weights = binding.weights;
  return grab;
}

Grab grabAround(const RestState &rest, std::size_t surfel, const PinchSettings &settings, double youngsModulus) {
  const double radius = radiusOf(rest, settings);
  return withSpring(patchAround(rest, rest.surfels.position(surfel, rest.positions), radius, surfel), radius, settings,
                    youngsModulus);
}

Grab grabAt(const RestState &rest, const Vec3 &at, const PinchSettings &settings, double youngsModulus) {
  const double radius = radiusOf(rest, settings);
  return withSpring(patchAround(rest, at, radius), radius, settings, youngsModulus);
}

void limitToTissue(Grab &grab, const Body &body, double ownLimit) {
  if (body.constitution().materials.size() > 1) {
    Interpolation each;
    each.positions.resize(grab.phyxels.size());
    each.weights.assign(grab.phyxels.size(), 1.0);
    each.phyxels.indices = grab.phyxels;
    for (std::size_t k = 1; k <= grab.phyxels.size(); ++k) each.phyxels.offsets.push_back(static_cast<Index>(k));
    const std::vector<double> moduli = body.moduliAt(each);
    double softness = 0.0, weight = 0.0;
    for (std::size_t k = 0; k < moduli.size(); ++k) {
      softness += grab.weights[k] / moduli[k];
      weight += grab.weights[k];
    }
    if (softness > 0.0) grab.maxForce *= weight / softness / body.material().youngsModulus;
  }
  if (ownLimit > 0.0) grab.maxForce = std::min(grab.maxForce, ownLimit);
}

std::optional<MaterialPoint> materialAt(const RestState &rest, std::span<const Vec3> phyxels, const Vec3 &position) {
  if (phyxels.empty() || phyxels.size() != rest.phyxelCount()) return std::nullopt;
  const auto nearest =
      static_cast<std::size_t>(std::min_element(phyxels.begin(), phyxels.end(),
                                                [&](const Vec3 &a, const Vec3 &b) {
                                                  return (a - position).squaredNorm() < (b - position).squaredNorm();
                                                }) -
                               phyxels.begin());
  // X - X0 = A (x - x0), least squares over the neighbours in the reference: in a fold, other phyxels may be near now.
  const Vec3 &X0 = rest.positions[nearest], &x0 = phyxels[nearest];
  const double reach = kNeighbourhood * rest.spacing;
  Mat3 normalMatrix = 1e-6 * rest.spacing * rest.spacing * Mat3::Identity(), crossMatrix = normalMatrix;
  for (std::size_t i = 0; i < phyxels.size(); ++i) {
    const Vec3 X = rest.positions[i] - X0;
    if (X.squaredNorm() > reach * reach) continue;
    const Vec3 x = phyxels[i] - x0;
    normalMatrix += x * x.transpose();
    crossMatrix += X * x.transpose();
  }
  const Mat3 A = normalMatrix.ldlt().solve(crossMatrix.transpose()).transpose();
  const Vec3 offset = A * (position - x0);
  // Where the phyxels are crushed, A is unreliable, so the distance is limited.
  const double scale = reach / std::max(offset.norm(), reach);
  const Vec3 at = X0 + scale * offset;
  return MaterialPoint{at, isHeldByFix(rest, at, nearest)};
}

std::uint16_t materialNumberAt(const RestState &rest, const Vec3 &at) {
  std::uint16_t number = 0;
  double nearest = kTissueTolerance * rest.spacing;
  for (const auto &[region, material] : rest.sampling.materials) {
    const double offset = std::max(0.0, signedDistance(region, rest.origin + at));
    if (offset > nearest) continue;  // of several regions that contain it, the last one applies
    nearest = offset;
    number = material;
  }
  return number;
}

Vec3 meanPosition(const Grab &grab, const Body &body) {
  Vec3 middle = Vec3::Zero();
  for (std::size_t k = 0; k < grab.phyxels.size(); ++k) middle += grab.weights[k] * positionOf(body, grab.phyxels[k]);
  return middle;
}

Vec3 addShapeSprings(Grab &grab, const Body &body) {
  grab.target = meanPosition(grab, body);
  grab.arms.clear();
  for (const Index i : grab.phyxels) grab.arms.push_back(positionOf(body, i) - grab.target);
  return grab.target;
}

}  // namespace pointbased
