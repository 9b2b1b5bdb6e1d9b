// SPDX-License-Identifier: Apache-2.0
// The modes of lattice cells relax as the material does.
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "engine_cases.h"
#include "support/catch.h"

using namespace engine_cases;

namespace {

constexpr PronyTerm kFast{0.35, 0.2}, kSlow{0.25, 3.0};

Constitution relaxing(const EngineCase &c, MaterialLaw law, double nu, PronyTerm first, PronyTerm second = {}) {
  Constitution out = constitution(c, law);
  out.materials[0].poissonRatio = nu;
  out.materials[0].prony = {first, second};
  return out;
}

/// The elastic material with the long-term shear modulus and the same bulk modulus.
Constitution relaxed(Constitution constitution) {
  Material &m = constitution.materials[0];
  const double K = m.lambda() + 2.0 / 3.0 * m.mu(), G = m.mu() * (1.0 - m.prony[0].share - m.prony[1].share);
  m.youngsModulus = 9.0 * K * G / (3.0 * K + G);
  m.poissonRatio = (3.0 * K - 2.0 * G) / (2.0 * (3.0 * K + G));
  m.prony = {};
  return constitution;
}

/// A body that is moved from state to state and has a history.
struct Led {
  const EngineCase &c;
  Constitution constitution;
  PointHistory history;

  Led(const EngineCase &engineCase, Constitution of) : c(engineCase), constitution(std::move(of)) {
    history.reset(constitution, c.stencils.pointCount(), true);
  }
  std::vector<Vec3> to(std::span<const Vec3> u, double dt) {
    const std::size_t points = c.stencils.pointCount();
    std::vector<Mat3> gradients(points), stresses(points);
    std::vector<double> ratios(points);
    std::vector<HourglassStrain> modes(points);
    std::vector<Vec3> entries(c.stencils.phyxels.indices.size()), forces(c.phyxels());
    deformationGradients(c.stencils, u, gradients, serialFor());
    pointStresses(constitution, c.stencils, gradients, {}, history, dt, &history, stresses, ratios, serialFor());
    relaxModes(constitution, c.stencils, u, gradients, history, dt, &history, modes, serialFor());
    internalForces(constitution, c.stencils, c.positions, u, gradients, stresses, entries, forces, serialFor(), modes);
    return forces;
  }
};

/// u = Q field(Q^T X), X from the centre, in spacings.
template <class Field>
std::vector<Vec3> along(const EngineCase &c, Field field) {
  const Mat3 &Q = c.stencils.axes;
  Vec3 middle = Vec3::Zero();
  for (const Vec3 &X : c.positions) middle += X / static_cast<double>(c.phyxels());
  std::vector<Vec3> u;
  for (const Vec3 &X : c.positions)
    u.push_back(c.spacing * (Q * field(Vec3(Q.transpose() * (X - middle) / c.spacing))));
  return u;
}

std::vector<Vec3> scaled(std::span<const Vec3> v, double factor) {
  return plus(std::vector<Vec3>(v.size(), Vec3::Zero()), factor, v);
}

double apart(std::span<const Vec3> a, std::span<const Vec3> b) { return largest(plus(a, -1.0, b)); }

std::vector<Vec3> general(const EngineCase &c, std::uint64_t seed, double amplitude = 0.1) {
  return scaled(noise(c, 1.0, seed), amplitude * c.spacing);
}

}  // namespace

TEST_CASE("relaxing modes: a twisted cell holds G(t) of its force, whatever the step") {
  const EngineCase c = lattice(1, 1, 1, false);
  // Torsion, and the mode xyz: nothing but modes, and no normal strain. F = I.
  const std::vector<Vec3> u = along(c, [](const Vec3 &x) {
    return Vec3(0.3 * Vec3(0, -x[0] * x[2], x[0] * x[1]) + x.prod() * Vec3(0.4, -0.2, 0.1));
  });
  for (const MaterialLaw law : kLaws)
    for (const int steps : {1, 3, 40}) {
      INFO(nameOf(law) << ", " << steps << " steps");
      Led led(c, relaxing(c, law, 0.45, kFast, kSlow));
      const std::vector<Vec3> atOnce = led.to(u, 0.0);
      REQUIRE(largest(atOnce) > 0.0);
      // another nu: the case compares with itself
      CHECK(apart(atOnce, evaluate(c, constitution(c, law), u).forces) > 0.0);
      std::vector<Vec3> after;
      const double t = 0.7;
      for (int k = 0; k < steps; ++k) after = led.to(u, t / steps);
      const double G =
          1.0 - kFast.share * (1.0 - std::exp(-t / kFast.time)) - kSlow.share * (1.0 - std::exp(-t / kSlow.time));
      CHECK(apart(after, scaled(atOnce, G)) < 1e-12 * largest(atOnce));
    }
}

TEST_CASE("relaxing modes: a bent cell follows the plane stress of a bulk modulus that does not relax") {
  const EngineCase c = lattice(1, 1, 1, false);
  const std::vector<Vec3> u = along(c, [](const Vec3 &x) { return Vec3(1e-3 * x[0] * x[2], 0.0, 0.0); });
  for (const double nu : {0.0, 0.3, 0.49}) {
    INFO("nu = " << nu);
    const Constitution of = relaxing(c, MaterialLaw::linear, nu, kFast);
    const Material &m = of.materials[0];
    Led start(c, of);
    const std::vector<Vec3> first = start.to(u, 0.0), last = evaluate(c, relaxed(of), u).forces;
    // Correspondence: 4 mu (K + mu/3) / (K + 4/3 mu) with mu(s) falls with the time of mu, where mu and λ* fall by g mu
    // and -g mu, and with that of K + 4/3 mu(s) = 0. Forces are linear in mu and λ*, so those of the first are a sum of
    // the elastic ones initially and in the long term.
    const double K = m.lambda() + 2.0 / 3.0 * m.mu(), t = 0.3, g = kFast.share;
    const double time = kFast.time * (K + 4.0 / 3.0 * m.mu()) / (K + 4.0 / 3.0 * m.mu() * (1.0 - g));
    const auto planeStress = [&](double mu) { return 2.0 * mu * (K - 2.0 / 3.0 * mu) / (K + 4.0 / 3.0 * mu); };
    Eigen::Matrix2d moduli;
    moduli << m.mu(), (1.0 - g) * m.mu(), planeStress(m.mu()), planeStress((1.0 - g) * m.mu());
    const Eigen::Vector2d parts = moduli.inverse() * Eigen::Vector2d(g * m.mu(), -g * m.mu());
    const std::vector<Vec3> ofShear = plus(scaled(first, parts[0]), parts[1], last);
    const std::vector<Vec3> ofWave = plus(plus(first, -1.0, last), -1.0, ofShear);
    const std::vector<Vec3> expected =
        plus(plus(last, std::exp(-t / kFast.time), ofShear), std::exp(-t / time), ofWave);
    double errors[2];
    for (const int k : {0, 1}) {
      Led led(c, of);
      std::vector<Vec3> forces = led.to(u, 0.0);
      const int steps = 40 << k;
      for (int i = 0; i < steps; ++i) forces = led.to(u, t / steps);
      errors[k] = apart(forces, expected) / largest(expected);
    }
    CHECK(errors[1] < 1e-5);  // second order in steps of 0.019 of the time
    CHECK(errors[0] / errors[1] == Approx(4.0).margin(0.1));
  }
}

TEST_CASE("relaxing modes: what is left in the end is elastic, with less shear modulus and the same bulk modulus") {
  const EngineCase c = lattice(3, 2, 2);
  for (const MaterialLaw law : {MaterialLaw::linear, MaterialLaw::stVenantKirchhoff})
    for (const double nu : {0.1, 0.45}) {
      INFO(nameOf(law) << ", nu = " << nu);
      Constitution of = relaxing(c, law, nu, kFast, kSlow);
      of.materials[0].volumeStiffness = law == MaterialLaw::linear ? 0.0 : 700.0;
      // Quadratic in X: no mode xyz, which follows Young's modulus.
      const std::vector<Vec3> u = along(c, [](const Vec3 &x) {
        return Vec3(0.02 * x[0] * x[1] + 0.1 * x[1], 0.03 * x[1] * x[2] - 0.02 * x[0] * x[2],
                    0.02 * x[0] * x[2] + 0.1 * x[2]);
      });
      Led led(c, of);
      (void)led.to(general(c, 3), 0.1);
      for (int k = 0; k < 3; ++k) (void)led.to(u, 1e9);
      const std::vector<Vec3> expected = evaluate(c, relaxed(of), u).forces;
      CHECK(apart(led.to(u, 1e9), expected) < 1e-8 * largest(expected));  // fractions of tau/dt remain
    }
}

TEST_CASE("relaxing modes: a rotation of space is followed, and makes no force and no torque") {
  const EngineCase c = lattice(2, 2, 2);
  for (const MaterialLaw law : {MaterialLaw::stVenantKirchhoff, MaterialLaw::corotated, MaterialLaw::neoHookean}) {
    INFO(nameOf(law));
    Led still(c, relaxing(c, law, 0.4, kFast, kSlow)), turned = still;
    for (int k = 0; k < 6; ++k) {
      const Mat3 R = Eigen::AngleAxisd(0.7 * k, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
      const std::vector<Vec3> u = general(c, static_cast<std::uint64_t>(40 + k));
      std::vector<Vec3> Ru;
      for (std::size_t i = 0; i < u.size(); ++i) Ru.push_back(R * (c.positions[i] + u[i]) - c.positions[i]);
      const std::vector<Vec3> f = still.to(u, 0.1), g = turned.to(Ru, 0.1);
      Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
      double error = 0.0;
      for (std::size_t i = 0; i < u.size(); ++i) {
        error = std::max(error, (g[i] - R * f[i]).norm());
        force += f[i];
        torque += (c.positions[i] + u[i]).cross(f[i]);
      }
      CHECK(error < 1e-11 * largest(f));
      CHECK(force.norm() < 1e-11 * largest(f));
      CHECK(torque.norm() < 1e-11 * largest(f) * 4.0 * c.spacing);
    }
  }
}

TEST_CASE("relaxing modes: no closed loop of displacements gives work back") {
  const EngineCase c = lattice(2, 1, 1);
  for (const MaterialLaw law : kLaws)
    for (int loop = 0; loop < 8; ++loop) {
      Led led(c, relaxing(c, law, 0.3, {0.6, 0.2}, {0.3, 3.0}));
      const auto seed = static_cast<std::uint64_t>(60 + 2 * loop);
      const std::vector<Vec3> a = general(c, seed, 0.2), b = general(c, seed + 1, 0.2);
      const double duration = std::pow(10.0, 0.4 * loop - 1.5);
      std::vector<Vec3> u(c.phyxels(), Vec3::Zero()), f = u;
      double work = 0.0, turnover = 0.0;
      const int steps = 300;
      for (int k = 1; k <= steps; ++k) {
        const double w = 2.0 * std::numbers::pi * k / steps;  // starts and ends at rest
        const std::vector<Vec3> next =
            plus(scaled(a, std::sin(w) + 0.3 * std::sin(2.0 * w)), 0.5 * (1.0 - std::cos(w)), b);
        const std::vector<Vec3> force = led.to(next, duration / steps);
        const double part = -0.5 * dot(plus(f, 1.0, force), plus(next, -1.0, u));
        work += part;
        turnover += std::abs(part);
        u = next;
        f = force;
      }
      INFO(nameOf(law) << ", " << duration << " s: " << work / turnover);
      CHECK(work > 1e-3 * turnover);  // the trapezoidal sum of 300 steps is more accurate than that
    }
}

TEST_CASE("relaxing modes: the differential is the derivative of the forces, and symmetric") {
  const EngineCase c = lattice(2, 2, 1);
  for (const MaterialLaw law : kLaws)
    for (const double dt : {0.0, 0.02, 5.0}) {
      INFO(nameOf(law) << ", dt = " << dt);
      Led led(c, relaxing(c, law, 0.4, kFast, kSlow));
      (void)led.to(general(c, 5, 0.2), 0.3);
      const std::vector<Vec3> u = general(c, 6, 0.2), du = noise(c, 1.0, 7), dw = noise(c, 1.0, 8);
      const std::vector<Vec3> df = differential(c, led.constitution, u, du, led.history, dt);
      const double h = 1e-4 * c.spacing;
      const auto at = [&](double s) { return evaluate(c, led.constitution, plus(u, s, du), led.history, dt).forces; };
      const std::vector<Vec3> slope = scaled(
          plus(scaled(plus(at(h), -1.0, at(-h)), 8.0), -1.0, plus(at(2.0 * h), -1.0, at(-2.0 * h))), 1.0 / (12.0 * h));
      CHECK(apart(df, slope) < 1e-7 * largest(df));
      // For neo-Hookean points this holds only where a step is short against the times, see pronyStressDifferential().
      if (law == MaterialLaw::neoHookean && dt > 0.0) continue;
      const double one = dot(dw, df), other = dot(du, differential(c, led.constitution, u, dw, led.history, dt));
      CHECK(std::abs(one - other) < 1e-9 * std::abs(one));
    }
}

TEST_CASE("relaxing modes: blocks and assembled stiffness are those of the differential") {
  const EngineCase c = lattice(2, 1, 1);
  const double dt = 0.3;
  Led led(c, relaxing(c, MaterialLaw::linear, 0.4, kFast, kSlow));
  // So small that no block has to be made positive.
  (void)led.to(general(c, 5, 0.02), 0.3);
  const std::vector<Vec3> u = general(c, 6, 0.02);
  std::vector<Mat3> gradients(c.stencils.pointCount()), blocks(c.phyxels());
  deformationGradients(c.stencils, u, gradients, serialFor());
  const int n = static_cast<int>(3 * c.phyxels());
  for (const MaterialLaw law : {MaterialLaw::linear, MaterialLaw::stVenantKirchhoff}) {
    INFO(nameOf(law));
    led.constitution.materials[0].law = law;
    Eigen::MatrixXd K(n, n), assembled = Eigen::MatrixXd::Zero(n, n);
    for (int j = 0; j < n; ++j) {
      std::vector<Vec3> du(c.phyxels(), Vec3::Zero());
      du[static_cast<std::size_t>(j / 3)][j % 3] = 1.0;
      const std::vector<Vec3> df = differential(c, led.constitution, u, du, led.history, dt);
      for (int i = 0; i < n; ++i) K(i, j) = -df[static_cast<std::size_t>(i / 3)][i % 3];
    }
    stiffnessBlocks(led.constitution, c.stencils, c.positions, u, gradients, led.history, dt, 0.0, blocks, serialFor());
    for (std::size_t i = 0; i < c.phyxels(); ++i) {
      const auto at = static_cast<Eigen::Index>(3 * i);
      CHECK((blocks[i] - K.block<3, 3>(at, at)).norm() < 1e-9 * K.norm());
    }
    if (law != MaterialLaw::linear) continue;  // second derivatives of the strain are only in the blocks
    std::vector<Eigen::Triplet<double>> triplets;
    stiffnessTriplets(led.constitution, c.stencils, c.positions, u, gradients, led.history, dt, 0.0, triplets);
    for (const auto &t : triplets) assembled(t.row(), t.col()) += t.value();
    CHECK((assembled - K).norm() < 1e-10 * K.norm());
  }
}

TEST_CASE("relaxing modes: forces at once are the negative gradient of the energy") {
  const EngineCase c = lattice(2, 1, 1);
  for (const MaterialLaw law : kLaws) {
    INFO(nameOf(law));
    const Constitution of = relaxing(c, law, 0.4, kFast);
    const std::vector<Vec3> u = general(c, 9, 0.2), du = noise(c, 1.0, 10);
    const auto energy = [&](double s) {
      const ElasticEnergy e = energyAt(c, of, plus(u, s, du));
      return e.strain + e.stabilisation;
    };
    const double h = 1e-4 * c.spacing;
    const double slope = (8.0 * (energy(h) - energy(-h)) - (energy(2.0 * h) - energy(-2.0 * h))) / (12.0 * h);
    const double expected = -dot(evaluate(c, of, u).forces, du);
    CHECK(std::abs(slope - expected) < 1e-7 * std::abs(expected));
  }
}

TEST_CASE("relaxing modes: cells that do not relax keep their bits beside others that do") {
  EngineCase c = lattice(4, 1, 1);
  c.stencils.materials = {0, 0, 1, 1};
  Constitution of = constitution(c, MaterialLaw::neoHookean);
  of.materials.push_back(of.materials[0]);
  const std::vector<Vec3> u = general(c, 12, 0.2);
  const std::vector<Vec3> elastic = evaluate(c, of, u).forces;
  PointHistory none;
  none.reset(of, c.stencils.pointCount(), true);
  CHECK(none.modes.empty());
  of.materials[1].prony[0] = kFast;
  Led led(c, of);
  const std::vector<Vec3> forces = led.to(u, 0.5);
  std::vector<bool> relaxes(c.phyxels(), false);
  for (std::size_t q = 2; q < 4; ++q)
    for (Index e = c.stencils.phyxels.offsets[q]; e < c.stencils.phyxels.offsets[q + 1]; ++e)
      relaxes[c.stencils.phyxels.indices[e]] = true;
  for (std::size_t i = 0; i < c.phyxels(); ++i) CHECK((forces[i] == elastic[i]) == !relaxes[i]);
  CHECK(led.history.modes[0].previous.isZero(0.0));
  CHECK(led.history.modes[2].relaxed[0].norm() > 0.0);
}
