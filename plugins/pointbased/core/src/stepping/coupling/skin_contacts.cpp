// SPDX-License-Identifier: Apache-2.0
#include "stepping/coupling/skin_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/polar.h"
#include "shape/occupancy_field.h"

namespace pointbased::detail {
namespace {

// In spacings, of the finer body.
constexpr double kOffset = 0.02;     // distance at which skins begin to resist
constexpr double kThickness = 0.75;  // compressible fraction of the offset
constexpr double kStiffness = 50.0;  // of that layer, relative to E: under the pressure p it yields by p h/(50 E)
constexpr double kMargin = 0.5;      // of the offset: distance within which contacts are active
// 1/s: largest speed, in spacings per second, at which initial overlap is separated, and the pressure that does it, in
// moduli.
constexpr double kRecoverySpeed = 0.5, kRecoveryPressure = 1e-2;
constexpr double kSameTissue = 1.5;    // of one skin: parts that are nearer at rest do not touch
constexpr double kReach = 0.15;        // distance within which features are listed
constexpr double kLongestEdge = 0.75;  // of a skin's triangles
// For inaccurate skins: length of edges, and additional tolerance.
constexpr double kCoarseEdge = 0.5, kMaxDeviation = 0.05;

// m: parts of a skin that may touch each other are at rest farther apart than the search distance by this.
double restClearance(double spacing) { return (kSameTissue - kSelfContactReach) * spacing; }

// Points of lattices have non-negative weights. Others are fitted to the phyxels around them, as are the points that
// contact adds between them, for which twice as much is allowed.
double maxWeightSum(const RestState &rest) {
  if (rest.stencils.isLattice()) return 1.0;
  const Interpolation &rows = rest.surfels.rows();
  double largest = 1.0;
  for (std::size_t p = 0; p < rows.count(); ++p) {
    double sum = 0.0;
    for (Index e = rows.phyxels.offsets[p]; e < rows.phyxels.offsets[p + 1]; ++e) sum += std::abs(rows.weights[e]);
    largest = std::max(largest, sum);
  }
  return 2.0 * largest;
}

// m, tolerance of a skin: none is needed for fitting pieces, which are inaccurate by fractions of a spacing (infinite);
// half a voxel for voxel shapes.
double toleranceOf(const RestState &rest, bool isPiece) {
  if (isPiece) return std::numeric_limits<double>::infinity();
  double voxel = 0.0;
  for (const auto &[region, material] : rest.sampling.materials)
    if (const auto *voxels = std::get_if<VoxelRegion>(&region)) voxel = std::max(voxel, voxels->voxels->voxel());
  return 0.5 * voxel;
}

double areaOf(const RestState &rest) {
  const std::vector<Vec3> x = rest.surfels.expanded(rest.positions).positions;
  double area = 0.0;
  for (const auto &[a, b, c] : rest.skin) area += 0.5 * (x[b] - x[a]).cross(x[c] - x[a]).norm();
  return area;
}

}  // namespace

SkinContacts::Owner SkinContacts::ownerOf(std::size_t id, const Body &body, const ContactPairs &pairs) {
  return {id, body, std::any_of(pairs.begin(), pairs.end(), [id](const auto &pair) {
            return pair.second.fits && (pair.first.first == id || pair.first.second == id);
          })};
}

MovingSkin &SkinContacts::skinOf(const Owner &owner) {
  const auto &[id, body, isPiece] = owner;
  Skin &skin = skins_[id];
  if (skin.of == body.sharedRest() && skin.isPiece == isPiece) {
    if (!skin.moving->hasModuli()) skin.moving->setModuli(body.moduliAt(skin.moving->skin().vertices));
    return *skin.moving;
  }
  remove(id);
  const RestState &rest = body.rest();
  Skin &renewed = skins_[id];
  renewed.of = body.sharedRest();
  renewed.isPiece = isPiece;
  SkinResolution resolution{kLongestEdge * rest.spacing};
  if (const double tolerance = toleranceOf(rest, isPiece); tolerance > 0.0) {
    resolution.edge = kCoarseEdge * rest.spacing;
    resolution.deviation = std::min(tolerance, kMaxDeviation * rest.spacing);
  }
  auto built =
      makeContactSkin(rest.surfels.expanded(rest.positions), rest.skin, resolution, rest.bind, rest.maxInfluence);
  std::vector<double> spacings = spacingsAt(built->vertices, rest.positions, rest.spacing);
  renewed.moving = std::make_unique<MovingSkin>(std::move(built), rest.origin, rest.spacing, std::move(spacings));
  renewed.moving->setModuli(body.moduliAt(renewed.moving->skin().vertices));
  return *renewed.moving;
}

SkinPair &SkinContacts::pairOf(const Owner &first, const Owner &second, double friction, bool fits) {
  MovingSkin &own = skinOf(first), &other = skinOf(second);
  std::unique_ptr<SkinPair> &pair = pairs_[{first.id, second.id}];
  if (!pair) {
    const double spacing = std::min(own.spacing(), other.spacing());
    SkinPairSettings settings;
    settings.offset = kOffset * spacing;
    settings.thickness = kThickness * settings.offset;
    settings.stiffness = kStiffness;
    settings.margin = kMargin * settings.offset;
    settings.recoveryCompression = kRecoveryPressure / kStiffness * spacing;
    settings.sameTissueDistance = kSameTissue * spacing;
    settings.minReach = kReach * spacing;
    pair = std::make_unique<SkinPair>(own, other, settings);
  }
  pair->setFriction(friction);
  pair->setRecoverySpeed(fits ? 0.0 : kRecoverySpeed * pair->spacing());
  return *pair;
}

SkinContacts::SelfContactBound &SkinContacts::selfContactBound(std::size_t id, const Body &body) {
  if (SelfContactBound &known = selfContactBounds_[id]; known.of == body.sharedRest()) return known;
  SelfContactBound &bound = selfContactBounds_[id] = {};
  const double area = areaOf(body.rest());
  bound.of = body.sharedRest();
  bound.gain = maxWeightSum(body.rest());
  bound.clearance = restClearance(body.rest().spacing);
  bound.thickness = area > 0.0 ? 2.0 * body.rest().shapeVolume / area : 0.0;
  return bound;
}

SkinContacts::SelfContactBound &SkinContacts::measuredSelfContactBound(const Owner &owner) {
  const ContactSkin &skin = skinOf(owner).skin();  // which resets the bound if it is created
  SelfContactBound &bound = selfContactBound(owner.id, owner.body);
  bound.skin = &skin;
  bound.gain = skin.plainGain;
  return bound;
}

void SkinContacts::SelfContactBound::measure(std::span<const Vec3> displacements) {
  const std::vector<Vec3> &rest = of->positions;
  const double count = static_cast<double>(std::max<std::size_t>(1, rest.size()));
  Vec3 restMean = Vec3::Zero(), mean = Vec3::Zero();
  for (std::size_t i = 0; i < rest.size(); ++i) {
    restMean += rest[i];
    mean += rest[i] + displacements[i];
  }
  restMean /= count;
  mean /= count;
  Mat3 covariance = Mat3::Zero();
  for (std::size_t i = 0; i < rest.size(); ++i)
    covariance += (rest[i] + displacements[i] - mean) * (rest[i] - restMean).transpose();
  const Mat3 R = polarBySvd(covariance).R;
  TravelBound bound(of->maxInfluence);
  for (std::size_t i = 0; i < rest.size(); ++i)
    bound.add(i, rest[i] + displacements[i] - mean - R * (rest[i] - restMean));
  clearance = restClearance(of->spacing) - 2.0 * vertexBound(bound);
}

void SkinContacts::clear() {
  pairs_.clear();
  skins_.clear();
  selfContactBounds_.clear();
}

void SkinContacts::remove(std::size_t id) {
  std::erase_if(pairs_, [id](const auto &pair) { return pair.first.first == id || pair.first.second == id; });
  skins_.erase(id);
  selfContactBounds_.erase(id);
}

}  // namespace pointbased::detail
