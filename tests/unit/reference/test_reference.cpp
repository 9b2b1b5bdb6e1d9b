// SPDX-License-Identifier: Apache-2.0
// The reference itself, by properties that are not among its formulas.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "clouds.h"
#include "reference/surfel.h"
#include "support/catch.h"

using namespace clouds;
using reference::Material;

namespace {

constexpr double kSpacing = 0.01;  // m

// The thesis except for the strain of (6.4), whose force is not the gradient of an energy.
Errata literalOf63() {
  Errata errata = Errata::literal();
  errata.printedStrain = false;
  return errata;
}

void shake(Body &body, double amplitude) {
  Random random(2);
  for (Vec3 &u : body.u) u = amplitude * random.vector();
  reference::computeForces(body);
}

// Largest difference of -dU/du, by central differences of fourth order, from the force, relative to the largest force.
double forceError(Body &body, double h) {
  double error = 0.0;
  for (std::size_t i = 0; i < body.X.size(); i += 3)
    for (int c = 0; c < 3; ++c) {
      const double at = body.u[i][c];
      const auto energyAt = [&](double shift) {
        body.u[i][c] = at + shift;
        return reference::elasticEnergy(body);
      };
      const double slope = (8.0 * (energyAt(h) - energyAt(-h)) - (energyAt(2 * h) - energyAt(-2 * h))) / (12.0 * h);
      body.u[i][c] = at;
      error = std::max(error, std::abs(slope + body.force[i][c]));
    }
  return error / largest(body.force);
}

}  // namespace

TEST_CASE("the kernel integrates to one") {
  for (const double h : {0.02, 3.0}) {
    double sum = 0.0;
    constexpr int kSteps = 2000;
    for (int i = 0; i < kSteps; ++i) {
      const double r = h * (i + 0.5) / kSteps;
      sum += 4.0 * EIGEN_PI * r * r * reference::poly6(r, h) * h / kSteps;
    }
    CHECK_THAT(sum, WithinRel(1.0, 1e-5));  // midpoint rule
    CHECK(reference::poly6(h, h) == 0.0);
  }
}

TEST_CASE("the material is isotropic, and a bar in tension answers with Young's modulus") {
  const Material material{6000.0, 0.3, 1000.0, 0.0, {}};
  Mat3 e;
  e << 0.1, 0.02, -0.03, 0.02, -0.05, 0.04, -0.03, 0.04, 0.2;
  const Mat3 R = rotation(0.9, Vec3(1, 2, -1));
  const Mat3 turned = reference::stress(material, R * e * R.transpose());
  CHECK((turned - R * reference::stress(material, e) * R.transpose()).norm() < 1e-12 * turned.norm());
  const Mat3 uniaxial = reference::stress(material, Vec3(0.01, -0.003, -0.003).asDiagonal());
  CHECK_THAT(uniaxial(0, 0), WithinRel(60.0, 1e-12));
  CHECK(std::abs(uniaxial(1, 1)) < 1e-12);
}

TEST_CASE("linear displacements are reproduced exactly") {
  Mat3 A;
  A << 1.2, 0.1, -0.05, 0.0, 0.9, 0.2, 0.1, 0.0, 1.1;
  for (const Errata &errata : {Errata::literal(), Errata::corrected()}) {
    Body cube = body(block(4, 4, 4, kSpacing, 0.1), kSpacing, 26, errata);
    deform(cube, [&](const Vec3 &X) -> Vec3 { return A * X + Vec3(1, 2, 3); });
    for (const Mat3 &J : cube.J) CHECK((J - A).norm() < 1e-11);
  }
}

TEST_CASE("forces and torques sum to zero, literal and corrected") {
  Material material{6000.0, 0.3, 1000.0, 2000.0, {}};
  for (const Errata &errata : {Errata::literal(), Errata::corrected()}) {
    Body cube = body(block(4, 4, 4, kSpacing, 0.1), kSpacing, 26, errata, material);
    shake(cube, 0.2 * kSpacing);
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    for (std::size_t i = 0; i < cube.X.size(); ++i) {
      force += cube.force[i];
      torque += (cube.X[i] + cube.u[i]).cross(cube.force[i]);
    }
    CHECK(force.norm() < 1e-12 * largest(cube.force));
    CHECK(torque.norm() < 1e-12 * largest(cube.force) * 4 * kSpacing);
  }
}

TEST_CASE("the force is the negative gradient of the energy, its volume part included") {
  const Material material{6000.0, 0.3, 1000.0, 2000.0, {}};
  for (const Errata &errata : {literalOf63(), Errata::corrected()}) {
    Body cube = body(block(4, 4, 4, kSpacing, 0.1), kSpacing, 26, errata, material);
    shake(cube, 0.1 * kSpacing);
    // Fourth order: truncation below 1e-9, cancellation 1e-16 U/(f h) about 1e-10.
    CHECK(forceError(cube, 1e-3 * kSpacing) < 1e-8);
  }
}

TEST_CASE("the completion of a flat sheet keeps the force the gradient of the energy") {
  Body sheet = body(block(5, 5, 1, kSpacing), kSpacing, 12, Errata::corrected());
  shake(sheet, 0.1 * kSpacing);
  for (const int rank : sheet.rank) CHECK(rank == 2);
  CHECK(forceError(sheet, 1e-3 * kSpacing) < 1e-8);
}

TEST_CASE("a rigid motion of any corrected cloud gives no force") {
  const Mat3 R = rotation(1.9, Vec3(0.3, -1.0, 0.7));
  const std::vector<Vec3> shapes[] = {block(4, 4, 4, kSpacing, 0.1), block(5, 5, 1, kSpacing),
                                      block(7, 1, 1, kSpacing)};
  for (const std::vector<Vec3> &points : shapes) {
    Body cloud = body(points, kSpacing, 6, Errata::corrected());
    deform(cloud, [&](const Vec3 &X) -> Vec3 { return R * X + Vec3(0.3, -0.1, 0.2); });
    CHECK(largest(cloud.force) < 1e-11 * 6000.0 * kSpacing * kSpacing);
  }
}

TEST_CASE("densities come out about that of the material, and volume is mass over density") {
  const Body cube = body(block(8, 8, 8, kSpacing), kSpacing, 26, Errata::literal());
  double mean = 0.0;
  for (std::size_t i = 0; i < cube.X.size(); ++i) {
    mean += cube.density[i] / static_cast<double>(cube.X.size());
    CHECK_THAT(cube.volume[i] * cube.density[i], WithinRel(cube.mass[i], 1e-12));
  }
  // s is a mean of reciprocals, which is not the reciprocal of the mean.
  CHECK_THAT(mean, WithinRel(1000.0, 0.1));
}

TEST_CASE("surfels follow an affine motion exactly") {
  Mat3 A;
  A << 1.2, 0.1, -0.05, 0.0, 0.9, 0.2, 0.1, 0.0, 1.1;
  Body cube = body(block(4, 4, 4, kSpacing, 0.1), kSpacing, 26, Errata::corrected());
  const auto motion = [&](const Vec3 &X) -> Vec3 { return A * X + Vec3(1, 2, 3); };
  deform(cube, motion);
  for (const Vec3 &X : {Vec3(0, 0, 0), Vec3(0.045, 0.02, 0.01), Vec3(0.2, 0.2, 0.2)})
    CHECK((X + reference::surfelDisplacement(cube, X) - motion(X)).norm() < 1e-11);
}

TEST_CASE("velocity Verlet keeps the momentum of a vibrating body") {
  Body cube = body(block(4, 4, 4, kSpacing), kSpacing, 26, Errata::corrected());
  shake(cube, 0.05 * kSpacing);
  for (Vec3 &v : cube.velocity) v = Vec3(0.1, 0.2, -0.3);
  const auto momentum = [&] {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < cube.X.size(); ++i) sum += cube.mass[i] * cube.velocity[i];
    return sum;
  };
  const Vec3 before = momentum();
  for (int i = 0; i < 100; ++i) reference::step(cube, 5e-4);
  CHECK((momentum() - before).norm() < 1e-12 * before.norm());
}
