// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/polar.h"
#include "contact/contact_bounce.h"
#include "contact/contact_kernel.h"
#include "contact/rigid_particles.h"
#include "discretisation/interpolation_at.h"

namespace pointbased {
namespace {

// Margins: shallower penetrations are solver residuals and not corrected. Larger: bodies rest deeper.
constexpr double kSlop = 0.02;
// Sweeps of the velocity projection; the next step corrects the remaining velocity. More: less drift, more time.
constexpr int kProjectionSweeps = 8;
// Sweeps, and tolerance relative to the largest normal speed, of restitution with rigid bodies: all contacts of a rigid
// body are coupled and converge slowly. Fewer sweeps, larger tolerance: more residual spin after a flat landing.
constexpr int kRigidRestitutionSweeps = 200;
constexpr double kRigidRestitutionTolerance = 1e-4;
// Consecutive sweeps over contacts with an impulse between two sweeps over all. More: cheaper, late detection of new
// ones.
constexpr int kSubsetSweeps = 4;
// Of the largest speed: contacts that open faster do not press. Larger: more are swept. Those in between are swept
// because among points on one flat face rounding alone decides which press, and the result must not depend on it.
constexpr double kOpeningFraction = 0.1;

// Velocities of phyxels and rigid bodies, changed by impulses on contact points.
struct ContactSystem {
  const Interpolation &binding;
  std::span<const double> inverseMasses;
  std::span<const detail::RigidParticles> rigid;
  std::span<Vec3> velocities;

  // Rigid body that the particle belongs to; null: it is a phyxel.
  [[nodiscard]] const detail::RigidParticles *rigidOf(Index j) const {
    const auto next = std::upper_bound(rigid.begin(), rigid.end(), j,
                                       [](Index k, const detail::RigidParticles &one) { return k < one.first; });
    if (next == rigid.begin()) return nullptr;
    return j < std::prev(next)->first + 4 ? &*std::prev(next) : nullptr;
  }
  [[nodiscard]] Vec3 velocity(Index p) const {
    Vec3 v = Vec3::Zero();
    for (Index e = binding.phyxels.offsets[p]; e < binding.phyxels.offsets[p + 1]; ++e)
      v += binding.weights[e] * velocities[binding.phyxels.indices[e]];
    return v;
  }
};

// Velocity changes of the slots by an impulse on contact c: visit(slot, change).
template <class Visit>
void forEachVelocityChange(const ContactState::Solution &solution, std::size_t c, const Vec3 &impulse,
                           const Visit &visit) {
  for (Index e = solution.rows[c]; e < solution.rows[c + 1]; ++e)
    if (solution.responses[e] != 0.0) visit(solution.slots[e], Vec3(solution.responses[e] * impulse));
  if (solution.rigidRows.empty()) return;
  for (Index r = solution.rigidRows[c]; r < solution.rigidRows[c + 1]; ++r) {
    const double *part = solution.rigidParts.data() + kernels::kRigidRecordSize * std::size_t{r};
    const Vec3 spin =
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(part + kernels::kRigidAngularResponse) * impulse;
    for (Index k = 0; k < 4; ++k) {
      const Vec3 arm = Eigen::Map<const Vec3>(part + kernels::kRigidArms + 3 * k);
      visit(solution.rigidSlots[r] + k, Vec3(part[kernels::kRigidLinearResponse] * impulse + spin.cross(arm)));
    }
  }
}

// Normal velocity that the impulse of a contact enforces as a minimum, m/s.
double minVelocityOf(const ContactState::Solution &solution, std::size_t c) {
  return std::max(solution.minVelocities[c] - solution.compliances[c] * solution.impulses[c],
                  solution.minVelocityLimits[c]);
}

// Warm start with a fraction of the stored impulses. The fraction minimises T + Σ λ (-minVelocities), the energy that
// the steps of projected Gauss-Seidel decrease as well. No energy is added, however few sweeps follow.
void warmStart(const ContactSystem &body, std::span<const Contact> active, ContactState::Solution &solution) {
  std::vector<Vec3> &change = solution.change;  // of the touched phyxels
  change.assign(solution.touched.size(), Vec3::Zero());
  double slope = 0.0, curvature = 0.0;
  for (std::size_t c = 0; c < active.size(); ++c) {
    const double impulse = solution.impulses[c];
    if (!(impulse > 0.0)) continue;
    const Vec3 v = body.velocity(active[c].point) - active[c].surfaceVelocity;
    const Vec3 whole = impulse * active[c].normal + solution.tangential[c];
    slope += whole.dot(v) - impulse * minVelocityOf(solution, c);
    forEachVelocityChange(solution, c, whole, [&](Index slot, const Vec3 &more) { change[slot] += more; });
  }
  for (std::size_t s = 0; s < change.size(); ++s)
    if (const double inverse = body.inverseMasses[solution.touched[s]]; inverse > 0.0)
      curvature += change[s].squaredNorm() / inverse;
  const double part = curvature > 0.0 && slope < 0.0 ? std::min(1.0, -slope / curvature) : 0.0;
  for (double &impulse : solution.impulses) impulse *= part;
  for (Vec3 &impulse : solution.tangential) impulse *= part;
  if (part > 0.0)
    for (std::size_t s = 0; s < change.size(); ++s) body.velocities[solution.touched[s]] += part * change[s];
}

// Response of the rigid bodies to contact c, and its effective inverse mass K = ∂v/∂P. K grows with the distance from
// the centre of mass, except along the direction towards it.
void buildRigidContactRows(const ContactSystem &body, const Contact &contact, std::size_t c,
                           ContactState::Solution &solution) {
  const Index begin = solution.rigidRows.back();
  Mat3 K = Mat3::Zero();
  std::array<const detail::RigidParticles *, 2> of{};
  std::array<double, 2> shares{};
  std::array<Vec3, 2> arms{Vec3::Zero(), Vec3::Zero()};
  for (Index e = solution.rows[c]; e < solution.rows[c + 1]; ++e) {
    const Index j = solution.touched[solution.slots[e]];
    const double weight = solution.weights[e];
    const detail::RigidParticles *one = body.rigidOf(j);
    if (!one) {
      K += weight * weight * body.inverseMasses[j] * Mat3::Identity();
      continue;
    }
    const std::size_t k = !of[0] || of[0] == one ? 0 : 1;
    of[k] = one;
    shares[k] += weight;
    arms[k] += weight * one->arms[j - one->first];
    solution.responses[e] = 0.0;
  }
  for (std::size_t k = 0; k < 2 && of[k]; ++k) {
    Mat3 across;  // cross-product matrix of the arm
    across << 0.0, -arms[k][2], arms[k][1], arms[k][2], 0.0, -arms[k][0], -arms[k][1], arms[k][0], 0.0;
    const Mat3 turn = of[k]->inverseInertia * across;
    K += shares[k] * shares[k] / of[k]->mass * Mat3::Identity() - across * turn;
    solution.rigidSlots.push_back(solution.slotOf[of[k]->first]);
    solution.rigidParts.push_back(shares[k] / of[k]->mass);
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) solution.rigidParts.push_back(turn(row, column));
    for (const Vec3 &arm : of[k]->arms) solution.rigidParts.insert(solution.rigidParts.end(), arm.begin(), arm.end());
  }
  solution.rigidRows.push_back(static_cast<Index>(solution.rigidSlots.size()));
  if (solution.rigidRows.back() == begin) return;
  const Vec3 &n = contact.normal;
  const Mat3 tangential = Mat3::Identity() - n * n.transpose();
  solution.inverseMasses[c] = n.dot(K * n);
  solution.records[kernels::kContactRecordSize * c + kernels::kTangentialMass] =
      1.0 / detail::largestEigenvalueBound(tangential * K * tangential);
}

// Packs the contacts and the velocities of the phyxels they touch contiguously for the sweeps.
void buildContactRows(const ContactSystem &body, std::span<const Contact> active, ContactState::Solution &solution) {
  constexpr Index kNowhere = 0xffffffffu;
  const Csr &phyxels = body.binding.phyxels;
  if (solution.slotOf.size() != body.inverseMasses.size()) solution.slotOf.assign(body.inverseMasses.size(), kNowhere);
  for (const Index j : solution.touched) solution.slotOf[j] = kNowhere;
  solution.touched.clear();
  solution.rows.assign(1, 0);
  solution.slots.clear();
  solution.weights.clear();
  solution.responses.clear();
  solution.rigidRows.clear();
  solution.rigidSlots.clear();
  solution.rigidParts.clear();
  if (!body.rigid.empty()) solution.rigidRows.assign(1, 0);
  solution.inverseMasses.assign(active.size(), 0.0);
  solution.records.assign(kernels::kContactRecordSize * active.size(), 0.0);
  for (std::size_t c = 0; c < active.size(); ++c) {
    const Index p = active[c].point;
    for (Index e = phyxels.offsets[p]; e < phyxels.offsets[p + 1]; ++e) {
      const Index j = phyxels.indices[e];
      Index &slot = solution.slotOf[j];
      if (slot == kNowhere) {
        // The four particles of a rigid body are contiguous, even if the contact has no share in some of them.
        const detail::RigidParticles *one = body.rigid.empty() ? nullptr : body.rigidOf(j);
        for (Index i = one ? one->first : j; i < (one ? one->first + 4 : j + 1); ++i) {
          solution.slotOf[i] = static_cast<Index>(solution.touched.size());
          solution.touched.push_back(i);
        }
      }
      solution.slots.push_back(slot);
      solution.weights.push_back(body.binding.weights[e]);
      solution.responses.push_back(body.binding.weights[e] * body.inverseMasses[j]);
      solution.inverseMasses[c] += body.binding.weights[e] * body.binding.weights[e] * body.inverseMasses[j];
    }
    solution.rows.push_back(static_cast<Index>(solution.slots.size()));
    if (!body.rigid.empty()) buildRigidContactRows(body, active[c], c, solution);
    for (std::size_t a = 0; a < 3; ++a)
      solution.records[kernels::kContactRecordSize * c + kernels::kContactNormal + a] =
          active[c].normal[static_cast<Eigen::Index>(a)];
  }
  solution.velocities.resize(4 * solution.touched.size());
}

// Sweeps until no velocity changes by more than the tolerance. Impulses start at their current values, which have
// already been applied. Requires buildContactRows() of the same contacts.
// @param staticObstacles  treats obstacles as static, without friction and compliance
void sweep(const ContactSystem &body, std::span<const Contact> active, const ImpulseSettings &settings,
           bool staticObstacles, ContactState::Solution &solution) {
  using kernels::kContactRecordSize;
  const std::size_t count = active.size();
  solution.friction.resize(count);
  for (std::size_t c = 0; c < count; ++c) {
    double *record = solution.records.data() + kContactRecordSize * c;
    solution.friction[c] = active[c].friction;
    record[kernels::kMass] = 1.0 / solution.inverseMasses[c];
    for (int a = 0; a < 3; ++a) {
      record[kernels::kSurfaceVelocity + static_cast<std::size_t>(a)] =
          staticObstacles ? 0.0 : active[c].surfaceVelocity[a];
      record[kernels::kTangentialImpulse + static_cast<std::size_t>(a)] = solution.tangential[c][a];
    }
  }
  for (std::size_t s = 0; s < solution.touched.size(); ++s) {
    const Vec3 &v = body.velocities[solution.touched[s]];
    for (int a = 0; a < 3; ++a) solution.velocities[4 * s + static_cast<std::size_t>(a)] = v[a];
    solution.velocities[4 * s + 3] = 0.0;
  }
  kernels::SweepJob job;
  job.count = count;
  job.rows = solution.rows.data();
  job.slots = solution.slots.data();
  job.weights = solution.weights.data();
  job.responses = solution.responses.data();
  job.velocities = solution.velocities.data();
  job.records = solution.records.data();
  job.inverseMasses = solution.inverseMasses.data();
  job.minVelocities = solution.minVelocities.data();
  job.compliances = staticObstacles ? nullptr : solution.compliances.data();
  job.minVelocityLimits = solution.minVelocityLimits.data();
  job.friction = staticObstacles ? nullptr : solution.friction.data();
  job.impulses = solution.impulses.data();
  if (!solution.rigidSlots.empty()) {
    job.rigidRows = solution.rigidRows.data();
    job.rigidSlots = solution.rigidSlots.data();
    job.rigidParts = solution.rigidParts.data();
  }
  // Most contacts of a step do not press in the end. After two sweeps over all contacts, only those that press or
  // nearly do are swept, in alternating direction so that the last one varies. All contacts are swept again before the
  // result is accepted, and after every kSubsetSweeps sweeps.
  double speed = 0.0;
  bool all = true;
  for (int k = 0, subsetSweeps = 0; k < settings.sweeps; ++k) {
    job.subset = all ? nullptr : solution.subset.data();
    job.count = all ? count : solution.subset.size();
    const kernels::SweepResult result = kernels::sweepContacts(job, k % 2 != 0);
    if (k == 0) speed = result.speed;
    const bool isConverged = result.change <= std::max(settings.tolerance * speed, settings.leastSpeed);
    if (isConverged && all) break;
    subsetSweeps = all ? 0 : subsetSweeps + 1;
    const bool sweepsAll = k == 0 || isConverged || subsetSweeps >= kSubsetSweeps || k + 2 >= settings.sweeps;
    if (all && !sweepsAll) {
      solution.subset.clear();
      for (std::size_t c = 0; c < count; ++c)
        if (!(solution.impulses[c] <= 0.0 &&
              solution.records[kContactRecordSize * c + kernels::kVelocityMargin] > kOpeningFraction * speed))
          solution.subset.push_back(static_cast<Index>(c));
    }
    all = sweepsAll;
  }
  for (std::size_t s = 0; s < solution.touched.size(); ++s)
    body.velocities[solution.touched[s]] = Eigen::Map<const Vec3>(solution.velocities.data() + 4 * s);
  for (std::size_t c = 0; c < count; ++c)
    solution.tangential[c] =
        Eigen::Map<const Vec3>(solution.records.data() + kContactRecordSize * c + kernels::kTangentialImpulse);
}

void prepare(const ContactSystem &body, std::span<const Contact> active, ContactState::Solution &solution) {
  solution.impulses.assign(active.size(), 0.0);
  solution.tangential.assign(active.size(), Vec3::Zero());
  solution.minVelocities.assign(active.size(), 0.0);
  solution.compliances.assign(active.size(), 0.0);
  solution.minVelocityLimits.assign(active.size(), -std::numeric_limits<double>::infinity());
  buildContactRows(body, active, solution);
}

}  // namespace

double closingSpeed(const ContactState &memory, const Interpolation &binding, std::span<const Vec3> velocities) {
  double speed = 0.0;
  for (const Contact &contact : memory.active)
    speed = std::max(
        speed, (contact.surfaceVelocity - detail::fieldAt(binding, contact.point, velocities)).dot(contact.normal));
  return speed;
}

bool findImpacts(const Interpolation &binding, std::span<const Vec3> velocities, double dt, double restitutionThreshold,
                 ContactState &memory) {
  std::vector<Contact> &impacts = memory.previous;  // overwritten by the next search
  impacts.clear();
  for (const Contact &contact : memory.active) {
    if (!(contact.restitution > 0.0) || contact.normalImpulse > 0.0) continue;
    const Vec3 v = detail::fieldAt(binding, contact.point, velocities) - contact.surfaceVelocity;
    const double speed = -v.dot(contact.normal);
    if (speed > restitutionThreshold && contact.gap - dt * speed < 0.0) impacts.push_back(contact);
  }
  return !impacts.empty();
}

Vec3 applyRestitution(const Interpolation &binding, std::span<const double> inverseMasses, double restitutionThreshold,
                      ContactState &memory, std::span<Vec3> velocities) {
  return detail::applyRestitution(binding, inverseMasses, {}, restitutionThreshold, memory, velocities);
}

Vec3 detail::applyRestitution(const Interpolation &binding, std::span<const double> inverseMasses,
                              std::span<const RigidParticles> rigid, double restitutionThreshold, ContactState &memory,
                              std::span<Vec3> velocities) {
  const ContactSystem body{binding, inverseMasses, rigid, velocities};
  std::vector<Contact> &impacts = memory.previous;
  const auto relative = [&](const Contact &c) { return Vec3(body.velocity(c.point) - c.surfaceVelocity); };
  std::erase_if(impacts, [&](const Contact &c) { return !(relative(c).dot(c.normal) < -restitutionThreshold); });
  if (impacts.empty()) return Vec3::Zero();

  ContactState::Solution &solution = memory.solution;
  const std::size_t count = impacts.size();
  std::vector<Vec3> &before = solution.arrivals;
  before.resize(count);
  for (std::size_t c = 0; c < count; ++c) before[c] = relative(impacts[c]);
  prepare(body, impacts, solution);  // cold start: none of these contacts persists
  ImpulseSettings settings;
  if (!rigid.empty()) {
    settings.sweeps = kRigidRestitutionSweeps;
    settings.tolerance = kRigidRestitutionTolerance;
  }
  sweep(body, impacts, settings, false, solution);

  // Adds e times the impulses. Together with friction they must do no work relative to the obstacles, Σ P · (v before +
  // v after)/2 <= 0; only the admissible fraction is added.
  const auto addRestitution = [&](double part) {
    for (std::size_t c = 0; c < count; ++c) {
      const Vec3 impulse = part * impacts[c].restitution * solution.impulses[c] * impacts[c].normal;
      forEachVelocityChange(solution, c, impulse,
                            [&](Index slot, const Vec3 &more) { velocities[solution.touched[slot]] += more; });
    }
  };
  std::vector<Vec3> &afterStop = solution.change;
  afterStop.resize(count);
  for (std::size_t c = 0; c < count; ++c) afterStop[c] = relative(impacts[c]);
  addRestitution(1.0);
  const auto addToSums = [&](double part) {
    if (memory.sums.of.empty()) return;
    for (std::size_t c = 0; c < count; ++c) {
      ContactSum &sum = memory.sums.at(impacts[c].obstacle);
      const double normal = (1.0 + part * impacts[c].restitution) * solution.impulses[c];
      sum.impulse += normal * impacts[c].normal + solution.tangential[c];
      sum.normalImpulseSum += normal;
    }
  };
  double none = 0.0, slope = 0.0, curvature = 0.0;  // twice the work, as a polynomial in the fraction
  Vec3 total = Vec3::Zero();
  for (std::size_t c = 0; c < count; ++c) {
    const Vec3 both = before[c] + afterStop[c], gained = relative(impacts[c]) - afterStop[c];
    const Vec3 first = solution.impulses[c] * impacts[c].normal + solution.tangential[c],
               more = impacts[c].restitution * solution.impulses[c] * impacts[c].normal;
    none += first.dot(both);
    slope += more.dot(both) + first.dot(gained);
    curvature += more.dot(gained);
    total += first + more;
  }
  if (!(none + slope + curvature > 0.0)) {
    addToSums(1.0);
    return total;
  }
  const double root = slope * slope - 4.0 * curvature * std::min(0.0, none);
  const double part =
      curvature > 0.0 ? std::clamp((-slope + std::sqrt(std::max(0.0, root))) / (2.0 * curvature), 0.0, 1.0) : 0.0;
  addRestitution(part - 1.0);
  for (std::size_t c = 0; c < count; ++c)
    total += (part - 1.0) * impacts[c].restitution * solution.impulses[c] * impacts[c].normal;
  addToSums(part);
  return total;
}

Vec3 solveContactImpulses(const Interpolation &binding, std::span<const double> inverseMasses, double dt,
                          const ImpulseSettings &settings, ContactState &memory, std::span<Vec3> velocities) {
  return detail::solveContactImpulses(binding, inverseMasses, {}, dt, settings, memory, velocities);
}

Vec3 detail::solveContactImpulses(const Interpolation &binding, std::span<const double> inverseMasses,
                                  std::span<const RigidParticles> rigid, double dt, const ImpulseSettings &settings,
                                  ContactState &memory, std::span<Vec3> velocities) {
  std::vector<Contact> &active = memory.active;
  ContactState::Solution &solution = memory.solution;
  solution.splitImpulse.clear();
  if (active.empty()) return Vec3::Zero();
  const ContactSystem body{binding, inverseMasses, rigid, velocities};
  prepare(body, active, solution);
  double deepest = 0.0;
  for (std::size_t c = 0; c < active.size(); ++c) {
    solution.impulses[c] = active[c].normalImpulse;
    solution.tangential[c] = active[c].frictionImpulse;
    if (active[c].stiffness > 0.0) {
      // The velocity projection contributes the other half of the force.
      solution.minVelocities[c] = std::min(-active[c].gap, active[c].thickness) / dt;
      solution.compliances[c] = 2.0 / (active[c].stiffness * dt * dt);
      solution.minVelocityLimits[c] = -std::max(0.0, active[c].gap + active[c].thickness) / dt;
      continue;
    }
    solution.minVelocities[c] = -std::max(0.0, active[c].gap) / dt;
    deepest = std::max(deepest, -active[c].gap);
  }
  warmStart(body, active, solution);
  sweep(body, active, settings, false, solution);
  Vec3 total = Vec3::Zero();
  for (std::size_t c = 0; c < active.size(); ++c) {
    active[c].normalImpulse = solution.impulses[c];
    active[c].frictionImpulse = solution.tangential[c];
    total += solution.impulses[c] * active[c].normal + solution.tangential[c];
  }

  const double slop = kSlop * memory.margin;
  if (!(deepest > slop)) return total;
  solution.splitImpulse.assign(velocities.size(), Vec3::Zero());
  const ContactSystem depenetration{binding, inverseMasses, rigid, solution.splitImpulse};
  for (std::size_t c = 0; c < active.size(); ++c) {
    const double gap = active[c].gap + active[c].thickness, depth = -gap - slop;
    // Velocities of the split impulses add to those of the body, which keep the other contacts within their gaps.
    solution.minVelocities[c] = depth > 0.0 && !(active[c].stiffness > 0.0)
                                    ? std::min(settings.splitImpulse * depth / dt, settings.recoverySpeed)
                                    : -std::max(0.0, gap) / dt;
    solution.impulses[c] = 0.0;
    solution.tangential[c].setZero();
  }
  sweep(depenetration, active, settings, true, solution);
  for (const Index j : solution.touched) {
    velocities[j] += solution.splitImpulse[j];
    if (inverseMasses[j] > 0.0) memory.depenetrationMoment += dt / inverseMasses[j] * solution.splitImpulse[j];
  }
  return total;
}

void projectContactVelocities(const Interpolation &binding, std::span<const double> inverseMasses, double dt,
                              ContactState &memory, std::span<Vec3> velocities) {
  (void)dt;
  detail::projectContactVelocities(binding, inverseMasses, {}, memory, velocities);
}

void detail::projectContactVelocities(const Interpolation &binding, std::span<const double> inverseMasses,
                                      std::span<const RigidParticles> rigid, ContactState &memory,
                                      std::span<Vec3> velocities) {
  ContactState::Solution &solution = memory.solution;
  if (!solution.splitImpulse.empty()) {
    for (const Index j : solution.touched)
      if (inverseMasses[j] > 0.0) velocities[j] -= solution.splitImpulse[j];
    // The rigid bodies have rotated since.
    for (const RigidParticles &one : rigid) one.project(velocities.subspan(one.first, 4));
  }
  solution.splitImpulse.clear();
  // Contacts closed by the step, stored in `previous`, which the next search overwrites.
  std::vector<Contact> &closed = memory.previous;
  closed.clear();
  for (const Contact &contact : memory.active)
    if (contact.normalImpulse > 0.0) closed.push_back(contact);
  if (closed.empty()) return;
  const ContactSystem body{binding, inverseMasses, rigid, velocities};
  prepare(body, closed, solution);
  for (std::size_t c = 0; c < closed.size(); ++c) {
    solution.impulses[c] = closed[c].projectionImpulse;
    solution.tangential[c] = closed[c].projectionFriction;
  }
  warmStart(body, closed, solution);
  ImpulseSettings settings;
  settings.sweeps = kProjectionSweeps;
  sweep(body, closed, settings, false, solution);
  std::size_t c = 0;
  for (Contact &contact : memory.active) {
    const bool closes = contact.normalImpulse > 0.0;
    contact.projectionImpulse = closes ? solution.impulses[c] : 0.0;
    contact.projectionFriction = closes ? solution.tangential[c] : Vec3(Vec3::Zero());
    if (closes) ++c;
  }
}

void sumContactImpulses(double dt, ContactState &memory) {
  if (memory.sums.of.empty()) return;
  memory.sums.duration += dt;
  for (const Contact &contact : memory.active) {
    if (!(contact.normalImpulse > 0.0)) continue;
    ContactSum &sum = memory.sums.at(contact.obstacle);
    const double normal = contact.normalImpulse + contact.projectionImpulse;
    sum.impulse += normal * contact.normal + contact.frictionImpulse + contact.projectionFriction;
    sum.normalImpulseSum += normal;
  }
}

}  // namespace pointbased
