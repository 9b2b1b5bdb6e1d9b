// SPDX-License-Identifier: Apache-2.0
#include "pointbased/simulator.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "base/expects.h"
#include "base/flush_denormals.h"
#include "body/state_hash.h"
#include "pointbased/cloud_quality.h"
#include "stepping/attachment_layer.h"
#include "stepping/island_scheduler.h"
#include "stepping/rigid_tissue.h"
#include "stepping/step_activity.h"
#include "stepping/step_cost.h"

namespace pointbased {
namespace {

constexpr double kStepWithoutBodies = 1.0 / 60.0;  // s
constexpr int kUsualLoadSteps = 10;
constexpr std::size_t kMaxEvents = 200;

// Same loop, with denormals flushed on every thread that runs a part of it.
ParallelFor flushing(ParallelFor parallelFor) {
  return [inner = std::move(parallelFor)](std::size_t n, std::size_t grain,
                                          const std::function<void(std::size_t, std::size_t)> &loop) {
    const auto part = [&loop](std::size_t begin, std::size_t end) {
      const detail::FlushDenormals flush;
      loop(begin, end);
    };
    inner(n, grain, std::cref(part));
  };
}

}  // namespace

Simulator::Simulator(ParallelFor parallelFor)
    : plainLoops_(flushing(std::move(parallelFor))), loops_(plainLoops_),
      activity_(std::make_unique<detail::StepActivity>()), scheduler_(std::make_unique<detail::IslandScheduler>()),
      skins_(std::make_unique<detail::SkinContacts>()), clock_(stageNames()) {}
Simulator::~Simulator() = default;

void Simulator::setWorld(const WorldSettings &world) {
  const bool wasStatic = quasiStatic();
  const bool otherEnergy = world.integrator != world_.integrator || world.gravity != world_.gravity ||
                           world.box.enabled != world_.box.enabled || world.box.min != world_.box.min ||
                           world.box.max != world_.box.max;
  world_ = world;
  if (!wasStatic && quasiStatic()) loadFactor_ = 0.0;
  if (wasStatic && !quasiStatic())
    for (const auto &[id, stepper] : bodies_) {
      const BoundaryConditions &conditions = stepper->body().rest().conditions;
      for (const Fix &fix : conditions.fixes) time_ = std::max(time_, loadFactor_ * fix.ramp);
      for (const Load &load : conditions.loads) time_ = std::max(time_, loadFactor_ * load.ramp);
    }
  for (auto &[id, stepper] : bodies_) stepper->body().quasiStatic = quasiStatic();
  if (wasStatic != quasiStatic()) updateAttachments();
  for (auto &[id, stepper] : bodies_) {
    stepper->body().setPrecision(world.precision);
    stepper->body().forcesCurrent = false;
    stepper->wake();
    if (otherEnergy) stepper->forgetEnergy();
    describe(id);
  }
}

std::size_t Simulator::addBody(std::unique_ptr<Body> body) {
  POINTBASED_EXPECTS(body != nullptr, "a body");
  body->quasiStatic = quasiStatic();
  body->setPrecision(world_.precision);
  std::string cloud = inspectCloud(body->rest()).warning();
  if (!cloud.empty()) cloud += "; sampling.neighbours and the spacing change it";
  for (const std::string &unusual :
       {volumeWarning(body->rest()), tornWarning(body->rest()), gluedWarning(body->rest()), cloud}) {
    if (unusual.empty()) continue;
    addWarning(nextId_, "body '" + body->name() + "': " + unusual);
  }
  if (auto tissues = detail::rigidTissuesOf(*body); !tissues.empty()) rigidTissues_[nextId_] = std::move(tissues);
  bodies_.emplace(nextId_, std::make_unique<detail::BodyStepper>(std::move(body)));
  updateSurroundings(nextId_);
  ++historyEpoch_;
  describe(nextId_);
  return nextId_++;
}

void Simulator::describe(std::size_t id) {
  const detail::BodyStepper &stepper = *bodies_.at(id);
  activity_->describe(id, detail::suggestRemedy(stepper.body(), world_, stepper.integratorIn(world_)));
}

std::string Simulator::activity() const { return activity_->line(); }

std::string Simulator::suggestAffordableStep(const StepFailure &ended, double budget) {
  const auto found = bodies_.find(ended.body);
  if (found == bodies_.end()) return {};
  for (std::size_t g = 0; g < islandCount_; ++g) {
    const auto members = islands_[g]->members();
    const bool isIn =
        std::any_of(members.begin(), members.end(), [&](const auto &one) { return one.id == ended.body; });
    if (std::string text = isIn ? islands_[g]->suggestAffordableStep(world_) : std::string(); !text.empty())
      return text;
  }
  return found->second->suggestAffordableStep(contextFor(ended.body, context(nullptr)), budget);
}

std::size_t Simulator::addObstacle(Obstacle obstacle) {
  ++historyEpoch_;
  obstacles_.push_back(std::move(obstacle));
  obstacleIds_.push_back(nextId_);
  updateSurroundings();
  for (auto &[id, stepper] : bodies_) {
    stepper->body().contact = ContactState();
    stepper->wake();
  }
  return nextId_++;
}

bool Simulator::removeBody(std::size_t id) {
  std::erase_if(probes_, [id](const Probe &p) { return p.body == id; });
  ++historyEpoch_;
  warnings_.erase(id);
  surroundings_.erase(id);
  rigidTissues_.erase(id);
  std::erase_if(contactPairs_, [id](const auto &pair) { return pair.first.first == id || pair.first.second == id; });
  activity_->forget(id);
  skins_->forget(id);
  removeAttachmentsOf(id);
  return bodies_.erase(id) > 0;
}

bool Simulator::removeObstacle(std::size_t id) {
  const auto found = std::find(obstacleIds_.begin(), obstacleIds_.end(), id);
  if (found == obstacleIds_.end()) return false;
  const auto number = found - obstacleIds_.begin();
  if (instruments_.erase(id) == 0) ++historyEpoch_;
  obstacles_.erase(obstacles_.begin() + number);
  obstacleIds_.erase(found);
  ownMotions_.erase(id);
  placed_.erase(id);
  warnings_.erase(id);
  removeAttachmentsOf(id);
  std::erase_if(contactPairs_, [id](const auto &pair) { return pair.first.first == id || pair.first.second == id; });
  updateSurroundings();
  for (auto &[other, stepper] : bodies_) {
    stepper->body().contact.forget(static_cast<Index>(ownObstacleCount(other) + number));
    stepper->wake();
  }
  return true;
}

void Simulator::clear() {
  attachments_.clear();
  bodies_.clear();
  warnings_.clear();
  obstacles_.clear();
  obstacleIds_.clear();
  instruments_.clear();
  ownMotions_.clear();
  placed_.clear();
  contactPairs_.clear();
  surroundings_.clear();
  rigidTissues_.clear();
  probes_.clear();
  reset();
}

const Obstacle *Simulator::obstacle(std::size_t id) const {
  const auto found = std::find(obstacleIds_.begin(), obstacleIds_.end(), id);
  return found == obstacleIds_.end() ? nullptr : &obstacles_[static_cast<std::size_t>(found - obstacleIds_.begin())];
}

void Simulator::addWarning(std::size_t id, const std::string &text) {
  warnings_[id].push_back(text);
  reportEvent("warning", text);
}

Body *Simulator::body(std::size_t id) {
  const auto found = bodies_.find(id);
  return found == bodies_.end() ? nullptr : &found->second->body();
}

const Body *Simulator::body(std::size_t id) const {
  const auto found = bodies_.find(id);
  return found == bodies_.end() ? nullptr : &found->second->body();
}

std::vector<std::size_t> Simulator::bodyIds() const {
  std::vector<std::size_t> ids;
  for (const auto &[id, stepper] : bodies_) ids.push_back(id);
  return ids;
}

Integrator Simulator::integratorOf(std::size_t id) const {
  const auto found = bodies_.find(id);
  return found == bodies_.end() ? world_.integrator : found->second->integratorNow(world_);
}

std::pair<double, double> Simulator::predictedCost(std::size_t id) const {
  const Body *target = body(id);
  if (!target || target->isStatic()) return {0.0, 0.0};
  const detail::StepCost cost = detail::predictCost(*target, world_.dt);
  return {cost.explicitEvaluations, cost.implicitEvaluations};
}

RigidMotion Simulator::obstacleMotion(std::size_t id) const {
  const Obstacle *found = obstacle(id);
  return found && found->motion ? found->motion(clockOfRamps()) : RigidMotion{};
}

std::size_t Simulator::addProbe(std::string name, std::size_t id, const Vec3 &reference) {
  const Body *target = body(id);
  if (!target) return 0;
  ++historyEpoch_;
  const Vec3 local = reference - target->rest().origin;
  probes_.push_back({nextId_++, std::move(name), id, reference,
                     target->rest().bind(std::span<const Vec3>(&local, 1), {}), Vec3::Zero()});
  return probes_.back().id;
}

bool Simulator::removeProbe(std::size_t id) {
  const bool found = std::erase_if(probes_, [id](const Probe &probe) { return probe.id == id; }) > 0;
  if (found) ++historyEpoch_;
  return found;
}

Simulator::ProbeState Simulator::probeState(const Probe &probe) const {
  const Body *target = body(probe.body);
  if (!target) return {probe.reference, Vec3::Zero()};
  Vec3 u, v;
  interpolateDisplacements(probe.binding, target->rest().positions, target->state().displacements,
                           std::span<Vec3>(&u, 1), serialFor());
  interpolateField(probe.binding, target->state().velocities, std::span<Vec3>(&v, 1), serialFor());
  if (const auto held = target->supportAt(probe.reference))
    return {probe.reference + held->motion.displacementOf(probe.reference - target->rest().origin), held->velocity};
  return {probe.reference + probe.referenceShift + u, v};
}

void Simulator::setConstitution(std::size_t id, Constitution constitution) {
  const auto found = bodies_.find(id);
  if (found == bodies_.end()) return;
  found->second->body().setConstitution(std::move(constitution), parallelFor_);
  found->second->forget();
  skins_->forgetModuli(id);
  updateAttachments();
  describe(id);
}

void Simulator::setRigid(std::size_t id, bool rigid, bool free) {
  const auto found = bodies_.find(id);
  if (found == bodies_.end()) return;
  const Body &present = found->second->body();
  if (present.rigid() == rigid && present.rigidIsFree() == free) return;
  const bool renewed = found->second->body().rereferenceCount() > 0;
  found->second->body().setRigid(rigid, free);
  found->second->forget();
  if (renewed) bindProbes(id, std::vector<Vec3>(probes_.size(), Vec3::Zero()));
  updateAttachments();
}

Result<void> Simulator::setFoundation(std::size_t id, const Foundation &foundation) {
  const auto found = bodies_.find(id);
  if (found == bodies_.end() || found->second->body().foundation().settings() == foundation) return {};
  if (auto set = found->second->body().setFoundation(foundation); !set) return set;
  found->second->forget();
  return {};
}

double Simulator::stepSize() const {
  if (quasiStatic()) return 0.0;
  if (world_.dt > 0.0 && std::isfinite(world_.dt)) return world_.dt;
  // Step of the body with the longest one; the others divide it into substeps.
  double dt = 0.0;
  for (const auto &[id, stepper] : bodies_) {
    if (stepper->body().isStatic()) continue;
    const double own = stepper->integratorIn(world_) == Integrator::explicitVerlet
                           ? kStepSafety * stepper->body().stableStepAtRest()
                           : kImplicitStep;
    if (std::isfinite(own)) dt = std::max(dt, own);
  }
  return dt > 0.0 ? dt : kStepWithoutBodies;
}

double Simulator::stepSizeOf(std::size_t id) const {
  const Body *target = body(id);
  const double step = stepSize();
  if (!target || target->isStatic() || integratorOf(id) != Integrator::explicitVerlet)
    return target && !target->isStatic() ? step : 0.0;
  const double stable = kStepSafety * target->stableStepAtRest();
  return step / detail::SubstepController::piecesOf(
                    step, target->isFreeRigid() ? std::min(stable, detail::kFreeStep) : stable);
}

Environment Simulator::environment() const {
  Environment env;
  env.gravity = world_.gravity;
  env.damping = world_.damping;
  env.obstacles = obstacles_;
  env.box = world_.box;
  env.tolerance = world_.tolerance;
  env.preconditioner = world_.preconditioner;
  env.parallelFor = &parallelFor_;
  return env;
}

StepComposition Simulator::compositionOf(std::size_t id) const {
  const auto found = bodies_.find(id);
  if (found == bodies_.end()) return {};
  const detail::BodyStepper &stepper = *found->second;
  CompositionNotes notes{{}, stepper.integratorNow(world_), world_.sleep, {}};
  if (stepper.body().isStatic())
    notes.idle = "rigid: it stands as it is";
  else if (stepper.stopped())
    notes.idle = "it has stopped";
  else if (stepper.asleep())
    notes.idle = "asleep until something changes";
  for (const Probe &probe : probes_)
    if (probe.body == id) notes.probes.push_back(probe.name);
  for (const auto &[other, own] : bodies_)
    if (other != id && canTouch(id, other)) notes.touches.push_back(own->body().name());
  notes.touchesItself = touchThemselves_.contains(id);
  Environment env = environment();
  env.obstacles = surroundingsOf(id);
  env.box = boxOf(id);
  return compose(stepper.body(), env, notes);
}

detail::StepContext Simulator::context(const StopRequest *stop) {
  Environment env = environment();
  env.clock = &clock_;
  env.stop = stop;
  return {world_, env, time_, stepSize(), loadFactor_, steps_ + 1, [this](const char *kind, const std::string &text) {
            reportEvent(kind, text);
          }};
}

bool Simulator::finished() const { return quasiStatic() && loadFactor_ >= 1.0 - 1e-12; }

std::size_t Simulator::stoppedBodies() const {
  return static_cast<std::size_t>(
      std::count_if(bodies_.begin(), bodies_.end(), [](const auto &entry) { return entry.second->stopped(); }));
}

bool Simulator::asleep(std::size_t id) const {
  const auto found = bodies_.find(id);
  return found != bodies_.end() && found->second->asleep();
}

void Simulator::wake(std::size_t id) {
  if (const auto found = bodies_.find(id); found != bodies_.end()) found->second->wake();
}

std::uint64_t Simulator::changes(std::size_t id) const {
  const auto found = bodies_.find(id);
  return found == bodies_.end() ? 0 : found->second->changes();
}

bool Simulator::failed() const {
  const auto standing = static_cast<std::size_t>(
      std::count_if(bodies_.begin(), bodies_.end(), [](const auto &entry) { return entry.second->body().isStatic(); }));
  return bodies_.size() > standing && stoppedBodies() + standing == bodies_.size();
}

tl::expected<void, StepFailure> Simulator::step(const StopRequest *stop) {
  const auto refusal = [this] {
    std::string text;
    for (const auto &[id, stepper] : bodies_) text += (text.empty() ? "" : "; ") + stepper->body().stopMessage();
    return tl::unexpected<StepFailure>({text});
  };
  if (failed()) return refusal();
  if (finished()) return {};
  const detail::FlushDenormals flush;
  const detail::StepContext context = this->context(stop);
  if (steps_ == 0) {
    reportInitialWarnings(context);
    if (failed()) return refusal();
    checkSkins();
  }
  for (auto &[id, stepper] : bodies_) stepper->beginStep();
  for (auto &[id, layer] : attachments_) layer->keep();
  double advanced = 0.0;
  try {
    const StoppableLoops::Watch watch(loops_, stop);
    throwIfStopRequested(stop);
    if (quasiStatic())
      increaseLoad(context);
    else
      advanced = advanceBodies(context);
  } catch (const Stopped &) {
    const std::size_t body = activity_->present();
    activity_->leaveAll();
    for (auto &[id, stepper] : bodies_) stepper->undoStep(parallelFor_);
    for (auto &[id, layer] : attachments_) layer->goBack();
    skins_->forget();
    return tl::unexpected<StepFailure>(
        {"the step was ended before it was done; the state before it stays", true, body});
  }
  if (!quasiStatic())
    for (auto &[id, stepper] : bodies_)
      if (!stepper->asleep() && !stepper->body().rigid() && rereferenceIfNeeded(id, stop)) stepper->forget();
  if (failed()) return refusal();
  time_ += advanced;
  advanced_ += advanced;
  ++steps_;
  reportTornAttachments();
  if (isSkinCheckDue()) clock_.measure(kGuard, [this] { checkSkins(); });
  clock_.commit();
  return {};
}

detail::IslandScheduler &Simulator::scheduleIslands(double dt) {
  buildIslands(dt);
  scheduler_->clear();
  std::size_t island = 0;
  for (auto &[id, stepper] : bodies_) {
    if (island < islandCount_ && islands_[island]->members().front().id == id) {
      islands_[island]->markEnergyExchange();
      scheduler_->add(*islands_[island++]);
    }
    if (islandMembers_.contains(id)) continue;
    stepper->setIsland(0);
    if (!stepper->stopped() && !stepper->body().isStatic()) scheduler_->add(id, *stepper);
  }
  return *scheduler_;
}

std::vector<detail::StepContext> Simulator::contextsOf(const detail::Island &island,
                                                       const detail::StepContext &own) const {
  std::vector<detail::StepContext> contexts;
  for (const detail::Island::Member &one : island.members()) contexts.push_back(contextFor(one.id, own));
  return contexts;
}

void Simulator::increaseLoad(const detail::StepContext &context) {
  const int increments = world_.loadSteps > 0 ? world_.loadSteps : kUsualLoadSteps;
  double next = std::min(1.0, loadFactor_ + 1.0 / increments);
  if (next > 1.0 - 1e-9) next = 1.0;
  scheduleIslands(0.0).run(context, plainLoops_, *activity_,
                           [this, next](detail::IslandScheduler::Member &member, const detail::StepContext &own) {
                             if (member.island)
                               member.island->loadUpTo(contextsOf(*member.island, own), next);
                             else
                               member.stepper->loadUpTo(contextFor(member.id, own), next);
                           });
  if (!failed()) loadFactor_ = next;
}

double Simulator::advanceBodies(const detail::StepContext &context) {
  detail::IslandScheduler &scheduler = scheduleIslands(context.dt);
  scheduler.run(context, plainLoops_, *activity_,
                [&](detail::IslandScheduler::Member &member, const detail::StepContext &own) {
                  member.advanced = member.stepper ? member.stepper->advance(contextFor(member.id, own), own.dt)
                                                   : member.island->advance(contextsOf(*member.island, own), own.dt);
                });
  double span = context.dt;
  for (const detail::IslandScheduler::Member &member : scheduler.members()) {
    span = std::min(span, member.advanced);
    if (member.stepper) {
      spent_[member.id] += member.seconds;
      continue;
    }
    double points = 0.0;
    for (const detail::Island::Member &one : member.island->members())
      points += static_cast<double>(one.stepper->body().rest().pointCount());
    for (const detail::Island::Member &one : member.island->members())
      spent_[one.id] += member.seconds * static_cast<double>(one.stepper->body().rest().pointCount()) / points;
  }
  if (!(span < context.dt)) return span;
  // If the substeps of a body were not enough, the others have advanced too far.
  scheduler.run(context, plainLoops_, *activity_,
                [&](detail::IslandScheduler::Member &member, const detail::StepContext &own) {
                  if (!(member.advanced > span)) return;
                  if (member.island)
                    member.island->advanceAgain(contextsOf(*member.island, own), span);
                  else if (!member.stepper->stopped())
                    member.stepper->advanceAgain(contextFor(member.id, own), span);
                });
  return span;
}

void Simulator::reset() {
  endGuidance();
  for (auto &[id, stepper] : bodies_) {
    const bool renewed = stepper->body().rereferenceCount() > 0;
    stepper->reset();
    if (renewed) bindProbes(id, std::vector<Vec3>(probes_.size(), Vec3::Zero()));
  }
  skins_->forget();
  for (const auto &island : islands_) island->resetSolver();
  for (auto &[id, layer] : attachments_) layer->mend();
  tornReported_.clear();
  ++historyEpoch_;
  time_ = 0.0;
  loadFactor_ = 0.0;
  steps_ = 0;
  events_.clear();
  for (const auto &[id, warnings] : warnings_)
    for (const std::string &warning : warnings) reportEvent("warning", warning);
  notRereferenced_.clear();
  skinDeepest_.clear();
  rigidDeepest_.clear();
  overlaps_.clear();
  lastPair_ = {0, 0};
  initialWarningsReported_ = false;
  spent_.clear();
  advanced_ = 0.0;
}

void Simulator::setExternalForces(std::size_t id, std::span<const Vec3> forces) {
  std::vector<Vec3> copy(forces.begin(), forces.end());
  swapExternalForces(id, copy);
}

void Simulator::swapExternalForces(std::size_t id, std::vector<Vec3> &forces) {
  Body *target = body(id);
  if (!target || target->isStatic()) return;
  const bool none = std::all_of(forces.begin(), forces.end(), [](const Vec3 &f) { return f.isZero(0.0); });
  if (none && target->externalForces().empty()) return;
  if (none) bodies_.at(id)->forgetEnergy();  // energy that they have added is not spurious
  if (!none && bodies_.at(id)->asleep()) bodies_.at(id)->wake();
  if (none) forces.clear();
  target->swapExternalForces(forces);
}

namespace {

template <class B>
auto findGrab(B *body, std::uint64_t id) -> decltype(body->grabs.data()) {
  if (!body) return nullptr;
  for (auto &hand : body->grabs)
    if (hand.id == id) return &hand;
  return nullptr;
}

}  // namespace

void Simulator::setGrab(std::size_t id, Grab grab, std::uint64_t hand) {
  Body *target = body(id);
  if (!target || grab.phyxels.empty() || target->isStatic()) return;
  POINTBASED_EXPECTS(grab.weights.size() == grab.phyxels.size(), "one weight per grabbed phyxel");
  POINTBASED_EXPECTS(grab.arms.empty() || grab.arms.size() == grab.phyxels.size(),
                     "one arm per grabbed phyxel, or none");
  POINTBASED_EXPECTS(
      std::all_of(grab.phyxels.begin(), grab.phyxels.end(), [&](Index i) { return i < target->rest().phyxelCount(); }),
      "grabs phyxels that there are");
  if (ActiveGrab *present = findGrab(target, hand))
    *present = {hand, std::move(grab), {}};
  else
    target->grabs.push_back({hand, std::move(grab), {}});
  target->forcesCurrent = false;
  bodies_.at(id)->forgetEnergy();
}

void Simulator::moveGrab(std::size_t id, const Vec3 &position, std::uint64_t hand) {
  if (ActiveGrab *present = findGrab(body(id), hand)) present->grab.target = position;
}

void Simulator::turnGrab(std::size_t id, const Mat3 &rotation, std::uint64_t hand) {
  if (ActiveGrab *present = findGrab(body(id), hand)) present->grab.rotation = rotation;
}

void Simulator::releaseGrab(std::size_t id, std::uint64_t hand) {
  Body *target = body(id);
  if (!target || std::erase_if(target->grabs, [hand](const ActiveGrab &h) { return h.id == hand; }) == 0) return;
  target->forcesCurrent = false;
  bodies_.at(id)->forgetEnergy();  // energy that the grab has added is not spurious
}

std::optional<GrabStatus> Simulator::grabStatus(std::size_t id, std::uint64_t hand) const {
  const ActiveGrab *present = findGrab(body(id), hand);
  return present ? std::optional(present->status) : std::nullopt;
}

void Simulator::surfels(std::size_t id, std::vector<Vec3> &positions, std::vector<Vec3> &normals) {
  const Body *target = body(id);
  if (!target) return;
  const RestState &rest = target->rest();
  positions.resize(rest.surfels.count());
  normals.resize(rest.surfelNormals.size());
  clock_.measure(kSurfels, [&] {
    updateSurfels(rest.surfels, rest.surfelNormals, rest.positions, target->state().displacements, positions, normals,
                  parallelFor_);
    target->placeHeldSurfels(positions, normals);
    for (Vec3 &x : positions) x += rest.origin;
  });
}

void Simulator::surfels(std::size_t id, std::vector<Vec3f> &positions, std::vector<Vec3f> &normals) {
  const Body *target = body(id);
  if (!target) return;
  const RestState &rest = target->rest();
  positions.resize(rest.surfels.count());
  normals.resize(rest.surfelNormals.size());
  clock_.measure(kSurfels, [&] {
    updateSurfels(rest.surfels, rest.surfelNormals, rest.origin, rest.positions, target->state().displacements,
                  screenPhyxels_, positions, normals, parallelFor_);
    target->placeHeldSurfels(positions, normals);
  });
}

Simulator::Energy Simulator::energy(std::size_t id) const {
  Energy out;
  const Body *target = body(id);
  if (!target) return out;
  const ElasticEnergy elastic = target->elasticEnergy(parallelFor_);
  out.elastic = elastic.strain;
  out.stabilisation = elastic.stabilisation;
  out.kinetic = target->kineticEnergy();
  out.foundation = target->foundation().energy(target->state().displacements) + attachedEnergy(id);
  for (std::size_t i = 0; i < target->masses().size(); ++i)
    out.gravity -= target->weights()[i] * world_.gravity.dot(target->state().displacements[i]);
  out.gravity -= world_.gravity.dot(target->referenceShiftMoment());
  return out;
}

std::vector<Reaction> Simulator::reactions(std::size_t id) const {
  const Body *target = body(id);
  return target ? target->reactions(world_.gravity) : std::vector<Reaction>{};
}

std::uint64_t Simulator::stateHash() const {
  std::uint64_t hash = detail::kHashStart;
  for (const auto &[id, stepper] : bodies_) hash = detail::hashOf(stepper->body(), hash);
  return hash;
}

void Simulator::reportEvent(const std::string &kind, const std::string &text) {
  if (events_.size() < kMaxEvents) events_.push_back({time(), kind, text});
}

}  // namespace pointbased
