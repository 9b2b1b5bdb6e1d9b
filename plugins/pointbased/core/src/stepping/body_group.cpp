// SPDX-License-Identifier: Apache-2.0
#include "stepping/body_group.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/number_text.h"
#include "stepping/step_cost.h"

namespace pointbased::detail {
namespace {

constexpr double kStride = 0.25;  // spacings that two bodies may come nearer to each other in a substep

Vec3 meanVelocity(const Body &body) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3 &v : body.state().velocities) sum += v;
  return body.state().velocities.empty() ? sum : Vec3(sum / static_cast<double>(body.state().velocities.size()));
}

}  // namespace

void BodyGroup::clear() {
  members_.clear();
  pairs_.clear();
  layers_.clear();
}

void BodyGroup::tellMembers() {
  std::uint64_t group = 0;
  if (members_.size() > 1 || !layers_.empty()) {
    group = layers_.size() + 1;
    for (const Member &member : members_) group = group * 1'000'003 + member.id + 1;
  }
  for (const Member &member : members_) member.runner->setGroup(group);
}

double BodyGroup::advance(std::span<const StepContext> orders, double span) {
  // What a body is attached to may move although they do not touch.
  const bool isLed = std::any_of(layers_.begin(), layers_.end(), [&](const JoinedLayer &one) {
    return goesOn(one.layer->motion(), orders.front().time, span);
  });
  bool rests = !isLed;
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (moves(k)) rests = members_[k].runner->sleepsOn(orders[k], span) && rests;
  if (rests) {
    for (const Member &member : members_) member.runner->substeps().begin(orders.front().dt);
    return span;
  }
  std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    BodyStepper &runner = *members_[k].runner;
    if (runner.asleep()) runner.wake();
    runner.beginAdvance(orders[k]);
    most = std::min(most, runner.mostSubsteps());
  }
  takeScheme(orders);
  const double gone = tryToAdvance(orders, span, most);
  bool still = !isLed;
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (moves(k)) still = members_[k].runner->isStill(orders[k], gone) && still;
  if (still)
    for (std::size_t k = 0; k < members_.size(); ++k)
      if (moves(k)) members_[k].runner->fallAsleep();
  return gone;
}

void BodyGroup::takeScheme(std::span<const StepContext> orders) {
  scheme_ = integratorIn(orders.front().world);
  BodyStepper *other = nullptr;  // that would take another one by itself
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    BodyStepper &runner = *members_[k].runner;
    runner.share(scheme_);
    // A body that would choose another integrator by itself has the group's: that is another event.
    if (runner.integratorIn(orders[k].world) == scheme_)
      runner.reportIntegrator(orders[k]);
    else if (!other)
      other = &runner;
  }
  if (!other || scheme_ != Integrator::explicitVerlet) return;
  const BodyStepper *rigid = freeRigid();
  other->reportShared(orders.front(), names(), rigid ? rigid->body().name() : std::string());
}

void BodyGroup::advanceAgain(std::span<const StepContext> orders, double span) {
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    if (members_[k].runner->asleep()) return;  // the state is the same at every time
    members_[k].runner->body().restoreState();
  }
  for (const JoinedLayer &joined : layers_) joined.layer->goBack();
  (void)tryToAdvance(orders, span, std::numeric_limits<std::uint64_t>::max());
}

double BodyGroup::tryToAdvance(std::span<const StepContext> orders, double span, std::uint64_t mostSubsteps) {
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (moves(k)) (void)members_[k].runner->keepIfSound(orders[k]);
  bool again = false;  // from the marks
  while (true) {
    bool any = false;
    for (std::size_t k = 0; k < members_.size(); ++k) any = any || moves(k);
    if (!any) return span;
    Gone gone = again ? againFromMarks(orders, span) : advanceOnce(orders, span, mostSubsteps);
    if (gone && orders.front().number % kEnergyInterval == 0)
      orders.front().environment.clock->measure(kGuard, [&] {
        std::optional<Refused> grown = lookAtEnergy(orders, orders.front().time + *gone);
        if (!grown) return;
        gone = tl::unexpected<Refused>(std::move(*grown));
        again = true;
      });
    if (gone) {
      for (std::size_t k = 0; k < members_.size(); ++k)
        if (moves(k)) members_[k].runner->endAdvance();
      return *gone;
    }
    for (const JoinedLayer &joined : layers_) joined.layer->goBack();
    for (std::size_t k = 0; k < members_.size(); ++k)
      if (k != gone.error().member && moves(k)) members_[k].runner->goBack(*orders[k].environment.parallelFor);
    const std::size_t refused = gone.error().member;
    (void)members_[refused].runner->tryAgain(
        orders[refused], gone.error().why,
        again ? "at " + number(members_[refused].runner->mark()->time) + " s" : "before");
  }
}

BodyGroup::Gone BodyGroup::advanceOnce(std::span<const StepContext> orders, double span, std::uint64_t mostSubsteps) {
  return scheme_ == Integrator::explicitVerlet ? advanceExplicit(orders, span, mostSubsteps)
                                               : advanceImplicit(orders, span, scheme_);
}

std::optional<double> BodyGroup::timeOfMarks() const {
  std::optional<double> time;
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    const std::optional<BodyStepper::Mark> &mark = members_[k].runner->mark();
    if (!mark || (time && *time != mark->time)) return std::nullopt;
    time = mark->time;
  }
  return time;
}

std::optional<BodyGroup::Refused> BodyGroup::lookAtEnergy(std::span<const StepContext> orders, double time) {
  const Vec3 &gravity = orders.front().world.gravity;
  bool comparable = timeOfMarks().has_value();
  for (const JoinedPair &joined : pairs_) comparable = !joined.pair->takeEased() && comparable;
  std::vector<EnergyLevel> levels(members_.size());
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    levels[k] = energyLevel(members_[k].runner->body(), gravity);
    comparable = comparable && !members_[k].runner->mayGainEnergy(orders[k]);
  }
  for (std::size_t l = 0; l < layers_.size(); ++l) {
    const JoinedLayer &joined = layers_[l];
    comparable = comparable && !joined.layer->motion();
    levels[moves(joined.first) || joined.second == JoinedLayer::kNobody ? joined.first : joined.second].total +=
        joined.layer->energy(sidesOf(l, time));
  }
  EnergyLevel before, now;
  std::size_t worst = 0;
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    now.add(levels[k]);
    if (!comparable) continue;
    const EnergyLevel &known = members_[k].runner->mark()->energy;
    before.add(known);
    if (levels[k].total - known.total > most) {
      most = levels[k].total - known.total;
      worst = k;
    }
  }
  Vec3 &ledOut = joint_.state().ledOut;
  now.lifted += std::max(0.0, -gravity.dot(ledOut));
  ledOut.setZero();
  for (std::size_t k = 0; k < members_.size(); ++k) members_[k].runner->body().contact.ledOut.setZero();
  std::string grown = comparable ? energyGrowth(before, now) : std::string();
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    if (grown.empty())
      members_[k].runner->setMark(time, levels[k]);
    else
      members_[k].runner->backToMark();
  }
  if (grown.empty()) return std::nullopt;
  return Refused{worst,
                 {{fullCheck(members_[worst].runner->body()).fastestPhyxel, std::move(grown), kLessEnergy}, false}};
}

BodyGroup::Gone BodyGroup::againFromMarks(std::span<const StepContext> orders, double span) {
  const double end = orders.front().time + span;
  std::vector<StepContext> pieces(orders.begin(), orders.end());
  double time = timeOfMarks().value_or(orders.front().time);
  while (end - time > 1e-9 * span) {
    const double left = std::min(orders.front().dt, end - time);
    for (StepContext &piece : pieces) piece.time = time;
    if (const Gone gone = advanceOnce(pieces, left, std::numeric_limits<std::uint64_t>::max()); !gone) return gone;
    time += left;
  }
  return span;
}

BodyGroup::Gone BodyGroup::maxSubstep(std::span<const StepContext> orders, double time, double left) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    const BodyStepper::Gone stable = members_[k].runner->maxSubstep(orders[k], time, left, nullptr);
    if (!stable) return tl::unexpected<Refused>({k, stable.error()});
    least = std::min(least, *stable);
  }
  for (const JoinedLayer &joined : layers_) least /= 1.0 + joined.layer->stiffening();
  // An impact sets phyxels in motion against each other that had the same velocity before.
  for (const JoinedPair &joined : pairs_) {
    if (joined.first == joined.second) continue;
    const Body &first = members_[joined.first].runner->body(), &second = members_[joined.second].runner->body();
    const double speed = (meanVelocity(first) - meanVelocity(second)).norm();
    if (speed > 0.0) least = std::min(least, kStride * std::min(first.rest().spacing, second.rest().spacing) / speed);
  }
  return least;
}

void BodyGroup::gatherSkins() {
  skins_.clear();
  for (JoinedPair &joined : pairs_)
    for (const auto &[side, k] : {std::pair(std::size_t{0}, joined.first), std::pair(std::size_t{1}, joined.second)}) {
      MovingSkin &skin = joined.pair->moving(side);
      if (std::none_of(skins_.begin(), skins_.end(), [&](const MovedSkin &one) { return one.skin == &skin; }))
        skins_.push_back({&skin, k});
    }
}

AttachmentLayer::Sides BodyGroup::sidesOf(std::size_t layer, double time) const {
  const JoinedLayer &joined = layers_[layer];
  AttachmentLayer::Sides sides{members_[joined.first].runner->body().state().displacements, {}, time};
  if (joined.second != JoinedLayer::kNobody)
    sides.second = members_[joined.second].runner->body().state().displacements;
  return sides;
}

void BodyGroup::addLayerForces(double time, bool onlyFresh) {
  const auto forcesOf = [&](std::size_t k) {
    const bool takes = k != JoinedLayer::kNobody && moves(k) && (!onlyFresh || fresh_[k] != 0);
    return takes ? members_[k].runner->body().forces() : std::span<Vec3>();
  };
  for (std::size_t l = 0; l < layers_.size(); ++l) {
    const JoinedLayer &joined = layers_[l];
    const std::span<Vec3> first = forcesOf(joined.first), second = forcesOf(joined.second);
    if (!first.empty() || !second.empty()) joined.layer->addForces(sidesOf(l, time), first, second);
  }
}

bool BodyGroup::tearLayers(double time) {
  bool any = false;
  for (std::size_t l = 0; l < layers_.size(); ++l) any = layers_[l].layer->tear(sidesOf(l, time)) || any;
  turnLayers(time);
  return any;
}

void BodyGroup::turnLayers(double time) {
  turned_ = 0.0;
  for (std::size_t l = 0; l < layers_.size(); ++l)
    turned_ = std::max(turned_, layers_[l].layer->turn(sidesOf(l, time)));
}

// All take the substeps of the one with the smallest.
bool BodyGroup::explicitIsCheaper(const WorldSettings &world) const {
  double points = 0.0, mostSubsteps = 0.0, implicitly = 0.0;
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    const Body &body = members_[k].runner->body();
    const StepCost cost = predictCost(body, world.dt);
    const auto own = static_cast<double>(body.rest().pointCount());
    points += own;
    mostSubsteps = std::max(mostSubsteps, cost.explicitEvaluations);
    implicitly += own * cost.implicitEvaluations;
  }
  return points * mostSubsteps < kImplicitContact * implicitly;
}

const BodyStepper *BodyGroup::freeRigid() const {
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (moves(k) && members_[k].runner->body().free()) return members_[k].runner;
  return nullptr;
}

Integrator BodyGroup::integratorIn(const WorldSettings &world) const {
  if (freeRigid()) return Integrator::explicitVerlet;
  // What the last step found, which a checkpoint keeps: from there the same is chosen again.
  const bool touches = std::any_of(pairs_.begin(), pairs_.end(),
                                   [](const JoinedPair &joined) { return !joined.pair->active().empty(); });
  if (world.integrator == Integrator::automatic && touches && explicitIsCheaper(world))
    return Integrator::explicitVerlet;
  Integrator out = Integrator::explicitVerlet;
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    const Integrator own = members_[k].runner->integratorIn(world);
    if (own == Integrator::explicitVerlet || own == out) continue;
    out = out == Integrator::explicitVerlet ? own : Integrator::implicitSdirk;
  }
  return out;
}

std::string BodyGroup::names() const {
  std::string names;
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (moves(k)) names += (names.empty() ? "'" : ", '") + members_[k].runner->body().name() + "'";
  return names;
}

std::string BodyGroup::whatWouldFit(const WorldSettings &world) const {
  if (integratorIn(world) == Integrator::explicitVerlet) return {};
  std::size_t phyxels = 0;
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (moves(k)) phyxels += members_[k].runner->body().rest().phyxelCount();
  const NewtonResult &solved = solver_.progress();
  return "bodies " + names() + " touch each other, themselves or are attached, and are one system of " +
         std::to_string(phyxels) + " phyxels, which was not solved after " + std::to_string(solved.iterations) +
         " Newton steps and " + std::to_string(solved.linearIterations) +
         " iterations of the linear solver. solver.integrator = \"explicit\" takes small steps instead, " +
         "contact.enabled = false solves them one by one; fewer phyxels or a larger solver.step_budget help as well";
}

void BodyGroup::gatherCoupling(std::span<const StepContext> orders) {
  parts_.clear();
  coupling_.clear();
  for (std::size_t k = 0; k < members_.size(); ++k) {
    Body &body = members_[k].runner->body();
    coupling_.add(body, moves(k));
    if (moves(k)) parts_.push_back({&body, &orders[k].environment});
  }
  coupling_.join(pairs_, layers_);
}

std::pair<std::size_t, Index> BodyGroup::ownerOf(Index phyxel) const {
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    const std::size_t count = members_[k].runner->body().rest().phyxelCount();
    if (phyxel < count) return {k, phyxel};
    phyxel -= static_cast<Index>(count);
  }
  return {0, 0};
}

BodyGroup::Gone BodyGroup::advanceImplicit(std::span<const StepContext> orders, double span, Integrator scheme) {
  double scale = 1.0;
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    members_[k].runner->body().contact.sums.begin(orders[k].environment.obstacles.size());
    scale = std::min(scale, members_[k].runner->stepScale());
  }
  gatherCoupling(orders);
  coupling_.beginSums();
  const StageCoupling::Contacts before = coupling_.contacts();
  const auto pieces = static_cast<int>(std::llround(std::ceil(1.0 / scale)));
  const double piece = span / pieces;
  for (int n = 0; n < pieces; ++n) {
    const double time = orders.front().time + n * piece;
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
      if (moves(k) && !quickCheck(members_[k].runner->body()).finite)
        refused = {k, {firstNonFinite(members_[k].runner->body()), false}};
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

void BodyGroup::substep(std::span<const StepContext> orders, double time, double dt, bool goesOn) {
  StageClock &clock = *orders.front().environment.clock;
  substeps_.clear();
  joint_.clear();
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (moves(k)) substeps_.emplace_back(members_[k].runner->body(), orders[k].environment, time, dt, true);
  }
  auto own = substeps_.begin();
  for (std::size_t k = 0; k < members_.size(); ++k)
    joint_.add(members_[k].runner->body(), moves(k), true, moves(k) ? (own++)->rigid() : nullptr);
  fresh_.assign(members_.size(), 0);
  std::size_t moving = 0;
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (moves(k)) fresh_[k] = substeps_[moving++].evaluateFirst() ? 1 : 0;
  if (std::find(fresh_.begin(), fresh_.end(), 1) != fresh_.end()) turnLayers(time);
  addLayerForces(time, true);
  for (ExplicitSubstep &one : substeps_) one.kickFirst();
  const bool touches = !pairs_.empty();
  bool serves = false;  // what has been found before
  double margin = std::numeric_limits<double>::infinity();
  if (touches)
    clock.measure(kContact, [&] {
      for (const JoinedPair &joined : pairs_) margin = std::min(margin, joined.pair->settings().margin);
      if (!goesOn) joint_.gather(pairs_, margin);
      serves = joint_.serves();
      joint_.predict();
      for (const MovedSkin &moved : skins_) {
        const Body &body = members_[moved.member].runner->body();
        moved.skin->move(body.state().displacements, joint_.predicted(moved.member), body.rest().maxInfluence, dt);
      }
      for (const JoinedPair &joined : pairs_) serves = serves && joined.pair->serves();
      for (const JoinedPair &joined : pairs_) {
        if (serves) break;
        joined.pair->setSteps(SkinPair::Steps::small);
        joined.pair->find(dt);
      }
    });
  for (ExplicitSubstep &one : substeps_) one.findContacts();
  if (touches)
    clock.measure(kContact, [&] {
      if (serves)
        joint_.gatherAgain();
      else
        joint_.gather(pairs_, margin);
      joint_.solve(dt, pairs_);
    });
  else
    for (ExplicitSubstep &one : substeps_) one.solveContacts();
  for (ExplicitSubstep &one : substeps_) one.driftOn();
  turnLayers(time + dt);  // before the forces: a normal that lags makes energy
  addLayerForces(time + dt);
  for (ExplicitSubstep &one : substeps_) one.kickLast();
  if (touches)
    clock.measure(kContact, [&] {
      if (joint_.empty()) return;
      if (!joint_.serves()) {
        for (const MovedSkin &moved : skins_) moved.skin->moveOn();
        for (const JoinedPair &joined : pairs_) joined.pair->renewPressing();
        joint_.gather(pairs_, margin);
      }
      joint_.settle(pairs_);
    });
  else
    for (ExplicitSubstep &one : substeps_) one.settleContacts();
  for (ExplicitSubstep &one : substeps_) one.damp();
  tearLayers(time + dt);
  for (const JoinedPair &joined : pairs_) joined.pair->addToSum(dt);
  for (std::size_t k = 0; k < members_.size() && touches; ++k)
    if (moves(k)) sumContactImpulses(dt, members_[k].runner->body().contact);
}

BodyGroup::Gone BodyGroup::advanceExplicit(std::span<const StepContext> orders, double span,
                                           std::uint64_t mostSubsteps) {
  // One with a stable step, if there is one.
  std::size_t leader = members_.size();
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (moves(k) &&
        (leader == members_.size() || (members_[leader].runner->body().free() && !members_[k].runner->body().free())))
      leader = k;
  gatherSkins();
  for (const JoinedPair &joined : pairs_) joined.pair->beginSum();
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (moves(k)) members_[k].runner->body().contact.sums.begin(orders[k].environment.obstacles.size());
  SubstepController &cut = members_[leader].runner->substeps();
  double left = span, time = orders.front().time, needed = 1.0;
  std::uint64_t substeps = 0;
  while (left > 1e-12 * span && substeps < mostSubsteps) {
    const Gone stable = maxSubstep(orders, time, left);
    if (!stable) return stable;
    needed = std::max(needed, cut.needed(span, *stable));
    const double piece = cut.piece(left, span, *stable);
    substep(orders, time, piece, substeps > 0);
    left -= piece;
    time += piece;
    ++substeps;
  }
  const double gone = left > 1e-12 * span ? time - orders.front().time : span;
  for (std::size_t k = 0; k < members_.size(); ++k) {
    if (!moves(k)) continue;
    BodyStepper &runner = *members_[k].runner;
    if (!isFinite(runner.body().state().velocities))
      return tl::unexpected<Refused>({k, {firstNonFinite(runner.body()), false}});
    runner.substeps().end(needed);
  }
  members_[leader].runner->reportSubsteps(orders[leader], span, gone, substeps, needed);
  return gone;
}

}  // namespace pointbased::detail
