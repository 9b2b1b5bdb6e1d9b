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
constexpr double kActive = 0.5;      // of the offset: distance within which contacts are active
// 1/s: largest speed, in spacings per second, at which initial overlap is separated, and the pressure that does it, in
// moduli.
constexpr double kEase = 0.5, kGentle = 1e-2;
constexpr double kOnePiece = 1.5;      // of one skin: parts that are nearer at rest do not touch
constexpr double kReach = 0.15;        // distance within which features are listed
constexpr double kLongestEdge = 0.75;  // of a skin's triangles
// For inaccurate skins: length of edges, and additional tolerance.
constexpr double kCoarseEdge = 0.5, kCoarse = 0.05;

// m, distance at rest of parts of a skin that may touch each other, beyond the distance at which they are checked.
double roomAtRest(double spacing) { return (kOnePiece - kSelfContactReach) * spacing; }

// Points of lattices have non-negative weights. Others are fitted to the phyxels around them, as are the points that
// contact adds between them, for which twice as much is allowed.
double mostWeight(const RestState &rest) {
  if (rest.stencils.isLattice()) return 1.0;
  const Interpolation &rows = rest.surfels.rows();
  double most = 1.0;
  for (std::size_t p = 0; p < rows.count(); ++p) {
    double sum = 0.0;
    for (Index e = rows.phyxels.offsets[p]; e < rows.phyxels.offsets[p + 1]; ++e) sum += std::abs(rows.weights[e]);
    most = std::max(most, sum);
  }
  return 2.0 * most;
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
  forget(id);
  const RestState &rest = body.rest();
  Skin &renewed = skins_[id];
  renewed.of = body.sharedRest();
  renewed.isPiece = isPiece;
  SkinResolution resolution{kLongestEdge * rest.spacing};
  if (const double tolerance = toleranceOf(rest, isPiece); tolerance > 0.0) {
    resolution.edge = kCoarseEdge * rest.spacing;
    resolution.deviation = std::min(tolerance, kCoarse * rest.spacing);
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
    settings.margin = kActive * settings.offset;
    settings.recoveryCompression = kGentle / kStiffness * spacing;
    settings.sameTissueDistance = kOnePiece * spacing;
    settings.minReach = kReach * spacing;
    pair = std::make_unique<SkinPair>(own, other, settings);
  }
  pair->setFriction(friction);
  pair->setRecoverySpeed(fits ? 0.0 : kEase * pair->spacing());
  return *pair;
}

SkinContacts::SelfContactBound &SkinContacts::selfContactBound(std::size_t id, const Body &body) {
  if (SelfContactBound &known = selfContactBounds_[id]; known.of == body.sharedRest()) return known;
  SelfContactBound &room = selfContactBounds_[id] = {};
  const double area = areaOf(body.rest());
  room.of = body.sharedRest();
  room.gain = mostWeight(body.rest());
  room.left = roomAtRest(body.rest().spacing);
  room.thickness = area > 0.0 ? 2.0 * body.rest().shapeVolume / area : 0.0;
  return room;
}

SkinContacts::SelfContactBound &SkinContacts::measuredSelfContactBound(const Owner &owner) {
  const ContactSkin &skin = skinOf(owner).skin();  // which resets the bound if it is created
  SelfContactBound &room = selfContactBound(owner.id, owner.body);
  room.skin = &skin;
  room.gain = skin.plainGain;
  return room;
}

void SkinContacts::SelfContactBound::measure(std::span<const Vec3> displacements) {
  const std::vector<Vec3> &rest = of->positions;
  const double count = static_cast<double>(std::max<std::size_t>(1, rest.size()));
  Vec3 meanThen = Vec3::Zero(), mean = Vec3::Zero();
  for (std::size_t i = 0; i < rest.size(); ++i) {
    meanThen += rest[i];
    mean += rest[i] + displacements[i];
  }
  meanThen /= count;
  mean /= count;
  Mat3 covariance = Mat3::Zero();
  for (std::size_t i = 0; i < rest.size(); ++i)
    covariance += (rest[i] + displacements[i] - mean) * (rest[i] - meanThen).transpose();
  const Mat3 R = polarBySvd(covariance).R;
  TravelBound way(of->maxInfluence);
  for (std::size_t i = 0; i < rest.size(); ++i)
    way.add(i, rest[i] + displacements[i] - mean - R * (rest[i] - meanThen));
  left = roomAtRest(of->spacing) - 2.0 * farthest(way);
}

void SkinContacts::forget() {
  pairs_.clear();
  skins_.clear();
  selfContactBounds_.clear();
}

void SkinContacts::forget(std::size_t id) {
  std::erase_if(pairs_, [id](const auto &pair) { return pair.first.first == id || pair.first.second == id; });
  skins_.erase(id);
  selfContactBounds_.erase(id);
}

}  // namespace pointbased::detail
