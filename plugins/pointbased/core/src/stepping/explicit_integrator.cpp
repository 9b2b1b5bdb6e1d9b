// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>

#include "base/kernels/field_kernel.h"
#include "contact/contact_bounce.h"
#include "pointbased/integrators.h"
#include "pointbased/step_composition.h"

namespace pointbased {
namespace {

constexpr std::size_t kPhyxelGrain = 256;

// Whether a phyxel may be faster; asks each only where the bounds of all do not tell.
bool isFaster(std::span<const Vec3> velocities, double speed) {
  if (velocities.empty()) return false;
  const kernels::FieldBounds bounds = kernels::boundsOf(velocities.front().data(), velocities.size());
  double most = 0.0;
  for (int c = 0; c < 3; ++c) most += std::pow(std::max(std::abs(bounds.low[c]), std::abs(bounds.high[c])), 2);
  if (most <= speed * speed && std::isfinite(bounds.sum)) return false;
  return std::any_of(velocities.begin(), velocities.end(),
                     [&](const Vec3 &v) { return v.squaredNorm() > speed * speed; });
}

// Room in front of a surface within which a contact counts even when nothing moves, in spacings.
constexpr double kContactMargin = 0.02;

// What falls for two steps bounces no more.
constexpr double kQuietKicks = 2.0;

void evaluate(Body &body, const Environment &env, const StepStages &stages, double time, double dt) {
  const ParallelFor &parallelFor = *env.parallelFor;
  StageClock &clock = *env.clock;
  if (stages.fused) {
    clock.measure(kForces, [&] { body.evaluate(time, dt, parallelFor); });
    return;
  }
  clock.measure(kGradients, [&] { body.computeGradients(parallelFor); });
  if (stages.flow && dt > 0.0) clock.measure(kFlow, [&] { body.computeFlow(dt, parallelFor); });
  clock.measure(kStresses, [&] { body.computeStresses(dt, parallelFor); });
  clock.measure(kForces, [&] { body.computeForces(time, parallelFor); });
}

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

// One spring on the mean of what is held.
void pullMean(Body &body, Hand &hand, double omega, const Vec3 &velocity) {
  const Grab &grab = hand.grab;
  GrabStatus &status = hand.status;
  status.force =
      status.mass * (omega * omega * (grab.target - status.point) - 2.0 * grab.dampingRatio * omega * velocity);
  const double size = status.force.norm();
  if (size > grab.maxForce) status.force *= grab.maxForce / size;
  for (std::size_t k = 0; k < grab.phyxels.size(); ++k)
    body.forces()[grab.phyxels[k]] += grab.weights[k] * status.force;
}

// A spring on every phyxel, to its place in the shape that is held.
void pullShape(Body &body, Hand &hand, double omega) {
  const Grab &grab = hand.grab;
  GrabStatus &status = hand.status;
  const double largest = *std::max_element(grab.weights.begin(), grab.weights.end());
  const auto forceOn = [&](std::size_t k) -> Vec3 {
    const Index i = grab.phyxels[k];
    const Vec3 x = body.rest().origin + body.rest().positions[i] + body.state().displacements[i];
    const Vec3 way = grab.target + grab.rotation * grab.arms[k] - x;
    return grab.weights[k] / largest * body.masses()[i] *
           (omega * omega * way - 2.0 * grab.dampingRatio * omega * body.state().velocities[i]);
  };
  double sum = 0.0;
  for (std::size_t k = 0; k < grab.phyxels.size(); ++k) sum += forceOn(k).norm();
  const double share = sum > grab.maxForce ? grab.maxForce / sum : 1.0;
  status.force.setZero();
  status.mass = 0.0;
  for (std::size_t k = 0; k < grab.phyxels.size(); ++k) {
    const Index i = grab.phyxels[k];
    const Vec3 force = share * forceOn(k);
    const Vec3 x = body.rest().origin + body.rest().positions[i] + body.state().displacements[i];
    body.forces()[i] += force;
    status.force += force;
    status.torque += (x - status.point).cross(force);
    status.mass += grab.weights[k] / largest * body.masses()[i];
  }
}

}  // namespace

void applyGrabs(Body &body, double stiffnessLimit) {
  // Hands that hold the same phyxels add up.
  const double limit = stiffnessLimit / static_cast<double>(std::max<std::size_t>(1, body.hands.size()));
  for (Hand &hand : body.hands) {
    const Grab &grab = hand.grab;
    hand.status = GrabStatus();
    Vec3 velocity = Vec3::Zero();
    double inverseMass = 0.0;
    for (std::size_t k = 0; k < grab.phyxels.size(); ++k) {
      const Index i = grab.phyxels[k];
      const double w = grab.weights[k];
      hand.status.point += w * (body.rest().origin + body.rest().positions[i] + body.state().displacements[i]);
      velocity += w * body.state().velocities[i];
      inverseMass += w * w / body.masses()[i];
    }
    hand.status.mass = 1.0 / inverseMass;
    const double omega = std::min(grab.frequency, limit);
    if (grab.arms.empty())
      pullMean(body, hand, omega, velocity);
    else
      pullShape(body, hand, omega);
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

void explicitSubstep(Body &body, const Environment &env, double time, double dt) {
  const ParallelFor &parallelFor = *env.parallelFor;
  StageClock &clock = *env.clock;
  State &state = body.state();
  const RestState &rest = body.rest();
  const std::size_t n = rest.phyxelCount();
  const std::span<const double> inverse = body.inverseMasses();
  const StepStages stages = stagesOf(body, env);
  const bool contact = stages.contact, patches = stages.patches;
  const double springLimit = 0.3 / dt;
  if (!body.forcesCurrent) {
    evaluate(body, env, stages, time, 0.0);
    if (stages.hands) applyGrabs(body, springLimit);
  }

  // With nothing in between, half a kick and the drift are one loop.
  const auto drift = [&](std::size_t begin, std::size_t end) {
    kernels::addScaled(dt, state.velocities[begin].data(), state.displacements[begin].data(), 3 * (end - begin));
  };
  const bool together = !contact && !patches;
  const auto kick = [&](double h, bool drifts) {
    kernels::Kick all;
    all.h = h;
    all.inverseMasses = inverse.data();
    all.gravityShares = body.held() && !body.gravityShares().empty() ? body.gravityShares().data() : nullptr;
    std::copy_n(env.gravity.data(), 3, all.gravity);
    all.forces = body.forces().front().data();
    all.velocities = state.velocities.front().data();
    const auto range = [&](std::size_t begin, std::size_t end) {
      kernels::kick(all, begin, end);
      if (drifts) drift(begin, end);
    };
    parallelFor(n, kPhyxelGrain, std::cref(range));
    if (patches) body.patches().kick(h, state.velocities);
  };
  clock.measure(kIntegrate, [&] { kick(0.5 * dt, together); });
  if (contact)
    clock.measure(kContact, [&] {
      findContacts(env.obstacles, env.box, time, dt, kContactMargin * rest.spacing,
                   {rest.contact, rest.origin, state.displacements, state.velocities, rest.maxInfluence}, body.contact,
                   parallelFor);
      const double quiet = kQuietKicks * env.gravity.norm() * dt;
      if (findArrivals(rest.contact.binding, state.velocities, dt, quiet, body.contact)) {
        kick(-0.5 * dt, false);
        bounceArrivals(rest.contact.binding, inverse, quiet, body.contact, state.velocities);
        kick(0.5 * dt, false);
      }
      solveContactImpulses(rest.contact.binding, inverse, dt, ImpulseSettings{}, body.contact, state.velocities);
    });
  // All of them: those that are held are put in their places below.
  if (!together) clock.measure(kIntegrate, [&] { parallelFor(n, kPhyxelGrain, std::cref(drift)); });
  if (stages.supports)
    clock.measure(kSupports, [&] {
      body.placeHeld(time + dt, true);
      if (patches) body.patches().correct(dt, body.patchTargets(time + dt), state.displacements, state.velocities);
    });
  evaluate(body, env, stages, time + dt, dt);
  if (stages.hands) applyGrabs(body, springLimit);
  clock.measure(kIntegrate, [&] {
    kick(0.5 * dt, false);
    if (stages.damping) {
      const double decay = std::exp(-env.damping * dt);
      for (std::size_t i = 0; i < n; ++i)
        if (inverse[i] > 0.0) state.velocities[i] *= decay;
    }
  });
  if (contact)
    clock.measure(kContact, [&] {
      settleContactVelocities(rest.contact.binding, inverse, dt, body.contact, state.velocities);
      sumContactImpulses(dt, body.contact);
    });
  body.forcesCurrent = true;
}

}  // namespace pointbased
