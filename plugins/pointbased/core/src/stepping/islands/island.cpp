// SPDX-License-Identifier: Apache-2.0
#include "stepping/islands/island.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/number_text.h"
#include "stepping/monitoring/step_cost.h"

namespace pointbased::detail {
namespace {

constexpr double kStride = 0.25;  // spacings by which two bodies may approach each other in a substep

Vec3 meanVelocity(const Body &body) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3 &v : body.state().velocities) sum += v;
  return body.state().velocities.empty() ? sum : Vec3(sum / static_cast<double>(body.state().velocities.size()));
}

}  // namespace

void Island::clear() {
  members_.clear();
  pairs_.clear();
  layers_.clear();
}

void Island::markEnergyExchange() {
  std::uint64_t island = 0;
  if (members_.size() > 1 || !layers_.empty()) {
    island = layers_.size() + 1;
    for (const Member &member : members_) island = island * 1'000'003 + member.id + 1;
  }
  for (const Member &member : members_) member.stepper->setIsland(island);
}

double Island::advance(std::span<const StepContext> contexts, double span) {
  // Attachments to a moving obstacle keep the island awake, even without contact.
  const bool isGuided = std::any_of(layers_.begin(), layers_.end(), [&](const JoinedLayer &one) {
    return isMoving(one.layer->motion(), contexts.front().time, span);
  });
  bool remainsAsleep = !isGuided;
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (moves(k)) remainsAsleep = members_[k].stepper->remainsAsleep(contexts[k], span) && remainsAsleep;
  if (remainsAsleep) {
    for (const Member &member : members_) member.stepper->substeps().begin(contexts.front().dt);
    return span;
  }
  std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    BodyStepper &stepper = *members_[k].stepper;
    if (stepper.asleep()) stepper.wake();
    stepper.beginAdvance(contexts[k]);
    most = std::min(most, stepper.maxSubsteps());
  }
  chooseScheme(contexts);
  const double advanced = tryToAdvance(contexts, span, most);
  bool isAtRest = !isGuided;
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (moves(k)) isAtRest = members_[k].stepper->isAtRest(contexts[k], advanced) && isAtRest;
  if (isAtRest)
    for (std::size_t k = 0; k < members_.size(); ++k)
      if (moves(k)) members_[k].stepper->fallAsleep();
  return advanced;
}

void Island::chooseScheme(std::span<const StepContext> contexts) {
  scheme_ = integratorIn(contexts.front().world);
  BodyStepper *other = nullptr;  // first member that would use another one on its own
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    BodyStepper &stepper = *members_[k].stepper;
    stepper.setSharedIntegrator(scheme_);
    // A body whose own choice would differ uses the integrator of the island, which is a different event.
    if (stepper.integratorIn(contexts[k].world) == scheme_)
      stepper.reportIntegrator(contexts[k]);
    else if (!other)
      other = &stepper;
  }
  if (!other || scheme_ != Integrator::explicitVerlet) return;
  const BodyStepper *rigid = freeRigid();
  other->reportShared(contexts.front(), names(), rigid ? rigid->body().name() : std::string());
}

void Island::advanceAgain(std::span<const StepContext> contexts, double span) {
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    if (members_[k].stepper->asleep()) return;  // the state does not depend on the time
    members_[k].stepper->body().restoreState();
  }
  for (const JoinedLayer &joined : layers_) joined.layer->restoreTears();
  (void)tryToAdvance(contexts, span, std::numeric_limits<std::uint64_t>::max());
}

double Island::tryToAdvance(std::span<const StepContext> contexts, double span, std::uint64_t maxSubsteps) {
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (moves(k)) (void)members_[k].stepper->checkpointIfValid(contexts[k]);
  bool again = false;  // starting at the energy checkpoints
  while (true) {
    bool any = false;
    for (std::size_t k = 0; k < members_.size(); ++k) any = any || moves(k);
    if (!any) return span;
    Advance advanced = again ? repeatFromCheckpoints(contexts, span) : advanceOnce(contexts, span, maxSubsteps);
    if (advanced && contexts.front().number % kEnergyInterval == 0)
      contexts.front().environment.clock->measure(kGuard, [&] {
        std::optional<Refused> grown = checkEnergy(contexts, contexts.front().time + *advanced);
        if (!grown) return;
        advanced = tl::unexpected<Refused>(std::move(*grown));
        again = true;
      });
    if (advanced) {
      for (std::size_t k = 0; k < members_.size(); ++k)
        if (moves(k)) members_[k].stepper->endAdvance();
      return *advanced;
    }
    for (const JoinedLayer &joined : layers_) joined.layer->restoreTears();
    for (std::size_t k = 0; k < members_.size(); ++k)
      if (k != advanced.error().member && moves(k))
        members_[k].stepper->restoreStepStart(*contexts[k].environment.parallelFor);
    const std::size_t refused = advanced.error().member;
    (void)members_[refused].stepper->retryWithSmallerStep(
        contexts[refused], advanced.error().why,
        again ? "at " + number(members_[refused].stepper->energyCheckpoint()->time) + " s" : "before");
  }
}

Island::Advance Island::advanceOnce(std::span<const StepContext> contexts, double span, std::uint64_t maxSubsteps) {
  return scheme_ == Integrator::explicitVerlet ? advanceExplicit(contexts, span, maxSubsteps)
                                               : advanceImplicit(contexts, span, scheme_);
}

std::optional<double> Island::timeOfCheckpoints() const {
  std::optional<double> time;
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    const std::optional<BodyStepper::EnergyCheckpoint> &checkpoint = members_[k].stepper->energyCheckpoint();
    if (!checkpoint || (time && *time != checkpoint->time)) return std::nullopt;
    time = checkpoint->time;
  }
  return time;
}

std::optional<Island::Refused> Island::checkEnergy(std::span<const StepContext> contexts, double time) {
  const Vec3 &gravity = contexts.front().world.gravity;
  bool comparable = timeOfCheckpoints().has_value();
  for (const JoinedPair &joined : pairs_) comparable = !joined.pair->consumeOverlapReduction() && comparable;
  std::vector<EnergyLevel> levels(members_.size());
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    levels[k] = energyLevel(members_[k].stepper->body(), gravity);
    comparable = comparable && !members_[k].stepper->mayGainEnergy(contexts[k]);
  }
  for (std::size_t l = 0; l < layers_.size(); ++l) {
    const JoinedLayer &joined = layers_[l];
    comparable = comparable && !joined.layer->motion();
    levels[moves(joined.first) || joined.second == JoinedLayer::kNoBody ? joined.first : joined.second].total +=
        joined.layer->energy(attachedState(l, time));
  }
  EnergyLevel before, now;
  std::size_t worst = 0;
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    now.add(levels[k]);
    if (!comparable) continue;
    const EnergyLevel &known = members_[k].stepper->energyCheckpoint()->energy;
    before.add(known);
    if (levels[k].total - known.total > most) {
      most = levels[k].total - known.total;
      worst = k;
    }
  }
  Vec3 &depenetrationMoment = joint_.state().depenetrationMoment;
  now.depenetrationWork += std::max(0.0, -gravity.dot(depenetrationMoment));
  depenetrationMoment.setZero();
  for (std::size_t k = 0; k < members_.size(); ++k) members_[k].stepper->body().contact.depenetrationMoment.setZero();
  std::string grown = comparable ? energyGrowth(before, now) : std::string();
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    if (grown.empty())
      members_[k].stepper->setEnergyCheckpoint(time, levels[k]);
    else
      members_[k].stepper->restoreEnergyCheckpoint();
  }
  if (grown.empty()) return std::nullopt;
  return Refused{worst,
                 {{fullCheck(members_[worst].stepper->body()).fastestPhyxel, std::move(grown), kLessEnergy}, false}};
}

Island::Advance Island::repeatFromCheckpoints(std::span<const StepContext> contexts, double span) {
  const double end = contexts.front().time + span;
  std::vector<StepContext> pieces(contexts.begin(), contexts.end());
  double time = timeOfCheckpoints().value_or(contexts.front().time);
  while (end - time > 1e-9 * span) {
    const double left = std::min(contexts.front().dt, end - time);
    for (StepContext &piece : pieces) piece.time = time;
    if (const Advance advanced = advanceOnce(pieces, left, std::numeric_limits<std::uint64_t>::max()); !advanced)
      return advanced;
    time += left;
  }
  return span;
}

Island::Advance Island::maxSubstep(std::span<const StepContext> contexts, double time, double left) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    const BodyStepper::Advance stable = members_[k].stepper->maxSubstep(contexts[k], time, left, nullptr);
    if (!stable) return tl::unexpected<Refused>({k, stable.error()});
    least = std::min(least, *stable);
  }
  for (const JoinedLayer &joined : layers_) least /= 1.0 + joined.layer->stiffening();
  // An impact sets phyxels in relative motion that had the same velocity before.
  for (const JoinedPair &joined : pairs_) {
    if (joined.first == joined.second) continue;
    const Body &first = members_[joined.first].stepper->body(), &second = members_[joined.second].stepper->body();
    const double speed = (meanVelocity(first) - meanVelocity(second)).norm();
    if (speed > 0.0) least = std::min(least, kStride * std::min(first.rest().spacing, second.rest().spacing) / speed);
  }
  return least;
}

void Island::gatherSkins() {
  skins_.clear();
  for (JoinedPair &joined : pairs_)
    for (const auto &[side, k] : {std::pair(std::size_t{0}, joined.first), std::pair(std::size_t{1}, joined.second)}) {
      MovingSkin &skin = joined.pair->moving(side);
      if (std::none_of(skins_.begin(), skins_.end(), [&](const MovedSkin &one) { return one.skin == &skin; }))
        skins_.push_back({&skin, k});
    }
}

AttachmentLayer::AttachedState Island::attachedState(std::size_t layer, double time) const {
  const JoinedLayer &joined = layers_[layer];
  AttachmentLayer::AttachedState sides{members_[joined.first].stepper->body().state().displacements, {}, time};
  if (joined.second != JoinedLayer::kNoBody)
    sides.second = members_[joined.second].stepper->body().state().displacements;
  return sides;
}

void Island::addLayerForces(double time, bool onlyFresh) {
  const auto forcesOf = [&](std::size_t k) {
    const bool needsForces = k != JoinedLayer::kNoBody && moves(k) && (!onlyFresh || fresh_[k] != 0);
    return needsForces ? members_[k].stepper->body().forces() : std::span<Vec3>();
  };
  for (std::size_t l = 0; l < layers_.size(); ++l) {
    const JoinedLayer &joined = layers_[l];
    const std::span<Vec3> first = forcesOf(joined.first), second = forcesOf(joined.second);
    if (!first.empty() || !second.empty()) joined.layer->addForces(attachedState(l, time), first, second);
  }
}

bool Island::tearLayers(double time) {
  bool any = false;
  for (std::size_t l = 0; l < layers_.size(); ++l) any = layers_[l].layer->tear(attachedState(l, time)) || any;
  updateLayerNormals(time);
  return any;
}

void Island::updateLayerNormals(double time) {
  normalRotation_ = 0.0;
  for (std::size_t l = 0; l < layers_.size(); ++l)
    normalRotation_ = std::max(normalRotation_, layers_[l].layer->updateNormals(attachedState(l, time)));
}

// All members use the substeps of the one with the smallest.
bool Island::explicitIsCheaper(const WorldSettings &world) const {
  double points = 0.0, maxSubsteps = 0.0, implicitly = 0.0;
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    const Body &body = members_[k].stepper->body();
    const StepCost cost = predictCost(body, world.dt);
    const auto own = static_cast<double>(body.rest().pointCount());
    points += own;
    maxSubsteps = std::max(maxSubsteps, cost.explicitEvaluations);
    implicitly += own * cost.implicitEvaluations;
  }
  return points * maxSubsteps < kImplicitContact * implicitly;
}

const BodyStepper *Island::freeRigid() const {
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (moves(k) && members_[k].stepper->body().isFreeRigid()) return members_[k].stepper;
  return nullptr;
}

Integrator Island::integratorIn(const WorldSettings &world) const {
  if (freeRigid()) return Integrator::explicitVerlet;
  // Contacts found by the last step are part of a checkpoint: the same choice is made again from there.
  const bool touches = std::any_of(pairs_.begin(), pairs_.end(),
                                   [](const JoinedPair &joined) { return !joined.pair->active().empty(); });
  if (world.integrator == Integrator::automatic && touches && explicitIsCheaper(world))
    return Integrator::explicitVerlet;
  Integrator out = Integrator::explicitVerlet;
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    const Integrator own = members_[k].stepper->integratorIn(world);
    if (own == Integrator::explicitVerlet || own == out) continue;
    out = out == Integrator::explicitVerlet ? own : Integrator::implicitSdirk;
  }
  return out;
}

std::string Island::names() const {
  std::string names;
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (moves(k)) names += (names.empty() ? "'" : ", '") + members_[k].stepper->body().name() + "'";
  return names;
}

std::string Island::suggestAffordableStep(const WorldSettings &world) const {
  if (integratorIn(world) == Integrator::explicitVerlet) return {};
  std::size_t phyxels = 0;
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (moves(k)) phyxels += members_[k].stepper->body().rest().phyxelCount();
  const NewtonResult &solved = solver_.progress();
  return "bodies " + names() + " touch each other, themselves or are attached, and are one system of " +
         std::to_string(phyxels) + " phyxels, which was not solved after " + std::to_string(solved.iterations) +
         " Newton steps and " + std::to_string(solved.linearIterations) +
         " iterations of the linear solver. solver.integrator = \"explicit\" takes small steps instead, " +
         "contact.enabled = false solves them one by one; fewer phyxels or a larger solver.step_budget help as well";
}

void Island::gatherCoupling(std::span<const StepContext> contexts) {
  parts_.clear();
  coupling_.clear();
  for (std::size_t k = 0; k < members_.size(); ++k) {
    Body &body = members_[k].stepper->body();
    coupling_.add(body, moves(k));
    if (moves(k)) parts_.push_back({&body, &contexts[k].environment});
  }
  coupling_.join(pairs_, layers_);
}

std::pair<std::size_t, Index> Island::ownerOf(Index phyxel) const {
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    const std::size_t count = members_[k].stepper->body().rest().phyxelCount();
    if (phyxel < count) return {k, phyxel};
    phyxel -= static_cast<Index>(count);
  }
  return {0, 0};
}

Island::Advance Island::advanceImplicit(std::span<const StepContext> contexts, double span, Integrator scheme) {
  double scale = 1.0;
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    members_[k].stepper->body().contact.sums.begin(contexts[k].environment.obstacles.size());
    scale = std::min(scale, members_[k].stepper->stepScale());
  }
  gatherCoupling(contexts);
  coupling_.beginSums();
  const StageCoupling::Contacts before = coupling_.contacts();
  const auto pieces = static_cast<int>(std::llround(std::ceil(1.0 / scale)));
  const double piece = span / pieces;
  for (int n = 0; n < pieces; ++n) {
    const double time = contexts.front().time + n * piece;
    const ImplicitResult result = implicitStep(parts_, &coupling_, solver_, time, piece, scheme);
    std::optional<Refused> refused;
    if (!result.failure.empty()) {
      const auto [member, phyxel] = ownerOf(result.newton.worst);
      refused = {member,
                 {{phyxel, result.failure,
                   "a smaller solver.dt, solver.integrator = \"backward_euler\", or material.law = \"neo_hookean\""},
                  false}};
    }
    for (std::size_t k = 0; k < members_.size() && !refused; ++k)
      if (moves(k) && !quickCheck(members_[k].stepper->body()).finite)
        refused = {k, {firstNonFinite(members_[k].stepper->body()), false}};
    if (refused) {
      coupling_.setContacts(before);
      solver_.forget();
      return tl::unexpected<Refused>(std::move(*refused));
    }
    (void)tearLayers(time + piece);
    addLayerForces(time + piece);
  }
  return span;
}

void Island::substep(std::span<const StepContext> contexts, double time, double dt, bool continues) {
  StageClock &clock = *contexts.front().environment.clock;
  substeps_.clear();
  joint_.clear();
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (moves(k)) substeps_.emplace_back(members_[k].stepper->body(), contexts[k].environment, time, dt, true);
  }
  auto own = substeps_.begin();
  for (std::size_t k = 0; k < members_.size(); ++k)
    joint_.add(members_[k].stepper->body(), moves(k), true, moves(k) ? (own++)->rigid() : nullptr);
  fresh_.assign(members_.size(), 0);
  std::size_t moving = 0;
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (moves(k)) fresh_[k] = substeps_[moving++].evaluateFirst() ? 1 : 0;
  if (std::find(fresh_.begin(), fresh_.end(), 1) != fresh_.end()) updateLayerNormals(time);
  addLayerForces(time, true);
  for (ExplicitSubstep &one : substeps_) one.kickFirst();
  const bool touches = !pairs_.empty();
  bool isReused = false;  // reuses the contacts that were found before
  double margin = std::numeric_limits<double>::infinity();
  if (touches)
    clock.measure(kContact, [&] {
      for (const JoinedPair &joined : pairs_) margin = std::min(margin, joined.pair->settings().margin);
      if (!continues) joint_.gather(pairs_, margin);
      isReused = joint_.isStillValid();
      joint_.predict();
      for (const MovedSkin &moved : skins_) {
        const Body &body = members_[moved.member].stepper->body();
        moved.skin->move(body.state().displacements, joint_.predicted(moved.member), body.rest().maxInfluence, dt);
      }
      for (const JoinedPair &joined : pairs_) isReused = isReused && joined.pair->isStillValid();
      for (const JoinedPair &joined : pairs_) {
        if (isReused) break;
        joined.pair->setStepKind(SkinPair::StepKind::explicitStep);
        joined.pair->find(dt);
      }
    });
  for (ExplicitSubstep &one : substeps_) one.findContacts();
  if (touches)
    clock.measure(kContact, [&] {
      if (isReused)
        joint_.regather();
      else
        joint_.gather(pairs_, margin);
      joint_.solve(dt, pairs_);
    });
  else
    for (ExplicitSubstep &one : substeps_) one.solveContacts();
  for (ExplicitSubstep &one : substeps_) one.drift();
  updateLayerNormals(time + dt);  // before the forces: a lagging normal would add energy
  addLayerForces(time + dt);
  for (ExplicitSubstep &one : substeps_) one.kickLast();
  if (touches)
    clock.measure(kContact, [&] {
      if (joint_.empty()) return;
      if (!joint_.isStillValid()) {
        for (const MovedSkin &moved : skins_) moved.skin->invalidatePositions();
        for (const JoinedPair &joined : pairs_) joined.pair->updateActive();
        joint_.gather(pairs_, margin);
      }
      joint_.projectVelocities(pairs_);
    });
  else
    for (ExplicitSubstep &one : substeps_) one.projectContactVelocities();
  for (ExplicitSubstep &one : substeps_) one.damp();
  tearLayers(time + dt);
  for (const JoinedPair &joined : pairs_) joined.pair->addToSum(dt);
  for (std::size_t k = 0; k < members_.size() && touches; ++k)
    if (moves(k)) sumContactImpulses(dt, members_[k].stepper->body().contact);
}

Island::Advance Island::advanceExplicit(std::span<const StepContext> contexts, double span, std::uint64_t maxSubsteps) {
  // A member with a stable step, if there is one.
  std::size_t reference = members_.size();
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (moves(k) && (reference == members_.size() ||
                     (members_[reference].stepper->body().isFreeRigid() && !members_[k].stepper->body().isFreeRigid())))
      reference = k;
  gatherSkins();
  for (const JoinedPair &joined : pairs_) joined.pair->beginSum();
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (moves(k)) members_[k].stepper->body().contact.sums.begin(contexts[k].environment.obstacles.size());
  SubstepController &controller = members_[reference].stepper->substeps();
  double left = span, time = contexts.front().time, needed = 1.0;
  std::uint64_t substeps = 0;
  while (left > 1e-12 * span && substeps < maxSubsteps) {
    const Advance stable = maxSubstep(contexts, time, left);
    if (!stable) return stable;
    needed = std::max(needed, controller.requiredPieces(span, *stable));
    const double piece = controller.nextSubstep(left, span, *stable);
    substep(contexts, time, piece, substeps > 0);
    left -= piece;
    time += piece;
    ++substeps;
  }
  const double advanced = left > 1e-12 * span ? time - contexts.front().time : span;
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    BodyStepper &stepper = *members_[k].stepper;
    if (!isFinite(stepper.body().state().velocities))
      return tl::unexpected<Refused>({k, {firstNonFinite(stepper.body()), false}});
    stepper.substeps().end(needed);
  }
  members_[reference].stepper->reportSubsteps(contexts[reference], span, advanced, substeps, needed);
  return advanced;
}

}  // namespace pointbased::detail
