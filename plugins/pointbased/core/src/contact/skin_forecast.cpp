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
constexpr float kListed = 0.65f;
// Times the travel of a step, as bodies may gain speed within it. Larger: safer, lists expire earlier.
constexpr double kFaster = 2.0;
// Cosine: parts whose normals all agree better cannot face each other. Smaller: more pairs are skipped.
constexpr float kAlike = 0.2f;
// Cosine: normals of a patch that agree better are stored as one. Larger: more directions, at most 6.
constexpr float kSame = 0.995f;
// Of the squared distance `apart`: patches with nearer rest boxes never touch. Larger: more pairs are skipped.
constexpr double kBeside = 0.25;
// Steps to look ahead: for the first list, at least, at most. More: longer lists, built less often.
constexpr double kFirst = 8.0, kFewest = 3.0, kMost = 1024.0;
// New horizon, times the last one if the list stayed valid, else times its valid steps. Larger: longer lists.
constexpr double kLonger = 2.0, kAsLong = 1.5;

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
      const NearestOfSegments near = nearestOfSegments(a0, a1, b0, b1);
      squared = std::min(squared, (a0 + near.onFirst * (a1 - a0) - b0 - near.onSecond * (b1 - b0)).squaredNorm());
    }
  }
  return squared;
}

}  // namespace

SkinForecast::SkinForecast(MovingSkin &skin, double apart, double near)
    : skin_(skin), apart_(apart), near_(static_cast<float>(near)),
      listed_(std::max(kListed * static_cast<float>(skin.spacing()), 2.0f * near_)), nodes_(skin.tree().nodes().size()),
      nodeOf_(skin.tree().patches().size()), places_(skin.skin().count()), velocities_(skin.skin().count()),
      facings_(nodeOf_.size()), balls_(skin.skin().triangles.size()), steps_(kFirst) {
  const std::vector<PatchTree::Node> &tree = skin.tree().nodes();
  for (Index k = 0; k < tree.size(); ++k)
    if (tree[k].patch != PatchTree::kNone) nodeOf_[tree[k].patch] = k;
  for (std::size_t v = 0; v < places_.size(); ++v) {
    places_[v] = skin.skin().vertices.positions[v].cast<float>();
    velocities_[v].setZero();
  }
  ++now_;
  for (Index t = 0; t < balls_.size(); ++t) (void)ballOf(t);
  restBalls_ = balls_;
  for (std::vector<Corner> &normals : normals_) normals.resize(balls_.size());
  findRings();
  pairs_.reserve(nodeOf_.size());
  open_.reserve(nodeOf_.size());
}

double SkinForecast::Deviation::measure(const ContactSkin &skin) {
  double squared = 0.0;
  for (Index v = 0; v < skin.count(); ++v) squared = std::max(squared, fieldAt(skin.vertices, v, ways).squaredNorm());
  waysThen = ways;
  return mostThen = std::sqrt(squared);
}

bool SkinForecast::isStillValid() {
  const std::span<const Vec3> u = skin_.displacements(), v = skin_.velocities();
  const std::vector<Index> &carriers = skin_.skin().carriers;
  if (placeThen_.size() != u.size()) return false;
  const Vec3 place = meanOf(u, carriers), velocity = meanOf(v, carriers);
  const Vec3 before = std::exchange(meanBefore_, velocity);
  double along = 0.0, squared = 0.0;
  for (const Index i : carriers) {
    along += (u[i] - place - placeThen_[i]).dot(velocityThen_[i]);
    squared += velocityThen_[i].squaredNorm();
  }
  // Time since the list was built, as the best fit to the displacements. No clock is needed if steps are undone or
  // repeated.
  const double begin = squared > 0.0 ? std::clamp(along / squared, 0.0, horizon_) : 0.0, dt = skin_.dt();
  TravelBound last(skin_.maxInfluence());
  std::array<TravelBound, 2> since{last, last};
  for (const Index i : carriers) {
    deviations_[0].ways[i] = u[i] - place - placeThen_[i] - begin * velocityThen_[i];
    deviations_[1].ways[i] = deviations_[0].ways[i] + kFaster * dt * (v[i] - velocity - velocityThen_[i]);
    for (std::size_t k = 0; k < since.size(); ++k) since[k].add(i, deviations_[k].ways[i] - deviations_[k].waysThen[i]);
    last.add(i, v[i] - velocity - velocityBefore_[i] + before);
    velocityBefore_[i] = v[i];
  }
  if (const double gained = last.ofVertices(skin_.skin()); gained > 0.0) velocityChange_ = gained;
  const double ofChange = dt * velocityChange_, room = 0.5 * static_cast<double>(listed_ - near_) - ofChange;
  double off = 0.0;
  for (std::size_t k = 0; k < since.size(); ++k) {
    const double bound = deviations_[k].mostThen + since[k].ofVertices(skin_.skin());
    off = std::max(off, bound < room ? bound : deviations_[k].measure(skin_.skin()));
  }
  begin_ = static_cast<float>(begin);
  end_ = static_cast<float>(begin + kFaster * dt);
  deviation_ = static_cast<float>(2.0 * (off + ofChange));
  ++served_;
  return begin + kFaster * dt <= horizon_ * (1.0 + 1e-9) && deviation_ < listed_ - near_;
}

void SkinForecast::look() {
  const std::span<const Vec3> u = skin_.displacements(), v = skin_.velocities();
  const double dt = skin_.dt();
  if (placeThen_.size() == u.size())
    steps_ =
        std::clamp(static_cast<double>(end_) > horizon_ ? kLonger * steps_ : kAsLong * static_cast<double>(served_),
                   kFewest, kMost);
  else
    velocityChange_ = 0.0;
  served_ = 0;
  const std::vector<Index> &carriers = skin_.skin().carriers;
  const Vec3 place = meanOf(u, carriers), velocity = meanOf(v, carriers);
  placeThen_.assign(u.begin(), u.end());
  velocityThen_.assign(v.begin(), v.end());
  velocityBefore_ = velocityThen_;
  meanBefore_ = velocity;
  for (Deviation &one : deviations_) {
    one.ways.assign(u.size(), Vec3::Zero());
    one.waysThen = one.ways;
    one.mostThen = 0.0;
  }
  for (Vec3 &one : placeThen_) one -= place;
  for (Vec3 &one : velocityThen_) one -= velocity;
  horizon_ = steps_ * dt;
  begin_ = 0.0f;
  end_ = static_cast<float>(kFaster * dt);
  deviation_ = static_cast<float>(2.0 * dt * velocityChange_);
  const auto horizon = static_cast<float>(horizon_);
  refit(horizon);
  pairs_.clear();
  const std::vector<PatchTree::Node> &tree = skin_.tree().nodes();
  const double apart = apart_ * apart_;
  open_.assign(1, {0, 0});
  while (!open_.empty()) {
    const auto [a, b] = open_.back();
    open_.pop_back();
    if (a == b) {
      if (!mayFace(a, b)) continue;
      if (tree[a].patch != PatchTree::kNone) continue;
      const Index child = tree[a].child;
      open_.insert(open_.end(), {{child, child}, {child, child + 1}, {child + 1, child + 1}});
      continue;
    }
    const bool areLeaves = tree[a].patch != PatchTree::kNone && tree[b].patch != PatchTree::kNone;
    // Patches that are adjacent at rest never collide, even where parts of them are farther apart.
    if (areLeaves && tree[a].rest.squaredDistance(tree[b].rest) <= kBeside * apart) continue;
    if (!mayComeNear(a, b) || !mayFace(a, b) || tree[a].rest.squaredFarthest(tree[b].rest) <= apart) continue;
    if (areLeaves) {
      compare(tree[a].patch, tree[b].patch, horizon);
      continue;
    }
    const bool first =
        tree[b].patch != PatchTree::kNone || (tree[a].patch == PatchTree::kNone && tree[a].size >= tree[b].size);
    const Index child = tree[first ? a : b].child;
    for (const Index one : {child, child + 1}) open_.push_back(first ? std::pair(one, b) : std::pair(a, one));
  }
}

void SkinForecast::refit(float horizon) {
  ++now_;
  skin_.placeVertices();
  const Vec3 place = meanOf(skin_.positions());
  const auto count = static_cast<Index>(places_.size());
  Vec3 velocity = Vec3::Zero();
  for (Index v = 0; v < count; ++v) velocity += skin_.velocity(v);
  velocity /= static_cast<double>(std::max<Index>(1, count));
  for (Index v = 0; v < count; ++v) {
    places_[v] = (skin_.position(v) - place).cast<float>();
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
        node.then.add(nodes_[child].then);
        node.normals.add(nodes_[child].normals);
      }
    else
      addPatch(tree[k].patch, horizon, node);
  }
}

void SkinForecast::addPatch(Index patch, float horizon, Motion &node) const {
  for (const Index v : skin_.tree().patches()[patch].corners) {
    node.now.add(corner(places_[v]));
    node.then.add(corner(places_[v] + horizon * velocities_[v]));
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
      const Eigen::Vector3f ab = places_[b] - places_[a] + time * (velocities_[b] - velocities_[a]),
                            ac = places_[c] - places_[a] + time * (velocities_[c] - velocities_[a]);
      const Eigen::Vector3f normal = ab.cross(ac);
      const float length = normal.norm();
      normals_[k][t] = length > 0.0f ? corner(normal / length) : Corner(Corner::Zero());
    }
}

// Parts of a solid meet face to face. Two parts whose normals nearly agree cannot touch each other.
// @source  after Volino and Magnenat-Thalmann, Computer Graphics Forum 13(3), 1994
bool SkinForecast::mayFace(Index a, Index b) const {
  const Box &mine = nodes_[a].normals, &theirs = nodes_[b].normals;
  const Corner least =
      (mine.low * theirs.low).min(mine.low * theirs.high).min((mine.high * theirs.low).min(mine.high * theirs.high));
  return !(least.sum() > kAlike);
}

// False if a plane perpendicular to a coordinate axis separates two nodes by more than listed_ until the horizon. The
// lower bound of the distance along an axis is concave in time: it is the minimum of linear functions.
bool SkinForecast::mayComeNear(Index a, Index b) const {
  const Motion &mine = nodes_[a], &theirs = nodes_[b];
  const Corner above = (mine.now.low - theirs.now.high).min(mine.then.low - theirs.then.high),
               below = (theirs.now.low - mine.now.high).min(theirs.then.low - mine.then.high);
  return above.max(below).maxCoeff() <= listed_;
}

// Compares patches first by separating planes, then triangle by triangle. Pairs of triangles that are one piece of
// tissue are skipped.
void SkinForecast::compare(Index a, Index b, float horizon) {
  if (!(faces(a, b, horizon) || faces(b, a, horizon))) return;
  if (!(separationOf(a, b, horizon).leastUntil(horizon) <= listed_)) return;
  Box first, second;
  for (const Index v : skin_.tree().patches()[a].corners) first.add(corner(velocities_[v]));
  for (const Index v : skin_.tree().patches()[b].corners) second.add(corner(velocities_[v]));
  const float fastest = std::sqrt((first.high - second.low).abs().max((second.high - first.low).abs()).square().sum());
  const float within = listed_ + horizon * fastest;
  float now = std::numeric_limits<float>::infinity(), then = now;
  for (const Index t : skin_.tree().patches()[a].triangles) {
    const Ball &mine = ballOf(t);
    for (const Index s : skin_.tree().patches()[b].triangles) {
      const Ball &theirs = ballOf(s);
      const Eigen::Vector3f way = theirs.middle - mine.middle;
      const float far = within + mine.radius + theirs.radius, squared = way.squaredNorm();
      if (squared > far * far) continue;
      if (areOnePiece(t, s)) continue;
      Separation found{0.0f, -fastest};
      if (squared > 0.0f) found = along(way / std::sqrt(squared), skin_.skin().triangles[t], skin_.skin().triangles[s]);
      if (found.leastUntil(horizon) > listed_) continue;
      now = std::min(now, found.distance);
      then = std::min(then, found.at(horizon));
    }
  }
  // The minimum of several linear functions is concave: it is nowhere below the chord between its ends.
  if (std::min(now, then) <= listed_) pairs_.push_back({a, b, {now, horizon > 0.0f ? (then - now) / horizon : 0.0f}});
}

bool SkinForecast::areOnePiece(Index triangle, Index other) const {
  const Ball &first = restBalls_[triangle], &second = restBalls_[other];
  const float within = static_cast<float>(apart_) - first.radius - second.radius;
  return within >= 0.0f && (second.middle - first.middle).squaredNorm() <= within * within;
}

bool SkinForecast::isNear(const Pair &pair) const {
  const auto &mine = skin_.tree().patches()[pair.first].triangles,
             &theirs = skin_.tree().patches()[pair.second].triangles;
  for (const double part : {0.0, 0.5, 1.0}) {
    const double time = part * kFaster * skin_.dt();
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
    for (const Index t : mine) {
      const Placed one = placed(t);
      for (const Index s : theirs) {
        if (areOnePiece(t, s)) continue;
        const Placed other = placed(s);
        if (one.box.squaredDistance(other.box) <= near_ * near_ &&
            squaredDistance(one.corners, other.corners) <= near_ * near_)
          return true;
      }
    }
  }
  return false;
}

// Separation of two planes perpendicular to a direction that points from the first set of vertices to the second.
template <class Corners>
SkinForecast::Separation SkinForecast::along(const Eigen::Vector3f &direction, const Corners &first,
                                             const Corners &second) const {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  float high = -kFar, fastest = -kFar, low = kFar, slowest = kFar;
  for (const Index v : first) {
    high = std::max(high, direction.dot(places_[v]));
    fastest = std::max(fastest, direction.dot(velocities_[v]));
  }
  for (const Index v : second) {
    low = std::min(low, direction.dot(places_[v]));
    slowest = std::min(slowest, direction.dot(velocities_[v]));
  }
  return {low - high, slowest - fastest};
}

Eigen::Vector3f SkinForecast::middleOf(Index patch) const {
  const Box &box = nodes_[nodeOf_[patch]].now;
  return (0.5f * (box.low + box.high)).head<3>().matrix();
}

// Whether a corner of b is in front of a, now or at the horizon. Otherwise the two cannot touch.
bool SkinForecast::faces(Index a, Index b, float horizon) {
  const auto &mine = skin_.tree().patches()[a].corners, &theirs = skin_.tree().patches()[b].corners;
  const Facings &facings = facingsOf(a);
  const auto known = facings.known();
  return !facings.isComplete || std::any_of(known.begin(), known.end(), [&](const Eigen::Vector3f &normal) {
    float lowest = std::numeric_limits<float>::infinity(), slowest = lowest;
    for (const Index v : mine) {
      lowest = std::min(lowest, normal.dot(places_[v]));
      slowest = std::min(slowest, normal.dot(velocities_[v]));
    }
    return std::any_of(theirs.begin(), theirs.end(), [&](Index v) {
      const float above = normal.dot(places_[v]) - lowest;
      return std::max(above, above + horizon * (normal.dot(velocities_[v]) - slowest)) > 0.0f;
    });
  });
}

// Best separation along the line between the centres, or along one of the two normals.
SkinForecast::Separation SkinForecast::separationOf(Index a, Index b, float horizon) {
  const Eigen::Vector3f way = middleOf(b) - middleOf(a);
  Separation best{-std::numeric_limits<float>::infinity(), 0.0f};
  const auto normalOf = [&](Index patch) -> Eigen::Vector3f { return facingsOf(patch).normals.front(); };
  for (const Eigen::Vector3f &across : {Eigen::Vector3f(way.stableNormalized()), normalOf(a), normalOf(b)}) {
    const Separation found = along(across.dot(way) < 0.0f ? Eigen::Vector3f(-across) : across,
                                   skin_.tree().patches()[a].corners, skin_.tree().patches()[b].corners);
    if (found.leastUntil(horizon) > best.leastUntil(horizon)) best = found;
    if (best.leastUntil(horizon) > listed_) break;
  }
  return best;
}

// Distinct directions in which a patch and the triangles around it face.
const SkinForecast::Facings &SkinForecast::facingsOf(Index patch) {
  Facings &facings = facings_[patch];
  if (std::exchange(facings.seen, now_) == now_) return facings;
  facings.count = 0;
  facings.isComplete = true;
  facings.normals.front().setZero();
  for (const Index t : rings_.row(patch)) {
    const Eigen::Vector3f normal = normals_[0][t].head<3>().matrix();
    const auto known = facings.known();
    if (!(normal.squaredNorm() > 0.0f) ||
        std::any_of(known.begin(), known.end(), [&](const Eigen::Vector3f &one) { return one.dot(normal) > kSame; }))
      continue;
    facings.isComplete = facings.count < facings.normals.size();
    if (!facings.isComplete) break;
    facings.normals[facings.count++] = normal;
  }
  return facings;
}

const SkinForecast::Ball &SkinForecast::ballOf(Index triangle) {
  Ball &ball = balls_[triangle];
  if (ball.seen == now_) return ball;
  ball = Ball();
  ball.seen = now_;
  const auto &corners = skin_.skin().triangles[triangle];
  for (const Index v : corners) ball.middle += places_[v] / 3.0f;
  for (const Index v : corners) ball.radius = std::max(ball.radius, (places_[v] - ball.middle).norm());
  return ball;
}

}  // namespace pointbased::detail
