// SPDX-License-Identifier: Apache-2.0
#include "stepping/implicit/stage_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pointbased/step_composition.h"
#include "solvers/multigrid.h"

namespace pointbased::detail {
namespace {

// Contact stiffness in units of E A / d: a body of height H penetrates by rho g H / (kContactStiffness E / d) under its
// weight.
constexpr double kContactStiffness = 30.0;
constexpr double kRoundOffs = 64.0;  // units in the last place, in the sums of a gradient

// Iterator over triplets, of which a large body has millions; checks for cancellation.
class CancellableTriplets {
 public:
  CancellableTriplets(const Eigen::Triplet<double> *at, const StopRequest *stop) : at_(at), stop_(stop) {}
  CancellableTriplets &operator++() {
    constexpr std::size_t kPollInterval = 1 << 22;
    if (++seen_ % kPollInterval == 0) throwIfStopRequested(stop_);
    ++at_;
    return *this;
  }
  const Eigen::Triplet<double> *operator->() const { return at_; }
  bool operator!=(const CancellableTriplets &other) const { return at_ != other.at_; }

 private:
  const Eigen::Triplet<double> *at_;
  const StopRequest *stop_;
  std::size_t seen_ = 0;
};

}  // namespace

StageProblem::StageProblem(Body &body, const Environment &env, const ImplicitStage &stage)
    : body_(body), env_(env), stage_(stage), n_(body.rest().phyxelCount()) {
  a_ = stage.h > 0.0 ? 1.0 / (stage.h * stage.h) : stage.holding;
  damping_ = stage.h > 0.0 ? env.damping / stage.h : 0.0;
  const StepStages stages = stagesOf(body, env);
  const BoundaryConditions &conditions = body.rest().conditions;
  deadLoads_.assign(n_, Vec3::Zero());
  for (std::size_t l = 0; l < conditions.loads.size(); ++l) {
    const Load &load = conditions.loads[l];
    if (load.pressure != 0.0 && load.follower)
      followers_ = true;
    else
      addLoadForces(load, conditions.loaded[l], body.factor(load.ramp, stage.end), body.state().displacements,
                    deadLoads_);
  }
  for (std::size_t i = 0; i < n_; ++i) deadLoads_[i] += body.weights()[i] * env.gravity;
  const double share = body.factor(0.0, stage.end);
  for (std::size_t i = 0; i < body.externalForces().size(); ++i) deadLoads_[i] += share * body.externalForces()[i];
  if (stages.grabs && stage.h > 0.0) {
    // Grab springs are evaluated at the beginning of the stage, soft enough to be stable despite this delay.
    std::fill(body.forces().begin(), body.forces().end(), Vec3::Zero());
    applyGrabs(body, 0.3 / stage.h);
    for (std::size_t i = 0; i < n_; ++i) deadLoads_[i] += body.forces()[i];
    body.forcesCurrent = false;
  }
  const Constitution &c = body.constitution();
  dissipative_ = stage.h > 0.0 && (stages.viscous || stages.relaxing);
  vectorised_ = body.vectorisedTangent();
  work_.assign(n_, Vec3::Zero());
  contact_ = stages.contact;
  penalty_ = {kContactStiffness, body.contactModuli(), body.rest().spacing, stage.contactSpan};
  start_ = body.state().displacements;
  double volume = 0.0, modulus = 0.0;
  for (const double v : body.rest().volumes) volume += v;
  for (const Material &m : c.materials) modulus = std::max(modulus, m.waveModulus());
  roundOff_ = std::numeric_limits<double>::epsilon() * modulus * volume;
  (void)body.patchTargets(stage.end);
}

bool StageProblem::setState(std::span<const Vec3> u) {
  State &state = body_.state();
  double sum = 0.0;
  for (std::size_t i = 0; i < n_; ++i) {
    state.displacements[i] = u[i];
    if (stage_.h > 0.0) state.velocities[i] = (u[i] - stage_.p[i]) / stage_.h;
    sum += u[i].squaredNorm();
  }
  if (!std::isfinite(sum)) return false;
  if (vectorised_) {
    body_.invalidatePointValues();
  } else {
    body_.computeGradients(*env_.parallelFor);
  }
  workCurrent_ = linearised_ = false;
  return true;
}

double StageProblem::energy() {
  const State &state = body_.state();
  double sum = 0.0;
  for (std::size_t i = 0; i < n_; ++i) {
    const Vec3 &u = state.displacements[i];
    const double m = body_.masses()[i];
    if (stage_.h > 0.0)
      sum += 0.5 * a_ * m * (u - stage_.p[i] - stage_.h * stage_.q[i]).squaredNorm() +
             0.5 * damping_ * m * (u - stage_.p[i]).squaredNorm();
    else if (a_ > 0.0)
      sum += 0.5 * a_ * m * (u - start_[i]).squaredNorm();
    sum -= deadLoads_[i].dot(u);
  }
  const ElasticEnergy elastic = body_.elasticEnergy(*env_.parallelFor);
  sum += elastic.strain + elastic.stabilisation;
  if (body_.patches().rows() > 0) sum += body_.patches().energy(targets(), state.displacements);
  if (contact_) sum += contactEnergy(body_.rest().contact, body_.contact, penalty_, start_, state.displacements);
  if (foundationActs()) {
    // Damping, with the velocity at the end of the stage, has a potential of the displacement within it.
    sum += foundation().energy(state.displacements);
    if (relativeRetardation() > 0.0) sum += relativeRetardation() * foundation().energy(displacementOfStage());
  }
  if (followers_ || dissipative_) {
    computeWork();
    if (reference_.empty()) setReference();
    sum += referenceEnergy_ - workSinceReference();
  }
  return sum;
}

bool StageProblem::movesFreely() const {
  const bool touches = contact_ && !body_.contact.active.empty();
  return stage_.h > 0.0 && !touches && !followers_ && !body_.held() && !body_.foundation().acts();
}

Vec3 StageProblem::translationToMomentum() {
  std::vector<Vec3> residual(n_);
  gradient(residual);
  Vec3 sum = Vec3::Zero();
  double mass = 0.0;
  for (std::size_t i = 0; i < n_; ++i) {
    sum += residual[i];
    mass += body_.masses()[i];
  }
  return -sum / ((a_ + damping_) * mass);
}

void StageProblem::gradient(std::span<Vec3> out) {
  State &state = body_.state();
  if (followers_ || dissipative_) {
    computeWork();
    if (!reference_.empty()) referenceEnergy_ -= workSinceReference();
    setReference();
  }
  if (vectorised_) {
    body_.evaluateInternal(false, *env_.parallelFor);
  } else {
    body_.computeElasticStresses(*env_.parallelFor);
    body_.computeInternalForces(*env_.parallelFor);
  }
  if (body_.patches().rows() > 0) body_.patches().updateForces(targets(), state.displacements);
  forces_.assign(body_.forces().begin(), body_.forces().end());
  if (body_.patches().rows() > 0) body_.patches().addForces(forces_);
  if (contact_) addContactForces(body_.rest().contact, body_.contact, penalty_, start_, state.displacements, forces_);
  if (foundationActs())
    foundation().addForces(state.displacements,
                           stage_.h > 0.0 ? std::span<const Vec3>(state.velocities) : std::span<const Vec3>(), forces_,
                           *env_.parallelFor);
  for (std::size_t i = 0; i < n_; ++i) {
    const double m = body_.masses()[i];
    Vec3 g = -forces_[i] - deadLoads_[i] - work_[i];
    if (stage_.h > 0.0)
      g += a_ * m * (state.displacements[i] - stage_.p[i] - stage_.h * stage_.q[i]) +
           damping_ * m * (state.displacements[i] - stage_.p[i]);
    else if (a_ > 0.0)
      g += a_ * m * (state.displacements[i] - start_[i]);
    out[i] = g;
  }
}

double StageProblem::reach(std::span<const Vec3> gradient) const {
  if (!(stage_.h > 0.0)) return std::numeric_limits<double>::infinity();
  double farthest = 0.0;
  for (std::size_t i = 0; i < n_; ++i) farthest = std::max(farthest, gradient[i].norm() / body_.masses()[i]);
  farthest /= a_ + damping_;
  // Displacements are rounded in the inertia and in the strains; the stiffest mode converts the latter into forces.
  double size = 0.0;
  for (const Vec3 &u : body_.state().displacements) size = std::max(size, u.squaredNorm());
  const double stiff = stage_.h * body_.restFrequency();
  const double rounding = kRoundOffs * std::numeric_limits<double>::epsilon() *
                          (std::sqrt(size) + stiff * stiff * (std::sqrt(size) + body_.rest().spacing));
  return farthest <= rounding ? 0.0 : farthest;
}

void StageProblem::product(std::span<const Vec3> du, std::span<Vec3> out) {
  const RestState &rest = body_.rest();
  if (vectorised_) {
    if (!linearised_) body_.linearise(*env_.parallelFor);
    linearised_ = true;
    body_.forceDifferential(du, viscousScale(), out, *env_.parallelFor);
  } else {
    forceDifferential(body_.constitution(), rest.stencils, rest.positions, body_.state().displacements,
                      body_.gradients(), history(), dt(), viscousScale(), du, scratch_, out, *env_.parallelFor);
  }
  for (std::size_t i = 0; i < n_; ++i) out[i] = (a_ + damping_) * body_.masses()[i] * du[i] - out[i];
  if (body_.patches().rows() > 0) body_.patches().addProduct(du, out);
  if (contact_) addContactProduct(rest.contact, body_.contact, penalty_, start_, body_.state().displacements, du, out);
  foundation().addProduct(1.0 + relativeRetardation(), du, out, *env_.parallelFor);
}

void StageProblem::diagonalBlocks(std::span<Mat3> out) {
  const RestState &rest = body_.rest();
  stiffnessBlocks(body_.constitution(), rest.stencils, rest.positions, body_.state().displacements, body_.gradients(),
                  history(), dt(), viscousScale(), out, *env_.parallelFor);
  for (std::size_t i = 0; i < n_; ++i) out[i].diagonal().array() += (a_ + damping_) * body_.masses()[i];
  if (body_.patches().rows() > 0) body_.patches().addDiagonal(out);
  addContactAndSurroundings(out);
}

void StageProblem::addContactAndSurroundings(std::span<Mat3> out) {
  if (contact_)
    addContactBlocks(body_.rest().contact, body_.contact, penalty_, start_, body_.state().displacements, out);
  foundation().addBlocks(1.0 + relativeRetardation(), out);
  for (std::size_t i = 0; i < coupling_.size(); ++i) out[i] += coupling_[i];
}

bool StageProblem::assemble(Eigen::SparseMatrix<double> &out) {
  const RestState &rest = body_.rest();
  triplets_.clear();
  stiffnessTriplets(body_.constitution(), rest.stencils, rest.positions, body_.state().displacements, body_.gradients(),
                    history(), dt(), viscousScale(), triplets_);
  for (std::size_t i = 0; i < n_; ++i)
    for (int c = 0; c < 3; ++c) {
      const int row = static_cast<int>(3 * i) + c;
      triplets_.emplace_back(row, row, (a_ + damping_) * body_.masses()[i]);
    }
  if (body_.patches().rows() > 0) body_.patches().addTriplets(triplets_);
  if (contact_)
    addContactTriplets(rest.contact, body_.contact, penalty_, start_, body_.state().displacements, triplets_);
  foundation().addTriplets(1.0 + relativeRetardation(), triplets_);
  out.resize(static_cast<Eigen::Index>(3 * n_), static_cast<Eigen::Index>(3 * n_));
  throwIfStopRequested(env_.stop);
  out.setFromTriplets(CancellableTriplets(triplets_.data(), env_.stop),
                      CancellableTriplets(triplets_.data() + triplets_.size(), env_.stop));
  return true;
}

bool StageProblem::assembleGrids(Multigrid &out, const StopRequest *stop) {
  const std::shared_ptr<const RestState> rest = body_.sharedRest();
  const PatchSolver &patches = body_.patches();
  if (!out.isOf(rest, patches.phyxels()))
    out.reset(
        buildGridHierarchy(rest->stencils, rest->positions, rest->pointCentres, rest->spacing, patches.phyxels(), stop),
        rest);
  if (!out.exists()) return false;
  std::vector<Mat3> gradients(rest->pointCount());
  deformationGradients(rest->stencils, body_.state().displacements, gradients, *env_.parallelFor);
  findStiffnessFactors(body_.constitution(), rest->stencils, gradients, viscousScale(), factors_, *env_.parallelFor);
  if (const StencilSet *trilinear = out.trilinear())
    findStiffnessFactors(body_.constitution(), *trilinear, gradients, viscousScale(), trilinearFactors_,
                         *env_.parallelFor);
  std::vector<Mat3> blocks(n_);
  for (std::size_t i = 0; i < n_; ++i) blocks[i] = (a_ + damping_) * body_.masses()[i] * Mat3::Identity();
  addContactAndSurroundings(blocks);
  out.assemble(factors_, out.trilinear() != nullptr ? &trilinearFactors_ : nullptr, blocks,
               {patches.phyxels(), patches.weights(), patches.stiffness()}, prescribed(), *env_.parallelFor, stop);
  return true;
}

std::span<const Vec3> StageProblem::displacementOfStage() {
  displacementOfStage_.resize(n_);
  for (std::size_t i = 0; i < n_; ++i) displacementOfStage_[i] = body_.state().displacements[i] - stage_.p[i];
  return displacementOfStage_;
}

void StageProblem::computeWork() {
  if (workCurrent_) return;
  workCurrent_ = true;
  std::fill(work_.begin(), work_.end(), Vec3::Zero());
  const BoundaryConditions &conditions = body_.rest().conditions;
  for (std::size_t l = 0; l < conditions.loads.size(); ++l)
    if (conditions.loads[l].pressure != 0.0 && conditions.loads[l].follower)
      addLoadForces(conditions.loads[l], conditions.loaded[l], body_.factor(conditions.loads[l].ramp, stage_.end),
                    body_.state().displacements, work_);
  if (!dissipative_) return;
  const ParallelFor &parallelFor = *env_.parallelFor;
  const auto forcesWith = [&](bool history) {
    if (vectorised_) return body_.evaluateInternal(history, parallelFor);
    if (history) {
      body_.computeTrialStresses(stage_.elapsed, parallelFor);
    } else {
      body_.computeElasticStresses(parallelFor);
    }
    body_.computeInternalForces(parallelFor);
  };
  forcesWith(false);
  for (std::size_t i = 0; i < n_; ++i) work_[i] -= body_.forces()[i];
  forcesWith(true);
  for (std::size_t i = 0; i < n_; ++i) work_[i] += body_.forces()[i];
}

void StageProblem::setReference() {
  reference_ = body_.state().displacements;
  referenceWork_ = work_;
}

double StageProblem::workSinceReference() const {
  double work = 0.0;
  for (std::size_t i = 0; i < n_; ++i)
    work += 0.5 * (work_[i] + referenceWork_[i]).dot(body_.state().displacements[i] - reference_[i]);
  return work;
}

}  // namespace pointbased::detail
