// SPDX-License-Identifier: Apache-2.0
#include "stepping/simulation/step_monitor.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/number_text.h"
#include "stepping/monitoring/rigid_tissue.h"
#include "stepping/monitoring/skin_watch.h"
#include "stepping/monitoring/start_overlap.h"

namespace pointbased::detail {
namespace {

// Steps between two checks. A check costs about as much as a few explicit steps, and less than one implicit step. Where
// explicit steps are long, at least one check in a sixtieth of a second, if that is not too often.
constexpr std::uint64_t kExplicitSteps = 128, kFewestExplicitSteps = 32, kOtherSteps = 4;
constexpr double kCheckInterval = 1.0 / 60.0;  // s
// Fraction of the spacing: smaller overlaps result from label maps and the planes of nearest points.
constexpr double kMinOverlap = 0.1;
// Fraction of the spacing: cubes with flush sides separate from one spacing of overlap, and lock each other at one and
// a half.
constexpr double kDeepOverlap = 1.0;
// Fraction of the mass of a body inside another one at the start: contact separates less.
constexpr double kMaxOfBody = 0.6;
// Contact points per phyxel and step that are checked for overlap: one costs about as much as three phyxels of a step.
constexpr double kCheckedPointsPerPhyxel = 1.0 / 64.0;
// Fraction of the spacing: edges between contact points penetrate less.
constexpr double kSkinThrough = 0.5;
// Fraction of the spacing, of soft tissue in rigid tissue: half of the distance between contact points. The skin
// between them may penetrate this far where cells bend; deeper penetration is not due to the spacing of contact points.
constexpr double kInRigidTissue = 0.25;

std::string millimetres(double metres) { return number(1e3 * metres, 3) + " mm"; }

}  // namespace

std::uint64_t StepMonitor::skinCheckInterval() const {
  const bool isExplicit = std::any_of(state_.bodies.begin(), state_.bodies.end(), [this](const auto &entry) {
    return entry.second->integratorIn(state_.settings) == Integrator::explicitVerlet;
  });
  if (!isExplicit) return kOtherSteps;
  return static_cast<std::uint64_t>(std::clamp(std::ceil(kCheckInterval / state_.stepSize()),
                                               static_cast<double>(kFewestExplicitSteps),
                                               static_cast<double>(kExplicitSteps)));
}

bool StepMonitor::isSkinCheckDue() const {
  return state_.progress.steps == 0 || state_.progress.steps % skinCheckInterval() == 0 || state_.finished();
}

void StepMonitor::checkSkins() {
  if (state_.settings.box.enabled)
    for (const auto &[id, stepper] : state_.bodies) {
      const Body &body = stepper->body();
      // A skin with many points is checked less often, and not at all if the body has no contacts.
      const std::uint64_t interval =
          kExplicitSteps * (1 + body.rest().surfels.count() / (16 * (1 + body.rest().pointCount())));
      if (stepper->asleep() || body.contact.active.empty() ||
          (state_.progress.steps % interval != 0 && state_.progress.steps % kExplicitSteps == 0))
        continue;
      const double depth =
          pointbased::skinDepth(body, {}, world_.boxOf(id), state_.rampTime(), skin_, state_.parallelFor);
      reportPenetration(body, depth, kSkinThrough, state_.reported.skinDeepest[id], "its skin reaches ",
                        " through the world's box");
    }
  for (const auto &[id, tissues] : state_.contact.rigidTissues) checkRigidTissue(id);
  checkPairOverlap();
  checkContacts();
}

void StepMonitor::checkRigidTissue(std::size_t id) {
  const BodyStepper &stepper = *state_.bodies.at(id);
  const Body &body = stepper.body();
  if (state_.ownObstacleCount(id) == 0 || stepper.asleep() || body.contact.active.empty()) return;
  const double depth = depthInRigidTissue(body, skin_, state_.parallelFor);
  reportPenetration(body, depth, kInRigidTissue, state_.reported.rigidDeepest[id], "soft tissue comes ",
                    " into its rigid tissue,");
}

// Reports once, when the depth exceeds this number of spacings.
void StepMonitor::reportPenetration(const Body &body, double depth, double spacings, double &deepest, const char *what,
                                    const char *where) {
  const double spacing = body.rest().spacing, limit = spacings * spacing;
  if (depth > limit && deepest <= limit)
    state_.reportEvent("skin", "body '" + body.name() + "': " + what + millimetres(depth) + where +
                                   " between its contact points; a smaller sampling.spacing (it is " +
                                   millimetres(spacing) + ") helps");
  deepest = std::max(deepest, depth);
}

// All pairs at the start, and in implicit steps, which cost more; otherwise in turn, as many at a time as cost a few
// per cent of the steps in between.
void StepMonitor::checkPairOverlap() {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  double phyxels = 0.0;
  for (auto a = state_.bodies.begin(); a != state_.bodies.end(); ++a) {
    phyxels += static_cast<double>(a->second->body().rest().phyxelCount());
    for (auto b = std::next(a); b != state_.bodies.end(); ++b)
      if (!state_.reported.overlaps.contains({a->first, b->first}) && !world_.canTouch(a->first, b->first) &&
          !(a->second->asleep() && b->second->asleep()))
        pairs.emplace_back(a->first, b->first);
  }
  // Starts at the pair after the one that was checked last.
  std::rotate(pairs.begin(), std::upper_bound(pairs.begin(), pairs.end(), state_.reported.lastPair), pairs.end());
  double remaining = state_.progress.steps == 0 || skinCheckInterval() == kOtherSteps
                         ? std::numeric_limits<double>::infinity()
                         : kCheckedPointsPerPhyxel * phyxels * static_cast<double>(skinCheckInterval());
  for (const auto &pair : pairs) {
    if (!(remaining > 0.0)) break;
    state_.reported.lastPair = pair;
    const Body &first = state_.bodies.at(pair.first)->body(), &second = state_.bodies.at(pair.second)->body();
    const Overlap found = overlapOf(first, second);
    remaining -= static_cast<double>(found.checkedPoints);
    if (!(found.depth > kMinOverlap * std::min(first.rest().spacing, second.rest().spacing))) continue;
    state_.reported.overlaps.insert(pair);
    state_.reportEvent(
        "overlap",
        "bodies '" + first.name() + "' and '" + second.name() + "' overlap " +
            (state_.progress.steps == 0 ? "from the start" : "from here on") + ": " + millimetres(found.depth) +
            " deep, some " + number(1e6 * found.volume, 2) + " ml; " +
            (state_.contactPair(pair.first, pair.second).enabled ? "a body without a surface touches no other body"
                                                                 : "contact between them is switched off"));
  }
}

// Reports overlaps at the beginning of contact, and those that contact has not prevented.
void StepMonitor::checkContacts() {
  for (const auto &[id, pair] : state_.skins.pairs()) {
    const double least = kMinOverlap * pair->spacing();
    if (!(std::max(pair->depth(), pair->toleratedOverlap()) > least) || state_.reported.overlaps.contains(id)) continue;
    state_.reported.overlaps.insert(id);
    const std::string who = id.first == id.second ? "body '" + state_.body(id.first)->name() + "' overlaps itself"
                                                  : "bodies '" + state_.body(id.first)->name() + "' and '" +
                                                        state_.body(id.second)->name() + "' overlap";
    if (pair->toleratedOverlap() > least && !(pair->settings().recoverySpeed > 0.0))
      state_.reportEvent("overlap", who + " up to " + millimetres(pair->toleratedOverlap()) +
                                        " deep at the start; they fit each other, so that counts as touching");
    else if (pair->toleratedOverlap() > least)
      state_.reportEvent(
          "overlap", who + " " + millimetres(pair->toleratedOverlap()) + " deep where they meet; it is removed at " +
                         millimetres(pair->settings().recoverySpeed) + " a second" +
                         (pair->toleratedOverlap() > kDeepOverlap * pair->spacing()
                              ? " at most, but an overlap this deep may persist: begin with bodies that do not overlap"
                              : ""));
    else
      state_.reportEvent("overlap",
                         who + " " + millimetres(pair->depth()) +
                             " deep although they touch: contact does not hold what presses them together; a " +
                             "smaller solver.dt or a stiffer material helps");
  }
}

void StepMonitor::reportUnresolvedThickness(std::size_t id, double thickness) {
  if (!state_.reported.overlaps.insert({id, id}).second) return;
  state_.reportEvent("warning",
                     "body '" + state_.body(id)->name() + "' does not touch itself: it is " + millimetres(thickness) +
                         " thick in the mean (twice its volume over its area; of a tube the radius), and cells of " +
                         millimetres(state_.body(id)->rest().spacing) +
                         " do not tell its folds apart; with a sampling.spacing up to " +
                         millimetres(thickness / SkinContacts::SelfContactBound::kMinThickness) + " they would");
}

void StepMonitor::reportInitialWarnings(const StepContext &context) {
  if (state_.initialWarningsReported) return;
  state_.initialWarningsReported = true;
  reportLostRestitution();
  checkInitialState(context);
}

// Reports overlaps, and stops bodies that contact cannot separate from what they overlap.
void StepMonitor::checkInitialState(const StepContext &context) {
  SkinContacts skins;
  const auto skinOf = [&](std::size_t id) -> MovingSkin * {
    const Body &body = state_.bodies.at(id)->body();
    if (!SkinContacts::hasSkin(body)) return nullptr;
    MovingSkin &skin = skins.skinOf(SkinContacts::ownerOf(id, body, state_.contact.pairs));
    skin.move(body.state().displacements, body.state().velocities, body.rest().maxInfluence, 0.0);
    skin.refitTree();
    return &skin;
  };
  for (auto &[id, stepper] : state_.bodies) {
    const std::span<const Obstacle> obstacles = world_.obstaclesOf(id);
    Body &body = stepper->body();
    if (body.isStatic()) continue;
    for (std::size_t o = 0; o < obstacles.size() && !stepper->stopped(); ++o) {
      if (state_.obstacles.instruments.contains(state_.obstacles.ids[o])) continue;
      const ObstacleOverlap found = overlapWith(
          obstacles[o], world_.obstacleMotion(state_.obstacles.ids[o]), body, [&, of = id] { return skinOf(of); },
          state_.parallelFor);
      if (!(found.depth > kMinOverlap * body.rest().spacing)) continue;
      const std::string &name = obstacles[o].name;
      if (found.isEnclosed) {
        const double distance = found.escape.norm();
        const Vec3 direction = distance > 0.0 ? Vec3(found.escape / distance) : Vec3(Vec3::Zero());
        stepper->stop(context, {found.phyxel,
                                "obstacle '" + name + "' begins " + millimetres(found.depth) +
                                    " deep in it, where contact cannot separate them",
                                "to begin with '" + name + "' outside of the body, at least " + millimetres(distance) +
                                    " along (" + number(direction[0], 2) + ", " + number(direction[1], 2) + ", " +
                                    number(direction[2], 2) + "), or to switch contact of the pair off"});
        continue;
      }
      std::vector<std::vector<ContactState::LastOutside>> &lastOutside = body.contact.lastOutside;
      const std::size_t own = state_.ownObstacleCount(id) + o;
      if (!found.redirected.empty()) {
        lastOutside.resize(std::max(lastOutside.size(), state_.surroundingsOf(id).size()));
        lastOutside[own].assign(body.rest().contact.count(), ContactState::LastOutside());
      }
      for (const ObstacleOverlap::RedirectedPoint &redirected : found.redirected)
        lastOutside[own][redirected.point] = {redirected.position, true};
      state_.reportEvent("overlap",
                         "body '" + body.name() + "' and obstacle '" + name + "' overlap " + millimetres(found.depth) +
                             " deep at the start; contact leads the body out at 100 mm a second at most. Begin "
                             "with them apart where that motion is not wanted");
    }
  }
  for (auto a = state_.bodies.begin(); a != state_.bodies.end(); ++a)
    for (auto b = std::next(a); b != state_.bodies.end(); ++b) {
      Body &first = a->second->body(), &second = b->second->body();
      if ((first.isStatic() && second.isStatic()) || !world_.canTouch(a->first, b->first) ||
          state_.contactPair(a->first, b->first).fits)
        continue;
      if (!boundsOf(first).overlaps(boundsOf(second))) continue;
      const BodyOverlap found = overlapBetween(first, *skinOf(a->first), second, *skinOf(b->first));
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

void StepMonitor::reportLostRestitution() {
  const bool bounces = (state_.settings.box.enabled && state_.settings.box.restitution > 0.0) ||
                       std::any_of(state_.obstacles.all.begin(), state_.obstacles.all.end(),
                                   [](const Obstacle &o) { return o.restitution > 0.0; });
  if (!bounces) return;
  for (const auto &[id, stepper] : state_.bodies)
    if (!stepper->body().isStatic() && stepper->integratorIn(state_.settings) != Integrator::explicitVerlet)
      state_.reportEvent("warning",
                         "body '" + stepper->body().name() +
                             "' does not bounce: restitution counts in explicit steps alone, and it is " +
                             (state_.quasiStatic() ? "solved quasi-statically"
                                                   : "integrated implicitly; solver.integrator = \"explicit\" has it"));
}

void StepMonitor::reportTornAttachments() {
  for (const auto &[id, layer] : state_.attachments) {
    if (layer->torn().empty() || state_.reported.torn.contains(id)) continue;
    state_.reported.torn.insert(id);
    state_.reportEvent("torn", "attachment '" + layer->settings().name +
                                   "' has begun to tear: it pulls with more than " + number(layer->settings().tearsAt) +
                                   " Pa");
  }
}

}  // namespace pointbased::detail
