// SPDX-License-Identifier: Apache-2.0
#include "pointbased/contact.h"

#include <algorithm>
#include <cmath>

#include "contact/contact_search.h"

namespace pointbased {

using namespace detail;

namespace {

using ClearanceCache = ContactState::ClearanceCache;
using Side = ContactState::Side;

// Search distance of obstacles, in margins and in multiples of the travel of a step, at least twice the travel since
// the last query. Larger: queries cost more and are less frequent.
constexpr double kReachMargins = 40.0;
constexpr double kReachWays = 3.0;
// Margins: a plane is reused while the point stays that close to its query. Larger: fewer queries, larger error.
constexpr double kSamePlane = 0.25;
// Margins: a point that travels less in a step is at rest, no crossing is searched. Larger: more points count as at
// rest.
constexpr double kRest = 1e-3;
// Margins: points up to this depth may slide along an obstacle, deeper ones return to where they entered. Larger: more
// slide.
constexpr double kFollow = 50.0;

// One obstacle during one step.
struct Step {
  const Obstacle &obstacle;
  bool moves;
  RigidMotion now, then;
  double dt, margin;

  // World to the rest frame of the obstacle at the beginning of the step, and the relative displacement in that frame.
  [[nodiscard]] Vec3 local(const Vec3 &x) const { return moves ? toRest(now, x) : x; }
  [[nodiscard]] Vec3 way(const Vec3 &x, const Vec3 &at, const Vec3 &velocity) const {
    return moves ? Vec3(toRest(then, x + dt * velocity) - at) : Vec3(dt * velocity);
  }
  [[nodiscard]] Vec3 surfaceVelocity(const Vec3 &at) const {
    return moves && dt > 0.0 ? Vec3((then.displacementOf(at) - now.displacementOf(at)) / dt) : Vec3(Vec3::Zero());
  }
  // First side of the obstacle on a segment; its normal is turned against the direction of travel.
  [[nodiscard]] bool meets(const Vec3 &from, const Vec3 &to, Vec3 &normal, double &offset) const {
    if (!obstacle.crossing || from == to) return false;
    const double t = obstacle.crossing(from, to, normal);
    if (!(t >= 0.0)) return false;
    if (normal.dot(to - from) > 0.0) normal = -normal;
    offset = normal.dot(from + t * (to - from));
    return true;
  }
};

// Whether no contact is possible, the stored result is still valid, or a new query is necessary.
enum class Need { nothing, known, ask };

Need needOf(const ClearanceCache &known, const Vec3 &at, double way, double radius, double margin) {
  if (known.reach < 0.0) return Need::ask;
  const double moved = (at - known.at).norm();
  // NaN causes a query as well; the guard detects it later.
  if (std::min(known.distance, known.reach) - radius - margin - moved > way) return Need::nothing;
  return moved <= kSamePlane * margin && moved + way <= known.swept ? Need::known : Need::ask;
}

// Stores the answer of a query for a point: its plane, the side on which it is, and the surface it will cross.
void learn(const Step &step, const Vec3 &at, const Vec3 &way, double radius, const SurfacePoint &answer, double reach,
           ClearanceCache &known, Side &side) {
  const double margin = step.margin;
  known.at = at;
  known.reach = reach;
  known.distance = answer.distance;
  known.normal = answer.normal;
  known.ahead = false;
  double offset = 0.0;
  Vec3 normal;
  if (side.known && step.meets(side.place, at, normal, offset)) {
    known.normal = normal;
    known.distance = normal.dot(at) - offset;
    const Vec3 beside = at + (margin - known.distance) * normal;
    Vec3 other;
    if (known.distance > -kFollow * margin && !step.meets(side.place, beside, other, offset)) side.place = beside;
  } else if (known.distance >= -margin) {
    side.known = true;
    side.place = at;
    if (known.distance < margin) side.place += (margin - known.distance) * known.normal;
  }

  const double length = way.norm();
  known.swept = length + 0.5 * margin;
  if (!(length > kRest * margin) || (!side.known && known.distance < -margin)) return;
  // A point in contact is followed at a margin above the surface, so that the surface does not hide what stands on it.
  const bool touching = known.distance - radius <= margin;
  Vec3 from = at, along = way;
  if (touching) {
    from += std::max(0.0, margin - known.distance) * known.normal;
    along -= std::min(0.0, way.dot(known.normal)) * known.normal;
  }
  const double left = along.norm();
  if (!(left > kRest * margin)) return;
  if (!step.meets(from, from + along * ((left + radius + margin) / left), normal, offset)) return;
  if (touching && normal.dot(known.normal) > kSameSide) return;
  known.ahead = true;
  known.aheadNormal = normal;
  known.aheadOffset = offset;
}

bool before(const Contact &a, const Contact &b) {
  return a.point != b.point ? a.point < b.point : a.obstacle < b.obstacle;
}

// Carries the impulses of persisting contacts over.
void carryImpulsesOver(ContactState &memory) {
  std::size_t from = 0;
  for (Contact &contact : memory.active) {
    while (from < memory.previous.size() && before(memory.previous[from], contact)) ++from;
    bool goesOn = false;
    for (std::size_t k = from; k < memory.previous.size() && !before(contact, memory.previous[k]); ++k) {
      const Contact &was = memory.previous[k];
      if (!remember(was, contact)) continue;
      goesOn = true;
      contact.initialPenetration = std::clamp(-contact.gap, 0.0, was.initialPenetration);
      break;
    }
    if (!goesOn) contact.initialPenetration = std::max(0.0, -contact.gap);
  }
}

void addWalls(const WorldBox &box, double dt, double margin, const Looked &looked, std::vector<Contact> &active) {
  const auto add = [&](std::size_t k, const Vec3 &normal, double gap) {
    if (gap > margin + std::max(0.0, -looked.velocities[k].dot(normal)) * dt) return;
    Contact contact;
    contact.point = looked.point(k);
    contact.normal = normal;
    contact.gap = gap;
    contact.friction = box.friction;
    contact.restitution = box.restitution;
    contact.obstacle = Contact::kWall;
    contact.place = looked.positions[k];
    active.push_back(contact);
  };
  for (std::size_t k = 0; k < looked.count(); ++k) {
    const double radius = looked.radius(k);
    for (int axis = 0; axis < 3; ++axis) {
      add(k, Vec3::Unit(axis), looked.positions[k][axis] - box.min[axis] - radius);
      add(k, -Vec3::Unit(axis), box.max[axis] - looked.positions[k][axis] - radius);
    }
  }
}

Step stepOf(const Obstacle &obstacle, double time, double dt, double margin) {
  const bool moves = static_cast<bool>(obstacle.motion);
  return {obstacle,
          moves,
          moves ? obstacle.motion(time) : RigidMotion{},
          moves ? obstacle.motion(time + dt) : RigidMotion{},
          dt,
          margin};
}

/// Search for contacts with one obstacle.
class ObstacleSearch {
 public:
  ObstacleSearch(const Obstacle &obstacle, std::size_t number, const Step &step, const Looked &looked,
                 std::size_t count, ContactState &memory)
      : obstacle_(obstacle), number_(static_cast<Index>(number)), step_(step), looked_(looked),
        clearance_(memory.clearance[number]), sides_(memory.sides[number]), ask_(memory.questions),
        active_(memory.active) {
    if (clearance_.size() != count) clearance_.assign(count, ClearanceCache());
    if (sides_.size() != count) sides_.assign(count, Side());
  }

  void run(const ParallelFor &parallelFor) {
    collectQuestions();
    if (!ask_.points.empty()) answerQuestions(parallelFor);
    for (const Index k : ask_.candidates) addContacts(k);
  }

 private:
  void collectQuestions() {
    ask_.points.clear();
    ask_.candidates.clear();
    ask_.positions.clear();
    ask_.ways.clear();
    ask_.ranges.clear();
    for (std::size_t k = 0; k < looked_.count(); ++k) {
      if (!obstacle_.actsOn(looked_.point(k))) continue;
      const ClearanceCache &known = clearance_[looked_.point(k)];
      const Vec3 at = step_.local(looked_.positions[k]);
      const Vec3 way = step_.way(looked_.positions[k], at, looked_.velocities[k]);
      const double length = way.norm();
      const Need need = needOf(known, at, length, looked_.radius(k), step_.margin);
      if (need == Need::nothing) continue;
      ask_.candidates.push_back(static_cast<Index>(k));
      if (need == Need::known) continue;
      ask_.points.push_back(static_cast<Index>(k));
      ask_.positions.push_back(at);
      ask_.ways.push_back(way);
      // Unlimited for the first query and from inside, so that deep penetration is detected. The distance grows to
      // twice the travel if a point has moved far without contact.
      const bool unlimited = known.reach < 0.0 || known.distance < 0.0;
      ask_.ranges.push_back(unlimited ? std::numeric_limits<double>::infinity()
                                      : looked_.radius(k) + std::max({kReachMargins * step_.margin, kReachWays * length,
                                                                      2.0 * (at - known.at).norm()}));
    }
  }

  void answerQuestions(const ParallelFor &parallelFor) {
    ask_.answers.assign(ask_.points.size(), SurfacePoint());
    parallelFor(ask_.points.size(), 16, [&](std::size_t begin, std::size_t end) {
      obstacle_.closest(std::span<const Vec3>(ask_.positions).subspan(begin, end - begin),
                        std::span<const double>(ask_.ranges).subspan(begin, end - begin),
                        std::span<SurfacePoint>(ask_.answers).subspan(begin, end - begin));
      for (std::size_t k = begin; k < end; ++k) {
        const Index p = looked_.point(ask_.points[k]);
        learn(step_, ask_.positions[k], ask_.ways[k], looked_.radius(ask_.points[k]), ask_.answers[k], ask_.ranges[k],
              clearance_[p], sides_[p]);
      }
    });
  }

  void addContacts(Index k) {
    const double margin = step_.margin;
    const ClearanceCache &known = clearance_[looked_.point(k)];
    const Vec3 at = step_.local(looked_.positions[k]);
    const double length = step_.way(looked_.positions[k], at, looked_.velocities[k]).norm();
    // NaN passes through for the guard to detect.
    if (!(known.distance == std::numeric_limits<double>::infinity())) {
      const double gap = known.distance + known.normal.dot(at - known.at) - looked_.radius(k);
      // Without crossing queries the plane has to cover all that is in reach.
      if (!(gap > (obstacle_.crossing ? margin : length + margin))) add(k, at, known.normal, gap);
    }
    if (known.ahead) {
      const double gap = known.aheadNormal.dot(at) - known.aheadOffset - looked_.radius(k);
      if (!(gap > length + margin)) add(k, at, known.aheadNormal, gap);
    }
  }

  void add(Index k, const Vec3 &at, const Vec3 &normal, double gap) {
    Contact contact;
    contact.point = looked_.point(k);
    contact.normal = step_.moves ? Vec3(step_.now.rotation * normal) : normal;
    contact.gap = gap;
    contact.surfaceVelocity = step_.surfaceVelocity(at);
    contact.friction = obstacle_.friction;
    contact.restitution = obstacle_.restitution;
    contact.obstacle = number_;
    contact.place = looked_.positions[k];
    active_.push_back(contact);
  }

  const Obstacle &obstacle_;
  Index number_;
  const Step &step_;
  const Looked &looked_;
  std::vector<ClearanceCache> &clearance_;
  std::vector<Side> &sides_;
  ContactState::ClosestPointQueries &ask_;
  std::vector<Contact> &active_;
};

}  // namespace

void detail::searchContacts(std::span<const Obstacle> obstacles, const WorldBox &box, double time, double dt,
                            double margin, std::size_t count, const Looked &looked, ContactState &memory,
                            const ParallelFor &parallelFor) {
  std::swap(memory.previous, memory.active);
  memory.active.clear();
  memory.margin = margin;
  memory.clearance.resize(obstacles.size());
  memory.sides.resize(obstacles.size());
  memory.lookedAt = time;
  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    if (!obstacles[o].closest) {
      memory.clearance[o].clear();
      memory.sides[o].clear();
      continue;
    }
    ObstacleSearch(obstacles[o], o, stepOf(obstacles[o], time, dt, margin), looked, count, memory).run(parallelFor);
  }
  if (box.enabled) addWalls(box, dt, margin, looked, memory.active);

  // std::stable_sort allocates memory; with one obstacle the contacts are sorted already.
  if (!std::is_sorted(memory.active.begin(), memory.active.end(), before))
    std::stable_sort(memory.active.begin(), memory.active.end(), before);
  for (const Contact &contact : memory.active) memory.deepest = std::max(memory.deepest, -contact.gap);
  carryImpulsesOver(memory);
}

void ContactState::forget(Index obstacle) {
  const auto eraseOf = [obstacle](auto &perObstacle) {
    if (obstacle < perObstacle.size()) perObstacle.erase(perObstacle.begin() + obstacle);
  };
  eraseOf(clearance);
  eraseOf(sides);
  const auto eraseContacts = [obstacle](std::vector<Contact> &contacts) {
    std::erase_if(contacts, [obstacle](const Contact &contact) { return contact.obstacle == obstacle; });
    for (Contact &contact : contacts)
      if (contact.obstacle != Contact::kWall && contact.obstacle > obstacle) --contact.obstacle;
  };
  eraseContacts(active);
  eraseContacts(previous);
  sums = ContactSums();
  stageForces = ContactSums();
  blocks = Blocks();
}

void findContacts(std::span<const Obstacle> obstacles, const WorldBox &box, double time, double dt, double margin,
                  std::span<const Vec3> positions, std::span<const Vec3> velocities, std::span<const double> radii,
                  ContactState &memory, const ParallelFor &parallelFor) {
  searchContacts(obstacles, box, time, dt, margin, positions.size(), {{}, positions, velocities, radii}, memory,
                 parallelFor);
}

}  // namespace pointbased
