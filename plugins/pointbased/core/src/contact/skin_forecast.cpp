// SPDX-License-Identifier: Apache-2.0
#include "contact/skin_forecast.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "discretisation/interpolation_at.h"

namespace pointbased::detail {
namespace {

// Spacings: pairs that come nearer within the horizon are listed. Larger: longer lists that stay valid longer.
constexpr float kListReach = 0.65f;
// Times the travel of a step, as bodies may gain speed within it. Larger: safer, lists expire earlier.
constexpr double kSpeedFactor = 2.0;
// Cosine: parts whose normals all agree better cannot face each other. Smaller: more pairs are skipped.
constexpr float kAlignedCosine = 0.2f;
// Cosine: normals of a patch that agree better are stored as one. Larger: more directions, at most 6.
constexpr float kSameDirectionCosine = 0.995f;
// Of the squared `sameTissueDistance`: patches with nearer rest boxes never touch. Larger: more pairs are skipped.
constexpr double kAdjacentFraction = 0.25;
// Steps to look ahead: for the first list, at least, at most. More: longer lists, built less often.
constexpr double kFirstHorizon = 8.0, kMinHorizon = 3.0, kMaxHorizon = 1024.0;
// New horizon, times the last one if the list stayed valid, else times its valid steps. Larger: longer lists.
constexpr double kHorizonGrowth = 2.0, kHorizonRetry = 1.5;

Eigen::Array4f corner(const Eigen::Vector3f &x) { return {x[0], x[1], x[2], 0.0f}; }

Vec3 meanOf(std::span<const Vec3> all) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3 &one : all) sum += one;
  return sum / static_cast<double>(std::max<std::size_t>(1, all.size()));
}

Vec3 meanOf(std::span<const Vec3> all, std::span<const Index> which) {
  Vec3 sum = Vec3::Zero();
  for (const Index i : which) sum += all[i];
  return sum / static_cast<double>(std::max<std::size_t>(1, which.size()));
}

double squaredDistance(const std::array<Vec3, 3> &a, const std::array<Vec3, 3> &b) {
  double squared = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    squared = std::min({squared, nearestOnTriangle(a[k], b[0], b[1], b[2]).squared,
                        nearestOnTriangle(b[k], a[0], a[1], a[2]).squared});
    for (std::size_t l = 0; l < 3; ++l) {
      const Vec3 &a0 = a[k], &a1 = a[(k + 1) % 3], &b0 = b[l], &b1 = b[(l + 1) % 3];
      const NearestOfSegments nearest = nearestOfSegments(a0, a1, b0, b1);
      squared = std::min(squared, (a0 + nearest.onFirst * (a1 - a0) - b0 - nearest.onSecond * (b1 - b0)).squaredNorm());
    }
  }
  return squared;
}

}  // namespace

SkinForecast::SkinForecast(MovingSkin &skin, double sameTissueDistance, double reach)
    : skin_(skin), sameTissueDistance_(sameTissueDistance), reach_(static_cast<float>(reach)),
      listReach_(std::max(kListReach * static_cast<float>(skin.spacing()), 2.0f * reach_)),
      nodes_(skin.tree().nodes().size()), nodeOf_(skin.tree().patches().size()), positions_(skin.skin().count()),
      velocities_(skin.skin().count()), faceDirections_(nodeOf_.size()), spheres_(skin.skin().triangles.size()),
      steps_(kFirstHorizon) {
  const std::vector<PatchTree::Node> &tree = skin.tree().nodes();
  for (Index k = 0; k < tree.size(); ++k)
    if (tree[k].patch != PatchTree::kNone) nodeOf_[tree[k].patch] = k;
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    positions_[v] = skin.skin().vertices.positions[v].cast<float>();
    velocities_[v].setZero();
  }
  ++revision_;
  for (Index t = 0; t < spheres_.size(); ++t) (void)boundingSphereOf(t);
  restSpheres_ = spheres_;
  for (std::vector<Corner> &normals : normals_) normals.resize(spheres_.size());
  findRings();
  pairs_.reserve(nodeOf_.size());
  traversalStack_.reserve(nodeOf_.size());
}

double SkinForecast::Deviation::measure(const ContactSkin &skin) {
  double squared = 0.0;
  for (Index v = 0; v < skin.count(); ++v)
    squared = std::max(squared, fieldAt(skin.vertices, v, current).squaredNorm());
  measured = current;
  return measuredMax = std::sqrt(squared);
}

bool SkinForecast::isStillValid() {
  const std::span<const Vec3> u = skin_.displacements(), v = skin_.velocities();
  const std::vector<Index> &carriers = skin_.skin().carriers;
  if (listDisplacements_.size() != u.size()) return false;
  const Vec3 meanDisplacement = meanOf(u, carriers), velocity = meanOf(v, carriers);
  const Vec3 before = std::exchange(lastMeanVelocity_, velocity);
  double projection = 0.0, squared = 0.0;
  for (const Index i : carriers) {
    projection += (u[i] - meanDisplacement - listDisplacements_[i]).dot(listVelocities_[i]);
    squared += listVelocities_[i].squaredNorm();
  }
  // Time since the list was built, as the best fit to the displacements. No clock is needed if steps are undone or
  // repeated.
  const double begin = squared > 0.0 ? std::clamp(projection / squared, 0.0, horizon_) : 0.0, dt = skin_.dt();
  TravelBound last(skin_.maxInfluence());
  std::array<TravelBound, 2> since{last, last};
  for (const Index i : carriers) {
    deviations_[0].current[i] = u[i] - meanDisplacement - listDisplacements_[i] - begin * listVelocities_[i];
    deviations_[1].current[i] = deviations_[0].current[i] + kSpeedFactor * dt * (v[i] - velocity - listVelocities_[i]);
    for (std::size_t k = 0; k < since.size(); ++k)
      since[k].add(i, deviations_[k].current[i] - deviations_[k].measured[i]);
    last.add(i, v[i] - velocity - lastVelocities_[i] + before);
    lastVelocities_[i] = v[i];
  }
  if (const double change = last.ofVertices(skin_.skin()); change > 0.0) velocityChange_ = change;
  const double ofChange = dt * velocityChange_, tolerance = 0.5 * static_cast<double>(listReach_ - reach_) - ofChange;
  double largestDeviation = 0.0;
  for (std::size_t k = 0; k < since.size(); ++k) {
    const double bound = deviations_[k].measuredMax + since[k].ofVertices(skin_.skin());
    largestDeviation = std::max(largestDeviation, bound < tolerance ? bound : deviations_[k].measure(skin_.skin()));
  }
  begin_ = static_cast<float>(begin);
  end_ = static_cast<float>(begin + kSpeedFactor * dt);
  deviation_ = static_cast<float>(2.0 * (largestDeviation + ofChange));
  ++validSteps_;
  return begin + kSpeedFactor * dt <= horizon_ * (1.0 + 1e-9) && deviation_ < listReach_ - reach_;
}

void SkinForecast::rebuild() {
  const std::span<const Vec3> u = skin_.displacements(), v = skin_.velocities();
  const double dt = skin_.dt();
  if (listDisplacements_.size() == u.size())
    steps_ = std::clamp(static_cast<double>(end_) > horizon_ ? kHorizonGrowth * steps_
                                                             : kHorizonRetry * static_cast<double>(validSteps_),
                        kMinHorizon, kMaxHorizon);
  else
    velocityChange_ = 0.0;
  validSteps_ = 0;
  const std::vector<Index> &carriers = skin_.skin().carriers;
  const Vec3 meanDisplacement = meanOf(u, carriers), velocity = meanOf(v, carriers);
  listDisplacements_.assign(u.begin(), u.end());
  listVelocities_.assign(v.begin(), v.end());
  lastVelocities_ = listVelocities_;
  lastMeanVelocity_ = velocity;
  for (Deviation &one : deviations_) {
    one.current.assign(u.size(), Vec3::Zero());
    one.measured = one.current;
    one.measuredMax = 0.0;
  }
  for (Vec3 &one : listDisplacements_) one -= meanDisplacement;
  for (Vec3 &one : listVelocities_) one -= velocity;
  horizon_ = steps_ * dt;
  begin_ = 0.0f;
  end_ = static_cast<float>(kSpeedFactor * dt);
  deviation_ = static_cast<float>(2.0 * dt * velocityChange_);
  const auto horizon = static_cast<float>(horizon_);
  refit(horizon);
  pairs_.clear();
  const std::vector<PatchTree::Node> &tree = skin_.tree().nodes();
  const double sameTissueSquared = sameTissueDistance_ * sameTissueDistance_;
  traversalStack_.assign(1, {0, 0});
  while (!traversalStack_.empty()) {
    const auto [a, b] = traversalStack_.back();
    traversalStack_.pop_back();
    if (a == b) {
      if (!mayFace(a, b)) continue;
      if (tree[a].patch != PatchTree::kNone) continue;
      const Index child = tree[a].child;
      traversalStack_.insert(traversalStack_.end(), {{child, child}, {child, child + 1}, {child + 1, child + 1}});
      continue;
    }
    const bool areLeaves = tree[a].patch != PatchTree::kNone && tree[b].patch != PatchTree::kNone;
    // Patches that are adjacent at rest never collide, even where parts of them are farther apart.
    if (areLeaves && tree[a].rest.squaredDistance(tree[b].rest) <= kAdjacentFraction * sameTissueSquared) continue;
    if (!mayComeNear(a, b) || !mayFace(a, b) || tree[a].rest.maxSquaredDistance(tree[b].rest) <= sameTissueSquared)
      continue;
    if (areLeaves) {
      addPairIfNear(tree[a].patch, tree[b].patch, horizon);
      continue;
    }
    const bool first =
        tree[b].patch != PatchTree::kNone || (tree[a].patch == PatchTree::kNone && tree[a].size >= tree[b].size);
    const Index child = tree[first ? a : b].child;
    for (const Index one : {child, child + 1}) traversalStack_.push_back(first ? std::pair(one, b) : std::pair(a, one));
  }
}

void SkinForecast::refit(float horizon) {
  ++revision_;
  skin_.updatePositions();
  const Vec3 meanPosition = meanOf(skin_.positions());
  const auto count = static_cast<Index>(positions_.size());
  Vec3 velocity = Vec3::Zero();
  for (Index v = 0; v < count; ++v) velocity += skin_.velocity(v);
  velocity /= static_cast<double>(std::max<Index>(1, count));
  for (Index v = 0; v < count; ++v) {
    positions_[v] = (skin_.position(v) - meanPosition).cast<float>();
    velocities_[v] = (skin_.velocity(v) - velocity).cast<float>();
  }
  updateNormals(horizon);
  const std::vector<PatchTree::Node> &tree = skin_.tree().nodes();
  for (std::size_t k = nodes_.size(); k-- > 0;) {
    Motion &node = nodes_[k];
    node = Motion();
    if (tree[k].patch == PatchTree::kNone)
      for (const Index child : {tree[k].child, tree[k].child + 1}) {
        node.now.add(nodes_[child].now);
        node.atHorizon.add(nodes_[child].atHorizon);
        node.normals.add(nodes_[child].normals);
      }
    else
      addPatch(tree[k].patch, horizon, node);
  }
}

void SkinForecast::addPatch(Index patch, float horizon, Motion &node) const {
  for (const Index v : skin_.tree().patches()[patch].corners) {
    node.now.add(corner(positions_[v]));
    node.atHorizon.add(corner(positions_[v] + horizon * velocities_[v]));
  }
  for (const Index t : rings_.row(patch))
    for (const std::vector<Corner> &normals : normals_) node.normals.add(normals[t]);
}

// A patch faces the directions of all triangles around its corners, including those of other patches.
void SkinForecast::findRings() {
  const ContactSkin &skin = skin_.skin();
  rings_.offsets.assign(1, 0);
  for (const PatchTree::Patch &patch : skin_.tree().patches()) {
    std::vector<Index> ring;
    for (const Index v : patch.corners)
      for (const Index t : skin.trianglesOf.row(v)) ring.push_back(t);
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
    rings_.indices.insert(rings_.indices.end(), ring.begin(), ring.end());
    rings_.offsets.push_back(static_cast<Index>(rings_.indices.size()));
  }
}

// Now and at the horizon; zero for a triangle without area.
void SkinForecast::updateNormals(float horizon) {
  const std::vector<std::array<Index, 3>> &triangles = skin_.skin().triangles;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 2; ++k) {
      const auto &[a, b, c] = triangles[t];
      const float time = k == 0 ? 0.0f : horizon;
      const Eigen::Vector3f ab = positions_[b] - positions_[a] + time * (velocities_[b] - velocities_[a]),
                            ac = positions_[c] - positions_[a] + time * (velocities_[c] - velocities_[a]);
      const Eigen::Vector3f normal = ab.cross(ac);
      const float length = normal.norm();
      normals_[k][t] = length > 0.0f ? corner(normal / length) : Corner(Corner::Zero());
    }
}

// Parts of a solid meet face to face. Two parts whose normals nearly agree cannot touch each other.
// @source  after Volino and Magnenat-Thalmann, Computer Graphics Forum 13(3), 1994
bool SkinForecast::mayFace(Index a, Index b) const {
  const Box &own = nodes_[a].normals, &others = nodes_[b].normals;
  const Corner least =
      (own.low * others.low).min(own.low * others.high).min((own.high * others.low).min(own.high * others.high));
  return !(least.sum() > kAlignedCosine);
}

// False if a plane perpendicular to a coordinate axis separates two nodes by more than listReach_ until the horizon.
// The lower bound of the distance along an axis is concave in time: it is the minimum of linear functions.
bool SkinForecast::mayComeNear(Index a, Index b) const {
  const Motion &own = nodes_[a], &others = nodes_[b];
  const Corner above = (own.now.low - others.now.high).min(own.atHorizon.low - others.atHorizon.high),
               below = (others.now.low - own.now.high).min(others.atHorizon.low - own.atHorizon.high);
  return above.max(below).maxCoeff() <= listReach_;
}

// Compares patches first by separating planes, then triangle by triangle. Pairs of triangles of the same tissue
// are skipped.
void SkinForecast::addPairIfNear(Index a, Index b, float horizon) {
  if (!(facesPatch(a, b, horizon) || facesPatch(b, a, horizon))) return;
  if (!(separationOf(a, b, horizon).leastUntil(horizon) <= listReach_)) return;
  Box first, second;
  for (const Index v : skin_.tree().patches()[a].corners) first.add(corner(velocities_[v]));
  for (const Index v : skin_.tree().patches()[b].corners) second.add(corner(velocities_[v]));
  const float fastest = std::sqrt((first.high - second.low).abs().max((second.high - first.low).abs()).square().sum());
  const float within = listReach_ + horizon * fastest;
  float now = std::numeric_limits<float>::infinity(), atHorizon = now;
  for (const Index t : skin_.tree().patches()[a].triangles) {
    const BoundingSphere &own = boundingSphereOf(t);
    for (const Index s : skin_.tree().patches()[b].triangles) {
      const BoundingSphere &others = boundingSphereOf(s);
      const Eigen::Vector3f offset = others.centre - own.centre;
      const float range = within + own.radius + others.radius, squared = offset.squaredNorm();
      if (squared > range * range) continue;
      if (areSameTissue(t, s)) continue;
      Separation found{0.0f, -fastest};
      if (squared > 0.0f)
        found = separationAlong(offset / std::sqrt(squared), skin_.skin().triangles[t], skin_.skin().triangles[s]);
      if (found.leastUntil(horizon) > listReach_) continue;
      now = std::min(now, found.distance);
      atHorizon = std::min(atHorizon, found.at(horizon));
    }
  }
  // The minimum of several linear functions is concave: it is nowhere below the chord between its ends.
  if (std::min(now, atHorizon) <= listReach_)
    pairs_.push_back({a, b, {now, horizon > 0.0f ? (atHorizon - now) / horizon : 0.0f}});
}

bool SkinForecast::areSameTissue(Index triangle, Index other) const {
  const BoundingSphere &first = restSpheres_[triangle], &second = restSpheres_[other];
  const float within = static_cast<float>(sameTissueDistance_) - first.radius - second.radius;
  return within >= 0.0f && (second.centre - first.centre).squaredNorm() <= within * within;
}

bool SkinForecast::isWithinReach(const Pair &pair) const {
  const auto &own = skin_.tree().patches()[pair.first].triangles,
             &others = skin_.tree().patches()[pair.second].triangles;
  for (const double part : {0.0, 0.5, 1.0}) {
    const double time = part * kSpeedFactor * skin_.dt();
    struct Placed {
      std::array<Vec3, 3> corners;
      SkinBox box;
    };
    const auto placed = [&](Index triangle) {
      Placed out;
      for (std::size_t k = 0; k < 3; ++k) {
        const Index v = skin_.skin().triangles[triangle][k];
        out.box.add(out.corners[k] = skin_.position(v) + time * skin_.velocity(v));
      }
      return out;
    };
    for (const Index t : own) {
      const Placed one = placed(t);
      for (const Index s : others) {
        if (areSameTissue(t, s)) continue;
        const Placed other = placed(s);
        if (one.box.squaredDistance(other.box) <= reach_ * reach_ &&
            squaredDistance(one.corners, other.corners) <= reach_ * reach_)
          return true;
      }
    }
  }
  return false;
}

// Separation of two planes perpendicular to a direction that points from the first set of vertices to the second.
template <class Corners>
SkinForecast::Separation SkinForecast::separationAlong(const Eigen::Vector3f &direction, const Corners &first,
                                                       const Corners &second) const {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  float high = -kFar, fastest = -kFar, low = kFar, slowest = kFar;
  for (const Index v : first) {
    high = std::max(high, direction.dot(positions_[v]));
    fastest = std::max(fastest, direction.dot(velocities_[v]));
  }
  for (const Index v : second) {
    low = std::min(low, direction.dot(positions_[v]));
    slowest = std::min(slowest, direction.dot(velocities_[v]));
  }
  return {low - high, slowest - fastest};
}

Eigen::Vector3f SkinForecast::centreOf(Index patch) const {
  const Box &box = nodes_[nodeOf_[patch]].now;
  return (0.5f * (box.low + box.high)).head<3>().matrix();
}

// Whether a corner of b is in front of a, now or at the horizon. Otherwise the two cannot touch.
bool SkinForecast::facesPatch(Index a, Index b, float horizon) {
  const auto &corners = skin_.tree().patches()[a].corners, &otherCorners = skin_.tree().patches()[b].corners;
  const FaceDirections &own = faceDirectionsOf(a);
  const auto directions = own.directions();
  return !own.isComplete || std::any_of(directions.begin(), directions.end(), [&](const Eigen::Vector3f &normal) {
    float lowest = std::numeric_limits<float>::infinity(), slowest = lowest;
    for (const Index v : corners) {
      lowest = std::min(lowest, normal.dot(positions_[v]));
      slowest = std::min(slowest, normal.dot(velocities_[v]));
    }
    return std::any_of(otherCorners.begin(), otherCorners.end(), [&](Index v) {
      const float above = normal.dot(positions_[v]) - lowest;
      return std::max(above, above + horizon * (normal.dot(velocities_[v]) - slowest)) > 0.0f;
    });
  });
}

// Best separation along the line between the centres, or along one of the two normals.
SkinForecast::Separation SkinForecast::separationOf(Index a, Index b, float horizon) {
  const Eigen::Vector3f offset = centreOf(b) - centreOf(a);
  Separation best{-std::numeric_limits<float>::infinity(), 0.0f};
  const auto normalOf = [&](Index patch) -> Eigen::Vector3f { return faceDirectionsOf(patch).normals.front(); };
  for (const Eigen::Vector3f &across : {Eigen::Vector3f(offset.stableNormalized()), normalOf(a), normalOf(b)}) {
    const Separation found = separationAlong(across.dot(offset) < 0.0f ? Eigen::Vector3f(-across) : across,
                                             skin_.tree().patches()[a].corners, skin_.tree().patches()[b].corners);
    if (found.leastUntil(horizon) > best.leastUntil(horizon)) best = found;
    if (best.leastUntil(horizon) > listReach_) break;
  }
  return best;
}

// Distinct directions in which a patch and the triangles around it face.
const SkinForecast::FaceDirections &SkinForecast::faceDirectionsOf(Index patch) {
  FaceDirections &directions = faceDirections_[patch];
  if (std::exchange(directions.revision, revision_) == revision_) return directions;
  directions.count = 0;
  directions.isComplete = true;
  directions.normals.front().setZero();
  for (const Index t : rings_.row(patch)) {
    const Eigen::Vector3f normal = normals_[0][t].head<3>().matrix();
    const auto known = directions.directions();
    if (!(normal.squaredNorm() > 0.0f) || std::any_of(known.begin(), known.end(), [&](const Eigen::Vector3f &one) {
          return one.dot(normal) > kSameDirectionCosine;
        }))
      continue;
    directions.isComplete = directions.count < directions.normals.size();
    if (!directions.isComplete) break;
    directions.normals[directions.count++] = normal;
  }
  return directions;
}

const SkinForecast::BoundingSphere &SkinForecast::boundingSphereOf(Index triangle) {
  BoundingSphere &sphere = spheres_[triangle];
  if (sphere.revision == revision_) return sphere;
  sphere = BoundingSphere();
  sphere.revision = revision_;
  const auto &corners = skin_.skin().triangles[triangle];
  for (const Index v : corners) sphere.centre += positions_[v] / 3.0f;
  for (const Index v : corners) sphere.radius = std::max(sphere.radius, (positions_[v] - sphere.centre).norm());
  return sphere;
}

}  // namespace pointbased::detail
