// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "engine_cases.h"
#include "support/catch.h"
#include "vector_cases.h"

using namespace engine_cases;

namespace {

const double kHalfTurn = std::acos(-1.0);

// Clouds as bodies have them, flat and straight ones, a pair and a single phyxel among them; and those of all().
const std::vector<EngineCase> &allAndBodies() {
  static const std::vector<EngineCase> cases = [] {
    std::vector<EngineCase> out = all();
    std::vector<Vec3> plane, line, thick;
    shapes::Random random(11);
    for (int y = 0; y < 7; ++y)
      for (int x = 0; x < 7; ++x) plane.push_back(0.01 * Vec3(x + 0.2 * random(), y, 0.4 * y));
    for (int x = 0; x < 9; ++x) line.push_back(0.01 * Vec3(x + 0.2 * random(), 0.0, 0.0));
    for (int i = 0; i < 120; ++i) thick.push_back(0.03 * random.vector());
    for (const auto &rest : {shapes::restState(shapes::box(Vec3(0, 0, 0), Vec3(0.06, 0.04, 0.04)), 0.01),
                             shapes::restState(shapes::horseshoe(), 0.03), shapes::restState(thick, 0.01, {20, 1.8}),
                             shapes::restState(plane, 0.01, {12, 1.8}), shapes::restState(line, 0.01, {4, 1.8}),
                             shapes::restState(std::vector<Vec3>{Vec3(0, 0, 0), Vec3(0.01, 0, 0)}, 0.01),
                             shapes::restState(std::vector<Vec3>{Vec3(0, 0, 0)}, 0.01)})
      out.push_back({.name = "body of " + std::to_string(rest->phyxelCount()),
                     .stencils = rest->stencils,
                     .positions = rest->positions,
                     .masses = std::vector<double>(rest->phyxelCount(), 1060.0 * 1e-6),
                     .spacing = rest->spacing,
                     .stabilisation = kCloudStabilisation});
    return out;
  }();
  return cases;
}

// Fourth-order differences of the energy against the forces, relative to the largest force.
double gradientError(const EngineCase &c, const Constitution &constitution, const PointHistory &history = {}) {
  std::vector<Vec3> u = generalState(c);
  const Evaluated at = evaluate(c, constitution, u, history);
  const double step = 1e-4 * c.spacing;
  const auto energy = [&] {
    const ElasticEnergy e = energyAt(c, constitution, u, history);
    return e.strain + e.stabilisation;
  };
  double error = 0.0;
  for (std::size_t i = 0; i < u.size(); ++i)
    for (int a = 0; a < 3; ++a) {
      const double start = u[i][a];
      double e[4];
      const double steps[4] = {step, -step, 2.0 * step, -2.0 * step};
      for (int k = 0; k < 4; ++k) {
        u[i][a] = start + steps[k];
        e[k] = energy();
      }
      u[i][a] = start;
      error = std::max(error, std::abs((8.0 * (e[0] - e[1]) - (e[2] - e[3])) / (12.0 * step) + at.forces[i][a]));
    }
  return error / largest(at.forces);
}

}  // namespace

TEST_CASE("engine: a rigid motion gives no force, half a turn included") {
  for (const EngineCase &c : allAndBodies())
    for (const MaterialLaw law : kLaws) {
      if (law == MaterialLaw::linear) continue;  // small strain is not objective
      for (const double angle : {0.0, 0.7, kHalfTurn}) {
        INFO(c.name << ", " << nameOf(law) << ", " << angle);
        const Mat3 R = Eigen::AngleAxisd(angle, Vec3(0.3, -1.0, 0.7).normalized()).toRotationMatrix();
        const Constitution constitution = engine_cases::constitution(c, law);
        const Evaluated at = evaluate(c, constitution, displaced(c, R, Vec3(3.0, -1.0, 0.5)));
        // Round-off of displacements of metres over spacings of centimetres: 1e-16 · 3 m / 0.01 m, amplified by the
        // laws.
        CHECK(largest(at.forces) < 1e-10 * 6000.0 * c.spacing * c.spacing);
        for (const Mat3 &F : at.gradients) CHECK(greenStrain(F).norm() < 1e-10);
        CHECK(energyAt(c, constitution, displaced(c, R, Vec3(3.0, -1.0, 0.5))).stabilisation < 1e-18);
      }
    }
}

TEST_CASE("engine: a turn by half about the axis of a line's normal gives no force") {
  for (const EngineCase &c : all()) {
    // Exactly opposite for the pair and the line: where the shortest rotation is not unique.
    const Vec3 along = (c.positions[1] - c.positions[0]).normalized();
    const Mat3 R = Eigen::AngleAxisd(kHalfTurn, along.unitOrthogonal()).toRotationMatrix();
    const Evaluated at = evaluate(c, constitution(c, MaterialLaw::neoHookean), displaced(c, R, Vec3::Zero()));
    INFO(c.name);
    CHECK(largest(at.forces) < 1e-10 * 6000.0 * c.spacing * c.spacing);
  }
}

TEST_CASE("engine: forces and torques sum to zero") {
  for (const EngineCase &c : allAndBodies())
    for (const MaterialLaw law : kLaws) {
      INFO(c.name << ", " << nameOf(law));
      const std::vector<Vec3> u = noise(c, 0.3 * c.spacing, 3);
      const Evaluated at = evaluate(c, constitution(c, law), u);
      Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
      double scale = 0.0;
      for (std::size_t i = 0; i < c.phyxels(); ++i) {
        force += at.forces[i];
        torque += (c.positions[i] + u[i]).cross(at.forces[i]);
        scale += at.forces[i].norm();
      }
      CHECK(force.norm() <= 1e-13 * scale);
      // Small strain balances torques about the reference state only.
      if (law != MaterialLaw::linear) CHECK(torque.norm() <= 1e-12 * scale * 10.0 * c.spacing);
    }
}

TEST_CASE("engine: the force is the negative gradient of the energy for every law and stencil") {
  for (const EngineCase &c : allAndBodies())
    for (const MaterialLaw law : kLaws) {
      if (c.phyxels() < 2) continue;
      INFO(c.name << ", " << nameOf(law));
      Constitution constitution = engine_cases::constitution(c, law);
      CHECK(gradientError(c, constitution) < 1e-6);
      constitution.materials[0].volumeStiffness = 3000.0;
      // The volume term of the linear law sees the completed F, which is not a gradient at flat stencils.
      if (law != MaterialLaw::linear || c.full()) CHECK(gradientError(c, constitution) < 1e-6);
    }
}

TEST_CASE("engine: an affine motion is exact and has no energy of modes") {
  Mat3 A;
  A << 1.2, 0.1, -0.05, 0.0, 0.9, 0.2, 0.1, 0.0, 1.1;
  for (const EngineCase &c : allAndBodies()) {
    if (!c.full()) continue;
    for (const MaterialLaw law : kLaws) {
      INFO(c.name << ", " << nameOf(law));
      const Constitution constitution = engine_cases::constitution(c, law);
      const std::vector<Vec3> u = displaced(c, A, Vec3(0.1, 0.2, -0.3));
      const Evaluated at = evaluate(c, constitution, u);
      double volume = 0.0;
      for (std::size_t q = 0; q < at.gradients.size(); ++q) {
        CHECK((at.gradients[q] - A).norm() < 1e-11);
        volume += c.stencils.volumes[q];
      }
      const ElasticEnergy energy = energyAt(c, constitution, u);
      CHECK_THAT(energy.strain, WithinRel(volume * energyDensity(constitution.materials[0], A), 1e-10));
      CHECK(energy.stabilisation < 1e-20 * 6000.0);
    }
  }
}

TEST_CASE("engine: bending of a cell has the plane-stress energy it was asked for") {
  // u_x = k x z: E_xx = k z, the only strain that varies within the cell.
  const EngineCase c = lattice(1, 1, 1, false);
  Constitution constitution = engine_cases::constitution(c, MaterialLaw::stVenantKirchhoff);
  constitution.stabilisation = 1.0;
  const double k = 1e-4, h = c.spacing;
  const Mat3 &Q = c.stencils.axes;
  std::vector<Vec3> u;
  for (const Vec3 &X : c.positions) {
    const Vec3 local = Q.transpose() * X - Vec3::Constant(0.5 * h);
    u.push_back(Q * Vec3(k * local[0] * local[2], 0.0, 0.0));
  }
  const Material &m = constitution.materials[0];
  const double plane = 2.0 * m.lambda() * m.mu() / (m.lambda() + 2.0 * m.mu());
  const double expected = h * h * h * (h * h / 12.0) * k * k * (m.mu() + 0.5 * plane);
  CHECK_THAT(energyAt(c, constitution, u).stabilisation, WithinRel(expected, 1e-9));
}

TEST_CASE("engine: the linear law answers linearly on every stencil") {
  for (const EngineCase &c : all()) {
    INFO(c.name);
    Constitution constitution = engine_cases::constitution(c, MaterialLaw::linear);
    if (!c.full()) constitution.stabilisation = 0.0;  // the control of flat stencils rotates with them
    const std::vector<Vec3> u = noise(c, 0.2 * c.spacing, 8);
    const Evaluated once = evaluate(c, constitution, u), twice = evaluate(c, constitution, plus(u, 1.0, u));
    CHECK(largest(plus(twice.forces, -2.0, once.forces)) < 1e-12 * largest(once.forces));
  }
}

TEST_CASE("engine: points of two materials answer like bodies of one each") {
  for (const MaterialLaw law : {MaterialLaw::neoHookean, MaterialLaw::corotated}) {
    EngineCase c = lattice(4, 3, 3);
    const std::vector<Vec3> u = generalState(c);
    Constitution both = constitution(c, MaterialLaw::stVenantKirchhoff);
    both.materials.push_back(both.materials[0]);
    both.materials[1].law = law;
    both.materials[1].youngsModulus = 50000.0;
    for (std::size_t q = 0; q < c.stencils.pointCount(); ++q) c.stencils.materials.push_back(q % 3 == 0 ? 1 : 0);
    CHECK(gradientError(c, both) < 1e-6);
    const Evaluated mixed = evaluate(c, both, u);
    EngineCase plain = c;
    plain.stencils.materials.clear();
    const Evaluated first = evaluate(plain, {{both.materials[0]}, c.stabilisation}, u);
    const Evaluated second = evaluate(plain, {{both.materials[1]}, c.stabilisation}, u);
    for (std::size_t q = 0; q < mixed.stresses.size(); ++q)
      CHECK(mixed.stresses[q] == (q % 3 == 0 ? second : first).stresses[q]);
  }
}

TEST_CASE("engine: energies per point sum to the energy of the body") {
  for (const EngineCase &c : allAndBodies()) {
    const Constitution constitution = engine_cases::constitution(c, MaterialLaw::neoHookean);
    const std::vector<Vec3> u = generalState(c);
    const Evaluated at = evaluate(c, constitution, u);
    std::vector<Eigen::Vector2d> perPoint(c.stencils.pointCount());
    const ElasticEnergy energy = elasticEnergy(constitution, c.stencils, c.positions, u, at.gradients, {}, perPoint);
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d &e : perPoint) sum += e;
    CHECK_THAT(sum[0], WithinRel(energy.strain, 1e-13));
    CHECK_THAT(sum[1], WithinRel(energy.stabilisation, 1e-13));
    CHECK(perPoint[0].minCoeff() >= 0.0);
  }
}

TEST_CASE("engine: a state that is not a number is reported however the others are") {
  const EngineCase c = lattice(4, 3, 3);
  std::vector<Vec3> u(c.phyxels(), Vec3::Zero());
  CHECK_THAT(evaluate(c, constitution(c, MaterialLaw::neoHookean), u).ratio, WithinRel(1.0, 1e-12));
  u[1][2] = std::nan("");
  CHECK(std::isnan(evaluate(c, constitution(c, MaterialLaw::neoHookean), u).ratio));
}

TEST_CASE("engine: forces have the same bits however the loops are divided") {
  const ParallelFor backwards = vector_cases::inPieces();
  for (const EngineCase &c : allAndBodies()) {
    Constitution constitution = engine_cases::constitution(c, MaterialLaw::neoHookean);
    constitution.materials[0].viscosity = 2.0;
    const std::vector<Vec3> u = generalState(c), v = noise(c, 1.0, 4), du = noise(c, 1.0, 6);
    const Evaluated a = evaluate(c, constitution, u, {}, 0.0, v),
                    b = evaluate(c, constitution, u, {}, 0.0, v, backwards);
    CHECK(a.forces == b.forces);
    std::vector<Vec3> df(c.phyxels());
    TangentScratch scratch;
    forceDifferential(constitution, c.stencils, c.positions, u, a.gradients, {}, 0.0, 10.0, du, scratch, df, backwards);
    CHECK(df == differential(c, constitution, u, du, {}, 0.0, 10.0));
    std::vector<Mat3> blocks(c.phyxels()), blocksBackwards(c.phyxels());
    stiffnessBlocks(constitution, c.stencils, c.positions, u, a.gradients, {}, 0.0, 10.0, blocks, serialFor());
    stiffnessBlocks(constitution, c.stencils, c.positions, u, a.gradients, {}, 0.0, 10.0, blocksBackwards, backwards);
    CHECK(blocks == blocksBackwards);
    const std::vector<double> none;
    CHECK(largestFrequency(constitution, c.stencils, c.positions, c.masses, none, serialFor()) ==
          largestFrequency(constitution, c.stencils, c.positions, c.masses, none, backwards));
  }
}

TEST_CASE("viscous stress takes energy from a deformation and leaves a rotation alone") {
  auto rest = shapes::restState(shapes::box(Vec3(0, 0, 0), Vec3(0.05, 0.05, 0.05)), 0.01);
  Body body("test", rest, Constitution{{Material{.viscosity = 3.0}}}, serialFor());
  shapes::Random random(9);
  const auto power = [&] {
    shapes::evaluate(body);
    double p = 0.0;
    for (std::size_t i = 0; i < rest->phyxelCount(); ++i) p += body.forces()[i].dot(body.state().velocities[i]);
    return p;
  };
  for (Vec3 &v : body.state().velocities) v = random.vector();
  CHECK(power() < 0.0);  // undeformed: only the viscous part works
  const Vec3 spin(3, -2, 7);
  for (std::size_t i = 0; i < rest->phyxelCount(); ++i) body.state().velocities[i] = spin.cross(rest->positions[i]);
  shapes::evaluate(body);
  CHECK(largest(body.forces()) < 1e-10 * 6000.0 * 1e-4);
}

TEST_CASE("the largest frequency is that of the stiffest mode and follows the root of E over density") {
  auto rest = shapes::restState(shapes::box(Vec3(0, 0, 0), Vec3(0.06, 0.06, 0.06)), 0.01);
  const Constitution softer{{Material{}}, kCloudStabilisation},
      stiffer{{Material{.youngsModulus = 600000.0}}, kCloudStabilisation};
  const Body soft("soft", rest, softer, serialFor()), stiff("stiff", rest, stiffer, serialFor());
  CHECK_THAT(soft.stableStepAtRest() / stiff.stableStepAtRest(), WithinRel(10.0, 1e-6));
  // Around the time a pressure wave needs for a spacing.
  const Material &m = soft.material();
  const double wave = std::sqrt((m.lambda() + 2.0 * m.mu()) / m.restDensity);
  CHECK(soft.stableStepAtRest() > 0.5 * rest->spacing / wave);
  CHECK(soft.stableStepAtRest() < 3.0 * rest->spacing / wave);
}
