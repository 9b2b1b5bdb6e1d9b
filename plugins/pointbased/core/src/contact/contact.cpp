// SPDX-License-Identifier: Apache-2.0
#include "pointbased/contact.h"

#include <algorithm>
#include <cmath>

#include "contact/contact_search.h"

namespace pointbased {

using namespace detail;

namespace {

using ClearanceCache = ContactState::ClearanceCache;
using LastOutside = ContactState::LastOutside;

// Search distance of obstacles, in margins and in multiples of the travel of a step, at least twice the travel since
// the last query. Larger: queries cost more and are less frequent.
constexpr double kReachMargins = 40.0;
constexpr double kReachTravels = 3.0;
// Margins: a plane is reused while the point stays that close to its query. Larger: fewer queries, larger error.
constexpr double kPlaneReuseMargins = 0.25;
// Margins: a point that travels less in a step is at rest, no crossing is searched. Larger: more points count as at
// rest.
constexpr double kRestTravel = 1e-3;
// Margins: points up to this depth may slide along an obstacle, deeper ones return to where they entered. Larger: more
// points slide.
constexpr double kMaxSlideDepth = 50.0;

// One obstacle during one step.
struct Step {
  const Obstacle &obstacle;
  bool isMoving;
  RigidMotion now, then;
  double dt, margin;

  // World to the rest frame of the obstacle at the beginning of the step, and the relative displacement in that frame.
  [[nodiscard]] Vec3 local(const Vec3 &x) const { return isMoving ? toRestFrame(now, x) : x; }
  [[nodiscard]] Vec3 travel(const Vec3 &x, const Vec3 &at, const Vec3 &velocity) const {
    return isMoving ? Vec3(toRestFrame(then, x + dt * velocity) - at) : Vec3(dt * velocity);
  }
  [[nodiscard]] Vec3 surfaceVelocity(const Vec3 &at) const {
    return isMoving && dt > 0.0 ? Vec3((then.displacementOf(at) - now.displacementOf(at)) / dt) : Vec3(Vec3::Zero());
  }
  // First crossing of a segment with the obstacle; the normal is oriented against the direction of travel.
  [[nodiscard]] bool findCrossing(const Vec3 &from, const Vec3 &to, Vec3 &normal, double &offset) const {
    if (!obstacle.crossing || from == to) return false;
    const double t = obstacle.crossing(from, to, normal);
    if (!(t >= 0.0)) return false;
    if (normal.dot(to - from) > 0.0) normal = -normal;
    offset = normal.dot(from + t * (to - from));
    return true;
  }
};

// Whether no contact is possible, the stored result is still valid, or a new query is necessary.
enum class QueryNeed { none, cached, query };

QueryNeed queryNeedOf(const ClearanceCache &known, const Vec3 &at, double travel, double radius, double margin) {
  if (known.reach < 0.0) return QueryNeed::query;
  const double distance = (at - known.at).norm();
  // NaN causes a query as well; the guard detects it later.
  if (std::min(known.distance, known.reach) - radius - margin - distance > travel) return QueryNeed::none;
  return distance <= kPlaneReuseMargins * margin && distance + travel <= known.swept ? QueryNeed::cached
                                                                                     : QueryNeed::query;
}

// Stores the result of a query: the plane at the closest point, the last outside position, and the surface that the
// path crosses.
void storeQueryResult(const Step &step, const Vec3 &at, const Vec3 &travel, double radius, const SurfacePoint &result,
                      double reach, ClearanceCache &known, LastOutside &lastOutside) {
  const double margin = step.margin;
  known.at = at;
  known.reach = reach;
  known.distance = result.distance;
  known.normal = result.normal;
  known.ahead = false;
  double offset = 0.0;
  Vec3 normal;
  if (lastOutside.isKnown && step.findCrossing(lastOutside.position, at, normal, offset)) {
    known.normal = normal;
    known.distance = normal.dot(at) - offset;
    const Vec3 atMargin = at + (margin - known.distance) * normal;
    Vec3 ignored;
    if (known.distance > -kMaxSlideDepth * margin &&
        !step.findCrossing(lastOutside.position, atMargin, ignored, offset))
      lastOutside.position = atMargin;
  } else if (known.distance >= -margin) {
    lastOutside.isKnown = true;
    lastOutside.position = at;
    if (known.distance < margin) lastOutside.position += (margin - known.distance) * known.normal;
  }

  const double length = travel.norm();
  known.swept = length + 0.5 * margin;
  if (!(length > kRestTravel * margin) || (!lastOutside.isKnown && known.distance < -margin)) return;
  // The path of a point in contact starts a margin above the surface, so that it crosses other faces first.
  const bool isTouching = known.distance - radius <= margin;
  Vec3 from = at, along = travel;
  if (isTouching) {
    from += std::max(0.0, margin - known.distance) * known.normal;
    along -= std::min(0.0, travel.dot(known.normal)) * known.normal;
  }
  const double alongLength = along.norm();
  if (!(alongLength > kRestTravel * margin)) return;
  if (!step.findCrossing(from, from + along * ((alongLength + radius + margin) / alongLength), normal, offset)) return;
  if (isTouching && normal.dot(known.normal) > kSamePlaneCosine) return;
  known.ahead = true;
  known.aheadNormal = normal;
  known.aheadOffset = offset;
}

bool before(const Contact &a, const Contact &b) {
  return a.point != b.point ? a.point < b.point : a.obstacle < b.obstacle;
}

// Warm start: persisting contacts take the impulses of the last step.
void warmStartContacts(ContactState &memory) {
  std::size_t from = 0;
  for (Contact &contact : memory.active) {
    while (from < memory.previous.size() && before(memory.previous[from], contact)) ++from;
    bool persists = false;
    for (std::size_t k = from; k < memory.previous.size() && !before(contact, memory.previous[k]); ++k) {
      const Contact &earlier = memory.previous[k];
      if (!warmStartFrom(earlier, contact)) continue;
      persists = true;
      contact.initialPenetration = std::clamp(-contact.gap, 0.0, earlier.initialPenetration);
      break;
    }
    if (!persists) contact.initialPenetration = std::max(0.0, -contact.gap);
  }
}

void addWalls(const WorldBox &box, double dt, double margin, const QueryPoints &queryPoints,
              std::vector<Contact> &active) {
  const auto add = [&](std::size_t k, const Vec3 &normal, double gap) {
    if (gap > margin + std::max(0.0, -queryPoints.velocities[k].dot(normal)) * dt) return;
    Contact contact;
    contact.point = queryPoints.point(k);
    contact.normal = normal;
    contact.gap = gap;
    contact.friction = box.friction;
    contact.restitution = box.restitution;
    contact.obstacle = Contact::kWall;
    contact.position = queryPoints.positions[k];
    active.push_back(contact);
  };
  for (std::size_t k = 0; k < queryPoints.count(); ++k) {
    const double radius = queryPoints.radius(k);
    for (int axis = 0; axis < 3; ++axis) {
      add(k, Vec3::Unit(axis), queryPoints.positions[k][axis] - box.min[axis] - radius);
      add(k, -Vec3::Unit(axis), box.max[axis] - queryPoints.positions[k][axis] - radius);
    }
  }
}

Step stepOf(const Obstacle &obstacle, double time, double dt, double margin) {
  const bool isMoving = static_cast<bool>(obstacle.motion);
  return {obstacle,
          isMoving,
          isMoving ? obstacle.motion(time) : RigidMotion{},
          isMoving ? obstacle.motion(time + dt) : RigidMotion{},
          dt,
          margin};
}

/// Search for contacts with one obstacle.
class ObstacleSearch {
 public:
  ObstacleSearch(const Obstacle &obstacle, std::size_t number, const Step &step, const QueryPoints &queryPoints,
                 std::size_t count, ContactState &memory)
      : obstacle_(obstacle), number_(static_cast<Index>(number)), step_(step), queryPoints_(queryPoints),
        clearance_(memory.clearance[number]), lastOutside_(memory.lastOutside[number]), queries_(memory.queries),
        active_(memory.active) {
    if (clearance_.size() != count) clearance_.assign(count, ClearanceCache());
    if (lastOutside_.size() != count) lastOutside_.assign(count, LastOutside());
  }

  void run(const ParallelFor &parallelFor) {
    collectQueries();
    if (!queries_.points.empty()) runQueries(parallelFor);
    for (const Index k : queries_.candidates) addContacts(k);
  }

 private:
  void collectQueries() {
    queries_.points.clear();
    queries_.candidates.clear();
    queries_.positions.clear();
    queries_.travels.clear();
    queries_.ranges.clear();
    for (std::size_t k = 0; k < queryPoints_.count(); ++k) {
      if (!obstacle_.actsOn(queryPoints_.point(k))) continue;
      const ClearanceCache &known = clearance_[queryPoints_.point(k)];
      const Vec3 at = step_.local(queryPoints_.positions[k]);
      const Vec3 travel = step_.travel(queryPoints_.positions[k], at, queryPoints_.velocities[k]);
      const double length = travel.norm();
      const QueryNeed need = queryNeedOf(known, at, length, queryPoints_.radius(k), step_.margin);
      if (need == QueryNeed::none) continue;
      queries_.candidates.push_back(static_cast<Index>(k));
      if (need == QueryNeed::cached) continue;
      queries_.points.push_back(static_cast<Index>(k));
      queries_.positions.push_back(at);
      queries_.travels.push_back(travel);
      // Unlimited for the first query and from inside, so that deep penetration is detected. The distance grows to
      // twice the travel if a point has moved far without contact.
      const bool unlimited = known.reach < 0.0 || known.distance < 0.0;
      queries_.ranges.push_back(unlimited ? std::numeric_limits<double>::infinity()
                                          : queryPoints_.radius(k) +
                                                std::max({kReachMargins * step_.margin, kReachTravels * length,
                                                          2.0 * (at - known.at).norm()}));
    }
  }

  void runQueries(const ParallelFor &parallelFor) {
    queries_.answers.assign(queries_.points.size(), SurfacePoint());
    parallelFor(queries_.points.size(), 16, [&](std::size_t begin, std::size_t end) {
      obstacle_.closest(std::span<const Vec3>(queries_.positions).subspan(begin, end - begin),
                        std::span<const double>(queries_.ranges).subspan(begin, end - begin),
                        std::span<SurfacePoint>(queries_.answers).subspan(begin, end - begin));
      for (std::size_t k = begin; k < end; ++k) {
        const Index p = queryPoints_.point(queries_.points[k]);
        storeQueryResult(step_, queries_.positions[k], queries_.travels[k], queryPoints_.radius(queries_.points[k]),
                         queries_.answers[k], queries_.ranges[k], clearance_[p], lastOutside_[p]);
      }
    });
  }

  void addContacts(Index k) {
    const double margin = step_.margin;
    const ClearanceCache &known = clearance_[queryPoints_.point(k)];
    const Vec3 at = step_.local(queryPoints_.positions[k]);
    const double length = step_.travel(queryPoints_.positions[k], at, queryPoints_.velocities[k]).norm();
    // NaN passes through for the guard to detect.
    if (!(known.distance == std::numeric_limits<double>::infinity())) {
      const double gap = known.distance + known.normal.dot(at - known.at) - queryPoints_.radius(k);
      // Without crossing queries the plane has to cover all that is in reach.
      if (!(gap > (obstacle_.crossing ? margin : length + margin))) add(k, at, known.normal, gap);
    }
    if (known.ahead) {
      const double gap = known.aheadNormal.dot(at) - known.aheadOffset - queryPoints_.radius(k);
      if (!(gap > length + margin)) add(k, at, known.aheadNormal, gap);
    }
  }

  void add(Index k, const Vec3 &at, const Vec3 &normal, double gap) {
    Contact contact;
    contact.point = queryPoints_.point(k);
    contact.normal = step_.isMoving ? Vec3(step_.now.rotation * normal) : normal;
    contact.gap = gap;
    contact.surfaceVelocity = step_.surfaceVelocity(at);
    contact.friction = obstacle_.friction;
    contact.restitution = obstacle_.restitution;
    contact.obstacle = number_;
    contact.position = queryPoints_.positions[k];
    active_.push_back(contact);
  }

  const Obstacle &obstacle_;
  Index number_;
  const Step &step_;
  const QueryPoints &queryPoints_;
  std::vector<ClearanceCache> &clearance_;
  std::vector<LastOutside> &lastOutside_;
  ContactState::ClosestPointQueries &queries_;
  std::vector<Contact> &active_;
};

}  // namespace

void detail::searchContacts(std::span<const Obstacle> obstacles, const WorldBox &box, double time, double dt,
                            double margin, std::size_t count, const QueryPoints &queryPoints, ContactState &memory,
                            const ParallelFor &parallelFor) {
  std::swap(memory.previous, memory.active);
  memory.active.clear();
  memory.margin = margin;
  memory.clearance.resize(obstacles.size());
  memory.lastOutside.resize(obstacles.size());
  memory.searchTime = time;
  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    if (!obstacles[o].closest) {
      memory.clearance[o].clear();
      memory.lastOutside[o].clear();
      continue;
    }
    ObstacleSearch(obstacles[o], o, stepOf(obstacles[o], time, dt, margin), queryPoints, count, memory)
        .run(parallelFor);
  }
  if (box.enabled) addWalls(box, dt, margin, queryPoints, memory.active);

  // std::stable_sort allocates memory; with one obstacle the contacts are sorted already.
  if (!std::is_sorted(memory.active.begin(), memory.active.end(), before))
    std::stable_sort(memory.active.begin(), memory.active.end(), before);
  for (const Contact &contact : memory.active) memory.deepest = std::max(memory.deepest, -contact.gap);
  warmStartContacts(memory);
}

void ContactState::removeObstacle(Index obstacle) {
  const auto eraseOf = [obstacle](auto &perObstacle) {
    if (obstacle < perObstacle.size()) perObstacle.erase(perObstacle.begin() + obstacle);
  };
  eraseOf(clearance);
  eraseOf(lastOutside);
  const auto eraseContacts = [obstacle](std::vector<Contact> &contacts) {
    std::erase_if(contacts, [obstacle](const Contact &contact) { return contact.obstacle == obstacle; });
    for (Contact &contact : contacts)
      if (contact.obstacle != Contact::kWall && contact.obstacle > obstacle) --contact.obstacle;
  };
  eraseContacts(active);
  eraseContacts(previous);
  sums = ContactSums();
  stageForceSums = ContactSums();
  blocks = Blocks();
}

void findContacts(std::span<const Obstacle> obstacles, const WorldBox &box, double time, double dt, double margin,
                  std::span<const Vec3> positions, std::span<const Vec3> velocities, std::span<const double> radii,
                  ContactState &memory, const ParallelFor &parallelFor) {
  searchContacts(obstacles, box, time, dt, margin, positions.size(), {{}, positions, velocities, radii}, memory,
                 parallelFor);
}

}  // namespace pointbased
