// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <cmath>

#include "engine_cases.h"
#include "lattice_cases.h"
#include "support/catch.h"

using namespace engine_cases;

namespace {

using Dense = Eigen::MatrixXd;

// Fourth-order differences of the forces along du against forceDifferential, relative to the largest.
double differentialError(const EngineCase &c, const Constitution &constitution, std::span<const Vec3> u,
                         const PointHistory &history = {}, double dt = 0.0) {
  const std::vector<Vec3> du = noise(c, 1.0, 21);
  const std::vector<Vec3> exact = differential(c, constitution, u, du, history, dt);
  const double step = 1e-4 * c.spacing;
  const auto at = [&](double s) { return evaluate(c, constitution, plus(u, s, du), history, dt).forces; };
  const std::vector<Vec3> p1 = at(step), m1 = at(-step), p2 = at(2.0 * step), m2 = at(-2.0 * step);
  double error = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i)
    error = std::max(error, ((8.0 * (p1[i] - m1[i]) - (p2[i] - m2[i])) / (12.0 * step) - exact[i]).norm());
  return error / largest(exact);
}

// K, column by column through forceDifferential.
Dense stiffness(const EngineCase &c, const Constitution &constitution, std::span<const Vec3> u,
                const PointHistory &history = {}, double dt = 0.0, double viscousScale = 0.0) {
  const int n = static_cast<int>(3 * c.phyxels());
  Dense K(n, n);
  for (int j = 0; j < n; ++j) {
    std::vector<Vec3> du(c.phyxels(), Vec3::Zero());
    du[static_cast<std::size_t>(j / 3)][j % 3] = 1.0;
    const std::vector<Vec3> df = differential(c, constitution, u, du, history, dt, viscousScale);
    for (int i = 0; i < n; ++i) K(i, j) = -df[static_cast<std::size_t>(i / 3)][i % 3];
  }
  return K;
}

Dense assembled(const EngineCase &c, const Constitution &constitution, std::span<const Vec3> u,
                const PointHistory &history = {}, double dt = 0.0, double viscousScale = 0.0) {
  std::vector<Mat3> gradients(c.stencils.pointCount());
  deformationGradients(c.stencils, u, gradients, serialFor());
  std::vector<Eigen::Triplet<double>> triplets;
  stiffnessTriplets(constitution, c.stencils, c.positions, u, gradients, history, dt, viscousScale, triplets);
  const int n = static_cast<int>(3 * c.phyxels());
  Dense K = Dense::Zero(n, n);
  for (const auto &t : triplets) K(t.row(), t.col()) += t.value();
  return K;
}

// Of the dense eigenvalue problem K q = ω² M q.
double exactFrequency(const Dense &K, std::span<const double> masses) {
  Eigen::VectorXd root(K.rows());
  for (int i = 0; i < K.rows(); ++i) root[i] = 1.0 / std::sqrt(masses[static_cast<std::size_t>(i / 3)]);
  const Dense scaled = root.asDiagonal() * K * root.asDiagonal();
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Dense>(scaled, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff());
}

}  // namespace

TEST_CASE("engine: the force differential is the derivative of the forces for every law and stencil") {
  for (const EngineCase &c : all())
    for (const MaterialLaw law : kLaws) {
      INFO(c.name << ", " << nameOf(law));
      Constitution constitution = engine_cases::constitution(c, law);
      if (c.full()) constitution.materials[0].volumeStiffness = 2000.0;
      CHECK(differentialError(c, constitution, generalState(c)) < 1e-7);
    }
}

TEST_CASE("engine: the stiffness is symmetric") {
  for (const EngineCase &c : all())
    for (const MaterialLaw law : kLaws) {
      INFO(c.name << ", " << nameOf(law));
      const Constitution constitution = engine_cases::constitution(c, law);
      const std::vector<Vec3> u = generalState(c), du1 = noise(c, 1.0, 31), du2 = noise(c, 1.0, 32);
      const double a = dot(du1, differential(c, constitution, u, du2)),
                   b = dot(du2, differential(c, constitution, u, du1));
      CHECK(std::abs(a - b) < 1e-10 * std::max(std::abs(a), std::abs(b)));
    }
}

TEST_CASE("engine: the viscous part of the differential is that of the viscous forces") {
  for (const EngineCase &c : all()) {
    INFO(c.name);
    Constitution constitution = engine_cases::constitution(c, MaterialLaw::neoHookean);
    constitution.materials[0].viscosity = 7.0;
    const std::vector<Vec3> u = generalState(c), du = noise(c, 1.0, 9), none(c.phyxels(), Vec3::Zero());
    const double scale = 25.0;
    // Forces are linear in the velocities at fixed positions.
    const std::vector<Vec3> moving = evaluate(c, constitution, u, {}, 0.0, plus(none, scale, du)).forces;
    const std::vector<Vec3> viscous = plus(moving, -1.0, evaluate(c, constitution, u).forces);
    const std::vector<Vec3> change =
        plus(differential(c, constitution, u, du, {}, 0.0, scale), -1.0, differential(c, constitution, u, du));
    CHECK(largest(plus(change, -1.0, viscous)) < 1e-11 * largest(viscous));
    CHECK(dot(du, viscous) < 0.0);
  }
}

TEST_CASE("engine: the differential is exact at fixed history of plastic and relaxing points") {
  for (const EngineCase &c : all()) {
    INFO(c.name);
    Constitution constitution = engine_cases::constitution(c, MaterialLaw::neoHookean);
    constitution.materials[0].plastic.yield = 0.02;
    constitution.materials[0].plastic.creep = 0.5;
    constitution.materials[0].prony[0] = {0.4, 0.2};
    PointHistory history;
    history.reset(constitution, c.stencils.pointCount(), !c.stencils.modes.empty());
    // A history: flowed and relaxed in another state.
    const std::vector<Vec3> past =
        plus(displaced(c, Vec3(1.25, 1.25, 0.7).asDiagonal(), Vec3::Zero()), 0.05 * c.spacing, noise(c, 1.0, 77));
    const Evaluated then = evaluate(c, constitution, past);
    std::vector<Mat3> stresses(c.stencils.pointCount());
    std::vector<double> ratios(c.stencils.pointCount());
    REQUIRE(plasticFlow(constitution, c.stencils, then.gradients, 0.02, history, serialFor()) > 0);
    pointStresses(constitution, c.stencils, then.gradients, {}, history, 0.05, &history, stresses, ratios, serialFor());
    if (!history.modes.empty()) {
      std::vector<HourglassStrain> relaxed(c.stencils.pointCount());
      relaxModes(constitution, c.stencils, past, then.gradients, history, 0.05, &history, relaxed, serialFor());
      REQUIRE(history.modes[0].relaxed[0].norm() > 0.0);
    }
    CHECK(differentialError(c, constitution, generalState(c), history, 0.03) < 1e-7);
  }
}

TEST_CASE("engine: the blocks are those of the stiffness") {
  for (const EngineCase &c : all())
    for (const MaterialLaw law : kLaws) {
      if (!c.full()) continue;  // flat stencils omit the rotation of the completion
      INFO(c.name << ", " << nameOf(law));
      Constitution constitution = engine_cases::constitution(c, law);
      constitution.materials[0].viscosity = 3.0;
      const std::vector<Vec3> u =
          plus(displaced(c, Eigen::AngleAxisd(0.8, Vec3::UnitX()) * Eigen::Scaling(1.05), Vec3::Zero()),
               0.05 * c.spacing, noise(c, 1.0, 5));
      const Evaluated at = evaluate(c, constitution, u);
      std::vector<Mat3> blocks(c.phyxels());
      stiffnessBlocks(constitution, c.stencils, c.positions, u, at.gradients, {}, 0.0, 40.0, blocks, serialFor());
      const Dense K = stiffness(c, constitution, u, {}, 0.0, 40.0);
      for (std::size_t i = 0; i < blocks.size(); ++i) {
        const Mat3 exact = K.block<3, 3>(3 * static_cast<int>(i), 3 * static_cast<int>(i));
        // Positive definite: otherwise the comparison would be meaningless.
        REQUIRE(Eigen::LLT<Mat3>(exact).info() == Eigen::Success);
        CHECK((blocks[i] - exact).norm() < 1e-10 * exact.norm());
      }
    }
}

TEST_CASE("engine: blocks are positive definite however crushed a body is") {
  for (const EngineCase &c : all())
    for (const MaterialLaw law : kLaws) {
      INFO(c.name << ", " << nameOf(law));
      const Constitution constitution = engine_cases::constitution(c, law);
      const std::vector<Vec3> u = noise(c, 1.5 * c.spacing, 12);
      const Evaluated at = evaluate(c, constitution, u);
      std::vector<Mat3> blocks(c.phyxels());
      stiffnessBlocks(constitution, c.stencils, c.positions, u, at.gradients, {}, 0.0, 0.0, blocks, serialFor());
      for (const Mat3 &block : blocks) CHECK(Eigen::LLT<Mat3>(block).info() == Eigen::Success);
    }
}

TEST_CASE("engine: the assembled stiffness is the stiffness at rest") {
  for (const EngineCase &c : all())
    for (const MaterialLaw law : kLaws) {
      INFO(c.name << ", " << nameOf(law));
      Constitution constitution = engine_cases::constitution(c, law);
      if (!c.full()) constitution.stabilisation = 0.0;  // flat: the control's rotation is omitted
      const std::vector<Vec3> rest(c.phyxels(), Vec3::Zero());
      const Dense K = stiffness(c, constitution, rest), A = assembled(c, constitution, rest);
      // Clamping at -1e-10 of the trace of a point's tangent.
      CHECK((A - K).norm() < 1e-9 * K.norm());
    }
}

TEST_CASE("engine: the assembled stiffness is positive semi-definite at any deformation") {
  for (const EngineCase &c : all())
    for (const MaterialLaw law : kLaws) {
      INFO(c.name << ", " << nameOf(law));
      Constitution constitution = engine_cases::constitution(c, law);
      constitution.materials[0].viscosity = 1.0;
      const Dense A = assembled(c, constitution, noise(c, 1.5 * c.spacing, 12), {}, 0.0, 10.0);
      CHECK((A - A.transpose()).norm() < 1e-12 * A.norm());
      const Eigen::SelfAdjointEigenSolver<Dense> eigen(A, Eigen::EigenvaluesOnly);
      CHECK(eigen.eigenvalues()[0] > -1e-8 * eigen.eigenvalues()[eigen.eigenvalues().size() - 1]);
    }
}

TEST_CASE("engine: the largest frequency is that of the dense eigenvalue problem") {
  for (const EngineCase &c : all()) {
    INFO(c.name);
    const Constitution constitution = engine_cases::constitution(c, MaterialLaw::neoHookean);
    const std::vector<Vec3> rest(c.phyxels(), Vec3::Zero());
    std::vector<double> extra(c.phyxels(), 0.0), none;
    extra[0] = 300.0;
    for (const std::vector<double> *held : {&none, &extra}) {
      Dense K = stiffness(c, constitution, rest);
      for (int i = 0; i < K.rows() && !held->empty(); ++i) K(i, i) += (*held)[static_cast<std::size_t>(i / 3)];
      const double exact = exactFrequency(K, c.masses);
      const double found = largestFrequency(constitution, c.stencils, c.positions, c.masses, *held, serialFor());
      // From below, and well within the margin of the step.
      CHECK(found <= exact * (1.0 + 1e-9));
      CHECK(found >= (1.0 - 1e-3) * exact);
    }
  }
}

TEST_CASE("engine: the stable step of bodies is that of the dense eigenvalue problem") {
  const BodyShape ball = shapes::ball(Vec3(0.003, 0.001, 0.002), 0.026);
  for (const Evaluation evaluation : {Evaluation::stressPoints, Evaluation::phyxels})
    for (const bool relaxes : {false, true}) {
      const BodyRecipe recipe{.evaluation = evaluation, .sampling = {.spacing = 0.01}};
      const auto rest = shapes::restState(ball, recipe);
      Material material;
      if (relaxes) material.prony[0] = {0.3, 0.1};
      const bool lattice = evaluation == Evaluation::stressPoints;
      const Constitution constitution{{material}, lattice ? kLatticeStabilisation : kCloudStabilisation};
      const Body body("ball", rest, constitution, serialFor());
      const ParallelFor threads = lattice_cases::threadedFor(3);
      const auto alike = buildRestState(ball, recipe, {}, threads);
      REQUIRE(alike);
      CHECK((*alike)->positions == rest->positions);
      CHECK(Body("ball", *alike, constitution, threads).stableStepAtRest() == body.stableStepAtRest());
      const std::size_t n = rest->phyxelCount();
      INFO((lattice ? "lattice, " : "cloud, ") << n << " phyxels, relaxes " << relaxes);
      const std::vector<Vec3> still(n, Vec3::Zero());
      const std::vector<Mat3> identity(rest->pointCount(), Mat3::Identity());
      TangentScratch scratch;
      const auto size = static_cast<Eigen::Index>(3 * n);
      Dense K(size, size);
      std::vector<Vec3> du(n, Vec3::Zero()), df(n);
      for (std::size_t i = 0; i < 3 * n; ++i) {
        du[i / 3][static_cast<int>(i % 3)] = 1.0;
        forceDifferential(constitution, rest->stencils, rest->positions, still, identity, {}, 0.0, 0.0, du, scratch, df,
                          serialFor());
        du[i / 3].setZero();
        K.col(static_cast<Eigen::Index>(i)) = -Eigen::Map<const Eigen::VectorXd>(df.front().data(), size);
      }
      const double exact = exactFrequency(0.5 * (K + K.transpose()), body.masses());
      const double found = 2.0 / body.stableStepAtRest();
      CHECK(found <= exact * (1.0 + 1e-9));
      CHECK(found >= (1.0 - 1e-3) * exact);
    }
}

TEST_CASE("engine: stretched modes are in the tangent ratio") {
  // A neo-Hookean point does not stiffen along a stretch, its modes do: by the stretch squared.
  const EngineCase c = lattice(2, 2, 2, false);
  const Constitution constitution = engine_cases::constitution(c, MaterialLaw::neoHookean);
  const std::vector<Vec3> u = displaced(c, Vec3(2.0, 1.0, 1.0).asDiagonal(), Vec3::Zero());
  CHECK(evaluate(c, constitution, u).ratio >= 4.0);
}
