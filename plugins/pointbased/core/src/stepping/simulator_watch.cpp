// SPDX-License-Identifier: Apache-2.0
// Periodic checks for defects that are not prevented and for high costs, reported as events.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/number_text.h"
#include "pointbased/simulator.h"
#include "stepping/body_stepper.h"
#include "stepping/rigid_tissue.h"
#include "stepping/skin_contacts.h"
#include "stepping/skin_watch.h"
#include "stepping/start_overlap.h"

namespace pointbased {
namespace {

using detail::number;

// Steps between two checks. A check costs about as much as a few explicit steps, and less than one implicit step. Where
// explicit steps are long, at least one check in a sixtieth of a second, if that is not too often.
constexpr std::uint64_t kExplicitSteps = 128, kFewestExplicitSteps = 32, kOtherSteps = 4;
constexpr double kTimeOfLook = 1.0 / 60.0;  // s
// Fraction of the spacing: smaller overlaps result from label maps and the planes of nearest points.
constexpr double kMinOverlap = 0.1;
// Fraction of the spacing: cubes with flush sides separate from one spacing of overlap, and lock each other at one and
// a half.
constexpr double kDeepOverlap = 1.0;
// Fraction of the mass of a body inside another one at the start: contact separates less.
constexpr double kMaxOfBody = 0.6;
// Contact points per phyxel and step that are checked for overlap: one costs about as much as three phyxels of a step.
constexpr double kPointsOfLook = 1.0 / 64.0;
// Fraction of the spacing: edges between contact points penetrate less.
constexpr double kSkinThrough = 0.5;
// Fraction of the spacing, of soft tissue in rigid tissue: half of the distance between contact points. The skin
// between them may penetrate this far where cells bend; deeper penetration is not due to the spacing of contact points.
constexpr double kInRigidTissue = 0.25;

std::string millimetres(double metres) { return number(1e3 * metres, 3) + " mm"; }

}  // namespace

double Simulator::skinDepth(std::size_t id) const {
  const Body *target = body(id);
  if (!target) return 0.0;
  std::vector<Vec3> skin;
  const auto told = [id](const std::map<std::size_t, double> &depths) {
    const auto found = depths.find(id);
    return found == depths.end() ? 0.0 : found->second;
  };
  const double inRigid = ownObstacleCount(id) > 0 ? detail::depthInRigidTissue(*target, skin, parallelFor_) : 0.0;
  return std::max({target->contact.deepest, told(skinDeepest_), told(rigidDeepest_), inRigid,
                   depthOfPassage(*target, surroundingsOf(id), clockOfRamps(), parallelFor_),
                   pointbased::skinDepth(*target, obstaclesOf(id), boxOf(id), clockOfRamps(), skin, parallelFor_)});
}

double Simulator::costOf(std::size_t id) const {
  const auto found = spent_.find(id);
  return found == spent_.end() || !(advanced_ > 0.0) ? 0.0 : found->second / advanced_;
}

std::uint64_t Simulator::skinCheckInterval() const {
  const bool isExplicit = std::any_of(bodies_.begin(), bodies_.end(), [this](const auto &entry) {
    return entry.second->integratorIn(world_) == Integrator::explicitVerlet;
  });
  if (!isExplicit) return kOtherSteps;
  return static_cast<std::uint64_t>(std::clamp(std::ceil(kTimeOfLook / stepSize()),
                                               static_cast<double>(kFewestExplicitSteps),
                                               static_cast<double>(kExplicitSteps)));
}

bool Simulator::isSkinCheckDue() const { return steps_ == 0 || steps_ % skinCheckInterval() == 0 || finished(); }

void Simulator::checkSkins() {
  if (world_.box.enabled)
    for (const auto &[id, stepper] : bodies_) {
      const Body &body = stepper->body();
      // A skin with many points is checked less often, and not at all if the body has no contacts.
      const std::uint64_t every =
          kExplicitSteps * (1 + body.rest().surfels.count() / (16 * (1 + body.rest().pointCount())));
      if (stepper->asleep() || body.contact.active.empty() || (steps_ % every != 0 && steps_ % kExplicitSteps == 0))
        continue;
      const double depth = pointbased::skinDepth(body, {}, boxOf(id), clockOfRamps(), skin_, parallelFor_);
      reportPenetration(body, depth, kSkinThrough, skinDeepest_[id], "its skin reaches ", " through the world's box");
    }
  for (const auto &[id, tissues] : rigidTissues_) checkRigidTissue(id);
  checkPairOverlap();
  checkContacts();
}

void Simulator::checkRigidTissue(std::size_t id) {
  const detail::BodyStepper &stepper = *bodies_.at(id);
  const Body &body = stepper.body();
  if (ownObstacleCount(id) == 0 || stepper.asleep() || body.contact.active.empty()) return;
  const double depth = detail::depthInRigidTissue(body, skin_, parallelFor_);
  reportPenetration(body, depth, kInRigidTissue, rigidDeepest_[id], "soft tissue comes ", " into its rigid tissue,");
}

// Reports once, when the depth exceeds this number of spacings.
void Simulator::reportPenetration(const Body &body, double depth, double spacings, double &deepest, const char *what,
                                  const char *where) {
  const double spacing = body.rest().spacing, most = spacings * spacing;
  if (depth > most && deepest <= most)
    reportEvent("skin", "body '" + body.name() + "': " + what + millimetres(depth) + where +
                            " between the points where it feels contact; a smaller sampling.spacing (it is " +
                            millimetres(spacing) + ") helps");
  deepest = std::max(deepest, depth);
}

// All pairs at the start, and in implicit steps, which cost more; otherwise in turn, as many at a time as cost a few
// per cent of the steps in between.
void Simulator::checkPairOverlap() {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  double phyxels = 0.0;
  for (auto a = bodies_.begin(); a != bodies_.end(); ++a) {
    phyxels += static_cast<double>(a->second->body().rest().phyxelCount());
    for (auto b = std::next(a); b != bodies_.end(); ++b)
      if (!overlaps_.contains({a->first, b->first}) && !canTouch(a->first, b->first) &&
          !(a->second->asleep() && b->second->asleep()))
        pairs.emplace_back(a->first, b->first);
  }
  // Starts at the pair after the one that was checked last.
  std::rotate(pairs.begin(), std::upper_bound(pairs.begin(), pairs.end(), lastPair_), pairs.end());
  double left = steps_ == 0 || skinCheckInterval() == kOtherSteps
                    ? std::numeric_limits<double>::infinity()
                    : kPointsOfLook * phyxels * static_cast<double>(skinCheckInterval());
  for (const auto &pair : pairs) {
    if (!(left > 0.0)) break;
    lastPair_ = pair;
    const Body &first = bodies_.at(pair.first)->body(), &second = bodies_.at(pair.second)->body();
    const Overlap found = overlapOf(first, second);
    left -= static_cast<double>(found.looked);
    if (!(found.depth > kMinOverlap * std::min(first.rest().spacing, second.rest().spacing))) continue;
    overlaps_.insert(pair);
    reportEvent("overlap",
                "bodies '" + first.name() + "' and '" + second.name() + "' overlap " +
                    (steps_ == 0 ? "from the start" : "from here on") + ": " + millimetres(found.depth) +
                    " deep, some " + number(1e6 * found.volume, 2) + " ml; " +
                    (contactPair(pair.first, pair.second).enabled ? "a body without a surface touches no other body"
                                                                  : "contact between them is switched off"));
  }
}

// Reports overlaps at the beginning of contact, and those that contact has not prevented.
void Simulator::checkContacts() {
  for (const auto &[id, pair] : skins_->pairs()) {
    const double least = kMinOverlap * pair->spacing();
    if (!(std::max(pair->depth(), pair->allowed()) > least) || overlaps_.contains(id)) continue;
    overlaps_.insert(id);
    const std::string who =
        id.first == id.second ? "body '" + body(id.first)->name() + "' overlaps itself"
                              : "bodies '" + body(id.first)->name() + "' and '" + body(id.second)->name() + "' overlap";
    if (pair->allowed() > least && !(pair->settings().ease > 0.0))
      reportEvent("overlap", who + " up to " + millimetres(pair->allowed()) +
                                 " deep at the start; they fit each other, so that counts as touching");
    else if (pair->allowed() > least)
      reportEvent("overlap",
                  who + " " + millimetres(pair->allowed()) + " deep where they meet; it is led out at " +
                      millimetres(pair->settings().ease) + " a second" +
                      (pair->allowed() > kDeepOverlap * pair->spacing()
                           ? " at most, but what lies so deep may hold itself there: begin with bodies that are apart"
                           : ""));
    else
      reportEvent("overlap", who + " " + millimetres(pair->depth()) +
                                 " deep although they touch: contact does not hold what presses them together; a " +
                                 "smaller solver.dt or a stiffer material helps");
  }
}

void Simulator::reportUnresolvedThickness(std::size_t id, double thickness) {
  if (!overlaps_.insert({id, id}).second) return;
  reportEvent("warning",
              "body '" + body(id)->name() + "' does not touch itself: it is " + millimetres(thickness) +
                  " thick in the mean (twice its volume over its area; of a tube the radius), and cells of " +
                  millimetres(body(id)->rest().spacing) +
                  " do not tell its folds apart; with a sampling.spacing up to " +
                  millimetres(thickness / detail::SkinContacts::SelfContactBound::kThinnest) + " they would");
}

void Simulator::reportInitialWarnings(const detail::StepContext &context) {
  if (initialWarningsReported_) return;
  initialWarningsReported_ = true;
  reportLostRestitution();
  checkInitialState(context);
}

// Reports overlaps, and stops bodies that contact cannot separate from what they overlap.
void Simulator::checkInitialState(const detail::StepContext &context) {
  detail::SkinContacts skins;
  const auto skinOf = [&](std::size_t id) -> detail::MovingSkin * {
    const Body &body = bodies_.at(id)->body();
    if (!detail::SkinContacts::hasSkin(body)) return nullptr;
    detail::MovingSkin &skin = skins.skinOf(detail::SkinContacts::ownerOf(id, body, contactPairs_));
    skin.move(body.state().displacements, body.state().velocities, body.rest().maxInfluence, 0.0);
    skin.placeAll();
    return &skin;
  };
  for (auto &[id, stepper] : bodies_) {
    const std::span<const Obstacle> obstacles = obstaclesOf(id);
    Body &body = stepper->body();
    if (body.isStatic()) continue;
    for (std::size_t o = 0; o < obstacles.size() && !stepper->stopped(); ++o) {
      if (instruments_.contains(obstacleIds_[o])) continue;
      const detail::ObstacleOverlap found = detail::overlapWith(
          obstacles[o], obstacleMotion(obstacleIds_[o]), body, [&, of = id] { return skinOf(of); }, parallelFor_);
      if (!(found.depth > kMinOverlap * body.rest().spacing)) continue;
      const std::string &name = obstacles[o].name;
      if (found.isEnclosed) {
        const double way = found.way.norm();
        const Vec3 along = way > 0.0 ? Vec3(found.way / way) : Vec3(Vec3::Zero());
        stepper->stop(context, {found.phyxel,
                                "obstacle '" + name + "' begins " + millimetres(found.depth) +
                                    " deep in it, where contact cannot separate them",
                                "to begin with '" + name + "' outside of the body, at least " + millimetres(way) +
                                    " along (" + number(along[0], 2) + ", " + number(along[1], 2) + ", " +
                                    number(along[2], 2) + "), or to switch contact of the pair off"});
        continue;
      }
      std::vector<std::vector<ContactState::Side>> &sides = body.contact.sides;
      const std::size_t own = ownObstacleCount(id) + o;
      if (!found.led.empty()) {
        sides.resize(std::max(sides.size(), surroundingsOf(id).size()));
        sides[own].assign(body.rest().contact.count(), ContactState::Side());
      }
      for (const detail::ObstacleOverlap::Led &led : found.led) sides[own][led.point] = {led.place, true};
      reportEvent("overlap", "body '" + body.name() + "' and obstacle '" + name + "' overlap " +
                                 millimetres(found.depth) +
                                 " deep at the start; contact leads the body out at 100 mm a second at most. Begin "
                                 "with them apart where that motion is not wanted");
    }
  }
  for (auto a = bodies_.begin(); a != bodies_.end(); ++a)
    for (auto b = std::next(a); b != bodies_.end(); ++b) {
      Body &first = a->second->body(), &second = b->second->body();
      if ((first.isStatic() && second.isStatic()) || !canTouch(a->first, b->first) ||
          contactPair(a->first, b->first).fits)
        continue;
      if (!detail::boundsOf(first).meets(detail::boundsOf(second))) continue;
      const detail::BodyOverlap found = detail::overlapBetween(first, *skinOf(a->first), second, *skinOf(b->first));
      if (!(found.part > kMaxOfBody)) continue;
      for (const auto &[stepper, other] : {std::pair(a->second.get(), &second), std::pair(b->second.get(), &first)})
        if (!stepper->body().isStatic() && !stepper->stopped())
          stepper->stop(context, {0,
                                  "body '" + other->name() + "' begins in the same place: " +
                                      number(100.0 * found.part, 2) + " % of one lie in the other, up to " +
                                      millimetres(found.depth) + " deep, where contact cannot separate them",
                                  "to begin with bodies that are apart, or to switch contact of the pair off"});
    }
}

void Simulator::reportLostRestitution() {
  const bool bounces =
      (world_.box.enabled && world_.box.restitution > 0.0) ||
      std::any_of(obstacles_.begin(), obstacles_.end(), [](const Obstacle &o) { return o.restitution > 0.0; });
  if (!bounces) return;
  for (const auto &[id, stepper] : bodies_)
    if (!stepper->body().isStatic() && stepper->integratorIn(world_) != Integrator::explicitVerlet)
      reportEvent("warning", "body '" + stepper->body().name() +
                                 "' does not bounce: restitution counts in explicit steps alone, and it is " +
                                 (quasiStatic() ? "solved quasi-statically"
                                                : "integrated implicitly; solver.integrator = \"explicit\" has it"));
}

}  // namespace pointbased
