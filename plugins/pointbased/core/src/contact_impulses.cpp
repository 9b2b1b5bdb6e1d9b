// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "pointbased/contact.h"

namespace pointbased {
namespace {

// Penetrations less than this many margins are left to the next steps: they are what an unfinished solution leaves.
constexpr double kSlop = 0.02;

// The points of a body as a hand holds them: velocities of phyxels, moved by impulses on points.
struct Hand {
  const Interpolation &binding;
  std::span<const double> inverseMasses;
  std::span<Vec3> velocities;

  [[nodiscard]] double inverseMass(Index p) const {
    double sum = 0.0;
    for (Index e = binding.phyxels.offsets[p]; e < binding.phyxels.offsets[p + 1]; ++e)
      sum += binding.weights[e] * binding.weights[e] * inverseMasses[binding.phyxels.indices[e]];
    return sum;
  }
  [[nodiscard]] Vec3 velocity(Index p) const {
    Vec3 v = Vec3::Zero();
    for (Index e = binding.phyxels.offsets[p]; e < binding.phyxels.offsets[p + 1]; ++e)
      v += binding.weights[e] * velocities[binding.phyxels.indices[e]];
    return v;
  }
  void push(Index p, const Vec3 &impulse) const {
    for (Index e = binding.phyxels.offsets[p]; e < binding.phyxels.offsets[p + 1]; ++e) {
      const Index j = binding.phyxels.indices[e];
      velocities[j] += binding.weights[e] * inverseMasses[j] * impulse;
    }
  }
};

// Pushes by a part of the impulses in the solution, as large as lowers  T + Σ λ (-least)  most: the energy that the
// projected Gauss-Seidel steps lower too, so however few of them follow, nothing is added.
void warmStart(const Hand &body, std::span<const Contact> active, ContactMemory::Solution &solution) {
  std::vector<Vec3> &change = solution.change;
  change.assign(body.velocities.size(), Vec3::Zero());
  const Hand trial{body.binding, body.inverseMasses, change};
  double slope = 0.0, curvature = 0.0;
  for (std::size_t c = 0; c < active.size(); ++c) {
    const double impulse = solution.impulses[c];
    if (!(impulse > 0.0)) continue;
    const Vec3 v = body.velocity(active[c].point) - active[c].surfaceVelocity;
    const Vec3 whole = impulse * active[c].normal + solution.tangential[c];
    slope += whole.dot(v) - impulse * solution.least[c];
    trial.push(active[c].point, whole);
  }
  for (std::size_t j = 0; j < change.size(); ++j)
    if (body.inverseMasses[j] > 0.0) curvature += change[j].squaredNorm() / body.inverseMasses[j];
  const double part = curvature > 0.0 && slope < 0.0 ? std::min(1.0, -slope / curvature) : 0.0;
  for (double &impulse : solution.impulses) impulse *= part;
  for (Vec3 &impulse : solution.tangential) impulse *= part;
  if (part > 0.0)
    for (std::size_t j = 0; j < change.size(); ++j) body.velocities[j] += part * change[j];
}

// Sweeps until nothing changes by more than the tolerance; impulses start as they are and have been applied.
void sweep(const Hand &body, std::span<const Contact> active, const ImpulseSettings &settings, bool friction,
           ContactMemory::Solution &solution) {
  const std::size_t count = active.size();
  double speed = 0.0;
  for (int k = 0; k < settings.sweeps; ++k) {
    double change = 0.0;
    for (std::size_t at = 0; at < count; ++at) {
      const std::size_t c = k % 2 == 0 ? at : count - 1 - at;  // to and fro: the last one is not always the same
      const Contact &contact = active[c];
      const double w = solution.inverseMasses[c];
      if (!(w > 0.0)) continue;
      double &held = solution.impulses[c];
      Vec3 &tangential = solution.tangential[c];
      const Vec3 v = body.velocity(contact.point) - contact.surfaceVelocity;
      const double normal = v.dot(contact.normal);
      if (k == 0) speed = std::max(speed, w * held + std::abs(std::min(0.0, normal - solution.least[c])));
      const double wanted = held + (solution.least[c] - normal) / w;
      const double next = wanted < 0.0 ? 0.0 : wanted;  // what is not a number goes on, so that the guard finds it
      if (next == 0.0 && held == 0.0) continue;
      Vec3 impulse = (next - held) * contact.normal;
      held = next;
      if (friction && contact.friction > 0.0) {
        Vec3 t = tangential - (v - normal * contact.normal) / w;
        const double grip = contact.friction * held, size = t.norm();
        if (size > grip) t *= grip / size;
        impulse += t - tangential;
        tangential = t;
      }
      body.push(contact.point, impulse);
      change = std::max(change, w * impulse.norm());
    }
    if (change <= settings.tolerance * speed) break;
  }
}

void prepare(const Hand &body, std::span<const Contact> active, ContactMemory::Solution &solution) {
  solution.inverseMasses.resize(active.size());
  for (std::size_t c = 0; c < active.size(); ++c) solution.inverseMasses[c] = body.inverseMass(active[c].point);
  solution.impulses.assign(active.size(), 0.0);
  solution.tangential.assign(active.size(), Vec3::Zero());
  solution.least.assign(active.size(), 0.0);
}

}  // namespace

double closingSpeed(const ContactMemory &memory, std::span<const Vec3> velocities) {
  double speed = 0.0;
  for (const Contact &contact : memory.active)
    speed = std::max(speed, (contact.surfaceVelocity - velocities[contact.point]).dot(contact.normal));
  return speed;
}

Vec3 solveContactImpulses(const Interpolation &binding, std::span<const double> inverseMasses, double dt,
                          const ImpulseSettings &settings, ContactMemory &memory, std::span<Vec3> velocities) {
  std::vector<Contact> &active = memory.active;
  ContactMemory::Solution &solution = memory.solution;
  solution.recovery.clear();
  if (active.empty()) return Vec3::Zero();
  const Hand body{binding, inverseMasses, velocities};
  prepare(body, active, solution);
  double deepest = 0.0;
  for (std::size_t c = 0; c < active.size(); ++c) {
    solution.impulses[c] = active[c].normalImpulse;
    solution.tangential[c] = active[c].frictionImpulse;
    solution.least[c] = -std::max(0.0, active[c].gap) / dt;
    deepest = std::max(deepest, -active[c].gap);
  }
  warmStart(body, active, solution);
  sweep(body, active, settings, true, solution);
  Vec3 total = Vec3::Zero();
  for (std::size_t c = 0; c < active.size(); ++c) {
    active[c].normalImpulse = solution.impulses[c];
    active[c].frictionImpulse = solution.tangential[c];
    total += solution.impulses[c] * active[c].normal + solution.tangential[c];
  }

  const double slop = kSlop * memory.margin;
  if (!(deepest > slop)) return total;
  solution.recovery.assign(velocities.size(), Vec3::Zero());
  const Hand lead{binding, inverseMasses, solution.recovery};
  for (std::size_t c = 0; c < active.size(); ++c) {
    const double depth = -active[c].gap - slop;
    // Velocities of the recovery come on top of those of the body, which keep the others within their gaps.
    solution.least[c] = depth > 0.0 ? std::min(settings.recovery * depth / dt, settings.recoverySpeed)
                                    : -std::max(0.0, active[c].gap) / dt;
    solution.impulses[c] = 0.0;
    solution.tangential[c].setZero();
  }
  std::vector<Contact> &still = memory.previous;
  still = active;
  for (Contact &contact : still) contact.surfaceVelocity.setZero();
  sweep(lead, still, settings, false, solution);
  for (std::size_t j = 0; j < velocities.size(); ++j) velocities[j] += solution.recovery[j];
  return total;
}

void settleContactVelocities(const Interpolation &binding, std::span<const double> inverseMasses, double dt,
                             ContactMemory &memory, std::span<Vec3> velocities) {
  (void)dt;
  ContactMemory::Solution &solution = memory.solution;
  if (!solution.recovery.empty())
    for (std::size_t j = 0; j < velocities.size(); ++j)
      if (inverseMasses[j] > 0.0) velocities[j] -= solution.recovery[j];
  solution.recovery.clear();
  // Contacts that the step has closed; in `previous`, which the next search overwrites.
  std::vector<Contact> &closed = memory.previous;
  closed.clear();
  for (const Contact &contact : memory.active)
    if (contact.normalImpulse > 0.0) closed.push_back(contact);
  if (closed.empty()) return;
  const Hand body{binding, inverseMasses, velocities};
  prepare(body, closed, solution);
  for (std::size_t c = 0; c < closed.size(); ++c) {
    solution.impulses[c] = closed[c].settleImpulse;
    solution.tangential[c] = closed[c].settleFriction;
  }
  warmStart(body, closed, solution);
  sweep(body, closed, ImpulseSettings{}, true, solution);
  std::size_t c = 0;
  for (Contact &contact : memory.active) {
    const bool closes = contact.normalImpulse > 0.0;
    contact.settleImpulse = closes ? solution.impulses[c] : 0.0;
    contact.settleFriction = closes ? solution.tangential[c] : Vec3(Vec3::Zero());
    if (closes) ++c;
  }
}

}  // namespace pointbased
