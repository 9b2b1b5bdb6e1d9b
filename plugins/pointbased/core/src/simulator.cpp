// SPDX-License-Identifier: Apache-2.0
#include "pointbased/simulator.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace pointbased {
namespace {

// A step that needs more substeps than this has lost its balance; going on would only take longer to fail.
constexpr double kMostSubsteps = 1000.0;
constexpr double kStepWithoutBodies = 1e-3;
constexpr std::size_t kMostEvents = 1000;

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

void hashBytes(std::uint64_t &hash, const void *data, std::size_t n) {
  const auto *bytes = static_cast<const unsigned char *>(data);
  for (std::size_t i = 0; i < n; ++i) hash = (hash ^ bytes[i]) * 1099511628211ull;
}

}  // namespace

Simulator::Simulator(ParallelFor parallelFor)
    : parallelFor_(std::move(parallelFor)),
      clock_({"deformation_gradients", "stresses", "internal_forces", "contact", "integrate", "surfels"}) {}

void Simulator::setWorld(const WorldSettings &world) {
  world_ = world;
  forcesCurrent_ = false;
}

std::size_t Simulator::addBody(std::unique_ptr<Body> body) {
  const std::size_t id = nextId_++;
  bodies_.emplace(id, std::move(body));
  forcesCurrent_ = false;
  return id;
}

std::size_t Simulator::addObstacle(Obstacle obstacle) {
  const std::size_t id = nextId_++;
  obstacles_.push_back(std::move(obstacle));
  obstacleIds_.push_back(id);
  for (auto &[bodyId, body] : bodies_) body->contact.clearance.clear();
  return id;
}

bool Simulator::removeBody(std::size_t id) {
  grabs_.erase(id);
  grabStatus_.erase(id);
  std::erase_if(probes_, [&](const Probe &probe) { return probe.body == id; });
  return bodies_.erase(id) > 0;
}

bool Simulator::removeObstacle(std::size_t id) {
  const auto found = std::find(obstacleIds_.begin(), obstacleIds_.end(), id);
  if (found == obstacleIds_.end()) return false;
  obstacles_.erase(obstacles_.begin() + (found - obstacleIds_.begin()));
  obstacleIds_.erase(found);
  for (auto &[bodyId, body] : bodies_) body->contact.clearance.clear();
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
  return found == bodies_.end() ? nullptr : found->second.get();
}

const Body *Simulator::body(std::size_t id) const {
  const auto found = bodies_.find(id);
  return found == bodies_.end() ? nullptr : found->second.get();
}

std::vector<std::size_t> Simulator::bodyIds() const {
  std::vector<std::size_t> ids;
  for (const auto &[id, body] : bodies_) ids.push_back(id);
  return ids;
}

void Simulator::addProbe(std::string name, std::size_t id, const Vec3 &reference) {
  const Body *target = body(id);
  if (!target) return;
  const std::vector<Vec3> point{reference - target->rest().origin};
  probes_.push_back({std::move(name), id, reference, bindSurfels(point, {}, target->rest().positions, parallelFor_)});
}

Simulator::ProbeState Simulator::probeState(const Probe &probe) const {
  const Body &target = *body(probe.body);
  std::vector<Vec3> position(1);
  updateSurfels(probe.binding, target.rest().positions, target.state().displacements, target.gradients(), position, {},
                serialFor());
  Vec3 velocity = Vec3::Zero();
  for (std::size_t e = 0; e < probe.binding.weights.size(); ++e)
    velocity += probe.binding.weights[e] * target.state().velocities[probe.binding.phyxels.indices[e]];
  return {position[0] + target.rest().origin, velocity};
}

void Simulator::setMaterial(std::size_t id, const Material &material, double stabilisation) {
  if (Body *target = body(id)) {
    target->setMaterial(material, stabilisation, parallelFor_);
    forcesCurrent_ = false;
  }
}

double Simulator::stepSize() const {
  if (world_.dt > 0.0) return world_.dt;
  double dt = std::numeric_limits<double>::infinity();
  for (const auto &[id, body] : bodies_) dt = std::min(dt, kStepSafety * body->stableStepAtRest());
  return std::isfinite(dt) ? dt : kStepWithoutBodies;
}

void Simulator::evaluateForces(Body &target) {
  clock_.measure(kGradients, [&] { target.computeGradients(parallelFor_); });
  clock_.measure(kStresses, [&] { target.computeStresses(parallelFor_); });
  clock_.measure(kForces, [&] { target.computeForces(parallelFor_); });
}

void Simulator::applyGrab(std::size_t id, Body &target) {
  const auto found = grabs_.find(id);
  if (found == grabs_.end()) return;
  const Grab &grab = found->second;
  GrabStatus status;
  Vec3 velocity = Vec3::Zero();
  double inverseMass = 0.0;
  for (std::size_t k = 0; k < grab.phyxels.size(); ++k) {
    const Index i = grab.phyxels[k];
    const double w = grab.weights[k];
    status.point += w * (target.rest().origin + target.rest().positions[i] + target.state().displacements[i]);
    velocity += w * target.state().velocities[i];
    inverseMass += w * w / target.masses()[i];
  }
  status.mass = 1.0 / inverseMass;
  // The spring of an explicit step stays far below the body's own limit: omega dt <= 0.3.
  const double omega = std::min(grab.frequency, presentDt_ > 0.0 ? 0.3 / presentDt_ : grab.frequency);
  status.force = status.mass * (omega * omega * (grab.target - status.point) - 2.0 * grab.dampingRatio * omega * velocity);
  const double size = status.force.norm();
  if (size > grab.maxForce) status.force *= grab.maxForce / size;
  for (std::size_t k = 0; k < grab.phyxels.size(); ++k) target.forces()[grab.phyxels[k]] += grab.weights[k] * status.force;
  grabStatus_[id] = status;
}

// Velocity Verlet: half a kick, contact on the velocities that will move the phyxels, drift, new forces, half a kick.
void Simulator::substep(double dt) {
  presentDt_ = dt;
  const bool contact = world_.box.enabled || !obstacles_.empty();
  const double decay = world_.damping > 0.0 ? std::exp(-world_.damping * dt) : 1.0;
  for (auto &[id, body] : bodies_) {
    Body &b = *body;
    State &state = b.state();
    const std::size_t n = b.rest().phyxelCount();
    if (!forcesCurrent_) {
      evaluateForces(b);
      applyGrab(id, b);
    }
    const auto kick = [&] {
      parallelFor_(n, 512, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          state.velocities[i] += 0.5 * dt * (b.forces()[i] / b.masses()[i] + world_.gravity);
      });
    };
    clock_.measure(kIntegrate, kick);
    if (contact)
      clock_.measure(kContact, [&] {
        resolveContacts(obstacles_, world_.box, b.worldPositions(), state.velocities, b.rest().contactRadii, b.rest().spacing,
                        dt, b.contact, parallelFor_);
      });
    clock_.measure(kIntegrate, [&] {
      parallelFor_(n, 512, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) state.displacements[i] += dt * state.velocities[i];
      });
    });
    evaluateForces(b);
    applyGrab(id, b);
    clock_.measure(kIntegrate, [&] {
      kick();
      if (decay < 1.0)
        for (Vec3 &v : state.velocities) v *= decay;
    });
    if (contact) clock_.measure(kContact, [&] { settleContacts(b.contact, state.velocities); });
  }
  forcesCurrent_ = true;
  time_ += dt;
}

std::optional<std::string> Simulator::firstNonFinite() const {
  for (const auto &[id, body] : bodies_) {
    const State &state = body->state();
    double sum = 0.0;
    for (std::size_t i = 0; i < state.velocities.size(); ++i)
      sum += state.velocities[i].squaredNorm() + state.displacements[i].squaredNorm();
    if (std::isfinite(sum)) continue;
    for (std::size_t i = 0; i < state.velocities.size(); ++i)
      if (!state.velocities[i].allFinite() || !state.displacements[i].allFinite())
        return "body '" + body->name() + "', phyxel " + std::to_string(i) + ": the " +
               (state.velocities[i].allFinite() ? "displacement" : "velocity") + " is not finite";
    return "body '" + body->name() + "': the kinetic energy is not finite";
  }
  return std::nullopt;
}

tl::expected<void, StepFailure> Simulator::step() {
  if (failed_) return tl::unexpected<StepFailure>({"the simulation has failed before; reset it to go on"});
  for (const auto &[id, body] : bodies_) body->keepState();
  const double timeBefore = time_;
  const double wanted = stepSize();
  double left = wanted;
  std::uint64_t substeps = 0;
  std::optional<std::string> failure;
  while (left > 1e-12 * wanted) {
    double stable = std::numeric_limits<double>::infinity();
    for (const auto &[id, body] : bodies_) stable = std::min(stable, kStepSafety * body->stableStep());
    // Even pieces of what is left, so that the last one is not a sliver.
    const double pieces = std::ceil(left / stable * (1.0 - 1e-9));
    if (!(pieces <= kMostSubsteps)) {
      failure = "the stable step has fallen to " + number(stable) + " s, a " + number(wanted / stable) +
                " of the step: the body is crushed or inverted";
      break;
    }
    const double dt = pieces > 1.0 ? left / pieces : left;
    substep(dt);
    left -= dt;
    ++substeps;
    failure = firstNonFinite();
    if (failure) break;
  }
  if (failure) {
    for (auto &[id, body] : bodies_) {
      body->restoreState();
      evaluateForces(*body);
    }
    time_ = timeBefore;
    forcesCurrent_ = false;
    failed_ = true;
    const std::string text = *failure + "; the state before the step is kept. Help: a smaller solver.dt, more " +
                             "solver.damping or material.viscosity, or a stiffer material";
    note("diverged", text);
    return tl::unexpected<StepFailure>({text});
  }
  if (substeps > mostSubsteps_) {
    mostSubsteps_ = substeps;
    note("substep", "a step of " + number(wanted) + " s was divided into " + std::to_string(substeps) +
                        " substeps: the stable step of the deformed body is " + number(wanted / static_cast<double>(substeps)) + " s");
  }
  ++steps_;
  clock_.commit();
  return {};
}

void Simulator::reset() {
  for (auto &[id, body] : bodies_) body->reset();
  grabs_.clear();
  grabStatus_.clear();
  time_ = 0.0;
  steps_ = 0;
  failed_ = false;
  forcesCurrent_ = false;
  presentDt_ = 0.0;
  mostSubsteps_ = 1;
  events_.clear();
}

void Simulator::setGrab(std::size_t id, Grab grab) {
  if (!body(id) || grab.phyxels.empty()) return;
  grabs_[id] = std::move(grab);
  forcesCurrent_ = false;
}

void Simulator::moveGrab(std::size_t id, const Vec3 &target) {
  if (const auto found = grabs_.find(id); found != grabs_.end()) found->second.target = target;
}

void Simulator::releaseGrab(std::size_t id) {
  if (grabs_.erase(id) > 0) forcesCurrent_ = false;
  grabStatus_.erase(id);
}

std::optional<GrabStatus> Simulator::grabStatus(std::size_t id) const {
  const auto found = grabStatus_.find(id);
  if (found == grabStatus_.end()) return std::nullopt;
  return found->second;
}

void Simulator::surfels(std::size_t id, std::vector<Vec3> &positions, std::vector<Vec3> &normals) {
  const Body *target = body(id);
  if (!target) return;
  const RestState &rest = target->rest();
  positions.resize(rest.surfels.count());
  normals.resize(rest.surfels.normals.size());
  clock_.measure(kSurfels, [&] {
    updateSurfels(rest.surfels, rest.positions, target->state().displacements, target->gradients(), positions, normals,
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
    out.gravity -= target->masses()[i] * world_.gravity.dot(target->state().displacements[i]);
  return out;
}

std::uint64_t Simulator::stateHash() const {
  std::uint64_t hash = 14695981039346656037ull;
  for (const auto &[id, body] : bodies_) {
    for (const Vec3 &u : body->state().displacements) hashBytes(hash, u.data(), 3 * sizeof(double));
    for (const Vec3 &v : body->state().velocities) hashBytes(hash, v.data(), 3 * sizeof(double));
  }
  return hash;
}

void Simulator::note(const std::string &kind, const std::string &text) {
  if (events_.size() < kMostEvents) events_.push_back({time_, kind, text});
}

}  // namespace pointbased
