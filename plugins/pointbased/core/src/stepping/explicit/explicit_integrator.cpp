// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>

#include "base/kernels/field_kernel.h"
#include "contact/contact_bounce.h"
#include "pointbased/integrators.h"
#include "pointbased/step_composition.h"
#include "stepping/coupling/rigid_state.h"
#include "stepping/explicit/explicit_substep.h"

namespace pointbased {
namespace {

constexpr std::size_t kPhyxelGrain = 256;

// Whether any phyxel is faster; checks them one by one only if the bounds of all are not sufficient.
bool isFaster(std::span<const Vec3> velocities, double speed) {
  if (velocities.empty()) return false;
  const kernels::FieldBounds bounds = kernels::boundsOf(velocities.front().data(), velocities.size());
  double largest = 0.0;
  for (int c = 0; c < 3; ++c) largest += std::pow(std::max(std::abs(bounds.low[c]), std::abs(bounds.high[c])), 2);
  if (largest <= speed * speed && std::isfinite(bounds.sum)) return false;
  return std::any_of(velocities.begin(), velocities.end(),
                     [&](const Vec3 &v) { return v.squaredNorm() > speed * speed; });
}

// Distance from a surface within which a contact is active even without motion, in spacings.
constexpr double kContactMargin = 0.02;

// Speeds reached in two steps of free fall do not bounce.
constexpr double kThresholdKicks = 2.0;

// Contacts of a rigid body all affect each other, and converge more slowly than those of a soft body.
constexpr int kRigidSweeps = 60;
constexpr double kRigidTolerance = 1e-3, kRigidResidual = 5e-4;

}  // namespace

std::vector<std::string> stageNames() {
  return {"deformation_gradients",
          "plastic_flow",
          "stresses",
          "internal_forces",
          "supports",
          "contact",
          "integrate",
          "solve",
          "guard",
          "surfels"};
}

namespace {

// One spring on the weighted mean of the grabbed phyxels.
void applyMeanSpring(Body &body, ActiveGrab &active, double omega, const Vec3 &velocity) {
  const Grab &grab = active.grab;
  GrabStatus &status = active.status;
  status.force =
      status.mass * (omega * omega * (grab.target - status.point) - 2.0 * grab.dampingRatio * omega * velocity);
  const double size = status.force.norm();
  if (size > grab.maxForce) status.force *= grab.maxForce / size;
  for (std::size_t k = 0; k < grab.phyxels.size(); ++k)
    body.forces()[grab.phyxels[k]] += grab.weights[k] * status.force;
}

// A spring on every phyxel, to its position in the grabbed shape.
void applyShapeSprings(Body &body, ActiveGrab &active, double omega) {
  const Grab &grab = active.grab;
  GrabStatus &status = active.status;
  // For a rigid body the springs move its whole effective mass.
  const double mass = body.isFreeRigid() ? status.mass : heldMass(grab, body.masses());
  const auto forceOn = [&](std::size_t k) -> Vec3 {
    const Index i = grab.phyxels[k];
    const Vec3 x = body.rest().origin + body.rest().positions[i] + body.state().displacements[i];
    const Vec3 displacement = grab.target + grab.rotation * grab.arms[k] - x;
    return mass * grab.weights[k] *
           (omega * omega * displacement - 2.0 * grab.dampingRatio * omega * body.state().velocities[i]);
  };
  double sum = 0.0;
  for (std::size_t k = 0; k < grab.phyxels.size(); ++k) sum += forceOn(k).norm();
  const double limited = sum > grab.maxForce ? grab.maxForce / sum : 1.0;
  status.force.setZero();
  status.mass = mass;
  for (std::size_t k = 0; k < grab.phyxels.size(); ++k) {
    const Index i = grab.phyxels[k];
    const Vec3 force = limited * forceOn(k);
    const Vec3 x = body.rest().origin + body.rest().positions[i] + body.state().displacements[i];
    body.forces()[i] += force;
    status.force += force;
    status.torque += (x - status.point).cross(force);
  }
}

}  // namespace

double heldMass(const Grab &grab, std::span<const double> masses) {
  double mean = 0.0;
  for (std::size_t k = 0; k < grab.phyxels.size(); ++k) mean += grab.weights[k] * masses[grab.phyxels[k]];
  return mean / *std::max_element(grab.weights.begin(), grab.weights.end());
}

void applyGrabs(Body &body, double stiffnessLimit) {
  // The stiffness of grabs of the same phyxels adds up.
  const double limit = stiffnessLimit / static_cast<double>(std::max<std::size_t>(1, body.grabs.size()));
  for (ActiveGrab &active : body.grabs) {
    const Grab &grab = active.grab;
    active.status = GrabStatus();
    Vec3 velocity = Vec3::Zero();
    double inverseMass = 0.0;
    for (std::size_t k = 0; k < grab.phyxels.size(); ++k) {
      const Index i = grab.phyxels[k];
      const double w = grab.weights[k];
      active.status.point += w * (body.rest().origin + body.rest().positions[i] + body.state().displacements[i]);
      velocity += w * body.state().velocities[i];
      inverseMass += w * w / body.masses()[i];
    }
    if (body.isFreeRigid()) {
      const detail::RigidState rigid(body);
      const Vec3 arm = active.status.point - body.rest().origin - rigid.pose.centre;
      inverseMass = rigid.frame().largestInverseMassAt(rigid.pose, arm);
    }
    active.status.mass = 1.0 / inverseMass;
    const double omega = std::min(grab.frequency, limit);
    if (grab.arms.empty())
      applyMeanSpring(body, active, omega, velocity);
    else
      applyShapeSprings(body, active, omega);
  }
}

double impactSpeed(Body &body, const Environment &env, double time, double dt, double stride, double meanSpeed) {
  if (!stagesOf(body, env).contact) return 0.0;
  double closing = 0.0;
  env.clock->measure(kContact, [&] {
    bool fast = false;
    for (const Obstacle &obstacle : env.obstacles) fast = fast || obstacle.motion;
    if (!fast && (meanSpeed * dt <= 0.5 * stride || !isFaster(body.state().velocities, stride / dt))) return;
    const CarriedPoints points{body.rest().contact, body.rest().origin, body.state().displacements,
                               body.state().velocities, body.rest().maxInfluence};
    findContacts(env.obstacles, env.box, time, dt, kContactMargin * body.rest().spacing, points, body.contact,
                 *env.parallelFor);
    closing = closingSpeed(body.contact, points.points.binding, points.velocities);
  });
  return closing * dt > stride ? closing : 0.0;
}

namespace detail {

ExplicitSubstep::ExplicitSubstep(Body &body, const Environment &env, double time, double dt, bool touchesBodies)
    : body_(body), env_(env), time_(time), dt_(dt), stages_(stagesOf(body, env)),
      isFused_(!touchesBodies && !stages_.contact && !stages_.patches && !body.isFreeRigid()) {
  if (body.isFreeRigid()) rigid_.emplace(body);
}

void ExplicitSubstep::evaluate(double time, double dt) {
  const ParallelFor &parallelFor = *env_.parallelFor;
  StageClock &clock = *env_.clock;
  if (stages_.fused) {
    clock.measure(kForces, [&] { body_.evaluate(time, dt, parallelFor); });
  } else {
    clock.measure(kGradients, [&] { body_.computeGradients(parallelFor); });
    if (stages_.flow && dt > 0.0) clock.measure(kFlow, [&] { body_.computeFlow(dt, parallelFor); });
    clock.measure(kStresses, [&] { body_.computeStresses(dt, parallelFor); });
    clock.measure(kForces, [&] { body_.computeForces(time, parallelFor); });
  }
  if (stages_.grabs) applyGrabs(body_, 0.3 / dt_);
}

void ExplicitSubstep::drift(std::size_t begin, std::size_t end) {
  State &state = body_.state();
  kernels::addScaled(dt_, state.velocities[begin].data(), state.displacements[begin].data(), 3 * (end - begin));
}

void ExplicitSubstep::kick(double h, bool drifts) {
  if (rigid_) {
    rigid_->kick(h, body_.forces(), env_.gravity);
    return rigid_->storeVelocities();
  }
  State &state = body_.state();
  kernels::Kick job;
  job.h = h;
  job.inverseMasses = body_.inverseMasses().data();
  job.gravityShares = body_.held() && !body_.gravityShares().empty() ? body_.gravityShares().data() : nullptr;
  std::copy_n(env_.gravity.data(), 3, job.gravity);
  job.forces = body_.forces().front().data();
  job.velocities = state.velocities.front().data();
  const auto range = [&](std::size_t begin, std::size_t end) {
    kernels::kick(job, begin, end);
    if (drifts) drift(begin, end);
  };
  (*env_.parallelFor)(body_.rest().phyxelCount(), kPhyxelGrain, std::cref(range));
  if (stages_.patches) body_.patches().kick(h, state.velocities);
}

bool ExplicitSubstep::evaluateFirst() {
  if (body_.forcesCurrent) return false;
  evaluate(time_, 0.0);
  return true;
}

void ExplicitSubstep::kickFirst() {
  env_.clock->measure(kIntegrate, [&] { kick(0.5 * dt_, isFused_); });
}

// `apply` changes the velocities of the four particles to which contact points are bound.
template <class Apply>
void ExplicitSubstep::applyContact(const Apply &apply) {
  const RigidFrame &frame = rigid_->frame();
  const Interpolation &points = body_.rest().contact.binding;
  Interpolation binding;
  binding.positions.resize(points.count());
  binding.phyxels.offsets.resize(points.count() + 1, 0);
  for (const Contact &contact : body_.contact.active) binding.phyxels.offsets[contact.point + 1] = 4;
  for (std::size_t p = 0; p < points.count(); ++p) {
    Index &end = binding.phyxels.offsets[p + 1];
    const bool isActive = end > 0;
    end += binding.phyxels.offsets[p];
    if (!isActive) continue;
    std::array<double, 4> weights{};
    for (Index e = points.phyxels.offsets[p]; e < points.phyxels.offsets[p + 1]; ++e)
      for (std::size_t k = 0; k < 4; ++k)
        weights[k] += points.weights[e] * frame.weightsOf(points.phyxels.indices[e])[k];
    for (Index k = 0; k < 4; ++k) {
      binding.phyxels.indices.push_back(k);
      binding.weights.push_back(weights[k]);
    }
  }
  std::array<Vec3, 4> velocities = frame.particleVelocities(rigid_->pose, rigid_->motion);
  const RigidParticles particles = frame.particles(rigid_->pose, 0);
  std::array<double, 4> inverseMasses{};
  inverseMasses.fill(particles.inverseMass());
  apply(RigidContact{binding, inverseMasses, std::span(&particles, 1), velocities});
  rigid_->motion = frame.velocityOf(rigid_->pose, velocities);
  rigid_->storeVelocities();
}

void ExplicitSubstep::findContacts() {
  if (!stages_.contact) return;
  const RestState &rest = body_.rest();
  State &state = body_.state();
  env_.clock->measure(kContact, [&] {
    pointbased::findContacts(env_.obstacles, env_.box, time_, dt_, kContactMargin * rest.spacing,
                             {rest.contact, rest.origin, state.displacements, state.velocities, rest.maxInfluence},
                             body_.contact, *env_.parallelFor);
    const double threshold = kThresholdKicks * env_.gravity.norm() * dt_;
    if (!findImpacts(rest.contact.binding, state.velocities, dt_, threshold, body_.contact)) return;
    kick(-0.5 * dt_, false);
    if (rigid_)
      applyContact([&](const RigidContact &of) {
        detail::applyRestitution(of.binding, of.inverseMasses, of.rigid, threshold, body_.contact, of.velocities);
      });
    else
      pointbased::applyRestitution(rest.contact.binding, body_.inverseMasses(), threshold, body_.contact,
                                   state.velocities);
    kick(0.5 * dt_, false);
  });
}

void ExplicitSubstep::solveContacts() {
  if (!stages_.contact) return;
  env_.clock->measure(kContact, [&] {
    if (rigid_) {
      ImpulseSettings settings;
      settings.sweeps = kRigidSweeps;
      settings.tolerance = kRigidTolerance;
      settings.leastSpeed = kRigidResidual * kContactMargin * body_.rest().spacing / dt_;
      return applyContact([&](const RigidContact &of) {
        detail::solveContactImpulses(of.binding, of.inverseMasses, of.rigid, dt_, settings, body_.contact,
                                     of.velocities);
      });
    }
    pointbased::solveContactImpulses(body_.rest().contact.binding, body_.inverseMasses(), dt_, ImpulseSettings{},
                                     body_.contact, body_.state().velocities);
  });
}

void ExplicitSubstep::drift() {
  const std::size_t n = body_.rest().phyxelCount();
  const ParallelFor &parallelFor = *env_.parallelFor;
  StageClock &clock = *env_.clock;
  State &state = body_.state();
  const auto range = [this](std::size_t begin, std::size_t end) { drift(begin, end); };
  if (rigid_)
    clock.measure(kIntegrate, [&] {
      rigid_->advance(dt_);
      rigid_->store();
    });
  // All of them: held phyxels are moved to their prescribed positions below.
  else if (!isFused_)
    clock.measure(kIntegrate, [&] { parallelFor(n, kPhyxelGrain, std::cref(range)); });
  if (stages_.supports)
    clock.measure(kSupports, [&] {
      body_.placeHeld(time_ + dt_, true);
      if (stages_.patches)
        body_.patches().correct(dt_, body_.patchTargets(time_ + dt_), state.displacements, state.velocities);
    });
  evaluate(time_ + dt_, dt_);
}

void ExplicitSubstep::kickLast() {
  env_.clock->measure(kIntegrate, [&] { kick(0.5 * dt_, false); });
  body_.forcesCurrent = true;
}

// Last, so that bodies resting on others press with their full weight.
void ExplicitSubstep::damp() {
  if (!stages_.damping) return;
  env_.clock->measure(kIntegrate, [&] {
    const double decay = std::exp(-env_.damping * dt_);
    std::vector<Vec3> &velocities = body_.state().velocities;
    for (std::size_t i = 0; i < velocities.size(); ++i)
      if (body_.inverseMasses()[i] > 0.0) velocities[i] *= decay;
  });
}

void ExplicitSubstep::projectContactVelocities() {
  if (!stages_.contact) return;
  env_.clock->measure(kContact, [&] {
    if (rigid_)
      applyContact([&](const RigidContact &of) {
        detail::projectContactVelocities(of.binding, of.inverseMasses, of.rigid, body_.contact, of.velocities);
      });
    else
      pointbased::projectContactVelocities(body_.rest().contact.binding, body_.inverseMasses(), dt_, body_.contact,
                                           body_.state().velocities);
    sumContactImpulses(dt_, body_.contact);
  });
}

}  // namespace detail

void explicitSubstep(Body &body, const Environment &env, double time, double dt) {
  detail::ExplicitSubstep substep(body, env, time, dt, false);
  (void)substep.evaluateFirst();
  substep.kickFirst();
  substep.findContacts();
  substep.solveContacts();
  substep.drift();
  substep.kickLast();
  substep.projectContactVelocities();
  substep.damp();
}

}  // namespace pointbased
