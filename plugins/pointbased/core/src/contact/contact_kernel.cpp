// SPDX-License-Identifier: Apache-2.0
#include "contact/contact_kernel.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "contact/contact_kernel.cpp"
#include "base/kernels/instruction_sets.h"  // first: selects the instruction sets for the code below

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pointbased::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Four doubles in as many registers as necessary.
#if HWY_TARGET == HWY_SCALAR
constexpr std::size_t kWide = 1;
#elif HWY_MAX_BYTES >= 32
constexpr std::size_t kWide = 4;
#else
constexpr std::size_t kWide = 2;
#endif
using Tag = hn::CappedTag<double, kWide>;
using Part = hn::Vec<Tag>;
constexpr std::size_t kParts = 4 / kWide;

struct Four {
  Part part[kParts];
};

HWY_INLINE Four load(const double *p) {
  Four r;
  for (std::size_t k = 0; k < kParts; ++k) r.part[k] = hn::LoadU(Tag(), p + k * kWide);
  return r;
}
HWY_INLINE void store(const Four &a, double *p) {
  for (std::size_t k = 0; k < kParts; ++k) hn::StoreU(a.part[k], Tag(), p + k * kWide);
}
HWY_INLINE Four zero() {
  Four r;
  for (std::size_t k = 0; k < kParts; ++k) r.part[k] = hn::Zero(Tag());
  return r;
}
/// s a + b
HWY_INLINE Four mulAdd(double s, const Four &a, const Four &b) {
  Four r;
  const Part by = hn::Set(Tag(), s);
  for (std::size_t k = 0; k < kParts; ++k) r.part[k] = hn::MulAdd(by, a.part[k], b.part[k]);
  return r;
}
HWY_INLINE Four add(const Four &a, const Four &b) {
  Four r;
  for (std::size_t k = 0; k < kParts; ++k) r.part[k] = hn::Add(a.part[k], b.part[k]);
  return r;
}
HWY_INLINE Four sub(const Four &a, const Four &b) {
  Four r;
  for (std::size_t k = 0; k < kParts; ++k) r.part[k] = hn::Sub(a.part[k], b.part[k]);
  return r;
}
HWY_INLINE double dot(const Four &a, const Four &b) {
  double x[4];
  Four product;
  for (std::size_t k = 0; k < kParts; ++k) product.part[k] = hn::Mul(a.part[k], b.part[k]);
  store(product, x);
  return (x[0] + x[1]) + x[2];
}

HWY_INLINE Four cross(const double *a, const double *b) {
  const double c[4] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0], 0.0};
  return load(c);
}

HWY_INLINE Four velocityOf(const SweepJob &job, std::size_t c) {
  Four v = zero();
  for (Index e = job.rows[c]; e < job.rows[c + 1]; ++e)
    v = mulAdd(job.shares[e], load(job.velocities + 4 * std::size_t{job.slots[e]}), v);
  return sub(v, load(job.sides + kContactNumbers * c + kSurfaceVelocity));
}

// Applies an impulse to phyxels by their shares, and to the particles of a rigid body by its rigid motion.
void push(const SweepJob &job, std::size_t c, const Four &impulse) {
  for (Index e = job.rows[c]; e < job.rows[c + 1]; ++e) {
    double *velocity = job.velocities + 4 * std::size_t{job.slots[e]};
    store(mulAdd(job.pushes[e], impulse, load(velocity)), velocity);
  }
  double p[4];
  store(impulse, p);
  for (Index r = job.rigidRows[c]; r < job.rigidRows[c + 1]; ++r) {
    const double *part = job.rigidParts + kRigidNumbers * std::size_t{r}, *turn = part + kRigidTurn;
    double spin[3];
    for (std::size_t a = 0; a < 3; ++a) spin[a] = turn[3 * a] * p[0] + turn[3 * a + 1] * p[1] + turn[3 * a + 2] * p[2];
    for (std::size_t k = 0; k < 4; ++k) {
      double *velocity = job.velocities + 4 * (std::size_t{job.rigidSlots[r]} + k);
      const Four change = mulAdd(part[kRigidShare], impulse, cross(spin, part + kRigidArms + 3 * k));
      store(add(load(velocity), change), velocity);
    }
  }
}

// Contact with a rigid body. A normal impulse also rotates the body, so friction is solved after it.
// @return square of the largest change of a velocity, m²/s²
double sweepRigid(const SweepJob &job, std::size_t c, SweepResult &result) {
  double *side = job.sides + kContactNumbers * c;
  const Four n = load(side + kNormalOfContact);
  const double w = job.inverseMasses[c], normal = dot(velocityOf(job, c), n), held = job.impulses[c];
  double wanted = held + (job.least[c] - normal) * side[kMass], least = job.least[c];
  if (job.compliances != nullptr && job.compliances[c] > 0.0) {
    const double compliance = job.compliances[c];
    least = std::max(least - compliance * held, job.floors[c]);
    wanted = std::max(held + (job.least[c] - normal - compliance * held) / (w + compliance),
                      held + (job.floors[c] - normal) * side[kMass]);
  }
  result.speed = std::max(result.speed, w * held + std::abs(std::min(0.0, normal - least)));
  side[kRoomOfContact] = normal - least;
  const double next = wanted < 0.0 ? 0.0 : wanted;
  if (next == 0.0 && held == 0.0) return 0.0;
  job.impulses[c] = next;
  push(job, c, mulAdd(next - held, n, zero()));
  const double change = w * (next - held);
  if (job.friction == nullptr || !(job.friction[c] > 0.0)) return change * change;
  const double mass = side[kTangentialMass];
  const Four v = velocityOf(job, c), before = load(side + kTangentialImpulse);
  Four t = sub(before, mulAdd(mass, mulAdd(-dot(v, n), n, v), zero()));
  const double grip = job.friction[c] * next, squared = dot(t, t);
  if (squared > grip * grip) t = mulAdd(grip / std::sqrt(squared), t, zero());
  const Four more = sub(t, before);
  push(job, c, more);
  store(t, side + kTangentialImpulse);
  return std::max(change * change, dot(more, more) / (mass * mass));
}

SweepResult sweep(const SweepJob &job, bool backwards) {
  SweepResult result;
  double changeSquared = 0.0;
  for (std::size_t at = 0; at < job.count; ++at) {
    const std::size_t k = backwards ? job.count - 1 - at : at;
    const std::size_t c = job.which != nullptr ? job.which[k] : k;
    const double w = job.inverseMasses[c];
    if (!(w > 0.0)) continue;
    if (job.rigidRows != nullptr && job.rigidRows[c] < job.rigidRows[c + 1]) {
      changeSquared = std::max(changeSquared, sweepRigid(job, c, result));
      continue;
    }
    const Index first = job.rows[c], last = job.rows[c + 1];
    // Two accumulators: consecutive additions do not depend on each other.
    Four even = zero(), odd = zero();
    Index e = first;
    for (; e + 1 < last; e += 2) {
      even = mulAdd(job.shares[e], load(job.velocities + 4 * std::size_t{job.slots[e]}), even);
      odd = mulAdd(job.shares[e + 1], load(job.velocities + 4 * std::size_t{job.slots[e + 1]}), odd);
    }
    if (e < last) even = mulAdd(job.shares[e], load(job.velocities + 4 * std::size_t{job.slots[e]}), even);
    double *side = job.sides + kContactNumbers * c;
    const Four n = load(side + kNormalOfContact);
    const Four v = sub(add(even, odd), load(side + kSurfaceVelocity));
    const double normal = dot(v, n), held = job.impulses[c];
    const double mass = side[kMass];
    double wanted = held + (job.least[c] - normal) * mass;
    double least = job.least[c];
    if (job.compliances != nullptr && job.compliances[c] > 0.0) {
      // Compliant layer, down to the limit of its compression: the larger of both impulses.
      const double compliance = job.compliances[c];
      least = std::max(least - compliance * held, job.floors[c]);
      wanted = std::max(held + (job.least[c] - normal - compliance * held) / (w + compliance),
                        held + (job.floors[c] - normal) * mass);
    }
    result.speed = std::max(result.speed, w * held + std::abs(std::min(0.0, normal - least)));
    side[kRoomOfContact] = normal - least;
    const double next = wanted < 0.0 ? 0.0 : wanted;  // NaN passes through for the guard to detect
    if (next == 0.0 && held == 0.0) continue;
    job.impulses[c] = next;
    Four impulse = mulAdd(next - held, n, zero());
    if (job.friction != nullptr && job.friction[c] > 0.0) {
      const Four before = load(side + kTangentialImpulse);
      Four t = sub(before, mulAdd(mass, mulAdd(-normal, n, v), zero()));
      // The root is computed only where the contact slides: the next contact waits for it.
      const double grip = job.friction[c] * next, squared = dot(t, t);
      if (squared > grip * grip) t = mulAdd(grip / std::sqrt(squared), t, zero());
      impulse = add(impulse, sub(t, before));
      store(t, side + kTangentialImpulse);
    }
    for (e = first; e < last; ++e) {
      double *velocity = job.velocities + 4 * std::size_t{job.slots[e]};
      store(mulAdd(job.pushes[e], impulse, load(velocity)), velocity);
    }
    changeSquared = std::max(changeSquared, w * w * dot(impulse, impulse));
  }
  result.change = std::sqrt(changeSquared);
  return result;
}

}  // namespace pointbased::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointbased::kernels {

HWY_EXPORT(sweep);

SweepResult sweepContacts(const SweepJob &job, bool backwards) { return HWY_DYNAMIC_DISPATCH(sweep)(job, backwards); }

}  // namespace pointbased::kernels
#endif
