// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "pointbased/integrators.h"

namespace pointbased {
namespace {

// Room in front of a surface within which a contact counts even when nothing moves, in spacings.
constexpr double kContactMargin = 0.02;

void evaluate(Body &body, const Environment &env, double time, double dt) {
  const ParallelFor &parallelFor = *env.parallelFor;
  StageClock &clock = *env.clock;
  clock.measure(kGradients, [&] { body.computeGradients(parallelFor); });
  if (!body.state().history.plasticInverse.empty() && dt > 0.0)
    clock.measure(kFlow, [&] { body.computeFlow(dt, parallelFor); });
  clock.measure(kStresses, [&] { body.computeStresses(dt, parallelFor); });
  clock.measure(kForces, [&] { body.computeForces(time, parallelFor); });
}

}  // namespace

std::vector<std::string> stageNames() {
  return {"deformation_gradients", "plastic_flow", "stresses", "internal_forces", "supports",
          "contact",               "integrate",    "solve",    "guard",           "surfels"};
}

void applyGrab(Body &body, double stiffnessLimit) {
  if (!body.grab) return;
  const Grab &grab = *body.grab;
  GrabStatus status;
  Vec3 velocity = Vec3::Zero();
  double inverseMass = 0.0;
  for (std::size_t k = 0; k < grab.phyxels.size(); ++k) {
    const Index i = grab.phyxels[k];
    const double w = grab.weights[k];
    status.point += w * (body.rest().origin + body.rest().positions[i] + body.state().displacements[i]);
    velocity += w * body.state().velocities[i];
    inverseMass += w * w / body.masses()[i];
  }
  status.mass = 1.0 / inverseMass;
  const double omega = std::min(grab.frequency, stiffnessLimit);
  status.force = status.mass * (omega * omega * (grab.target - status.point) - 2.0 * grab.dampingRatio * omega * velocity);
  const double size = status.force.norm();
  if (size > grab.maxForce) status.force *= grab.maxForce / size;
  for (std::size_t k = 0; k < grab.phyxels.size(); ++k) body.forces()[grab.phyxels[k]] += grab.weights[k] * status.force;
  body.grabStatus = status;
}

double impactSpeed(Body &body, const Environment &env, double time, double dt, double stride) {
  if (!env.contact() || body.rest().contact.count() == 0) return 0.0;
  double closing = 0.0;
  env.clock->measure(kContact, [&] {
    bool fast = false;
    for (const Obstacle &obstacle : env.obstacles) fast = fast || obstacle.motion;
    const double limit = stride * stride / (dt * dt);
    for (std::size_t i = 0; i < body.state().velocities.size() && !fast; ++i)
      fast = body.state().velocities[i].squaredNorm() > limit;
    if (!fast) return;
    const std::span<const Vec3> velocities = body.contactVelocities(*env.parallelFor);
    findContacts(env.obstacles, env.box, time, dt, kContactMargin * body.rest().spacing,
                 body.contactPositions(*env.parallelFor), velocities, body.rest().contact.radii, body.contact,
                 *env.parallelFor);
    closing = closingSpeed(body.contact, velocities);
  });
  return closing * dt > stride ? closing : 0.0;
}

void explicitSubstep(Body &body, const Environment &env, double time, double dt) {
  const ParallelFor &parallelFor = *env.parallelFor;
  StageClock &clock = *env.clock;
  State &state = body.state();
  const RestState &rest = body.rest();
  const std::size_t n = rest.phyxelCount();
  const std::span<const double> inverse = body.inverseMasses();
  const bool contact = env.contact() && rest.contact.count() > 0;
  const bool patches = body.patches().rows() > 0;
  const double springLimit = 0.3 / dt;
  if (!body.forcesCurrent) {
    evaluate(body, env, time, 0.0);
    applyGrab(body, springLimit);
  }

  // Copies of what the loops read: through references it would be loaded again for every phyxel.
  const auto kick = [&](double h) {
    parallelFor(n, 512, [&, h](std::size_t begin, std::size_t end) {
      const std::span<Vec3> velocities = state.velocities;
      const std::span<const Vec3> forces = body.forces();
      const Vec3 gravity = env.gravity;
      if (!body.held()) {
        for (std::size_t i = begin; i < end; ++i) velocities[i] += h * (inverse[i] * forces[i] + gravity);
        return;
      }
      const std::span<const double> shares = body.gravityShares();
      for (std::size_t i = begin; i < end; ++i)
        if (inverse[i] > 0.0)
          velocities[i] += h * (inverse[i] * forces[i] + (shares.empty() ? 1.0 : shares[i]) * gravity);
    });
    if (patches) body.patches().kick(h, state.velocities);
  };
  clock.measure(kIntegrate, [&] { kick(0.5 * dt); });
  if (contact)
    clock.measure(kContact, [&] {
      findContacts(env.obstacles, env.box, time, dt, kContactMargin * rest.spacing, body.contactPositions(parallelFor),
                   body.contactVelocities(parallelFor), rest.contact.radii, body.contact, parallelFor);
      solveContactImpulses(rest.contact.binding, inverse, dt, ImpulseSettings{}, body.contact, state.velocities);
    });
  clock.measure(kIntegrate, [&] {
    parallelFor(n, 512, [&](std::size_t begin, std::size_t end) {
      // As plain numbers, all of them: those that are held are put in their places below.
      using Numbers = Eigen::VectorXd;
      const auto size = static_cast<Eigen::Index>(3 * (end - begin));
      Eigen::Map<Numbers>(state.displacements[begin].data(), size) +=
          dt * Eigen::Map<const Numbers>(state.velocities[begin].data(), size);
    });
  });
  if (body.held())
    clock.measure(kSupports, [&] {
      body.placeHeld(time + dt, true);
      if (patches) body.patches().correct(dt, body.patchTargets(time + dt), state.displacements, state.velocities);
    });
  evaluate(body, env, time + dt, dt);
  applyGrab(body, springLimit);
  clock.measure(kIntegrate, [&] {
    kick(0.5 * dt);
    if (env.damping > 0.0) {
      const double decay = std::exp(-env.damping * dt);
      for (std::size_t i = 0; i < n; ++i)
        if (inverse[i] > 0.0) state.velocities[i] *= decay;
    }
  });
  if (contact)
    clock.measure(kContact, [&] {
      settleContactVelocities(rest.contact.binding, inverse, dt, body.contact, state.velocities);
    });
  body.forcesCurrent = true;
}

}  // namespace pointbased
