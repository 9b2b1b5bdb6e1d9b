// SPDX-License-Identifier: Apache-2.0
#include "pointbased/stepper.h"

#include <algorithm>

#include "base/expects.h"
#include "base/flush_denormals.h"
#include "stepping/islands/island_scheduler.h"
#include "stepping/monitoring/step_cost.h"
#include "stepping/simulation/step_monitor.h"

namespace pointbased {
namespace {

constexpr int kUsualLoadSteps = 10;

}  // namespace

Stepper::Stepper(detail::SimulationState &state, const World &world)
    : state_(state), world_(world), monitor_(std::make_unique<detail::StepMonitor>(state, world)),
      scheduler_(std::make_unique<detail::IslandScheduler>()) {}
Stepper::~Stepper() = default;

double Stepper::stepSize() const { return state_.stepSize(); }

double Stepper::stepSizeOf(std::size_t id) const {
  const Body *target = state_.body(id);
  const double step = state_.stepSize();
  if (!target || target->isStatic() || integratorOf(id) != Integrator::explicitVerlet)
    return target && !target->isStatic() ? step : 0.0;
  const double stable = kStepSafety * target->stableStepAtRest();
  return step / detail::SubstepController::piecesOf(
                    step, target->isFreeRigid() ? std::min(stable, detail::kFreeStep) : stable);
}

Integrator Stepper::integratorOf(std::size_t id) const {
  const auto found = state_.bodies.find(id);
  return found == state_.bodies.end() ? state_.settings.integrator : found->second->integratorNow(state_.settings);
}

std::pair<double, double> Stepper::predictedCost(std::size_t id) const {
  const Body *target = state_.body(id);
  if (!target || target->isStatic()) return {0.0, 0.0};
  const detail::StepCost cost = detail::predictCost(*target, state_.settings.dt);
  return {cost.explicitEvaluations, cost.implicitEvaluations};
}

StepComposition Stepper::compositionOf(std::size_t id) const {
  const auto found = state_.bodies.find(id);
  if (found == state_.bodies.end()) return {};
  const detail::BodyStepper &stepper = *found->second;
  CompositionNotes notes{{}, stepper.integratorNow(state_.settings), state_.settings.sleep, {}};
  if (stepper.body().isStatic())
    notes.idle = "rigid: it stands as it is";
  else if (stepper.stopped())
    notes.idle = "it has stopped";
  else if (stepper.asleep())
    notes.idle = "asleep until something changes";
  for (const Probe &probe : state_.probes)
    if (probe.body == id) notes.probes.push_back(probe.name);
  for (const auto &[other, own] : state_.bodies)
    if (other != id && world_.canTouch(id, other)) notes.touches.push_back(own->body().name());
  notes.touchesItself = state_.islands.touchThemselves.contains(id);
  Environment env = environment();
  env.obstacles = state_.surroundingsOf(id);
  env.box = world_.boxOf(id);
  return compose(stepper.body(), env, notes);
}

std::string Stepper::suggestAffordableStep(const StepFailure &ended, double budget) {
  const auto found = state_.bodies.find(ended.body);
  if (found == state_.bodies.end()) return {};
  for (std::size_t g = 0; g < state_.islands.count; ++g) {
    const auto members = state_.islands.list[g]->members();
    const bool isIn =
        std::any_of(members.begin(), members.end(), [&](const auto &one) { return one.id == ended.body; });
    if (std::string text = isIn ? state_.islands.list[g]->suggestAffordableStep(state_.settings) : std::string();
        !text.empty())
      return text;
  }
  return found->second->suggestAffordableStep(contextFor(ended.body, context(nullptr)), budget);
}

std::size_t Stepper::stoppedBodies() const {
  return static_cast<std::size_t>(std::count_if(state_.bodies.begin(), state_.bodies.end(),
                                                [](const auto &entry) { return entry.second->stopped(); }));
}

bool Stepper::failed() const {
  const auto standing = static_cast<std::size_t>(std::count_if(
      state_.bodies.begin(), state_.bodies.end(), [](const auto &entry) { return entry.second->body().isStatic(); }));
  return state_.bodies.size() > standing && stoppedBodies() + standing == state_.bodies.size();
}

bool Stepper::asleep(std::size_t id) const {
  const auto found = state_.bodies.find(id);
  return found != state_.bodies.end() && found->second->asleep();
}

void Stepper::wake(std::size_t id) {
  if (const auto found = state_.bodies.find(id); found != state_.bodies.end()) found->second->wake();
  countChange(id);
}

void Stepper::countChange(std::size_t id) {
  if (const auto found = state_.bodies.find(id); found != state_.bodies.end()) found->second->countChange();
}

std::uint64_t Stepper::changes(std::size_t id) const {
  const auto found = state_.bodies.find(id);
  return found == state_.bodies.end() ? 0 : found->second->changes();
}

Environment Stepper::environment() const {
  Environment env;
  env.gravity = state_.settings.gravity;
  env.damping = state_.settings.damping;
  env.obstacles = state_.obstacles.all;
  env.box = state_.settings.box;
  env.tolerance = state_.settings.tolerance;
  env.preconditioner = state_.settings.preconditioner;
  env.parallelFor = &state_.parallelFor;
  return env;
}

detail::StepContext Stepper::context(const StopRequest *stop) {
  Environment env = environment();
  env.clock = &state_.clock;
  env.stop = stop;
  return {state_.settings,
          env,
          state_.progress.time,
          state_.stepSize(),
          state_.progress.loadFactor,
          state_.progress.steps + 1,
          [this](const char *kind, const std::string &text) { state_.reportEvent(kind, text); }};
}

detail::StepContext Stepper::contextFor(std::size_t id, const detail::StepContext &context) const {
  detail::StepContext own = context;
  if (!state_.contact.surroundings.contains(id)) return own;
  own.environment.obstacles = state_.surroundingsOf(id);
  own.environment.box = world_.boxOf(id);
  return own;
}

std::vector<detail::StepContext> Stepper::contextsOf(const detail::Island &island,
                                                     const detail::StepContext &own) const {
  std::vector<detail::StepContext> contexts;
  for (const detail::Island::Member &one : island.members()) contexts.push_back(contextFor(one.id, own));
  return contexts;
}

tl::expected<void, StepFailure> Stepper::step(const StopRequest *stop) {
  const auto refusal = [this] {
    std::string text;
    for (const auto &[id, stepper] : state_.bodies) text += (text.empty() ? "" : "; ") + stepper->body().stopMessage();
    return tl::unexpected<StepFailure>({text});
  };
  if (failed()) return refusal();
  if (state_.finished()) return {};
  const detail::FlushDenormals flush;
  const detail::StepContext context = this->context(stop);
  if (state_.progress.steps == 0) {
    monitor_->reportInitialWarnings(context);
    if (failed()) return refusal();
    monitor_->checkSkins();
  }
  for (auto &[id, stepper] : state_.bodies) stepper->beginStep();
  for (auto &[id, layer] : state_.attachments) layer->saveTears();
  double advanced = 0.0;
  try {
    const StoppableLoops::Watch watch(state_.loops, stop);
    throwIfStopRequested(stop);
    if (state_.quasiStatic())
      increaseLoad(context);
    else
      advanced = advanceBodies(context);
  } catch (const Stopped &) {
    const std::size_t body = state_.activity.present();
    state_.activity.leaveAll();
    for (auto &[id, stepper] : state_.bodies) stepper->undoStep(state_.parallelFor);
    for (auto &[id, layer] : state_.attachments) layer->restoreTears();
    state_.skins.clear();
    return tl::unexpected<StepFailure>(
        {"the step was ended before it was done; the state before it stays", true, body});
  }
  if (!state_.quasiStatic())
    for (auto &[id, stepper] : state_.bodies)
      if (!stepper->asleep() && !stepper->body().rigid() && rereferenceIfNeeded(id, stop)) stepper->invalidate();
  if (failed()) return refusal();
  state_.progress.time += advanced;
  state_.computingTime.advanced += advanced;
  ++state_.progress.steps;
  monitor_->reportTornAttachments();
  if (monitor_->isSkinCheckDue()) state_.clock.measure(kGuard, [this] { monitor_->checkSkins(); });
  state_.clock.commit();
  return {};
}

detail::IslandScheduler &Stepper::scheduleIslands(double dt) {
  buildIslands(dt);
  scheduler_->clear();
  std::size_t island = 0;
  for (auto &[id, stepper] : state_.bodies) {
    if (island < state_.islands.count && state_.islands.list[island]->members().front().id == id) {
      state_.islands.list[island]->markEnergyExchange();
      scheduler_->add(*state_.islands.list[island++]);
    }
    if (state_.islands.members.contains(id)) continue;
    stepper->setIsland(0);
    if (!stepper->stopped() && !stepper->body().isStatic()) scheduler_->add(id, *stepper);
  }
  return *scheduler_;
}

void Stepper::increaseLoad(const detail::StepContext &context) {
  const int increments = state_.settings.loadSteps > 0 ? state_.settings.loadSteps : kUsualLoadSteps;
  double next = std::min(1.0, state_.progress.loadFactor + 1.0 / increments);
  if (next > 1.0 - 1e-9) next = 1.0;
  scheduleIslands(0.0).run(context, state_.plainLoops, state_.activity,
                           [this, next](detail::IslandScheduler::Member &member, const detail::StepContext &own) {
                             if (member.island)
                               member.island->loadUpTo(contextsOf(*member.island, own), next);
                             else
                               member.stepper->loadUpTo(contextFor(member.id, own), next);
                           });
  if (!failed()) state_.progress.loadFactor = next;
}

double Stepper::advanceBodies(const detail::StepContext &context) {
  detail::IslandScheduler &scheduler = scheduleIslands(context.dt);
  scheduler.run(context, state_.plainLoops, state_.activity,
                [&](detail::IslandScheduler::Member &member, const detail::StepContext &own) {
                  member.advanced = member.stepper ? member.stepper->advance(contextFor(member.id, own), own.dt)
                                                   : member.island->advance(contextsOf(*member.island, own), own.dt);
                });
  double span = context.dt;
  for (const detail::IslandScheduler::Member &member : scheduler.members()) {
    span = std::min(span, member.advanced);
    if (member.stepper) {
      state_.computingTime.seconds[member.id] += member.seconds;
      continue;
    }
    double points = 0.0;
    for (const detail::Island::Member &one : member.island->members())
      points += static_cast<double>(one.stepper->body().rest().pointCount());
    for (const detail::Island::Member &one : member.island->members())
      state_.computingTime.seconds[one.id] +=
          member.seconds * static_cast<double>(one.stepper->body().rest().pointCount()) / points;
  }
  if (!(span < context.dt)) return span;
  // If the substeps of a body were not enough, the others have advanced too far.
  scheduler.run(context, state_.plainLoops, state_.activity,
                [&](detail::IslandScheduler::Member &member, const detail::StepContext &own) {
                  if (!(member.advanced > span)) return;
                  if (member.island)
                    member.island->advanceAgain(contextsOf(*member.island, own), span);
                  else if (!member.stepper->stopped())
                    member.stepper->advanceAgain(contextFor(member.id, own), span);
                });
  return span;
}

void Stepper::repeatLastIncrement() {
  const int increments = state_.settings.loadSteps > 0 ? state_.settings.loadSteps : kUsualLoadSteps;
  if (state_.finished()) state_.progress.loadFactor = 1.0 - 1.0 / increments;
}

void Stepper::setExternalForces(std::size_t id, std::span<const Vec3> forces) {
  std::vector<Vec3> copy(forces.begin(), forces.end());
  swapExternalForces(id, copy);
}

void Stepper::swapExternalForces(std::size_t id, std::vector<Vec3> &forces) {
  Body *target = state_.body(id);
  if (!target || target->isStatic()) return;
  const bool none = std::all_of(forces.begin(), forces.end(), [](const Vec3 &f) { return f.isZero(0.0); });
  if (none && target->externalForces().empty()) return;
  if (none) state_.bodies.at(id)->clearEnergyCheckpoint();  // energy that they have added is not spurious
  if (!none && state_.bodies.at(id)->asleep()) state_.bodies.at(id)->wake();
  if (none) forces.clear();
  target->swapExternalForces(forces);
}

namespace {

template <class B>
auto findGrab(B *body, std::uint64_t id) -> decltype(body->grabs.data()) {
  if (!body) return nullptr;
  for (auto &active : body->grabs)
    if (active.id == id) return &active;
  return nullptr;
}

}  // namespace

void Stepper::setGrab(std::size_t id, Grab grab, std::uint64_t grabId) {
  Body *target = state_.body(id);
  if (!target || grab.phyxels.empty() || target->isStatic()) return;
  POINTBASED_EXPECTS(grab.weights.size() == grab.phyxels.size(), "one weight per grabbed phyxel");
  POINTBASED_EXPECTS(grab.arms.empty() || grab.arms.size() == grab.phyxels.size(),
                     "one arm per grabbed phyxel, or none");
  POINTBASED_EXPECTS(
      std::all_of(grab.phyxels.begin(), grab.phyxels.end(), [&](Index i) { return i < target->rest().phyxelCount(); }),
      "grabs phyxels that there are");
  if (ActiveGrab *present = findGrab(target, grabId))
    *present = {grabId, std::move(grab), {}};
  else
    target->grabs.push_back({grabId, std::move(grab), {}});
  target->forcesCurrent = false;
  state_.bodies.at(id)->clearEnergyCheckpoint();
}

void Stepper::moveGrab(std::size_t id, const Vec3 &position, std::uint64_t grabId) {
  if (ActiveGrab *present = findGrab(state_.body(id), grabId)) present->grab.target = position;
}

void Stepper::turnGrab(std::size_t id, const Mat3 &rotation, std::uint64_t grabId) {
  if (ActiveGrab *present = findGrab(state_.body(id), grabId)) present->grab.rotation = rotation;
}

void Stepper::releaseGrab(std::size_t id, std::uint64_t grabId) {
  Body *target = state_.body(id);
  if (!target || std::erase_if(target->grabs, [grabId](const ActiveGrab &one) { return one.id == grabId; }) == 0)
    return;
  target->forcesCurrent = false;
  state_.bodies.at(id)->clearEnergyCheckpoint();  // energy that the grab has added is not spurious
}

std::optional<GrabStatus> Stepper::grabStatus(std::size_t id, std::uint64_t grabId) const {
  const ActiveGrab *present = findGrab(state_.body(id), grabId);
  return present ? std::optional(present->status) : std::nullopt;
}

}  // namespace pointbased
