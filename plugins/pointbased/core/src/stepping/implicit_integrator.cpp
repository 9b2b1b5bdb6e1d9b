// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "pointbased/integrators.h"

namespace pointbased {
namespace {

// Stiffness of contact in units of E A / d: a body of height H presses itself in by rho g H / (kContactStiffness E /
// d).
constexpr double kContactStiffness = 30.0;
constexpr double kContactMargin = 0.02;  // spacings
constexpr int kContactRounds = 4;        // solutions of a stage until no point meets a surface that was not known
constexpr double kRough = 100.0;         // tolerances within which a solution already tells what the contacts are
// change of the contact forces that is left to the next stage, of all that presses
constexpr double kSettled = 1e-2;
constexpr int kFlowRounds = 30;      // of a static equilibrium with plastic flow
constexpr int kHoldingRounds = 200;  // of a static equilibrium of what only contact holds
constexpr double kStride = 0.5;      // spacings that it may move in one of them
constexpr double kHoldMore = 8.0;    // times the inertia after one that went too far or was not solved
constexpr double kLeaning = 1e-3;    // part of the loads that may still lean on inertia

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

double largestModulus(const Constitution &constitution) {
  double modulus = 0.0;
  for (const Material &m : constitution.materials) modulus = std::max(modulus, m.youngsModulus);
  return modulus;
}

// One stage: base position and velocity, the length h, and the end time at which loads and supports count.
struct ImplicitStage {
  double h = 0.0;            // s; 0: static
  double end = 0.0;          // s, or load factor
  double contactSpan = 0.0;  // s (or load factor) over which contact planes move
  std::vector<Vec3> p, q;
  double holding = 0.0;  // 1/s²: static, of the inertia that holds what nothing else does
  double elapsed = 0.0;  // s since the beginning of the step: what relaxes has relaxed for so long
};

// Over triplets, of which a large body has millions; looks whether they are still wanted.
class AskedTriplets {
 public:
  AskedTriplets(const Eigen::Triplet<double> *at, const StopRequest *stop) : at_(at), stop_(stop) {}
  AskedTriplets &operator++() {
    constexpr std::size_t kLookEvery = 1 << 22;
    if (++seen_ % kLookEvery == 0) endIfRaised(stop_);
    ++at_;
    return *this;
  }
  const Eigen::Triplet<double> *operator->() const { return at_; }
  bool operator!=(const AskedTriplets &other) const { return at_ != other.at_; }

 private:
  const Eigen::Triplet<double> *at_;
  const StopRequest *stop_;
  std::size_t seen_ = 0;
};

class StageProblem final : public IncrementalPotential {
 public:
  StageProblem(Body &body, const Environment &env, const ImplicitStage &stage)
      : body_(body), env_(env), stage_(stage), n_(body.rest().phyxelCount()) {
    a_ = stage.h > 0.0 ? 1.0 / (stage.h * stage.h) : stage.holding;
    damping_ = stage.h > 0.0 ? env.damping / stage.h : 0.0;
    const BoundaryConditions &conditions = body.rest().conditions;
    dead_.assign(n_, Vec3::Zero());
    for (std::size_t l = 0; l < conditions.loads.size(); ++l) {
      const Load &load = conditions.loads[l];
      if (load.pressure != 0.0 && load.follower)
        followers_ = true;
      else
        addLoadForces(load, conditions.loaded[l], body.factor(load.ramp, stage.end), body.state().displacements, dead_);
    }
    for (std::size_t i = 0; i < n_; ++i) dead_[i] += body.weights()[i] * env.gravity;
    if (body.grab && stage.h > 0.0) {
      // The hand's spring is taken at the beginning of the stage, soft enough not to be thrown by its own delay.
      std::fill(body.forces().begin(), body.forces().end(), Vec3::Zero());
      applyGrab(body, 0.3 / stage.h);
      for (std::size_t i = 0; i < n_; ++i) dead_[i] += body.forces()[i];
      body.forcesCurrent = false;
    }
    const Constitution &c = body.constitution();
    dissipative_ = stage.h > 0.0 && (c.viscous() || c.relaxing());
    vectorised_ = body.vectorisedTangent();
    work_.assign(n_, Vec3::Zero());
    contact_ = env.contact() && body.rest().contact.count() > 0;
    penalty_ = {kContactStiffness * largestModulus(c), body.rest().spacing, stage.contactSpan};
    start_ = body.state().displacements;
    double volume = 0.0, modulus = 0.0;
    for (const double v : body.rest().volumes) volume += v;
    for (const Material &m : c.materials) modulus = std::max(modulus, m.waveModulus());
    roundOff_ = std::numeric_limits<double>::epsilon() * modulus * volume;
    (void)body.patchTargets(stage.end);
  }

  [[nodiscard]] ContactPenalty &penalty() { return penalty_; }
  [[nodiscard]] std::span<const Vec3> start() const { return start_; }

  [[nodiscard]] std::size_t phyxels() const override { return n_; }
  [[nodiscard]] std::span<const std::uint8_t> prescribed() const override { return body_.heldMask(); }

  [[nodiscard]] bool setState(std::span<const Vec3> u) override {
    State &state = body_.state();
    double sum = 0.0;
    for (std::size_t i = 0; i < n_; ++i) {
      state.displacements[i] = u[i];
      if (stage_.h > 0.0) state.velocities[i] = (u[i] - stage_.p[i]) / stage_.h;
      sum += u[i].squaredNorm();
    }
    if (!std::isfinite(sum)) return false;
    if (vectorised_) {
      body_.forgetPoints();
    } else {
      body_.computeGradients(*env_.parallelFor);
    }
    workCurrent_ = linearised_ = false;
    return true;
  }

  [[nodiscard]] double energy() override {
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
      sum -= dead_[i].dot(u);
    }
    const ElasticEnergy elastic = body_.elasticEnergy(*env_.parallelFor);
    sum += elastic.strain + elastic.stabilisation;
    if (body_.patches().rows() > 0) sum += body_.patches().energy(targets(), state.displacements);
    if (contact_) sum += contactEnergy(body_.rest().contact, body_.contact, penalty_, start_, state.displacements);
    if (around()) {
      // Damping, with the velocity of the end of the stage, has a potential of the way within it.
      sum += foundation().energy(state.displacements);
      if (lag() > 0.0) sum += lag() * foundation().energy(way());
    }
    if (followers_ || dissipative_) {
      computeWork();
      if (reference_.empty()) setReference();
      sum += referenceEnergy_ - workSinceReference();
    }
    return sum;
  }

  // Laws tell the energy by terms of the size of their moduli, however small the strain.
  [[nodiscard]] double roundOff() const override { return roundOff_; }

  void gradient(std::span<Vec3> out) override {
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
    if (around())
      foundation().addForces(state.displacements,
                             stage_.h > 0.0 ? std::span<const Vec3>(state.velocities) : std::span<const Vec3>(),
                             forces_, *env_.parallelFor);
    for (std::size_t i = 0; i < n_; ++i) {
      const double m = body_.masses()[i];
      Vec3 g = -forces_[i] - dead_[i] - work_[i];
      if (stage_.h > 0.0)
        g += a_ * m * (state.displacements[i] - stage_.p[i] - stage_.h * stage_.q[i]) +
             damping_ * m * (state.displacements[i] - stage_.p[i]);
      else if (a_ > 0.0)
        g += a_ * m * (state.displacements[i] - start_[i]);
      out[i] = g;
    }
  }

  // The Hessian is at least that of inertia where nothing is crushed.
  [[nodiscard]] double reach(std::span<const Vec3> gradient) const override {
    if (!(stage_.h > 0.0)) return std::numeric_limits<double>::infinity();
    double farthest = 0.0;
    for (std::size_t i = 0; i < n_; ++i) farthest = std::max(farthest, gradient[i].norm() / body_.masses()[i]);
    return farthest / (a_ + damping_);
  }

  void product(std::span<const Vec3> du, std::span<Vec3> out) override {
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
    if (contact_)
      addContactProduct(rest.contact, body_.contact, penalty_, start_, body_.state().displacements, du, out);
    foundation().addProduct(1.0 + lag(), du, out, *env_.parallelFor);
  }

  void diagonalBlocks(std::span<Mat3> out) override {
    const RestState &rest = body_.rest();
    stiffnessBlocks(body_.constitution(), rest.stencils, rest.positions, body_.state().displacements, body_.gradients(),
                    history(), dt(), viscousScale(), out, *env_.parallelFor);
    for (std::size_t i = 0; i < n_; ++i) out[i].diagonal().array() += (a_ + damping_) * body_.masses()[i];
    if (body_.patches().rows() > 0) body_.patches().addDiagonal(out);
    if (contact_) addContactBlocks(rest.contact, body_.contact, penalty_, start_, body_.state().displacements, out);
    foundation().addBlocks(1.0 + lag(), out);
  }

  [[nodiscard]] bool assemble(Eigen::SparseMatrix<double> &out) override {
    const RestState &rest = body_.rest();
    triplets_.clear();
    stiffnessTriplets(body_.constitution(), rest.stencils, rest.positions, body_.state().displacements,
                      body_.gradients(), history(), dt(), viscousScale(), triplets_);
    for (std::size_t i = 0; i < n_; ++i)
      for (int c = 0; c < 3; ++c) {
        const int row = static_cast<int>(3 * i) + c;
        triplets_.emplace_back(row, row, (a_ + damping_) * body_.masses()[i]);
      }
    if (body_.patches().rows() > 0) body_.patches().addTriplets(triplets_);
    if (contact_)
      addContactTriplets(rest.contact, body_.contact, penalty_, start_, body_.state().displacements, triplets_);
    foundation().addTriplets(1.0 + lag(), triplets_);
    out.resize(static_cast<Eigen::Index>(3 * n_), static_cast<Eigen::Index>(3 * n_));
    endIfRaised(env_.stop);
    out.setFromTriplets(AskedTriplets(triplets_.data(), env_.stop),
                        AskedTriplets(triplets_.data() + triplets_.size(), env_.stop));
    return true;
  }

 private:
  [[nodiscard]] std::span<const Vec3> targets() { return body_.patchTargets(stage_.end); }
  [[nodiscard]] const ElasticFoundation &foundation() const { return body_.foundation(); }
  [[nodiscard]] bool around() const { return foundation().acts(); }
  // Of the foundation's damping to its stiffness, in the Hessian.
  [[nodiscard]] double lag() const { return stage_.h > 0.0 ? foundation().settings().retardationTime / stage_.h : 0.0; }
  [[nodiscard]] std::span<const Vec3> way() {
    way_.resize(n_);
    for (std::size_t i = 0; i < n_; ++i) way_[i] = body_.state().displacements[i] - stage_.p[i];
    return way_;
  }
  [[nodiscard]] double dt() const { return dissipative_ ? stage_.elapsed : 0.0; }
  [[nodiscard]] double viscousScale() const { return dissipative_ ? 1.0 / stage_.h : 0.0; }
  // At the beginning of the step: what relaxes is advanced from there by dt().
  [[nodiscard]] const PointHistory &history() const { return body_.state().history; }

  // Forces that have no potential, at the present displacements: followers; viscous and relaxing stresses as the
  // difference to the elastic ones.
  void computeWork() {
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

  // All energies of a solution are told from its first state on: another origin for one of them alone would be a step
  // in the merit as large as the work itself.
  void setReference() {
    reference_ = body_.state().displacements;
    referenceWork_ = work_;
  }
  [[nodiscard]] double workSinceReference() const {
    double work = 0.0;
    for (std::size_t i = 0; i < n_; ++i)
      work += 0.5 * (work_[i] + referenceWork_[i]).dot(body_.state().displacements[i] - reference_[i]);
    return work;
  }

  Body &body_;
  const Environment &env_;
  const ImplicitStage &stage_;
  std::size_t n_;
  double a_ = 0.0, damping_ = 0.0;
  bool followers_ = false, dissipative_ = false, contact_ = false, workCurrent_ = false;
  bool vectorised_ = false, linearised_ = false;
  std::vector<Vec3> dead_, work_, start_, forces_, way_;
  std::vector<Vec3> reference_, referenceWork_;
  double referenceEnergy_ = 0.0, roundOff_ = 0.0;
  ContactPenalty penalty_;
  TangentScratch scratch_;
  std::vector<Eigen::Triplet<double>> triplets_;
};

NewtonSettings settingsOf(const Body &body, const Environment &env, bool isStatic) {
  NewtonSettings settings;
  settings.toleranceDisplacement = env.tolerance > 0.0 ? env.tolerance : (isStatic ? 1e-6 : 1e-5) * body.rest().spacing;
  settings.preconditioner = env.preconditioner;
  settings.stop = env.stop;
  settings.maxIterations = isStatic ? 60 : 30;
  return settings;
}

std::string explain(const NewtonResult &result) {
  switch (result.outcome) {
    case NewtonOutcome::converged: return {};
    case NewtonOutcome::cancelled: return "cancelled";
    default: break;
  }
  const char *what = result.outcome == NewtonOutcome::iterationLimit ? "the equilibrium was not found in time"
                     : result.outcome == NewtonOutcome::notFinite    ? "a quantity is not finite"
                                                                     : "the energy could not be lowered further";
  return std::string(what) + " (residual " + number(result.residual) + " N after " + std::to_string(result.iterations) +
         " iterations, last correction " + number(1000.0 * result.lastStep) + " mm)";
}

void addWork(const NewtonResult &solved, NewtonResult &sum) {
  const int iterations = sum.iterations, linear = sum.linearIterations, factorisations = sum.factorisations;
  sum = solved;
  sum.iterations += iterations;
  sum.linearIterations += linear;
  sum.factorisations += factorisations;
}

// Points that press on something, ascending.
std::vector<Index> touching(const ContactState &contact) {
  std::vector<Index> points;
  for (const Contact &c : contact.active)
    if (c.normalForce > 0.0 && (points.empty() || points.back() != c.point)) points.push_back(c.point);
  return points;
}

// Where a solution of the stage begins: of the free way and of what else is offered the state of lowest energy. A free
// way that goes deep into an obstacle is a bad beginning.
std::vector<Vec3> beginningOf(StageProblem &problem, const std::vector<std::vector<Vec3>> &offers) {
  std::size_t best = 0;
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < offers.size() && offers.size() > 1; ++k) {
    const double energy = problem.setState(offers[k]) ? problem.energy() : std::numeric_limits<double>::infinity();
    if (!(energy < lowest)) continue;
    lowest = energy;
    best = k;
  }
  return offers[best];
}

// Where a stage would end if nothing but inertia, gravity and damping were there: of a body that falls the solution.
void fallFreely(const Body &body, const Environment &env, const ImplicitStage &stage, std::span<Vec3> u) {
  const bool falls = !body.held() && touching(body.contact).empty();
  const Vec3 gained = falls ? Vec3(stage.h * stage.h * env.gravity) : Vec3(Vec3::Zero());
  const double slower = falls ? 1.0 / (1.0 + env.damping * stage.h) : 1.0;
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = stage.p[i] + slower * (stage.h * stage.q[i] + gained);
}

// Solves a stage with its contacts; body.state() is the end of it. `from` is the time at which the planes are looked
// for. `goesOn`: asked when the contacts are about known; false: the stage is given up unfinished.
NewtonResult solveStage(Body &body, NewtonSolver &solver, const Environment &env, const ImplicitStage &stage,
                        double from, const std::function<bool()> &shouldContinue, std::span<const Vec3> offer = {},
                        const std::function<bool()> &goesOn = {}) {
  const bool contact = env.contact() && body.rest().contact.count() > 0;
  const ParallelFor &parallelFor = *env.parallelFor;
  StageProblem problem(body, env, stage);
  const NewtonSettings settings = settingsOf(body, env, stage.h <= 0.0);
  const std::vector<Vec3> start = body.state().displacements;
  std::vector<Vec3> u = start;
  if (stage.h > 0.0) fallFreely(body, env, stage, u);
  // Held phyxels and whatever they carry start where they have to be.
  body.placeHeld(stage.end, false);
  const std::vector<Vec3> placed = body.state().displacements;
  const auto hold = [&](std::vector<Vec3> &at) {
    for (std::size_t i = 0; i < at.size(); ++i)
      if (!body.heldMask().empty() && body.heldMask()[i]) at[i] = placed[i];
  };
  hold(u);

  const auto lookAlongTheWay = [&] {
    body.state().displacements = start;
    for (std::size_t i = 0; i < u.size(); ++i)
      body.state().velocities[i] =
          stage.contactSpan > 0.0 ? Vec3((u[i] - start[i]) / stage.contactSpan) : Vec3(Vec3::Zero());
    findContacts(env.obstacles, env.box, from, stage.contactSpan, kContactMargin * body.rest().spacing,
                 body.contactPositions(parallelFor), body.contactVelocities(parallelFor), body.rest().contact.radii,
                 body.contact, parallelFor);
  };
  NewtonResult result;
  const auto solve = [&](const std::function<bool(const NewtonResult &)> &watch) {
    env.clock->measure(kSolve, [&] { addWork(solver.solve(problem, u, settings, watch), result); });
    return result.good();
  };
  const auto wanted = [&](const NewtonResult &) { return !shouldContinue || shouldContinue(); };
  if (!contact) {
    (void)solve(wanted);
    (void)problem.setState(u);
    return result;
  }

  const std::vector<Vec3> freeWay = u;
  lookAlongTheWay();
  if (stage.h > 0.0 && !body.contact.active.empty()) {
    std::vector<std::vector<Vec3>> offers{u, start};
    if (!offer.empty()) offers.emplace_back(offer.begin(), offer.end());
    for (std::vector<Vec3> &at : offers) hold(at);
    u = beginningOf(problem, offers);
  }
  const ContactPoints &points = body.rest().contact;
  ContactState &memory = body.contact;
  std::vector<Contact> kept;
  ContactForces forces;
  const auto change = [&] { return forces.changeTo(points, problem.penalty(), start, u, memory); };
  std::vector<Vec3> solution;  // the last one
  bool plain = false;
  for (int round = 0; round < kContactRounds; ++round) {
    // Half way it is looked whether friction of what presses now is another, or the stage is not to go on: then it is
    // not worth to go on to the end.
    bool asked = plain || round > 0, enough = false;
    const auto look = [&](const NewtonResult &r) {
      if (!wanted(r)) return false;
      if (asked || r.iterations == 0 || r.lastStep > kRough * settings.toleranceDisplacement) return true;
      asked = true;
      kept = memory.active;
      forces.tell(points, problem.penalty(), start, u, memory);
      updateNormalForces(points, problem.penalty(), start, u, memory);
      enough = (goesOn && !goesOn()) || change() > kSettled;
      if (!enough) memory.active.swap(kept);
      return !enough;
    };
    const std::size_t before = memory.active.size();
    if (!solve(look) && !enough) {
      if (result.outcome == NewtonOutcome::cancelled || result.outcome == NewtonOutcome::notFinite) break;
      if (!solution.empty()) {
        // Friction stays that of the solution before.
        u = solution;
        result.outcome = NewtonOutcome::converged;
        break;
      }
      if (plain || stage.h <= 0.0) break;
      // Once more from the free way, to the end.
      plain = true;
      u = freeWay;
      round = -1;
      continue;
    }
    if (!enough) solution = u;
    result.outcome = NewtonOutcome::converged;
    // Told anew, with the planes that the solution meets and friction of its normal forces, the forces of contact are
    // those it was found with, or it is solved again with what they are now.
    if (!enough) forces.tell(points, problem.penalty(), start, u, memory);
    updateNormalForces(points, problem.penalty(), start, u, memory);
    lookAlongTheWay();
    updateNormalForces(points, problem.penalty(), start, u, memory);
    if (goesOn && !goesOn()) {
      // Whoever solves it in another way may begin where this one has got to.
      (void)problem.setState(u);
      return result;
    }
    if (enough) continue;
    if (change() <= kSettled || (round > 0 && memory.active.size() == before)) break;
  }
  (void)problem.setState(u);
  if (result.good()) finishContactStage(body.rest().contact, problem.penalty(), start, u, body.contact);
  return result;
}

// Whether a point passes a surface on the straight way from `start` to the present state.
bool meets(Body &body, const Environment &env, std::span<const Vec3> start, double time, double dt) {
  State &state = body.state();
  const std::vector<Vec3> u = state.displacements, v = state.velocities;
  for (std::size_t i = 0; i < u.size(); ++i) {
    state.velocities[i] = (u[i] - start[i]) / dt;
    state.displacements[i] = start[i];
  }
  const std::span<const Vec3> ways = body.contactVelocities(*env.parallelFor);
  findContacts(env.obstacles, env.box, time, dt, kContactMargin * body.rest().spacing,
               body.contactPositions(*env.parallelFor), ways, body.rest().contact.radii, body.contact,
               *env.parallelFor);
  state.displacements = u;
  state.velocities = v;
  return std::any_of(body.contact.active.begin(), body.contact.active.end(), [&](const Contact &c) {
    return c.gap + dt * (ways[c.point] - c.surfaceVelocity).dot(c.normal) < 0.0;
  });
}

}  // namespace

ImplicitResult implicitStep(Body &body, NewtonSolver &solver, const Environment &env, double time, double dt,
                            Integrator scheme) {
  State &state = body.state();
  const std::size_t n = state.displacements.size();
  const std::vector<Vec3> u0 = state.displacements, v0 = state.velocities;
  const ParallelFor &parallelFor = *env.parallelFor;
  ImplicitResult out;
  ImplicitStage stage;
  const auto run = [&](double from, const std::function<bool()> &goesOn = {}) {
    return solveStage(body, solver, env, stage, from, {}, {}, goesOn);
  };
  // Both second-order schemes continue the forces of a first stage beyond it. Those of an impact do not go on, and
  // would throw the body back with more than its energy: such steps are backward Euler, an inelastic impact.
  const std::vector<Index> touchedBefore = touching(body.contact);
  const std::vector<Contact> contactsBefore = body.contact.active;
  bool impact = false;
  const auto backwardEuler = [&] {
    const std::vector<Vec3> reached = state.displacements;
    state.displacements = u0;
    state.velocities = v0;
    body.contact.active = contactsBefore;
    stage = {dt, time + dt, dt, u0, v0, 0.0, dt};
    const int first = out.newton.iterations, firstLinear = out.newton.linearIterations;
    out.newton = solveStage(body, solver, env, stage, time, {}, reached);
    out.newton.iterations += first;
    out.newton.linearIterations += firstLinear;
  };
  switch (scheme) {
    case Integrator::implicitMidpoint: {
      stage = {0.5 * dt, time + 0.5 * dt, 0.5 * dt, u0, v0, 0.0, 0.5 * dt};
      out.newton = run(time, [&] { return !(impact = !touching(body.contact).empty()); });
      if (out.newton.good() && impact) {
        backwardEuler();
        break;
      }
      for (std::size_t i = 0; i < n; ++i) {
        const Vec3 middle = state.displacements[i];
        state.displacements[i] = 2.0 * middle - u0[i];
        state.velocities[i] = 2.0 * (state.displacements[i] - u0[i]) / dt - v0[i];
      }
      // What the second half meets, the middle has not seen.
      if (out.newton.good() && env.contact() && body.rest().contact.count() > 0 && meets(body, env, u0, time, dt))
        backwardEuler();
      break;
    }
    case Integrator::implicitSdirk: {
      const double gamma = 1.0 - std::sqrt(0.5);
      stage = {gamma * dt, time + gamma * dt, gamma * dt, u0, v0, 0.0, gamma * dt};
      out.newton = run(time, [&] {
        const std::vector<Index> touched = touching(body.contact);
        const bool leadsOut = std::any_of(body.contact.active.begin(), body.contact.active.end(),
                                          [](const Contact &c) { return c.initialPenetration > 0.0; });
        impact = leadsOut || !std::includes(touchedBefore.begin(), touchedBefore.end(), touched.begin(), touched.end());
        return !impact;
      });
      if (!out.newton.good()) break;
      if (impact) {
        backwardEuler();
        break;
      }
      for (std::size_t i = 0; i < n; ++i) {
        const Vec3 k = state.velocities[i], l = (state.velocities[i] - v0[i]) / (gamma * dt);
        stage.p[i] = u0[i] + (1.0 - gamma) * dt * k;
        stage.q[i] = v0[i] + (1.0 - gamma) * dt * l;
      }
      stage.end = time + dt;
      stage.elapsed = dt;
      stage.contactSpan = (1.0 - gamma) * dt;
      const int first = out.newton.iterations, firstLinear = out.newton.linearIterations;
      out.newton = run(time + gamma * dt);
      out.newton.iterations += first;
      out.newton.linearIterations += firstLinear;
      break;
    }
    default:
      stage = {dt, time + dt, dt, u0, v0, 0.0, dt};
      out.newton = run(time);
      break;
  }
  if (out.failure = explain(out.newton); !out.failure.empty()) return out;

  body.placeHeld(time + dt, true);
  if (body.vectorised()) {
    env.clock->measure(kForces, [&] { body.evaluate(time + dt, dt, parallelFor); });
    body.forcesCurrent = true;
    return out;
  }
  env.clock->measure(kGradients, [&] { body.computeGradients(parallelFor); });
  if (!state.history.plasticInverse.empty()) env.clock->measure(kFlow, [&] { body.computeFlow(dt, parallelFor); });
  env.clock->measure(kStresses, [&] { body.computeStresses(dt, parallelFor); });
  env.clock->measure(kForces, [&] { body.computeForces(time + dt, parallelFor); });
  body.forcesCurrent = true;
  return out;
}

namespace {

// Σ of what pulls at phyxels at load factor `at`, N.
double loadsOf(Body &body, const Environment &env, double at) {
  std::vector<Vec3> forces(body.rest().phyxelCount());
  for (std::size_t i = 0; i < forces.size(); ++i) forces[i] = body.weights()[i] * env.gravity;
  const BoundaryConditions &conditions = body.rest().conditions;
  for (std::size_t l = 0; l < conditions.loads.size(); ++l)
    addLoadForces(conditions.loads[l], conditions.loaded[l], body.factor(conditions.loads[l].ramp, at),
                  body.state().displacements, forces);
  double sum = 0.0;
  for (const Vec3 &f : forces) sum += f.norm();
  return sum;
}

}  // namespace

ImplicitResult quasiStaticStep(Body &body, NewtonSolver &solver, const Environment &env, double from, double to,
                               const std::function<bool()> &shouldContinue) {
  State &state = body.state();
  const ParallelFor &parallelFor = *env.parallelFor;
  const double tolerance = settingsOf(body, env, true).toleranceDisplacement;
  ImplicitResult out;
  const bool held = body.held() || body.foundation().settings().holds();
  // Held bodies are solved as they are; the others lean on their own inertia, less and less, until they lie still.
  double holding = 0.0;
  if (!held) {
    const double frequency = body.restFrequency();
    // What has no stiffness at all (a phyxel alone) is let down by a spacing at a time.
    holding = frequency > 0.0 ? 1e-4 * frequency * frequency : env.gravity.norm() / body.rest().spacing;
  }
  const double stride = kStride * body.rest().spacing;
  const double loads = held ? 0.0 : loadsOf(body, env, to);
  int flows = 0;
  for (int round = 0;; ++round) {
    const ImplicitStage stage{0.0, to, to - from, {}, {}, holding, 0.0};
    const std::vector<Vec3> before = state.displacements;
    const std::vector<Contact> contactsBefore = body.contact.active;
    out.newton = solveStage(body, solver, env, stage, from, shouldContinue);
    double moved = 0.0, leaning = 0.0;  // m, N
    for (std::size_t i = 0; i < before.size(); ++i) {
      const double way = (state.displacements[i] - before[i]).norm();
      moved = std::max(moved, way);
      leaning += body.masses()[i] * holding * way;
    }
    const bool last = round + 1 >= kHoldingRounds;
    if (holding > 0.0 && !last && out.newton.outcome != NewtonOutcome::cancelled &&
        (!out.newton.good() || !(moved <= stride))) {
      // Too far at once: contacts are known along a way of a spacing or so.
      state.displacements = before;
      body.contact.active = contactsBefore;
      holding *= kHoldMore;
      continue;
    }
    if (out.failure = explain(out.newton); !out.failure.empty()) return out;
    bool flowed = false;
    if (!state.history.plasticInverse.empty()) {
      if (flows++ >= kFlowRounds) {
        out.failure = "plastic flow has not come to rest at load factor " + number(to) +
                      "; the load is more than the body carries";
        return out;
      }
      // Without time all flow that is due takes place.
      flowed = body.computeFlow(1e6, parallelFor) > 0;
    }
    if (!flowed && (holding == 0.0 || (moved < tolerance && leaning <= kLeaning * loads))) break;
    if (last) {
      out.failure = "nothing holds it against its loads at load factor " + number(to) + " (it still moves " +
                    number(1000.0 * moved) + " mm); add a [[fix]] or an obstacle below it";
      return out;
    }
    if (moved < 0.5 * stride) holding *= moved < 0.01 * stride ? 0.125 : 0.5;
  }
  std::fill(state.velocities.begin(), state.velocities.end(), Vec3::Zero());
  env.clock->measure(kGradients, [&] { body.computeGradients(parallelFor); });
  env.clock->measure(kStresses, [&] { body.computeStresses(0.0, parallelFor); });
  env.clock->measure(kForces, [&] { body.computeForces(to, parallelFor); });
  body.forcesCurrent = true;
  return out;
}

}  // namespace pointbased
