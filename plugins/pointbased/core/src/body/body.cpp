// SPDX-License-Identifier: Apache-2.0
#include "pointbased/body.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/expects.h"
#include "body/rigid_frame.h"
#include "forces/engine_frequency.h"
#include "forces/entry_forces.h"
#include "forces/vector_forces.h"

namespace pointbased {
namespace {

// Mean of a property of the materials around every phyxel, weighted by volume.
std::vector<double> meansAround(const Constitution &constitution, const RestState &rest, double Material::*number) {
  const StencilSet &s = rest.stencils;
  std::vector<double> means(rest.phyxelCount(), constitution.materials.front().*number);
  if (!rest.materialShares.empty()) {
    const std::size_t kinds = constitution.materials.size();
    for (std::size_t i = 0; i < means.size(); ++i) {
      means[i] = 0.0;
      for (std::size_t m = 0; m < kinds; ++m)
        means[i] += rest.materialShares[i * kinds + m] * (constitution.materials[m].*number);
    }
    return means;
  }
  if (s.materials.empty()) return means;
  for (std::size_t i = 0; i < means.size(); ++i) {
    double sum = 0.0, volume = 0.0;
    for (const Index entry : s.entriesOfPhyxel.row(i)) {
      const Index q = s.pointOfEntry(entry);
      if (!s.isCorner(entry, q)) continue;
      sum += s.volumes[q] * (constitution.materials[s.materials[q]].*number);
      volume += s.volumes[q];
    }
    if (volume > 0.0) means[i] = sum / volume;
  }
  return means;
}

// Scaled such that the body has the mass of its evaluation points.
std::vector<double> phyxelDensities(const Constitution &constitution, const RestState &rest) {
  const StencilSet &s = rest.stencils;
  std::vector<double> densities = meansAround(constitution, rest, &Material::restDensity);
  if (!rest.materialShares.empty() || s.materials.empty()) return densities;
  const std::vector<double> &volumes = rest.weightVolumes.empty() ? rest.volumes : rest.weightVolumes;
  double mass = 0.0, shared = 0.0;
  for (std::size_t q = 0; q < s.pointCount(); ++q)
    mass += s.volumes[q] * constitution.materials[s.materials[q]].restDensity;
  for (std::size_t i = 0; i < densities.size(); ++i)
    shared += densities[i] * (volumes[i] - (rest.heldVolumes.empty() ? 0.0 : rest.heldVolumes[i]));
  if (shared > 0.0)
    for (double &density : densities) density *= mass / shared;
  return densities;
}

// Young's modulus where something acts on a body: the mean around the phyxels of a row. It is computed as a difference
// to the first one, so that a body of one material has its modulus to the bit.
double modulusAt(std::span<const double> moduli, const Csr &rows, std::span<const double> weights, std::size_t row) {
  const double first = moduli[rows.indices[rows.offsets[row]]];
  double sum = 0.0, all = 0.0;
  for (Index e = rows.offsets[row]; e < rows.offsets[row + 1]; ++e) {
    sum += std::abs(weights[e]) * (moduli[rows.indices[e]] - first);
    all += std::abs(weights[e]);
  }
  return first + sum / all;
}

// Number of materials that the points of a body refer to.
std::size_t materialsNamed(const StencilSet &s) {
  return s.materials.empty() ? 1 : std::size_t{1} + *std::max_element(s.materials.begin(), s.materials.end());
}

}  // namespace

Body::Body(std::string name, std::shared_ptr<const RestState> rest, Constitution constitution,
           const ParallelFor &parallelFor)
    : name_(std::move(name)), rest_(std::move(rest)), first_(rest_) {
  POINTBASED_EXPECTS(rest_ != nullptr, "a rest state");
  resizeForRestState();
  setConstitution(std::move(constitution), parallelFor);
  reset();
}

Body::~Body() = default;
Body::Body(Body &&) noexcept = default;
Body &Body::operator=(Body &&) noexcept = default;

Vec3 Body::firstReference(Index phyxel) const {
  const Vec3 &X = rest_->positions[phyxel];
  return rest_->referenceShift.empty() ? X : Vec3(X - rest_->referenceShift[phyxel]);
}

void Body::addPatchesOf(const ConstrainedRegion &part, Index fix) {
  for (std::size_t p = 0; p < part.rows.rows(); ++p) {
    Vec3 point = Vec3::Zero(), shift = Vec3::Zero();
    for (Index e = part.rows.offsets[p]; e < part.rows.offsets[p + 1]; ++e) {
      const Index j = part.rows.indices[e];
      point += part.weights[e] * firstReference(j);
      if (!rest_->referenceShift.empty()) shift += part.weights[e] * rest_->referenceShift[j];
    }
    patchPoints_.push_back(point);
    patchShifts_.push_back(shift);
    fixOfPatch_.push_back(fix);
  }
}

// Resizes and resets everything that depends on the rest state.
void Body::resizeForRestState() {
  const std::size_t n = rest_->phyxelCount();
  masses_.resize(n);
  inverseMasses_.resize(n);
  forces_.assign(n, Vec3::Zero());
  externalForces_.clear();
  std::vector<Mat3>().swap(gradients_);
  std::vector<Mat3>().swap(stresses_);
  gradientsStale_ = stressesStale_ = false;
  heldPhyxels_.clear();
  findHeldSurfels();
  patchPoints_.clear();
  patchShifts_.clear();
  fixOfPatch_.clear();
  supportMasses_.clear();
  carrier_.clear();

  heldMask_.assign(n, 0);
  const BoundaryConditions &conditions = rest_->conditions;
  for (std::size_t f = 0; f < conditions.held.size(); ++f) {
    const ConstrainedRegion &part = conditions.held[f];
    for (const Index i : part.phyxels)
      if (!heldMask_[i]) {
        heldMask_[i] = 1;
        heldPhyxels_.push_back({i, static_cast<Index>(f)});
      }
    addPatchesOf(part, static_cast<Index>(f));
  }
  for (std::size_t k = 0; k < liveSupports_.size(); ++k)
    addPatchesOf(liveSupports_[k].part, static_cast<Index>(conditions.held.size() + k));
  patchTargets_.resize(patchPoints_.size());
  if (!rest_->heldVolumes.empty()) {
    supportMasses_.assign(n, 0.0);
    carrier_.assign(n, 0);
    for (std::size_t f = conditions.held.size(); f-- > 0;)
      for (const Index i : conditions.held[f].rows.indices) carrier_[i] = static_cast<Index>(f);
  }
  const bool weighs = !conditions.held.empty() && !rest_->weightVolumes.empty();
  for (auto *values : {&weights_, &supportWeights_, &gravityShares_}) values->assign(weighs ? n : 0, 0.0);
  restMasses_.clear();
  bindFoundation();
}

void Body::setConstitution(Constitution constitution, const ParallelFor &parallelFor) {
  POINTBASED_EXPECTS(constitution.materials.size() >= materialsNamed(rest_->stencils),
                     "a material for every number that points have");
  const std::size_t points = rest_->pointCount();
  const bool remembersFlow = !state_.history.plasticInverse.empty(), remembersStress = !state_.history.prony.empty();
  const std::vector<Mat3> flow = std::move(state_.history.plasticInverse),
                          flowBefore = std::move(state_.history.plasticBefore);
  const std::vector<PronyPoint> stress = std::move(state_.history.prony);
  const std::vector<HourglassHistory> modes = std::move(state_.history.modes);
  constitution_ = std::move(constitution);
  state_.history = PointHistory();
  state_.history.reset(constitution_, points, rest_->stencils.isLattice());
  if (remembersFlow && !state_.history.plasticInverse.empty()) {
    state_.history.plasticInverse = flow;
    state_.history.plasticBefore = flowBefore;
  }
  if (remembersStress && !state_.history.prony.empty()) state_.history.prony = stress;
  if (!modes.empty() && !state_.history.modes.empty()) state_.history.modes = modes;

  const std::vector<double> densities = phyxelDensities(constitution_, *rest_);
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    const double density = densities[i];
    masses_[i] = density * rest_->volumes[i];
    if (!weights_.empty()) weights_[i] = density * rest_->weightVolumes[i];
    if (!rest_->heldVolumes.empty() && !heldMask_[i]) {
      // Less than all: a phyxel that deforms nothing still needs inertia.
      constexpr double kMaxCarried = 1.0 - 1e-6;
      supportMasses_[i] = std::clamp(rest_->supportVolumes[i] / rest_->volumes[i], 0.0, kMaxCarried) * masses_[i];
      masses_[i] -= supportMasses_[i];
      supportWeights_[i] = std::clamp(rest_->heldVolumes[i] / rest_->weightVolumes[i], 0.0, kMaxCarried) * weights_[i];
      weights_[i] -= supportWeights_[i];
    }
  }
  addMasses(parallelFor);
  contactModuli_ = moduliAt(rest_->contact.binding);
  updateMassDependents();
}

// Updates everything except the kernels that depends on the masses.
void Body::updateMassDependents() {
  const std::vector<double> moduli = meansAround(constitution_, *rest_, &Material::youngsModulus);
  Csr rows;
  std::vector<double> weights, stiffness;
  const auto add = [&](const ConstrainedRegion &part) {
    for (std::size_t p = 0; p < part.rows.rows(); ++p) {
      for (Index e = part.rows.offsets[p]; e < part.rows.offsets[p + 1]; ++e) {
        rows.indices.push_back(part.rows.indices[e]);
        weights.push_back(part.weights[e]);
      }
      rows.offsets.push_back(static_cast<Index>(rows.indices.size()));
      const double modulus = modulusAt(moduli, part.rows, part.weights, p);
      stiffness.push_back(part.stiffness[p] * modulus * part.areas[p] / rest_->spacing);
    }
  };
  for (const ConstrainedRegion &part : rest_->conditions.held) add(part);
  for (const LiveSupport &support : liveSupports_) add(support.part);
  patches_.set(rows, weights, stiffness, inverseMasses_);
  foundationFrequency_ = std::sqrt(foundation_.squaredFrequencyBound(masses_));
  if (rigid_) frameRigid();
  forcesCurrent = false;
}

void Body::shareGravity() {
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    if (!weights_.empty()) gravityShares_[i] = weights_[i] / masses_[i];
    inverseMasses_[i] = heldMask_[i] ? 0.0 : 1.0 / masses_[i];
  }
}

void Body::frameRigid() {
  rigidFrame_ = std::make_unique<const detail::RigidFrame>(rest_->positions, masses_, rest_->spacing);
}

std::vector<double> Body::moduliAt(const Interpolation &points) const {
  const std::vector<double> moduli = meansAround(constitution_, *rest_, &Material::youngsModulus);
  std::vector<double> out(points.count());
  for (std::size_t p = 0; p < out.size(); ++p) out[p] = modulusAt(moduli, points.phyxels, points.weights, p);
  return out;
}

double Body::frequencyAtRest(const ParallelFor &parallelFor) const {
  if (!vectorForces_)
    return largestFrequency(constitution_, rest_->stencils, rest_->positions, masses_, {}, parallelFor);
  detail::VectorForces &forces = doublePrecisionForces();
  forces.linearise(std::vector<Vec3>(rest_->phyxelCount(), Vec3::Zero()), parallelFor);
  const double frequency = detail::largestFrequencyOf(
      [&](std::span<const Vec3> du, std::span<Vec3> df) { forces.differential(du, 0.0, df, parallelFor); }, masses_, {},
      parallelFor);
  forces.dropTangent();
  if (precision_ != Precision::doublePrecision) doublePrecisionForces_.reset();
  return frequency;
}

double Body::stableStepFor(double tangentRatio) const {
  // The largest eigenvalue of a sum is at most the sum of the largest eigenvalues.
  const double own = isFreeRigid() ? 0.0 : restFrequency_;
  const double elastic = own * own, damped = foundationFrequency_ * foundationFrequency_;
  const double around = damped + attachedFrequency_;
  const double frequency = around > 0.0 ? std::sqrt(elastic * tangentRatio + around) : own * std::sqrt(tangentRatio);
  if (frequency == 0.0) return std::numeric_limits<double>::infinity();
  // Viscous forces use the velocity half a step earlier: stability bound of central differences with lagged damping.
  double relaxation = 0.0;
  for (const Material &m : constitution_.materials)
    relaxation = std::max(relaxation, 2.0 * m.viscosity / m.waveModulus());
  const double xi = around > 0.0 ? 0.5 * (relaxation * elastic + foundation_.settings().retardationTime * damped) /
                                       std::sqrt(elastic + around)
                                 : 0.5 * relaxation * own;
  return 2.0 / frequency * (std::sqrt(1.0 + xi * xi) - xi);
}

void Body::setPrecision(Precision precision) {
  if (precision == precision_) return;
  precision_ = precision;
  vectorise(serialFor());
  forcesCurrent = false;
}

void Body::vectorise(const ParallelFor &parallelFor) {
  vectorForces_ =
      detail::vectorForces(rest_->stencils, rest_->positions, masses_, constitution_, precision_, parallelFor);
  doublePrecisionForces_.reset();
  if (!vectorForces_) makePoints();
}

// Initialised to the state at rest until the first evaluation.
void Body::makePoints() const {
  const std::size_t points = rest_->pointCount();
  if (gradients_.size() != points) gradients_.assign(points, Mat3::Identity());
  if (stresses_.size() != points) stresses_.assign(points, Mat3::Zero());
}

detail::VectorForces &Body::doublePrecisionForces() const {
  if (precision_ == Precision::doublePrecision) return *vectorForces_;
  if (!doublePrecisionForces_)
    doublePrecisionForces_ = detail::vectorForces(rest_->stencils, rest_->positions, masses_, constitution_,
                                                  Precision::doublePrecision, serialFor());
  return *doublePrecisionForces_;
}

void Body::evaluateInternal(bool viscous, const ParallelFor &parallelFor) {
  const std::span<const Vec3> velocities =
      viscous && constitution_.viscous() ? state_.velocities : std::span<const Vec3>();
  tangentRatio_ =
      doublePrecisionForces().evaluate(state_.displacements, velocities, {state_.history, 0.0}, forces_, parallelFor);
  gradientsStale_ = stressesStale_ = true;
}

void Body::linearise(const ParallelFor &parallelFor) {
  doublePrecisionForces().linearise(state_.displacements, parallelFor);
}

void Body::forceDifferential(std::span<const Vec3> du, double viscousScale, std::span<Vec3> df,
                             const ParallelFor &parallelFor) {
  doublePrecisionForces().differential(du, viscousScale, df, parallelFor);
}

void Body::evaluate(double t, double dt, const ParallelFor &parallelFor) {
  if (isFreeRigid()) {
    std::fill(forces_.begin(), forces_.end(), Vec3(Vec3::Zero()));
    gradientsStale_ = stressesStale_ = true;
    addLoads(t, parallelFor);
    return;
  }
  if (!vectorForces_) {
    computeGradients(parallelFor);
    if (!state_.history.plasticInverse.empty() && dt > 0.0) computeFlow(dt, parallelFor);
    computeStresses(dt, parallelFor);
    computeForces(t, parallelFor);
    return;
  }
  const std::span<const Vec3> velocities = constitution_.viscous() ? state_.velocities : std::span<const Vec3>();
  tangentRatio_ = vectorForces_->evaluate(state_.displacements, velocities, {state_.history, dt}, forces_, parallelFor);
  gradientsStale_ = stressesStale_ = true;
  addLoads(t, parallelFor);
}

std::span<const Mat3> Body::gradients() const {
  makePoints();
  if (gradientsStale_) {
    deformationGradients(rest_->stencils, state_.displacements, gradients_, serialFor());
    if (vectorForces_) vectorForces_->toMaterials(gradients_);
    gradientsStale_ = false;
  }
  return gradients_;
}

std::span<const Mat3> Body::stresses() const {
  makePoints();
  if (rigid_) {
    std::fill(stresses_.begin(), stresses_.end(), Mat3(Mat3::Zero()));
    stressesStale_ = false;
  }
  if (stressesStale_) {
    // With the history at the end of the step: over a time of 0 nothing relaxes further.
    tangentRatios_.resize(rest_->pointCount());
    std::vector<Mat3> rates;
    if (constitution_.viscous()) {
      rates.resize(rest_->pointCount());
      gradientRates(rest_->stencils, state_.velocities, rates, serialFor());
    }
    (void)pointStresses(constitution_, rest_->stencils, gradients(), rates, state_.history, 0.0, nullptr, stresses_,
                        tangentRatios_, serialFor());
    stressesStale_ = false;
  }
  return stresses_;
}

void Body::computeGradients(const ParallelFor &parallelFor) {
  makePoints();
  gradientsStale_ = false;
  deformationGradients(rest_->stencils, state_.displacements, gradients_, parallelFor);
  if (vectorForces_) vectorForces_->toMaterials(gradients_);
}

std::size_t Body::computeFlow(double dt, const ParallelFor &parallelFor) {
  return plasticFlow(constitution_, rest_->stencils, gradients_, dt, state_.history, parallelFor);
}

void Body::stressesInto(double dt, const PointHistory &before, PointHistory *after, bool viscous,
                        const ParallelFor &parallelFor) {
  std::span<const Mat3> rates;
  rates_.clear();
  if (viscous && constitution_.viscous()) {
    rates_.resize(rest_->pointCount());
    gradientRates(rest_->stencils, state_.velocities, rates_, parallelFor);
    rates = rates_;
  }
  tangentRatios_.resize(rest_->pointCount());
  makePoints();
  stressesStale_ = rigid_;  // rigid bodies have none
  tangentRatio_ = pointStresses(constitution_, rest_->stencils, gradients_, rates, before, dt, after, stresses_,
                                tangentRatios_, parallelFor);
  relaxedModes_.resize(before.modes.size());
  if (!before.modes.empty())
    relaxModes(constitution_, rest_->stencils, state_.displacements, gradients_, before, dt, after, relaxedModes_,
               parallelFor);
}

void Body::computeStresses(double dt, const ParallelFor &parallelFor) {
  stressesInto(dt, state_.history, state_.history.prony.empty() ? nullptr : &state_.history, true, parallelFor);
}

void Body::computeTrialStresses(double dt, const ParallelFor &parallelFor) {
  if (state_.history.prony.empty()) return stressesInto(dt, state_.history, nullptr, true, parallelFor);
  trial_.prony.resize(state_.history.prony.size());
  trial_.modes.resize(state_.history.modes.size());
  stressesInto(dt, state_.history, &trial_, true, parallelFor);
}

void Body::computeElasticStresses(const ParallelFor &parallelFor) {
  if (state_.history.prony.empty()) return stressesInto(0.0, state_.history, nullptr, false, parallelFor);
  // Only bodies with relaxation need this copy.
  PointHistory elastic;
  elastic.plasticInverse = state_.history.plasticInverse;
  stressesInto(0.0, elastic, nullptr, false, parallelFor);
}

void Body::computeInternalForces(const ParallelFor &parallelFor) {
  entryForces_.resize(rest_->stencils.phyxels.indices.size());
  // Same rates as for the stresses.
  const std::span<const Vec3> velocities = rates_.empty() ? std::span<const Vec3>() : state_.velocities;
  detail::internalForcesOf(constitution_, rest_->stencils, rest_->positions, state_.displacements, gradients_,
                           stresses_, relaxedModes_, velocities, entryForces_, forces_, parallelFor);
}

void Body::computeForces(double t, const ParallelFor &parallelFor) {
  computeInternalForces(parallelFor);
  addLoads(t, parallelFor);
}

void Body::addLoads(double t, const ParallelFor &parallelFor) {
  foundation_.addForces(state_.displacements, state_.velocities, forces_, parallelFor);
  const BoundaryConditions &conditions = rest_->conditions;
  for (std::size_t l = 0; l < conditions.loads.size(); ++l)
    addLoadForces(conditions.loads[l], conditions.loaded[l], factor(conditions.loads[l].ramp, t), state_.displacements,
                  forces_);
  if (externalForces_.empty()) return;
  const double share = factor(0.0, t);
  double *sum = forces_.front().data();
  const double *added = externalForces_.front().data();
  for (std::size_t i = 0; i < 3 * externalForces_.size(); ++i) sum[i] += share * added[i];
}

void Body::swapExternalForces(std::vector<Vec3> &forces) {
  POINTBASED_EXPECTS(forces.empty() || forces.size() == rest_->phyxelCount(), "one external force per phyxel, or none");
  if (forces.empty() && externalForces_.empty()) return;
  const bool patchable = forcesCurrent && !quasiStatic && forces.size() == externalForces_.size();
  // Consecutive steps need no evaluation between them.
  if (patchable) {
    double *sum = forces_.front().data();
    const double *now = forces.front().data(), *before = externalForces_.front().data();
    for (std::size_t i = 0; i < 3 * forces.size(); ++i) sum[i] += now[i] - before[i];
  } else {
    forcesCurrent = false;
  }
  externalForces_.swap(forces);
}

double Body::factor(double ramp, double t) const {
  if (quasiStatic) return std::clamp(t, 0.0, 1.0);
  return ramp > 0.0 ? std::clamp(t / ramp, 0.0, 1.0) : 1.0;
}

ElasticEnergy Body::elasticEnergy(const ParallelFor &parallelFor) const {
  if (rigid_) return {};
  return vectorised() ? doublePrecisionForces().energy(state_.displacements, state_.history, parallelFor)
                      : elasticEnergy();
}

ElasticEnergy Body::elasticEnergy(std::span<Eigen::Vector2d> perPoint) const {
  if (rigid_) {
    std::fill(perPoint.begin(), perPoint.end(), Eigen::Vector2d(Eigen::Vector2d::Zero()));
    return {};
  }
  return pointbased::elasticEnergy(constitution_, rest_->stencils, rest_->positions, state_.displacements, gradients(),
                                   state_.history, perPoint);
}

double Body::kineticEnergy() const {
  double energy = 0.0;
  for (std::size_t i = 0; i < masses_.size(); ++i) energy += 0.5 * masses_[i] * state_.velocities[i].squaredNorm();
  return energy;
}

double Body::totalMass() const {
  double mass = 0.0;
  for (const double m : restMasses()) mass += m;
  for (const double m : supportMasses_) mass += m;
  return mass;
}

std::span<const Vec3> Body::contactPositions(const ParallelFor &parallelFor) {
  const ContactPoints &points = rest_->contact;
  contactPositions_.resize(points.count());
  interpolateDisplacements(points.binding, rest_->positions, state_.displacements, contactPositions_, parallelFor);
  for (std::size_t p = 0; p < contactPositions_.size(); ++p)
    contactPositions_[p] += rest_->origin + points.binding.positions[p];
  return contactPositions_;
}

std::span<const Vec3> Body::contactVelocities(const ParallelFor &parallelFor) {
  contactVelocities_.resize(rest_->contact.count());
  interpolateField(rest_->contact.binding, state_.velocities, contactVelocities_, parallelFor);
  return contactVelocities_;
}

}  // namespace pointbased
