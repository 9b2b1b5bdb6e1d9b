// SPDX-License-Identifier: Apache-2.0
#include "pointbased/simulator.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>

#include "flush_denormals.h"
#include "pointbased/cloud_quality.h"

namespace pointbased {
namespace {

constexpr std::uint64_t kMostSubsteps = 10'000, kLeastSubsteps = 1'000;  // of a step, before it ends early
constexpr double kMostWork = 2e7;           // evaluations of points in a step: some seconds, so that a run can be interrupted
constexpr double kCrushed = 3e-4;           // of the stable step at rest: below it a body stops (an impact at Mach 27: 1e-3)
constexpr double kRestless = 0.25;          // of the step in use while somebody changes the size of the steps to and fro
constexpr double kStepWithoutBodies = 1.0 / 60.0;  // s
constexpr std::size_t kMostEvents = 200;
constexpr int kMostHalvings = 6;            // of the increments of a load that are tried before a body stops
constexpr double kSmallestScale = 1.0 / 64; // of the steps that are tried before a body stops
constexpr double kCrushedScale = 1.0 / 4;   // likewise where it is crushed, which smaller steps seldom change
constexpr std::uint64_t kPatience = 256;    // good steps before a larger one is tried again
constexpr double kStride = 0.25;            // spacings a phyxel may go, relative to its body, in a substep

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

// The same loop with denormals flushed on every thread that takes a part of it.
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

void hashBytes(std::uint64_t &hash, const void *data, std::size_t size) {
  const auto *bytes = static_cast<const unsigned char *>(data);
  for (std::size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 1099511628211ull;
}

}  // namespace

struct Simulator::Runner {
  std::unique_ptr<Body> body;
  NewtonSolver solver;
  EnergyWatch energy;
  double scale = 1.0;             // part of the stable step in use, after failures
  std::uint64_t goodSteps = 0;
  std::uint64_t mostSubsteps = 1;
  double pieces = 1.0;            // of a step at present: changing them to and fro would pump energy into what swings
  std::uint64_t fewerWouldDo = 0; // steps in a row
  bool crushed = false;           // why the last step has failed
  double advanced = 0.0;          // s, that the last step has gone
  bool limited = true;            // in the substeps of a step
  double lastStep = 0.0;          // s
  std::uint64_t sinceChange = kPatience, restless = 0;  // steps since their size has changed, and left to be careful
  bool toldSwitch = false, toldSlow = false;
  std::vector<std::string> warnings;  // about its shape and sampling

  [[nodiscard]] std::uint64_t substepLimit() const {
    if (!limited) return std::numeric_limits<std::uint64_t>::max();
    const double points = static_cast<double>(std::max<std::size_t>(1, body->rest().pointCount()));
    return static_cast<std::uint64_t>(
        std::clamp(kMostWork / points, static_cast<double>(kLeastSubsteps), static_cast<double>(kMostSubsteps)));
  }
  // Each size of step keeps an energy of its own, (ω dt)²/4 of the exact one off in the fastest modes. One change moves the
  // energy once, changes in turn can pump it: then dt is taken so small that these energies are the same to 4 %.
  void noticeStep(double dt) {
    if (lastStep > 0.0 && std::abs(dt - lastStep) > 1e-9 * lastStep) {
      if (sinceChange < kPatience) restless = kPatience;
      sinceChange = 0;
    } else {
      ++sinceChange;
      if (restless > 0) --restless;
    }
    lastStep = dt;
  }
};

Simulator::Simulator(ParallelFor parallelFor) : parallelFor_(flushing(std::move(parallelFor))), clock_(stageNames()) {}
Simulator::~Simulator() = default;

void Simulator::setWorld(const WorldSettings &world) {
  const bool wasStatic = quasiStatic();
  const bool otherEnergy = world.integrator != world_.integrator || world.gravity != world_.gravity ||
                           world.box.enabled != world_.box.enabled || world.box.min != world_.box.min ||
                           world.box.max != world_.box.max;
  world_ = world;
  if (!wasStatic && quasiStatic()) loadFactor_ = 0.0;
  if (wasStatic && !quasiStatic())
    for (const auto &[id, runner] : bodies_) {
      const BoundaryConditions &conditions = runner->body->rest().conditions;
      for (const Fix &fix : conditions.fixes) time_ = std::max(time_, loadFactor_ * fix.ramp);
      for (const Load &load : conditions.loads) time_ = std::max(time_, loadFactor_ * load.ramp);
    }
  for (auto &[id, runner] : bodies_) {
    runner->body->quasiStatic = quasiStatic();
    runner->body->forcesCurrent = false;
    if (otherEnergy) runner->energy.forget();
  }
}

std::size_t Simulator::addBody(std::unique_ptr<Body> body) {
  body->quasiStatic = quasiStatic();
  auto runner = std::make_unique<Runner>();
  runner->body = std::move(body);
  const RestState &rest = runner->body->rest();
  std::string cloud = inspectCloud(rest).warning();
  if (!cloud.empty()) cloud += "; sampling.neighbours and the spacing change it";
  for (const std::string &unusual : {volumeWarning(rest), cloud})
    if (!unusual.empty()) {
      runner->warnings.push_back("body '" + runner->body->name() + "': " + unusual);
      note("warning", runner->warnings.back());
    }
  bodies_.emplace(nextId_, std::move(runner));
  return nextId_++;
}

std::size_t Simulator::addObstacle(Obstacle obstacle) {
  obstacles_.push_back(std::move(obstacle));
  obstacleIds_.push_back(nextId_);
  for (auto &[id, runner] : bodies_) runner->body->contact = ContactMemory();
  return nextId_++;
}

bool Simulator::removeBody(std::size_t id) {
  std::erase_if(probes_, [id](const Probe &p) { return p.body == id; });
  return bodies_.erase(id) > 0;
}

bool Simulator::removeObstacle(std::size_t id) {
  const auto found = std::find(obstacleIds_.begin(), obstacleIds_.end(), id);
  if (found == obstacleIds_.end()) return false;
  obstacles_.erase(obstacles_.begin() + (found - obstacleIds_.begin()));
  obstacleIds_.erase(found);
  for (auto &[other, runner] : bodies_) runner->body->contact = ContactMemory();
  return true;
}

void Simulator::clear() {
  bodies_.clear();
  obstacles_.clear();
  obstacleIds_.clear();
  probes_.clear();
  reset();
}

Body *Simulator::body(std::size_t id) {
  const auto found = bodies_.find(id);
  return found == bodies_.end() ? nullptr : found->second->body.get();
}

const Body *Simulator::body(std::size_t id) const {
  const auto found = bodies_.find(id);
  return found == bodies_.end() ? nullptr : found->second->body.get();
}

std::vector<std::size_t> Simulator::bodyIds() const {
  std::vector<std::size_t> ids;
  for (const auto &[id, runner] : bodies_) ids.push_back(id);
  return ids;
}

RigidMotion Simulator::obstacleMotion(std::size_t id) const {
  const auto found = std::find(obstacleIds_.begin(), obstacleIds_.end(), id);
  if (found == obstacleIds_.end()) return {};
  const Obstacle &obstacle = obstacles_[static_cast<std::size_t>(found - obstacleIds_.begin())];
  return obstacle.motion ? obstacle.motion(clockOfRamps()) : RigidMotion{};
}

void Simulator::addProbe(std::string name, std::size_t id, const Vec3 &reference) {
  const Body *target = body(id);
  if (!target) return;
  const Vec3 local = reference - target->rest().origin;
  probes_.push_back(
      {std::move(name), id, reference, target->rest().bind(std::span<const Vec3>(&local, 1), {}), Vec3::Zero()});
}

Simulator::ProbeState Simulator::probeState(const Probe &probe) const {
  const Body *target = body(probe.body);
  if (!target) return {probe.reference, Vec3::Zero()};
  Vec3 u, v;
  interpolateDisplacements(probe.binding, target->rest().positions, target->state().displacements,
                           std::span<Vec3>(&u, 1), serialFor());
  interpolateField(probe.binding, target->state().velocities, std::span<Vec3>(&v, 1), serialFor());
  return {probe.reference + probe.carried + u, v};
}

void Simulator::setConstitution(std::size_t id, Constitution constitution) {
  const auto found = bodies_.find(id);
  if (found == bodies_.end()) return;
  found->second->body->setConstitution(std::move(constitution), parallelFor_);
  found->second->solver.forget();
  found->second->energy.forget();
}

Integrator Simulator::integratorOf(const Runner &runner) const {
  if (world_.integrator == Integrator::explicitVerlet && world_.dt <= 0.0 &&
      kStepSafety * runner.body->stableStepAtRest() < kSmallestExplicitStep)
    return Integrator::implicitSdirk;
  // Without damping of its own the midpoint rule does not settle what relaxes.
  if (world_.integrator == Integrator::implicitMidpoint && runner.body->constitution().relaxing())
    return Integrator::implicitSdirk;
  return world_.integrator;
}

double Simulator::stepSize() const {
  if (quasiStatic()) return 0.0;
  if (world_.dt > 0.0 && std::isfinite(world_.dt)) return world_.dt;
  double dt = std::numeric_limits<double>::infinity();
  for (const auto &[id, runner] : bodies_)
    dt = std::min(dt, integratorOf(*runner) == Integrator::explicitVerlet ? kStepSafety * runner->body->stableStepAtRest()
                                                                         : kImplicitStep);
  return std::isfinite(dt) ? dt : kStepWithoutBodies;
}

Environment Simulator::environment() {
  Environment env;
  env.gravity = world_.gravity;
  env.damping = world_.damping;
  env.obstacles = obstacles_;
  env.box = world_.box;
  env.tolerance = world_.tolerance;
  env.preconditioner = world_.preconditioner;
  env.parallelFor = &parallelFor_;
  env.clock = &clock_;
  return env;
}

bool Simulator::driven(const Body &body) const {
  if (body.grab || !obstacles_.empty()) {
    if (body.grab) return true;
    for (const Obstacle &obstacle : obstacles_)
      if (obstacle.motion) return true;
  }
  const BoundaryConditions &conditions = body.rest().conditions;
  for (const Fix &fix : conditions.fixes)
    if (fix.ramp > 0.0 && time_ <= 1.5 * fix.ramp) return true;
  for (const Load &load : conditions.loads)
    if ((load.ramp > 0.0 && time_ <= 1.5 * load.ramp) || (load.pressure != 0.0 && load.follower)) return true;
  return body.constitution().relaxing();
}

std::optional<GuardFinding> Simulator::advanceExplicit(Runner &runner, const Environment &env, double dt,
                                                       GuardGlance glance) {
  Body &body = *runner.body;
  const double rest = body.stableStepAtRest(), careful = runner.restless > 0 ? kRestless : 1.0;
  const std::uint64_t most = runner.substepLimit();
  double left = dt, time = time_, mostNeeded = 1.0;
  std::uint64_t substeps = 0;
  while (left > 1e-12 * dt && substeps < most) {
    double stable = body.stableStep();
    GuardView view;
    clock_.measure(kGuard, [&] {
      if (substeps > 0) glance = glanceAt(body);
      if (!glance.finite || glance.speedBound * stable > kStride * body.rest().spacing) view = lookAt(body);
    });
    if (!view.finite) return firstNonFinite(body);
    const bool stiff = !(stable > kCrushed * rest);
    const double part = kStepSafety * runner.scale * careful;
    stable *= part;
    if (view.fastest > 0.0) stable = std::min(stable, kStride * body.rest().spacing / view.fastest);
    // An impact sets phyxels in motion against each other that had the same velocity before.
    const double impact = impactSpeed(body, env, time, std::min(left, stable), kStride * body.rest().spacing);
    if (impact > 0.0) stable = std::min(stable, kStride * body.rest().spacing / impact);
    runner.crushed = std::isfinite(rest) && !(stable > part * kCrushed * rest);
    if (runner.crushed) {
      view = lookAt(body);
      if (!view.finite) return firstNonFinite(body);
      return GuardFinding{view.fastestPhyxel,
                          "the stable step has fallen to " + number(stable / part) + " s, 1/" + number(rest / stable * part) +
                              " of that at rest: " +
                              (stiff ? "the body is crushed or inverted"
                                       : "it moves " + number(std::max(view.fastest, impact)) + " m/s"),
                          "solver.integrator = \"implicit\", a smaller solver.dt, or a softer or coarser body"};
    }
    // Even pieces of what is left, so that the last one is not a sliver.
    const double needed = std::ceil(left / stable * (1.0 - 1e-9));
    mostNeeded = std::max(mostNeeded, std::ceil(dt / stable * (1.0 - 1e-9)));
    const double pieces = std::max(needed, std::ceil(left * runner.pieces / dt * (1.0 - 1e-9)));
    const double piece = pieces > 1.0 ? (pieces < 1e15 ? left / pieces : stable) : left;
    explicitSubstep(body, env, time, piece);
    left -= piece;
    time += piece;
    ++substeps;
  }
  // Displacements have grown by these velocities and dt: they are finite where these are.
  bool finite = true;
  clock_.measure(kGuard, [&] { finite = isFinite(body.state().velocities); });
  if (!finite) return firstNonFinite(body);
  const bool whole = !(left > 1e-12 * dt);
  runner.advanced = whole ? dt : time - time_;
  if (mostNeeded >= runner.pieces) {
    runner.pieces = mostNeeded;
    runner.fewerWouldDo = 0;
  } else if (++runner.fewerWouldDo >= kPatience) {
    runner.pieces = mostNeeded;
    runner.fewerWouldDo = 0;
  }
  if (substeps > runner.mostSubsteps) {
    runner.mostSubsteps = substeps;
    note("substep", "body '" + body.name() + "': a step of " + number(dt) + " s was divided into " +
                        (whole ? std::to_string(substeps) : number(mostNeeded)) + " substeps of " +
                        number(runner.advanced / static_cast<double>(substeps)) + " s");
  }
  if (!whole && !runner.toldSlow) {
    runner.toldSlow = true;
    note("slowed", "body '" + body.name() + "': a step ended after " + std::to_string(substeps) + " substeps at " +
                       number(runner.advanced) + " s of " + number(dt) + " s; time goes on by what is done in a step");
  }
  return std::nullopt;
}

std::optional<GuardFinding> Simulator::advanceImplicit(Runner &runner, const Environment &env, double dt) {
  Body &body = *runner.body;
  const Integrator scheme = integratorOf(runner);
  const auto pieces = static_cast<int>(std::llround(std::ceil(1.0 / runner.scale)));
  const double piece = dt / pieces;
  for (int k = 0; k < pieces; ++k) {
    const ImplicitResult result = implicitStep(body, runner.solver, env, time_ + k * piece, piece, scheme);
    if (!result.failure.empty())
      return GuardFinding{result.newton.worst, result.failure,
                          "a smaller solver.dt, solver.integrator = \"backward_euler\", or material.law = \"neo_hookean\""};
    bool finite = true;
    clock_.measure(kGuard, [&] { finite = glanceAt(body).finite; });
    if (!finite) return firstNonFinite(body);
  }
  return std::nullopt;
}

void Simulator::stop(Runner &runner, const GuardFinding &finding) {
  Body &body = *runner.body;
  // Forces and strains of the state that stays, not of the step that failed.
  body.computeGradients(parallelFor_);
  body.computeStresses(0.0, parallelFor_);
  body.computeForces(clockOfRamps(), parallelFor_);
  body.stopped = "body '" + body.name() + "', phyxel " + std::to_string(finding.phyxel) + ": " + finding.quantity +
                 "; it stands still in the last good state. Help: " + finding.help;
  note("stopped", body.stopped);
}

void Simulator::advance(Runner &runner, const Environment &env, double dt) {
  Body &body = *runner.body;
  runner.advanced = dt;
  const Integrator integrator = integratorOf(runner);
  if (integrator != world_.integrator && !runner.toldSwitch) {
    runner.toldSwitch = true;
    note("switched", world_.integrator == Integrator::implicitMidpoint
                         ? "body '" + body.name() + "' relaxes, which the midpoint rule does not settle; it is given \"implicit\""
                         : "body '" + body.name() + "' is so stiff that explicit steps would be " +
                               number(kStepSafety * body.stableStepAtRest()) +
                               " s long; it is integrated implicitly. If it hardly deforms, make it an obstacle (rigid)");
  }
  // What somebody has put in from outside is caught before it becomes the state to go back to.
  GuardGlance glance;
  clock_.measure(kGuard, [&] { glance = glanceAt(body); });
  if (!glance.finite) {
    const auto poisoned = firstNonFinite(body);
    body.restoreState();
    return stop(runner, poisoned ? *poisoned : GuardFinding{0, "the state is not finite", "a reset"});
  }
  if (body.grab && !body.grab->target.allFinite()) {
    const Index held = body.grab->phyxels.front();
    return stop(runner, {held, "the hand that holds it is at no finite place", "to let go and reset"});
  }
  body.keepState();
  GuardFinding finding;
  for (bool again = true; again;) {
    runner.crushed = false;
    auto found = integrator == Integrator::explicitVerlet ? advanceExplicit(runner, env, dt, glance)
                                                          : advanceImplicit(runner, env, dt);
    if (!found && (steps_ + 1) % EnergyWatch::kEnergyInterval == 0)
      clock_.measure(kGuard, [&] { found = runner.energy.look(body, world_.gravity, driven(body)); });
    if (!found) {
      if (runner.scale < 1.0 && ++runner.goodSteps >= kPatience) {
        runner.scale = std::min(1.0, 2.0 * runner.scale);
        runner.goodSteps = 0;
      }
      return;
    }
    finding = *found;
    body.restoreState();
    body.computeGradients(parallelFor_);
    body.computeStresses(0.0, parallelFor_);
    runner.solver.forget();
    runner.goodSteps = 0;
    again = runner.scale > (runner.crushed ? kCrushedScale : kSmallestScale);
    if (again) {
      runner.scale *= 0.5;
      note("smaller_step", "body '" + body.name() + "', phyxel " + std::to_string(finding.phyxel) + ": " + finding.quantity +
                               "; back to the state before, with steps " + number(1.0 / runner.scale) + " times smaller");
    }
  }
  runner.advanced = dt;
  stop(runner, finding);
}

void Simulator::loadIncrement(Runner &runner, const Environment &env, double from, double to) {
  Body &body = *runner.body;
  double at = from, size = to - from;
  int halvings = 0;
  while (at < to - 1e-12) {
    const double next = std::min(to, at + size);
    body.keepState();
    const ImplicitResult result = quasiStaticStep(body, runner.solver, env, at, next);
    const bool finite = glanceAt(body).finite;
    if (result.failure.empty() && finite) {
      at = next;
      continue;
    }
    body.restoreState();
    runner.solver.forget();
    const GuardFinding finding{result.newton.worst, result.failure.empty() ? "the state is not finite" : result.failure,
                               "more solver.load_steps, a smaller load, or solver.integrator = \"implicit\" with damping"};
    if (++halvings > kMostHalvings) return stop(runner, finding);
    size *= 0.5;
    note("smaller_step", "body '" + body.name() + "': " + finding.quantity + "; back to load factor " + number(at) +
                             ", with increments of " + number(size));
  }
}

bool Simulator::finished() const { return quasiStatic() && loadFactor_ >= 1.0 - 1e-12; }

std::size_t Simulator::stoppedBodies() const {
  return static_cast<std::size_t>(
      std::count_if(bodies_.begin(), bodies_.end(), [](const auto &entry) { return !entry.second->body->stopped.empty(); }));
}

bool Simulator::failed() const { return !bodies_.empty() && stoppedBodies() == bodies_.size(); }

tl::expected<void, StepFailure> Simulator::step() {
  const auto refusal = [this] {
    std::string text;
    for (const auto &[id, runner] : bodies_) text += (text.empty() ? "" : "; ") + runner->body->stopped;
    return tl::unexpected<StepFailure>({text});
  };
  if (failed()) return refusal();
  if (finished()) return {};
  const detail::FlushDenormals flush;
  const Environment env = environment();
  const double dt = stepSize();
  if (quasiStatic()) {
    const int increments = world_.loadSteps > 0 ? world_.loadSteps : 10;
    double next = std::min(1.0, loadFactor_ + 1.0 / increments);
    if (next > 1.0 - 1e-9) next = 1.0;
    for (auto &[id, runner] : bodies_)
      if (runner->body->stopped.empty()) loadIncrement(*runner, env, loadFactor_, next);
    if (failed()) return refusal();
    loadFactor_ = next;
  } else {
    double span = dt;
    std::vector<Runner *> ahead;
    for (auto &[id, runner] : bodies_) {
      if (!runner->body->stopped.empty()) continue;
      runner->noticeStep(dt);
      advance(*runner, env, span);
      if (runner->advanced < span) {
        // Those before it have gone too far.
        span = runner->advanced;
        for (Runner *other : ahead) {
          if (!other->body->stopped.empty()) continue;
          other->body->restoreState();
          other->limited = false;
          advance(*other, env, span);
          other->limited = true;
        }
      }
      ahead.push_back(runner.get());
    }
    for (auto &[id, runner] : bodies_) {
      if (!renewIfDue(id)) continue;
      runner->solver.forget();
      runner->energy.forget();
    }
    if (failed()) return refusal();
    time_ += span;
  }
  ++steps_;
  clock_.commit();
  return {};
}

void Simulator::reset() {
  for (auto &[id, runner] : bodies_) {
    const bool renewed = runner->body->renewals() > 0;
    runner->body->reset();
    if (renewed) bindProbes(id, std::vector<Vec3>(probes_.size(), Vec3::Zero()));
    runner->solver.forget();
    runner->energy.forget();
    runner->scale = 1.0;
    runner->goodSteps = 0;
    runner->mostSubsteps = 1;
    runner->pieces = 1.0;
    runner->fewerWouldDo = 0;
    runner->toldSwitch = false;
    runner->toldSlow = false;
    runner->lastStep = 0.0;
    runner->sinceChange = kPatience;
    runner->restless = 0;
  }
  time_ = 0.0;
  loadFactor_ = 0.0;
  steps_ = 0;
  events_.clear();
  for (const auto &[id, runner] : bodies_)
    for (const std::string &warning : runner->warnings) note("warning", warning);
  notRenewed_.clear();
}

void Simulator::setGrab(std::size_t id, Grab grab) {
  Body *target = body(id);
  if (!target || grab.phyxels.empty()) return;
  target->grab = std::move(grab);
  target->forcesCurrent = false;
}

void Simulator::moveGrab(std::size_t id, const Vec3 &position) {
  if (Body *target = body(id); target && target->grab) target->grab->target = position;
}

void Simulator::releaseGrab(std::size_t id) {
  Body *target = body(id);
  if (!target) return;
  if (target->grab) target->forcesCurrent = false;
  target->grab.reset();
  target->grabStatus.reset();
}

std::optional<GrabStatus> Simulator::grabStatus(std::size_t id) const {
  const Body *target = body(id);
  return target ? target->grabStatus : std::nullopt;
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
    for (Vec3 &x : positions) x += rest.origin;
  });
}

Simulator::Energy Simulator::energy(std::size_t id) const {
  Energy out;
  const Body *target = body(id);
  if (!target) return out;
  const ElasticEnergy elastic = target->elasticEnergy();
  out.elastic = elastic.strain;
  out.stabilisation = elastic.stabilisation;
  out.kinetic = target->kineticEnergy();
  for (std::size_t i = 0; i < target->masses().size(); ++i)
    out.gravity -= target->weights()[i] * world_.gravity.dot(target->state().displacements[i]);
  out.gravity -= world_.gravity.dot(target->carriedMoment());
  return out;
}

std::vector<Reaction> Simulator::reactions(std::size_t id) const {
  const Body *target = body(id);
  return target ? target->reactions(world_.gravity) : std::vector<Reaction>{};
}

std::uint64_t Simulator::stateHash() const {
  std::uint64_t hash = 14695981039346656037ull;
  for (const auto &[id, runner] : bodies_) {
    const State &state = runner->body->state();
    for (const Vec3 &u : state.displacements) hashBytes(hash, u.data(), 3 * sizeof(double));
    for (const Vec3 &v : state.velocities) hashBytes(hash, v.data(), 3 * sizeof(double));
    for (const Mat3 &F : state.history.plasticInverse) hashBytes(hash, F.data(), 9 * sizeof(double));
    for (const PronyPoint &point : state.history.prony) {
      hashBytes(hash, point.previous.data(), 9 * sizeof(double));
      for (const Mat3 &Q : point.internal) hashBytes(hash, Q.data(), 9 * sizeof(double));
    }
    for (const ModalMemory &modes : state.history.modes) {
      hashBytes(hash, modes.previous.data(), 12 * sizeof(double));
      for (const ModalStrain &relaxed : modes.relaxed) hashBytes(hash, relaxed.data(), 12 * sizeof(double));
    }
    if (runner->body->renewals() == 0) continue;
    for (const Vec3 &X : runner->body->rest().positions) hashBytes(hash, X.data(), 3 * sizeof(double));
    for (const Mat3 &S : runner->body->rest().stencils.reference) hashBytes(hash, S.data(), 9 * sizeof(double));
  }
  return hash;
}

void Simulator::note(const std::string &kind, const std::string &text) {
  if (events_.size() < kMostEvents) events_.push_back({time(), kind, text});
}

}  // namespace pointbased
