// SPDX-License-Identifier: Apache-2.0
#include "analysis/fine_reference_solution.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "analysis/fine_reference_forces.h"
#include "base/rigid_fit.h"
#include "body/history_transfer.h"
#include "stepping/implicit/stage_solution.h"

namespace pointbased::detail {
namespace {

constexpr int kMaxHalvings = 2;             // of the path from the state of the body to equilibrium
constexpr int kMaxRounds = 25;              // of an unsupported body
constexpr double kHolding = 1e-7;           // of its largest squared frequency: inertia that stabilises an unsupported
                                            // body
constexpr double kAgainstTurns = 2.0;       // times the least inertia that prevents it from turning over
constexpr double kContactStiffness = 10.0;  // Young's moduli per spacing of the fine reference, Pa/m
constexpr double kSettled = 0.01;           // part of the path that a round may still change: errors need no more
                                            // digits
constexpr double kRoundLeft = 0.7, kRoundLeaves = 0.85;  // remaining progress at first, and its factor per round
constexpr int kUsualLoadSteps = 10;

tl::unexpected<std::string> refused(const std::string &text) { return tl::unexpected<std::string>(text); }

// Whether fixing these points prevents rotation of the body: they are not collinear.
bool holdsAgainstTurns(std::span<const Vec3> points, double spacing) {
  if (points.size() < 3) return false;
  Vec3 centre = Vec3::Zero();
  for (const Vec3 &x : points) centre += x / static_cast<double>(points.size());
  Mat3 variance = Mat3::Zero();
  for (const Vec3 &x : points) variance += (x - centre) * (x - centre).transpose() / static_cast<double>(points.size());
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(variance, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues()[1] > 0.04 * spacing * spacing;
}

std::vector<Vec3> placesOf(const Body &fineReference, std::span<const Vec3> u) {
  std::vector<Vec3> out(fineReference.rest().positions);
  for (std::size_t j = 0; j < out.size(); ++j) out[j] += u[j];
  return out;
}

// Solves a fine reference from the state of its body.
class DirectSolver {
 public:
  DirectSolver(const FineReferenceProblem &problem, Body &fineReference)
      : problem_(problem), fineReference_(fineReference), clock_(problem.target.clock),
        isHeld_(fineReference.held() || fineReference.foundation().settings().holds()), stages_(stageNames()) {
    env_.gravity = problem.target.world.gravity;
    env_.tolerance = problem.target.world.tolerance;
    env_.preconditioner = problem.target.world.preconditioner;
    env_.parallelFor = &problem.parallelFor;
    env_.clock = &stages_;
    env_.stop = problem.stop;
  }

  [[nodiscard]] Result<void> solve(std::span<const Vec3> leftOver) {
    begin(leftOver);
    // First in one step. If that fails, along a path on which the initial out-of-balance forces fade.
    double at = 0.0, size = 1.0;
    int halvings = 0;
    std::vector<Vec3> good = fineReference_.state().displacements;
    while (at < 1.0) {
      const double next = std::min(1.0, at + size);
      std::vector<Vec3> forces = given_;
      for (std::size_t j = 0; j < forces.size(); ++j) forces[j] = share_ * (given_[j] - (1.0 - next) * start_[j]);
      fineReference_.swapExternalForces(forces);
      const std::string failure = isHeld_ ? solveHeld() : solveFree();
      if (failure == "cancelled") return refused(failure);
      if (failure.empty()) {
        at = next;
        good = fineReference_.state().displacements;
        continue;
      }
      if (!problem_.isLast || !isHeld_ || ++halvings > kMaxHalvings)
        return refused("its fine reference has no equilibrium near the present state: " + failure);
      size *= 0.5;
      fineReference_.state().displacements = good;
      solver_.forget();
    }
    return {};
  }

  [[nodiscard]] bool isHeldByContact() const { return leansOnContact_; }

 private:
  void begin(std::span<const Vec3> leftOver) {
    const Body &body = problem_.body;
    std::vector<Vec3> at(fineReference_.rest().positions);
    for (Vec3 &x : at) x += fineReference_.rest().origin - body.rest().origin;
    interpolateDisplacements(body.rest().bind(at, {}), body.rest().positions, body.state().displacements,
                             fineReference_.state().displacements, problem_.parallelFor);
    transferPlasticStrain(body, fineReference_.state(), fineReference_.rest());
    fineReference_.placeHeld(clock_, false);
    if (!isHeld_) holdByContact();
    given_ = carriedOver(body, leftOver, !leansOnContact_, fineReference_, problem_.parallelFor);
    if (leansOnContact_) {
      std::vector<Vec3> pull(given_.size(), Vec3::Zero());
      fineReference_.foundation().addForces(fineReference_.state().displacements, {}, pull, problem_.parallelFor);
      for (std::size_t j = 0; j < pull.size(); ++j) given_[j] -= pull[j];
    }
    start_ = knownForces(fineReference_, env_.gravity, clock_, problem_.parallelFor);
    if (!isHeld_) balance(fineReference_, start_, given_);
    for (std::size_t j = 0; j < start_.size(); ++j) start_[j] += given_[j];
    const double share = fineReference_.factor(0.0, clock_);
    share_ = share > 0.0 ? 1.0 / share : 0.0;
  }

  // With contact forces prescribed, a body at rest on something could sink into it, slide and tip over. It is therefore
  // held where it is in contact, by springs that are unloaded in the state of the body.
  void holdByContact() {
    if (fineReference_.foundation().settings().acts()) return;
    SurfacePoints points = touchingPoints(problem_.body, fineReference_.rest());
    if (!holdsAgainstTurns(points.positions, problem_.body.rest().spacing)) return;
    double stiffest = 0.0;
    for (const Material &material : fineReference_.constitution().materials)
      stiffest = std::max(stiffest, material.youngsModulus);
    const double k = kContactStiffness * stiffest / fineReference_.rest().spacing;
    Interpolation binding = fineReference_.rest().bind(points.positions, points.normals);
    ElasticFoundation &springs = fineReference_.foundation();
    springs.set({k, k, 0.0});
    springs.bind(std::move(points), std::move(binding), fineReference_.rest().phyxelCount());
    isHeld_ = leansOnContact_ = true;
  }

  [[nodiscard]] std::string stage(double holding) {
    const ImplicitStage stage{0.0, clock_, 0.0, {}, {}, holding, 0.0};
    const auto wanted = [this] {
      return !problem_.goesOn || problem_.goesOn(1.0 - kRoundLeft * std::pow(kRoundLeaves, round_));
    };
    return failureOf(solveStage(fineReference_, solver_, env_, stage, {clock_, {}, wanted, {}}).newton);
  }

  [[nodiscard]] std::string solveHeld() { return stage(0.0); }

  // All forces that do not rotate with the body: prescribed forces, loads and gravity. Elastic forces have no virial of
  // rotations.
  [[nodiscard]] std::vector<Vec3> deadForces() {
    std::vector<Vec3> dead = knownForces(fineReference_, env_.gravity, clock_, problem_.parallelFor);
    fineReference_.computeInternalForces(problem_.parallelFor);
    for (std::size_t j = 0; j < dead.size(); ++j) dead[j] += given_[j] - fineReference_.forces()[j];
    return dead;
  }

  // Stabilised by its inertia; mean position and rotation are preserved.
  [[nodiscard]] std::string solveFree() {
    const std::vector<Vec3> begun = placesOf(fineReference_, fineReference_.state().displacements);
    const double holding = std::max(kHolding * fineReference_.restFrequency() * fineReference_.restFrequency(),
                                    kAgainstTurns * holdingAgainstTurns(fineReference_, deadForces()));
    for (int round = 0; round < kMaxRounds; ++round) {
      const std::vector<Vec3> before = fineReference_.state().displacements;
      round_ = round;
      if (const std::string failure = stage(holding); !failure.empty()) return failure;
      std::vector<Vec3> &u = fineReference_.state().displacements;
      const std::vector<Vec3> now = placesOf(fineReference_, u);
      const RigidFit back = rigidFit(now, begun, fineReference_.masses());
      double way = 0.0, moved = 0.0;
      for (std::size_t j = 0; j < u.size(); ++j) {
        u[j] += back(now[j]) - now[j];
        way = std::max(way, (fineReference_.rest().positions[j] + u[j] - begun[j]).norm());
        moved = std::max(moved, (u[j] - before[j]).norm());
      }
      if (moved <= std::max(kSettled * way, 1e-6 * fineReference_.rest().spacing)) return {};
    }
    return "a body that nothing but contact and inertia holds has not come to rest; hold it, or verify another moment";
  }

  const FineReferenceProblem &problem_;
  Body &fineReference_;
  const double clock_;
  bool isHeld_, leansOnContact_ = false;
  StageClock stages_;
  Environment env_;
  NewtonSolver solver_;
  std::vector<Vec3> given_, start_;  // N: prescribed; out of balance at the beginning
  double share_ = 1.0;               // inverse of the load factor, so that these forces act in full
  int round_ = 0;                    // of an unsupported body
};

FineReferenceState stateOf(Body &fineReference, const Vec3 &gravity, double clock, const ParallelFor &parallelFor) {
  (void)knownForces(fineReference, gravity, clock, parallelFor);
  const ElasticEnergy energy = fineReference.elasticEnergy(parallelFor);
  return {fineReference.state().displacements, fineReference.reactions(gravity), energy.strain + energy.stabilisation,
          false};
}

}  // namespace

Result<FineReferenceState> solveDirectly(const FineReferenceProblem &problem, std::span<const Vec3> leftOver,
                                         std::unique_ptr<Body> fineReference) {
  fineReference->quasiStatic = problem.body.quasiStatic;
  DirectSolver solution(problem, *fineReference);
  if (auto solved = solution.solve(leftOver); !solved) return refused(solved.error());
  FineReferenceState out =
      stateOf(*fineReference, problem.target.world.gravity, problem.target.clock, problem.parallelFor);
  out.isHeldByContact = solution.isHeldByContact();
  return out;
}

Result<FineReferenceState> solveAlongLoadPath(const FineReferenceProblem &problem,
                                              std::unique_ptr<Body> fineReference) {
  const VerificationTarget &target = problem.target;
  const double increments = target.world.loadSteps > 0 ? target.world.loadSteps : kUsualLoadSteps;
  const double steps = target.clock * increments;
  if (std::abs(steps - std::round(steps)) > 1e-6)
    return refused("solver.load_steps has changed on the way; begin anew");
  if (!target.externalForces.empty()) {
    std::vector<Vec3> forces =
        carriedOver(problem.body, target.externalForces, true, *fineReference, problem.parallelFor);
    fineReference->swapExternalForces(forces);
  }
  Simulator simulator(problem.parallelFor);
  simulator.setWorld(target.world);
  const std::size_t id = simulator.addBody(std::move(fineReference));
  for (const Obstacle &obstacle : target.obstacles) simulator.addObstacle(obstacle);
  while (simulator.loadFactor() < target.clock - 1e-9) {
    if (problem.goesOn && !problem.goesOn(simulator.loadFactor() / target.clock)) return refused("cancelled");
    if (const auto done = simulator.step(problem.stop); !done)
      return refused(done.error().ended ? "cancelled" : "its fine reference has no equilibrium: " + done.error().text);
  }
  return stateOf(*simulator.body(id), target.world.gravity, target.clock, problem.parallelFor);
}

}  // namespace pointbased::detail
