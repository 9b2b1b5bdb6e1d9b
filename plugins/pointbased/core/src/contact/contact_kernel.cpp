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
    v = mulAdd(job.weights[e], load(job.velocities + 4 * std::size_t{job.slots[e]}), v);
  return sub(v, load(job.records + kContactRecordSize * c + kSurfaceVelocity));
}

// Applies an impulse to phyxels by their shares, and to the particles of a rigid body by its rigid motion.
void applyImpulse(const SweepJob &job, std::size_t c, const Four &impulse) {
  for (Index e = job.rows[c]; e < job.rows[c + 1]; ++e) {
    double *velocity = job.velocities + 4 * std::size_t{job.slots[e]};
    store(mulAdd(job.responses[e], impulse, load(velocity)), velocity);
  }
  double p[4];
  store(impulse, p);
  for (Index r = job.rigidRows[c]; r < job.rigidRows[c + 1]; ++r) {
    const double *part = job.rigidParts + kRigidRecordSize * std::size_t{r},
                 *angularResponse = part + kRigidAngularResponse;
    double spin[3];
    for (std::size_t a = 0; a < 3; ++a)
      spin[a] = angularResponse[3 * a] * p[0] + angularResponse[3 * a + 1] * p[1] + angularResponse[3 * a + 2] * p[2];
    for (std::size_t k = 0; k < 4; ++k) {
      double *velocity = job.velocities + 4 * (std::size_t{job.rigidSlots[r]} + k);
      const Four change = mulAdd(part[kRigidLinearResponse], impulse, cross(spin, part + kRigidArms + 3 * k));
      store(add(load(velocity), change), velocity);
    }
  }
}

// Contact with a rigid body. A normal impulse also rotates the body, so friction is solved after it.
// @return square of the largest change of a velocity, m²/s²
double sweepRigid(const SweepJob &job, std::size_t c, SweepResult &result) {
  double *record = job.records + kContactRecordSize * c;
  const Four n = load(record + kContactNormal);
  const double w = job.inverseMasses[c], normal = dot(velocityOf(job, c), n), oldImpulse = job.impulses[c];
  double unclamped = oldImpulse + (job.minVelocities[c] - normal) * record[kMass], minVelocity = job.minVelocities[c];
  if (job.compliances != nullptr && job.compliances[c] > 0.0) {
    const double compliance = job.compliances[c];
    minVelocity = std::max(minVelocity - compliance * oldImpulse, job.minVelocityLimits[c]);
    unclamped = std::max(oldImpulse + (job.minVelocities[c] - normal - compliance * oldImpulse) / (w + compliance),
                         oldImpulse + (job.minVelocityLimits[c] - normal) * record[kMass]);
  }
  result.speed = std::max(result.speed, w * oldImpulse + std::abs(std::min(0.0, normal - minVelocity)));
  record[kVelocityMargin] = normal - minVelocity;
  const double newImpulse = unclamped < 0.0 ? 0.0 : unclamped;
  if (newImpulse == 0.0 && oldImpulse == 0.0) return 0.0;
  job.impulses[c] = newImpulse;
  applyImpulse(job, c, mulAdd(newImpulse - oldImpulse, n, zero()));
  const double change = w * (newImpulse - oldImpulse);
  if (job.friction == nullptr || !(job.friction[c] > 0.0)) return change * change;
  const double mass = record[kTangentialMass];
  const Four v = velocityOf(job, c), before = load(record + kTangentialImpulse);
  Four t = sub(before, mulAdd(mass, mulAdd(-dot(v, n), n, v), zero()));
  const double frictionLimit = job.friction[c] * newImpulse, squared = dot(t, t);
  if (squared > frictionLimit * frictionLimit) t = mulAdd(frictionLimit / std::sqrt(squared), t, zero());
  const Four changeOfFriction = sub(t, before);
  applyImpulse(job, c, changeOfFriction);
  store(t, record + kTangentialImpulse);
  return std::max(change * change, dot(changeOfFriction, changeOfFriction) / (mass * mass));
}

SweepResult sweep(const SweepJob &job, bool backwards) {
  SweepResult result;
  double changeSquared = 0.0;
  for (std::size_t at = 0; at < job.count; ++at) {
    const std::size_t k = backwards ? job.count - 1 - at : at;
    const std::size_t c = job.subset != nullptr ? job.subset[k] : k;
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
      even = mulAdd(job.weights[e], load(job.velocities + 4 * std::size_t{job.slots[e]}), even);
      odd = mulAdd(job.weights[e + 1], load(job.velocities + 4 * std::size_t{job.slots[e + 1]}), odd);
    }
    if (e < last) even = mulAdd(job.weights[e], load(job.velocities + 4 * std::size_t{job.slots[e]}), even);
    double *record = job.records + kContactRecordSize * c;
    const Four n = load(record + kContactNormal);
    const Four v = sub(add(even, odd), load(record + kSurfaceVelocity));
    const double normal = dot(v, n), oldImpulse = job.impulses[c];
    const double mass = record[kMass];
    double unclamped = oldImpulse + (job.minVelocities[c] - normal) * mass;
    double minVelocity = job.minVelocities[c];
    if (job.compliances != nullptr && job.compliances[c] > 0.0) {
      // Compliant layer, down to the limit of its compression: the larger of both impulses.
      const double compliance = job.compliances[c];
      minVelocity = std::max(minVelocity - compliance * oldImpulse, job.minVelocityLimits[c]);
      unclamped = std::max(oldImpulse + (job.minVelocities[c] - normal - compliance * oldImpulse) / (w + compliance),
                           oldImpulse + (job.minVelocityLimits[c] - normal) * mass);
    }
    result.speed = std::max(result.speed, w * oldImpulse + std::abs(std::min(0.0, normal - minVelocity)));
    record[kVelocityMargin] = normal - minVelocity;
    const double newImpulse = unclamped < 0.0 ? 0.0 : unclamped;  // NaN passes through for the guard to detect
    if (newImpulse == 0.0 && oldImpulse == 0.0) continue;
    job.impulses[c] = newImpulse;
    Four impulse = mulAdd(newImpulse - oldImpulse, n, zero());
    if (job.friction != nullptr && job.friction[c] > 0.0) {
      const Four before = load(record + kTangentialImpulse);
      Four t = sub(before, mulAdd(mass, mulAdd(-normal, n, v), zero()));
      // The root is computed only where the contact slides: the next contact waits for it.
      const double frictionLimit = job.friction[c] * newImpulse, squared = dot(t, t);
      if (squared > frictionLimit * frictionLimit) t = mulAdd(frictionLimit / std::sqrt(squared), t, zero());
      impulse = add(impulse, sub(t, before));
      store(t, record + kTangentialImpulse);
    }
    for (e = first; e < last; ++e) {
      double *velocity = job.velocities + 4 * std::size_t{job.slots[e]};
      store(mulAdd(job.responses[e], impulse, load(velocity)), velocity);
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
