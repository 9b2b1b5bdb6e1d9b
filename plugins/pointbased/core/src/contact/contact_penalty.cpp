// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "pointbased/contact.h"

#include "base/expects.h"

namespace pointbased {
namespace {

// Speed at which initial penetration is pushed out. Larger: bodies are ejected. Smaller: they stay inside longer.
constexpr double kRecoverySpeed = 0.1;  // m/s
// Of the spacing: last remainder of an initial penetration, kept for one more step. Larger: a larger jump at the end.
constexpr double kMinRemainder = 1e-6;

void expectSizes(const ContactPoints &points, const ContactState &memory, const ContactPenalty &penalty,
                 std::span<const Vec3> start, std::span<const Vec3> now) {
  const auto haveStiffness = [&] {
    return penalty.moduli.empty() && !memory.active.empty() &&
           std::all_of(memory.active.begin(), memory.active.end(), [](const Contact &c) { return c.stiffness > 0.0; });
  };
  POINTBASED_EXPECTS(penalty.moduli.size() == points.count() || haveStiffness(),
                     "one modulus per contact point, or contacts with a stiffness of their own");
  POINTBASED_EXPECTS(start.size() == now.size(), "displacements of the same phyxels");
}

struct PenaltyState {
  double gap = 0.0;                            // m
  Vec3 tangentialDisplacement = Vec3::Zero();  // m
  double k = 0.0;                              // N/m
  double frictionLimit = 0.0;                  // N, mu N
  double stickLimit = 0.0;                     // m, largest tangentialDisplacement at which friction sticks
};

PenaltyState penaltyStateOf(const ContactPoints &points, const ContactPenalty &penalty, const Contact &contact,
                            std::span<const Vec3> start, std::span<const Vec3> now) {
  const Interpolation &b = points.binding;
  Vec3 displacement = -penalty.h * contact.surfaceVelocity;
  for (Index e = b.phyxels.offsets[contact.point]; e < b.phyxels.offsets[contact.point + 1]; ++e) {
    const Index j = b.phyxels.indices[e];
    displacement += b.weights[e] * (now[j] - start[j]);
  }
  PenaltyState out;
  const double normal = displacement.dot(contact.normal);
  out.gap = contact.gap + contact.initialPenetration + normal;
  out.tangentialDisplacement = contact.tangentialDisplacement + displacement - normal * contact.normal;
  if (contact.stiffness > 0.0) {
    out.k = contact.stiffness;
  } else {
    const double spacing = points.spacings.empty() ? penalty.spacing : points.spacings[contact.point];
    out.k = penalty.stiffness * penalty.moduli[contact.point] * points.areas[contact.point] / spacing;
  }
  out.frictionLimit = contact.friction * contact.normalForce;
  out.stickLimit = out.k > 0.0 ? out.frictionLimit / out.k : 0.0;
  return out;
}

Vec3 forceOf(const PenaltyState &s, const Vec3 &normal) {
  Vec3 force = Vec3::Zero();
  if (s.gap < 0.0) force -= s.k * s.gap * normal;
  if (s.frictionLimit > 0.0) {
    const double size = s.tangentialDisplacement.norm();
    force -= (size <= s.stickLimit ? s.k : s.frictionLimit / size) * s.tangentialDisplacement;
  }
  return force;
}

Mat3 hessianOf(const PenaltyState &s, const Vec3 &normal) {
  Mat3 H = Mat3::Zero();
  const Mat3 nn = normal * normal.transpose();
  if (s.gap < 0.0) H += s.k * nn;
  if (s.frictionLimit > 0.0) {
    const Mat3 T = Mat3::Identity() - nn;
    const double size = s.tangentialDisplacement.norm();
    if (size <= s.stickLimit)
      H += s.k * T;
    else
      H += s.frictionLimit / size *
           (T - s.tangentialDisplacement * s.tangentialDisplacement.transpose() / (size * size));
  }
  return H;
}

// visit(contact, penalised) for every contact with a normal force or friction.
template <class Visit>
void forActing(const ContactPoints &points, const ContactState &memory, const ContactPenalty &penalty,
               std::span<const Vec3> start, std::span<const Vec3> now, const Visit &visit) {
  expectSizes(points, memory, penalty, start, now);
  for (const Contact &contact : memory.active) {
    const PenaltyState s = penaltyStateOf(points, penalty, contact, start, now);
    if (s.gap < 0.0 || s.frictionLimit > 0.0) visit(contact, s);
  }
}

}  // namespace

ContactForce contactForceAt(const ContactPoints &points, const Contact &contact, const ContactPenalty &penalty,
                            std::span<const Vec3> start, std::span<const Vec3> now) {
  const PenaltyState s = penaltyStateOf(points, penalty, contact, start, now);
  const double normal = s.k * std::max(0.0, -s.gap);
  return {normal, forceOf(s, contact.normal) - normal * contact.normal};
}

double contactEnergy(const ContactPoints &points, const ContactState &memory, const ContactPenalty &penalty,
                     std::span<const Vec3> start, std::span<const Vec3> now) {
  expectSizes(points, memory, penalty, start, now);
  double energy = 0.0;
  for (const Contact &contact : memory.active) {
    const PenaltyState s = penaltyStateOf(points, penalty, contact, start, now);
    if (s.gap < 0.0) energy += 0.5 * s.k * s.gap * s.gap;
    if (s.frictionLimit > 0.0) {
      const double size = s.tangentialDisplacement.norm();
      energy += size <= s.stickLimit ? 0.5 * s.k * size * size : s.frictionLimit * (size - 0.5 * s.stickLimit);
    }
  }
  return energy;
}

void addContactForces(const ContactPoints &points, const ContactState &memory, const ContactPenalty &penalty,
                      std::span<const Vec3> start, std::span<const Vec3> now, std::span<Vec3> forces) {
  const Interpolation &b = points.binding;
  forActing(points, memory, penalty, start, now, [&](const Contact &contact, const PenaltyState &s) {
    const Vec3 force = forceOf(s, contact.normal);
    for (Index e = b.phyxels.offsets[contact.point]; e < b.phyxels.offsets[contact.point + 1]; ++e)
      forces[b.phyxels.indices[e]] += b.weights[e] * force;
  });
}

void addContactProduct(const ContactPoints &points, const ContactState &memory, const ContactPenalty &penalty,
                       std::span<const Vec3> start, std::span<const Vec3> now, std::span<const Vec3> du,
                       std::span<Vec3> out) {
  const Interpolation &b = points.binding;
  forActing(points, memory, penalty, start, now, [&](const Contact &contact, const PenaltyState &s) {
    Vec3 d = Vec3::Zero();
    for (Index e = b.phyxels.offsets[contact.point]; e < b.phyxels.offsets[contact.point + 1]; ++e)
      d += b.weights[e] * du[b.phyxels.indices[e]];
    const Vec3 force = hessianOf(s, contact.normal) * d;
    for (Index e = b.phyxels.offsets[contact.point]; e < b.phyxels.offsets[contact.point + 1]; ++e)
      out[b.phyxels.indices[e]] += b.weights[e] * force;
  });
}

void addContactBlocks(const ContactPoints &points, const ContactState &memory, const ContactPenalty &penalty,
                      std::span<const Vec3> start, std::span<const Vec3> now, std::span<Mat3> blocks) {
  const Interpolation &b = points.binding;
  forActing(points, memory, penalty, start, now, [&](const Contact &contact, const PenaltyState &s) {
    const Mat3 H = hessianOf(s, contact.normal);
    for (Index e = b.phyxels.offsets[contact.point]; e < b.phyxels.offsets[contact.point + 1]; ++e)
      blocks[b.phyxels.indices[e]] += b.weights[e] * b.weights[e] * H;
  });
}

void addContactTriplets(const ContactPoints &points, const ContactState &memory, const ContactPenalty &penalty,
                        std::span<const Vec3> start, std::span<const Vec3> now,
                        std::vector<Eigen::Triplet<double>> &out) {
  const Interpolation &b = points.binding;
  forActing(points, memory, penalty, start, now, [&](const Contact &contact, const PenaltyState &s) {
    const Mat3 H = hessianOf(s, contact.normal);
    for (Index e = b.phyxels.offsets[contact.point]; e < b.phyxels.offsets[contact.point + 1]; ++e)
      for (Index f = b.phyxels.offsets[contact.point]; f < b.phyxels.offsets[contact.point + 1]; ++f)
        for (int r = 0; r < 3; ++r)
          for (int c = 0; c < 3; ++c)
            out.emplace_back(static_cast<int>(3 * b.phyxels.indices[e]) + r,
                             static_cast<int>(3 * b.phyxels.indices[f]) + c, b.weights[e] * b.weights[f] * H(r, c));
  });
}

namespace {

// Force on every point; returns the sum of the normal forces.
double forcesOnPoints(const ContactPoints &points, const ContactPenalty &penalty, std::span<const Vec3> start,
                      std::span<const Vec3> now, const ContactState &memory, std::vector<Vec3> &out) {
  out.assign(points.count(), Vec3::Zero());
  double normalForceSum = 0.0;
  for (const Contact &contact : memory.active) {
    const PenaltyState s = penaltyStateOf(points, penalty, contact, start, now);
    out[contact.point] += forceOf(s, contact.normal);
    normalForceSum += s.k * std::max(0.0, -s.gap);
  }
  return normalForceSum;
}

}  // namespace

void ContactForces::record(const ContactPoints &points, const ContactPenalty &penalty, std::span<const Vec3> start,
                           std::span<const Vec3> now, const ContactState &memory) {
  (void)forcesOnPoints(points, penalty, start, now, memory, recorded_);
}

double ContactForces::changeTo(const ContactPoints &points, const ContactPenalty &penalty, std::span<const Vec3> start,
                               std::span<const Vec3> now, const ContactState &memory) {
  const double normalForceSum = forcesOnPoints(points, penalty, start, now, memory, present_);
  double change = 0.0;
  for (std::size_t p = 0; p < present_.size(); ++p) change += (present_[p] - recorded_[p]).norm();
  if (change == 0.0) return 0.0;
  return normalForceSum > 0.0 ? change / normalForceSum : std::numeric_limits<double>::infinity();
}

void updateNormalForces(const ContactPoints &points, const ContactPenalty &penalty, std::span<const Vec3> start,
                        std::span<const Vec3> now, ContactState &memory) {
  for (Contact &contact : memory.active) {
    const PenaltyState s = penaltyStateOf(points, penalty, contact, start, now);
    contact.normalForce = s.gap < 0.0 ? -s.k * s.gap : 0.0;
    contact.normalImpulse = penalty.h * contact.normalForce;
  }
}

void sumContactForces(const ContactPoints &points, const ContactPenalty &penalty, std::span<const Vec3> start,
                      std::span<const Vec3> now, ContactState &memory) {
  for (ContactSum &sum : memory.stageForceSums.of) sum = ContactSum();
  if (memory.stageForceSums.of.empty()) return;
  for (const Contact &contact : memory.active) {
    const PenaltyState s = penaltyStateOf(points, penalty, contact, start, now);
    ContactSum &sum = memory.stageForceSums.at(contact.obstacle);
    sum.impulse += forceOf(s, contact.normal);
    sum.normalImpulseSum += s.k * std::max(0.0, -s.gap);
  }
}

void addStageForces(double span, ContactState &memory) {
  if (memory.sums.of.empty() || memory.stageForceSums.of.size() != memory.sums.of.size()) return;
  memory.sums.duration += span;
  for (std::size_t o = 0; o < memory.sums.of.size(); ++o) {
    memory.sums.of[o].impulse += span * memory.stageForceSums.of[o].impulse;
    memory.sums.of[o].normalImpulseSum += span * memory.stageForceSums.of[o].normalImpulseSum;
  }
}

void endContactStage(const ContactPoints &points, const ContactPenalty &penalty, std::span<const Vec3> start,
                     std::span<const Vec3> now, ContactState &memory) {
  for (Contact &contact : memory.active) {
    const PenaltyState s = penaltyStateOf(points, penalty, contact, start, now);
    const double size = s.tangentialDisplacement.norm();
    contact.tangentialDisplacement =
        size > s.stickLimit ? Vec3(s.stickLimit / size * s.tangentialDisplacement) : s.tangentialDisplacement;
    // A small remainder is kept, so that the step that removes the last penetration can detect it.
    const double remaining = contact.initialPenetration - kRecoverySpeed * penalty.h,
                 minRemainder = kMinRemainder * penalty.spacing;
    contact.initialPenetration = remaining > minRemainder                    ? remaining
                                 : contact.initialPenetration > minRemainder ? minRemainder
                                                                             : 0.0;
  }
}

}  // namespace pointbased
