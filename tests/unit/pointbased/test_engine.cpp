// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "pointbased/engine.h"
#include "shapes.h"
#include "support/catch.h"

using namespace pointbased;

namespace {

Body makeBody(std::shared_ptr<const RestState> rest, MaterialLaw law, double stabilisation = kCloudStabilisation,
              double youngsModulus = 6000.0, double viscosity = 0.0) {
  Material material;
  material.law = law;
  material.youngsModulus = youngsModulus;
  material.viscosity = viscosity;
  return Body("test", std::move(rest), Constitution{{material}, stabilisation}, serialFor());
}

std::vector<std::shared_ptr<const RestState>> clouds() {
  std::vector<Vec3> plane, line, thick;
  shapes::Random random(11);
  for (int y = 0; y < 7; ++y)
    for (int x = 0; x < 7; ++x) plane.push_back(0.01 * Vec3(x + 0.2 * random(), y, 0.4 * y));
  for (int x = 0; x < 9; ++x) line.push_back(0.01 * Vec3(x + 0.2 * random(), 0.0, 0.0));
  for (int i = 0; i < 120; ++i) thick.push_back(0.03 * random.vector());
  return {shapes::restState(shapes::box(Vec3(0, 0, 0), Vec3(0.06, 0.04, 0.04)), 0.01),
          shapes::restState(shapes::horseshoe(), 0.03),
          shapes::restState(thick, 0.01, {20, 1.8}),
          shapes::restState(plane, 0.01, {12, 1.8}),
          shapes::restState(line, 0.01, {4, 1.8}),
          shapes::restState(std::vector<Vec3>{Vec3(0, 0, 0), Vec3(0.01, 0, 0)}, 0.01),
          shapes::restState(std::vector<Vec3>{Vec3(0, 0, 0)}, 0.01)};
}

void displace(Body &body, const std::function<Vec3(const Vec3 &)> &to) {
  for (std::size_t i = 0; i < body.rest().phyxelCount(); ++i)
    body.state().displacements[i] = to(body.rest().positions[i]) - body.rest().positions[i];
}

double largestForce(const Body &body) {
  double largest = 0.0;
  for (const Vec3 &f : body.forces()) largest = std::max(largest, f.norm());
  return largest;
}

}  // namespace

TEST_CASE("a rigid motion of any body gives no force") {
  const Mat3 R = Eigen::AngleAxisd(1.9, Vec3(0.3, -1.0, 0.7).normalized()).toRotationMatrix();
  for (const auto &rest : clouds())
    for (const MaterialLaw law : {MaterialLaw::stVenantKirchhoff, MaterialLaw::neoHookean}) {
      Body body = makeBody(rest, law);
      displace(body, [&](const Vec3 &X) -> Vec3 { return R * X + Vec3(3.0, -1.0, 0.5); });
      shapes::evaluate(body);
      CHECK(largestForce(body) < 1e-10 * body.material().youngsModulus * rest->spacing * rest->spacing);
      for (const Mat3 &F : body.gradients()) CHECK(greenStrain(F).norm() < 1e-10);
    }
}

TEST_CASE("an affine motion is reproduced exactly, energy included") {
  Mat3 A;
  A << 1.2, 0.1, -0.05, 0.0, 0.9, 0.2, 0.1, 0.0, 1.1;
  for (const MaterialLaw law : {MaterialLaw::stVenantKirchhoff, MaterialLaw::neoHookean}) {
    Body body = makeBody(shapes::restState(shapes::horseshoe(), 0.02), law);
    displace(body, [&](const Vec3 &X) -> Vec3 { return A * X; });
    shapes::evaluate(body);
    for (const Mat3 &F : body.gradients()) CHECK((F - A).norm() < 1e-11);
    const ElasticEnergy energy = body.elasticEnergy();
    // The energy of the requested Young's modulus, on the body's own volume.
    CHECK_THAT(energy.strain, WithinRel(body.rest().shapeVolume * energyDensity(body.material(), A), 1e-10));
    CHECK(energy.stabilisation < 1e-20);
  }
}

TEST_CASE("internal forces and torques sum to zero for random displacements") {
  for (const auto &rest : clouds())
    for (const MaterialLaw law : {MaterialLaw::stVenantKirchhoff, MaterialLaw::neoHookean}) {
      Body body = makeBody(rest, law);
      shapes::Random random(3);
      for (Vec3 &u : body.state().displacements) u = 0.3 * rest->spacing * random.vector();
      shapes::evaluate(body);
      Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
      double scale = 0.0;
      for (std::size_t i = 0; i < rest->phyxelCount(); ++i) {
        const Vec3 x = rest->positions[i] + body.state().displacements[i];
        force += body.forces()[i];
        torque += x.cross(body.forces()[i]);
        scale += body.forces()[i].norm();
      }
      const double length = 10.0 * rest->spacing;
      CHECK(force.norm() <= 1e-13 * scale);
      CHECK(torque.norm() <= 1e-12 * scale * length);
    }
}

TEST_CASE("the force is the negative gradient of the energy") {
  for (const auto &rest : clouds()) {
    if (rest->phyxelCount() < 2) continue;
    for (const MaterialLaw law : {MaterialLaw::stVenantKirchhoff, MaterialLaw::neoHookean}) {
      Body body = makeBody(rest, law, 0.2);
      shapes::Random random(5);
      const Mat3 R = Eigen::AngleAxisd(0.8, Vec3(1, 1, 0).normalized()).toRotationMatrix();
      for (std::size_t i = 0; i < rest->phyxelCount(); ++i)
        body.state().displacements[i] =
            R * (1.1 * rest->positions[i]) - rest->positions[i] + 0.1 * rest->spacing * random.vector();
      CHECK(shapes::forceError(body, 1e-4 * rest->spacing) < 1e-6);
    }
  }
}

TEST_CASE("viscous stress takes energy from a deformation and leaves a rotation alone") {
  auto rest = shapes::restState(shapes::box(Vec3(0, 0, 0), Vec3(0.05, 0.05, 0.05)), 0.01);
  Body body = makeBody(rest, MaterialLaw::neoHookean, 0.0, 6000.0, 3.0);
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
  CHECK(largestForce(body) < 1e-10 * 6000.0 * 1e-4);
}

TEST_CASE("the largest frequency is that of the stiffest mode and follows the root of E over density") {
  auto rest = shapes::restState(shapes::box(Vec3(0, 0, 0), Vec3(0.06, 0.06, 0.06)), 0.01);
  const Body soft = makeBody(rest, MaterialLaw::neoHookean);
  const Body stiff = makeBody(rest, MaterialLaw::neoHookean, kCloudStabilisation, 600000.0);
  CHECK_THAT(soft.stableStepAtRest() / stiff.stableStepAtRest(), WithinRel(10.0, 1e-6));
  // Around the time a pressure wave needs for a spacing.
  const Material &m = soft.material();
  const double wave = std::sqrt((m.lambda() + 2.0 * m.mu()) / m.restDensity);
  CHECK(soft.stableStepAtRest() > 0.5 * rest->spacing / wave);
  CHECK(soft.stableStepAtRest() < 3.0 * rest->spacing / wave);
}

TEST_CASE("the same bits come out however the loops are divided") {
  const ParallelFor backwards = [](std::size_t n, std::size_t grain,
                                   const std::function<void(std::size_t, std::size_t)> &body) {
    for (std::size_t end = n; end > 0;) {
      const std::size_t begin = end > grain ? end - grain : 0;
      body(begin, end);
      end = begin;
    }
  };
  auto rest = shapes::restState(shapes::ball(Vec3(0, 0, 0), 0.05), 0.01);
  Body a = makeBody(rest, MaterialLaw::neoHookean), b = makeBody(rest, MaterialLaw::neoHookean);
  shapes::Random random(2);
  for (std::size_t i = 0; i < rest->phyxelCount(); ++i)
    a.state().displacements[i] = b.state().displacements[i] = 0.002 * random.vector();
  shapes::evaluate(a);
  b.computeGradients(backwards);
  b.computeStresses(0.0, backwards);
  b.computeForces(0.0, backwards);
  for (std::size_t i = 0; i < rest->phyxelCount(); ++i) CHECK(a.forces()[i] == b.forces()[i]);
}
