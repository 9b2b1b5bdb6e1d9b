// SPDX-License-Identifier: Apache-2.0
#include "analysis/shadow_solution.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "analysis/shadow_forces.h"
#include "base/point_tree.h"
#include "stepping/stage_solution.h"

namespace pointbased::detail {
namespace {

constexpr int kMostHalvings = 2;            // of the way from the body's state to the shadow's equilibrium
constexpr int kMostRounds = 25;             // of a body that nothing holds
constexpr double kHolding = 1e-7;           // of the square of its largest frequency: inertia that a free one leans on
constexpr double kAgainstTurns = 2.0;       // times the least inertia that keeps it from turning over
constexpr double kContactStiffness = 10.0;  // Young's moduli per spacing of the shadow, Pa/m
constexpr double kSettled = 0.01;           // part of the way that a round may still change: errors need no more digits
constexpr double kRoundLeft = 0.7, kRoundLeaves = 0.85;  // of the progress, by rounds
constexpr int kUsualLoadSteps = 10;
constexpr std::size_t kNearest = 16;  // points among which one of the same material is looked for

tl::unexpected<std::string> refused(const std::string &text) { return tl::unexpected<std::string>(text); }

// Plastic strain of the nearest point of the same material.
void takeFlow(const Body &body, Body &shadow) {
  const std::vector<Mat3> &from = body.state().history.plasticInverse;
  std::vector<Mat3> &to = shadow.state().history.plasticInverse;
  if (from.empty() || to.empty()) return;
  const StencilSet &coarse = body.rest().stencils, &fine = shadow.rest().stencils;
  const auto materialOf = [](const StencilSet &s, std::size_t q) { return s.materials.empty() ? 0 : s.materials[q]; };
  const PointTree tree(body.rest().pointCentres);
  std::vector<Index> indices(kNearest);
  std::vector<double> squared(kNearest);
  for (std::size_t q = 0; q < to.size(); ++q) {
    const Vec3 at = shadow.rest().pointCentres[q] + shadow.rest().origin - body.rest().origin;
    const std::size_t found = tree.nearest(at, kNearest, indices.data(), squared.data());
    const auto end = indices.begin() + static_cast<std::ptrdiff_t>(found);
    const auto same =
        std::find_if(indices.begin(), end, [&](Index p) { return materialOf(coarse, p) == materialOf(fine, q); });
    if (found > 0) to[q] = from[same == end ? indices.front() : *same];
  }
}

// Whether points that stay where they are leave a body no turn: they lie on no line.
bool holdsAgainstTurns(std::span<const Vec3> points, double spacing) {
  if (points.size() < 3) return false;
  Vec3 centre = Vec3::Zero();
  for (const Vec3 &x : points) centre += x / static_cast<double>(points.size());
  Mat3 spread = Mat3::Zero();
  for (const Vec3 &x : points) spread += (x - centre) * (x - centre).transpose() / static_cast<double>(points.size());
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(spread, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues()[1] > 0.04 * spacing * spacing;
}

std::vector<Vec3> placesOf(const Body &shadow, std::span<const Vec3> u) {
  std::vector<Vec3> out(shadow.rest().positions);
  for (std::size_t j = 0; j < out.size(); ++j) out[j] += u[j];
  return out;
}

// The solution of one shadow from the state of its body.
class FromHere {
 public:
  FromHere(const ShadowProblem &problem, Body &shadow)
      : problem_(problem), shadow_(shadow), clock_(problem.standing.clock),
        isHeld_(shadow.held() || shadow.foundation().settings().holds()), stages_(stageNames()) {
    env_.gravity = problem.standing.world.gravity;
    env_.tolerance = problem.standing.world.tolerance;
    env_.preconditioner = problem.standing.world.preconditioner;
    env_.parallelFor = &problem.parallelFor;
    env_.clock = &stages_;
    env_.stop = problem.stop;
  }

  [[nodiscard]] Result<void> solve(std::span<const Vec3> leftOver) {
    begin(leftOver);
    // In one go; where that fails along a way on which the forces of the beginning fade.
    double at = 0.0, size = 1.0;
    int halvings = 0;
    std::vector<Vec3> good = shadow_.state().displacements;
    while (at < 1.0) {
      const double next = std::min(1.0, at + size);
      std::vector<Vec3> forces = given_;
      for (std::size_t j = 0; j < forces.size(); ++j) forces[j] = share_ * (given_[j] - (1.0 - next) * start_[j]);
      shadow_.swapExternalForces(forces);
      const std::string failure = isHeld_ ? solveHeld() : solveFree();
      if (failure == "cancelled") return refused(failure);
      if (failure.empty()) {
        at = next;
        good = shadow_.state().displacements;
        continue;
      }
      if (!problem_.isLast || !isHeld_ || ++halvings > kMostHalvings)
        return refused("its shadow has no equilibrium near the present state: " + failure);
      size *= 0.5;
      shadow_.state().displacements = good;
      solver_.forget();
    }
    return {};
  }

  [[nodiscard]] bool leansOnContact() const { return leansOnContact_; }

 private:
  void begin(std::span<const Vec3> leftOver) {
    const Body &body = problem_.body;
    std::vector<Vec3> at(shadow_.rest().positions);
    for (Vec3 &x : at) x += shadow_.rest().origin - body.rest().origin;
    interpolateDisplacements(body.rest().bind(at, {}), body.rest().positions, body.state().displacements,
                             shadow_.state().displacements, problem_.parallelFor);
    takeFlow(body, shadow_);
    shadow_.placeHeld(clock_, false);
    if (!isHeld_) leanOnContact();
    given_ = carriedOver(body, leftOver, !leansOnContact_, shadow_, problem_.parallelFor);
    if (leansOnContact_) {
      std::vector<Vec3> pull(given_.size(), Vec3::Zero());
      shadow_.foundation().addForces(shadow_.state().displacements, {}, pull, problem_.parallelFor);
      for (std::size_t j = 0; j < pull.size(); ++j) given_[j] -= pull[j];
    }
    start_ = knownForces(shadow_, env_.gravity, clock_, problem_.parallelFor);
    if (!isHeld_) balance(shadow_, start_, given_);
    for (std::size_t j = 0; j < start_.size(); ++j) start_[j] += given_[j];
    const double share = shadow_.factor(0.0, clock_);
    share_ = share > 0.0 ? 1.0 / share : 0.0;
  }

  // With its forces of contact as given ones, a body that lies on something could sink into it, slide and tip over. So
  // it stays where it touches, on springs that are at rest in the state of the body.
  void leanOnContact() {
    if (shadow_.foundation().settings().acts()) return;
    SurfacePoints points = touchingPoints(problem_.body, shadow_.rest());
    if (!holdsAgainstTurns(points.positions, problem_.body.rest().spacing)) return;
    double stiffest = 0.0;
    for (const Material &material : shadow_.constitution().materials)
      stiffest = std::max(stiffest, material.youngsModulus);
    const double k = kContactStiffness * stiffest / shadow_.rest().spacing;
    Interpolation binding = shadow_.rest().bind(points.positions, points.normals);
    ElasticFoundation &springs = shadow_.foundation();
    springs.set({k, k, 0.0});
    springs.bind(std::move(points), std::move(binding), shadow_.rest().phyxelCount());
    isHeld_ = leansOnContact_ = true;
  }

  [[nodiscard]] std::string stage(double holding) {
    const ImplicitStage stage{0.0, clock_, 0.0, {}, {}, holding, 0.0};
    const auto wanted = [this] {
      return !problem_.goesOn || problem_.goesOn(1.0 - kRoundLeft * std::pow(kRoundLeaves, round_));
    };
    return failureOf(solveStage(shadow_, solver_, env_, stage, {clock_, {}, wanted, {}}).newton);
  }

  [[nodiscard]] std::string solveHeld() { return stage(0.0); }

  // All that does not turn with the body: what is given, loads and gravity. Elastic forces have no virial of turns.
  [[nodiscard]] std::vector<Vec3> deadForces() {
    std::vector<Vec3> dead = knownForces(shadow_, env_.gravity, clock_, problem_.parallelFor);
    shadow_.computeInternalForces(problem_.parallelFor);
    for (std::size_t j = 0; j < dead.size(); ++j) dead[j] += given_[j] - shadow_.forces()[j];
    return dead;
  }

  // Leaning on its inertia; its mean position and turn stay.
  [[nodiscard]] std::string solveFree() {
    const std::vector<Vec3> begun = placesOf(shadow_, shadow_.state().displacements);
    const double holding = std::max(kHolding * shadow_.restFrequency() * shadow_.restFrequency(),
                                    kAgainstTurns * holdingAgainstTurns(shadow_, deadForces()));
    for (int round = 0; round < kMostRounds; ++round) {
      const std::vector<Vec3> before = shadow_.state().displacements;
      round_ = round;
      if (const std::string failure = stage(holding); !failure.empty()) return failure;
      std::vector<Vec3> &u = shadow_.state().displacements;
      const std::vector<Vec3> now = placesOf(shadow_, u);
      const RigidFit back = rigidFit(now, begun, shadow_.masses());
      double way = 0.0, moved = 0.0;
      for (std::size_t j = 0; j < u.size(); ++j) {
        u[j] += back(now[j]) - now[j];
        way = std::max(way, (shadow_.rest().positions[j] + u[j] - begun[j]).norm());
        moved = std::max(moved, (u[j] - before[j]).norm());
      }
      if (moved <= std::max(kSettled * way, 1e-6 * shadow_.rest().spacing)) return {};
    }
    return "a body that nothing but contact and inertia holds has not come to rest; hold it, or verify another moment";
  }

  const ShadowProblem &problem_;
  Body &shadow_;
  const double clock_;
  bool isHeld_, leansOnContact_ = false;
  StageClock stages_;
  Environment env_;
  NewtonSolver solver_;
  std::vector<Vec3> given_, start_;  // N: taken as given; out of balance at the beginning
  double share_ = 1.0;               // of external forces that are to act whole
  int round_ = 0;                    // of a body that nothing holds
};

ShadowState stateOf(Body &shadow, const Vec3 &gravity, double clock, const ParallelFor &parallelFor) {
  (void)knownForces(shadow, gravity, clock, parallelFor);
  const ElasticEnergy energy = shadow.elasticEnergy(parallelFor);
  return {shadow.state().displacements, shadow.reactions(gravity), energy.strain + energy.stabilisation, false};
}

}  // namespace

RigidFit rigidFit(std::span<const Vec3> from, std::span<const Vec3> to, std::span<const double> weights) {
  RigidFit fit;
  Vec3 middle = Vec3::Zero();
  double sum = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    fit.centre += weights[i] * from[i];
    middle += weights[i] * to[i];
    sum += weights[i];
  }
  fit.centre /= sum;
  middle /= sum;
  fit.shift = middle - fit.centre;
  Mat3 product = Mat3::Zero();
  for (std::size_t i = 0; i < from.size(); ++i)
    product += weights[i] * (to[i] - middle) * (from[i] - fit.centre).transpose();
  const Eigen::JacobiSVD<Mat3> svd(product, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 flip = Mat3::Identity();
  flip(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  fit.rotation = svd.matrixU() * flip * svd.matrixV().transpose();
  return fit;
}

Result<ShadowState> solveFromHere(const ShadowProblem &problem, std::span<const Vec3> leftOver,
                                  std::unique_ptr<Body> shadow) {
  shadow->quasiStatic = problem.body.quasiStatic;
  FromHere solution(problem, *shadow);
  if (auto solved = solution.solve(leftOver); !solved) return refused(solved.error());
  ShadowState out = stateOf(*shadow, problem.standing.world.gravity, problem.standing.clock, problem.parallelFor);
  out.leansOnContact = solution.leansOnContact();
  return out;
}

Result<ShadowState> solveAlongTheWay(const ShadowProblem &problem, std::unique_ptr<Body> shadow) {
  const StandingBody &standing = problem.standing;
  const double increments = standing.world.loadSteps > 0 ? standing.world.loadSteps : kUsualLoadSteps;
  const double steps = standing.clock * increments;
  if (std::abs(steps - std::round(steps)) > 1e-6)
    return refused("solver.load_steps has changed on the way; begin anew");
  if (!standing.externalForces.empty()) {
    std::vector<Vec3> forces = carriedOver(problem.body, standing.externalForces, true, *shadow, problem.parallelFor);
    shadow->swapExternalForces(forces);
  }
  Simulator simulator(problem.parallelFor);
  simulator.setWorld(standing.world);
  const std::size_t id = simulator.addBody(std::move(shadow));
  for (const Obstacle &obstacle : standing.obstacles) simulator.addObstacle(obstacle);
  while (simulator.loadFactor() < standing.clock - 1e-9) {
    if (problem.goesOn && !problem.goesOn(simulator.loadFactor() / standing.clock)) return refused("cancelled");
    if (const auto done = simulator.step(problem.stop); !done)
      return refused(done.error().ended ? "cancelled" : "its shadow has no equilibrium: " + done.error().text);
  }
  return stateOf(*simulator.body(id), standing.world.gravity, standing.clock, problem.parallelFor);
}

}  // namespace pointbased::detail
