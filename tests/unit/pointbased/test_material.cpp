// SPDX-License-Identifier: Apache-2.0
#include "pointbased/material.h"
#include "shapes.h"
#include "support/catch.h"

using namespace pointbased;

namespace {

Mat3 randomGradient(shapes::Random &random, double size) {
  Mat3 F = Mat3::Identity();
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) F(r, c) += size * random();
  return F;
}

}  // namespace

TEST_CASE("the first Piola stress is the derivative of the energy density") {
  shapes::Random random(1);
  for (const MaterialLaw law : {MaterialLaw::stVenantKirchhoff, MaterialLaw::neoHookean}) {
    const Material material{law, 5000.0, 0.4, 1000.0, 0.0};
    // Sizes up to 1.5 include inverted gradients, where the continuation below kNeoHookeanSwitch is active.
    for (const double size : {0.05, 0.4, 1.5}) {
      for (int sample = 0; sample < 20; ++sample) {
        const Mat3 F = randomGradient(random, size);
        // Central differences jump where the continuation starts: its third derivative does.
        if (std::abs(F.determinant() - kNeoHookeanSwitch) < 1e-3) continue;
        const Mat3 P = firstPiolaStress(material, F);
        const double h = 1e-5;
        for (int c = 0; c < 3; ++c)
          for (int r = 0; r < 3; ++r) {
            Mat3 plus = F, minus = F;
            plus(r, c) += h;
            minus(r, c) -= h;
            const double slope = (energyDensity(material, plus) - energyDensity(material, minus)) / (2.0 * h);
            // Second-order differences at 1e-5 leave about 1e-9 of the largest curvature.
            CHECK_THAT(P(r, c), WithinAbs(slope, 1e-6 * (P.norm() + material.youngsModulus)));
          }
      }
    }
  }
}

TEST_CASE("a rotation has neither stress nor energy") {
  for (const MaterialLaw law : {MaterialLaw::stVenantKirchhoff, MaterialLaw::neoHookean}) {
    const Material material{law, 5000.0, 0.45, 1000.0, 0.0};
    const Mat3 R = Eigen::AngleAxisd(2.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
    CHECK(firstPiolaStress(material, R).norm() < 1e-11 * material.youngsModulus);  // round-off of R^T R
    CHECK(std::abs(energyDensity(material, R)) < 1e-11 * material.youngsModulus);
  }
}

TEST_CASE("a small uniaxial stretch with free sides answers with Young's modulus") {
  // Not with four times the modulus, as in the formulas of the 2004 paper and the thesis.
  for (const MaterialLaw law : {MaterialLaw::stVenantKirchhoff, MaterialLaw::neoHookean}) {
    const Material material{law, 5000.0, 0.3, 1000.0, 0.0};
    const double e = 1e-6;
    Mat3 F = Mat3::Identity();
    F(0, 0) += e;
    F(1, 1) -= 0.3 * e;
    F(2, 2) -= 0.3 * e;
    const Mat3 P = firstPiolaStress(material, F);
    CHECK_THAT(P(0, 0) / e, WithinRel(5000.0, 1e-4));  // second order in e and in the lateral contraction
    CHECK(std::abs(P(1, 1)) < 1e-4 * P(0, 0));
  }
}

TEST_CASE("the neo-Hookean law of a negative Poisson's ratio has the moduli it says and resists any compression") {
  for (const double poisson : {-0.3, -0.9, -0.99}) {
    CAPTURE(poisson);
    const Material material{MaterialLaw::neoHookean, 5000.0, poisson, 1000.0, 0.0};
    // Small strain: lambda and mu, by a stretch along one axis and by one along all.
    const double e = 1e-6;
    const Mat3 along = Vec3(1.0 + e, 1, 1).asDiagonal(), all = (1.0 + e) * Mat3::Identity();
    CHECK_THAT(firstPiolaStress(material, along)(0, 0) / e, WithinRel(material.waveModulus(), 1e-4));
    CHECK_THAT(firstPiolaStress(material, along)(1, 1) / e, WithinRel(material.lambda(), 1e-4));
    CHECK_THAT(firstPiolaStress(material, all)(0, 0) / e, WithinRel(3.0 * material.bulkModulus(), 1e-3));
    // With lambda/2 (ln J)² the pressure of a ball at nu = -0.9 would be largest at 4 % and negative from 8 % on.
    double before = 0.0;
    for (const double s : {0.99, 0.95, 0.9, 0.8, 0.7, 0.65, 0.5, 0.2, 0.05}) {
      const double pressure = -cauchyStress(material, s * Mat3::Identity())(0, 0);
      CHECK(pressure > before);
      before = pressure;
    }
    // The stress and the tangent are derivatives.
    shapes::Random random(4);
    for (int sample = 0; sample < 40; ++sample) {
      const Mat3 F = randomGradient(random, sample % 2 ? 0.4 : 1.5);
      if (std::abs(F.determinant() - kNeoHookeanSwitch) < 1e-3) continue;
      const Mat3 dF = randomGradient(random, 1.0), P = firstPiolaStress(material, F);
      const double h = 1e-5;
      const double slope = (energyDensity(material, F + h * dF) - energyDensity(material, F - h * dF)) / (2.0 * h);
      CHECK_THAT(P.cwiseProduct(dF).sum(), WithinAbs(slope, 1e-5 * (P.norm() + material.youngsModulus)));
    }
  }
  // Identical to the other law at nu = 0.
  const Mat3 F = Vec3(0.7, 1.2, 0.9).asDiagonal();
  const Material zero{MaterialLaw::neoHookean, 5000.0, 0.0, 1000.0, 0.0},
      below{MaterialLaw::neoHookean, 5000.0, -1e-9, 1000.0, 0.0};
  CHECK((firstPiolaStress(zero, F) - firstPiolaStress(below, F)).norm() < 1e-5);
}

TEST_CASE("the neo-Hookean law resists collapse and pushes an inverted point back") {
  const Material material{MaterialLaw::neoHookean, 5000.0, 0.45, 1000.0, 0.0};
  double before = 0.0;
  for (const double s : {0.8, 0.4, 0.1, 0.0, -0.5}) {
    const Mat3 F = Vec3(s, 1, 1).asDiagonal();
    const double stress = firstPiolaStress(material, F)(0, 0);
    CHECK(std::isfinite(energyDensity(material, F)));
    CHECK(stress < before);
    before = stress;
  }
}

TEST_CASE("the tangent ratio is one at rest and grows when a body is crushed") {
  const Material material{MaterialLaw::neoHookean, 5000.0, 0.45, 1000.0, 0.0};
  CHECK_THAT(tangentRatio(material, Mat3::Identity()), WithinRel(1.0, 1e-12));
  CHECK(tangentRatio(material, Vec3(0.4, 1, 1).asDiagonal().toDenseMatrix()) > 3.0);
  const Material stvk{MaterialLaw::stVenantKirchhoff, 5000.0, 0.0, 1000.0, 0.0};
  // d(stretch stress)/d(stretch) of StVK at stretch 2 is (3 * 4 - 1) / 2 = 5.5 times that at rest.
  CHECK(tangentRatio(stvk, Vec3(2, 1, 1).asDiagonal().toDenseMatrix()) >= 5.5);
}

TEST_CASE("a material outside what is physical is refused with every reason") {
  const auto bad = validate(Material{MaterialLaw::neoHookean, -1.0, 0.5, 0.0, -2.0});
  REQUIRE_FALSE(bad);
  CHECK_THAT(bad.error(),
             Contains("Young's modulus") && Contains("-1 < nu < 0.5") && Contains("density") && Contains("viscosity"));
  CHECK_FALSE(validate(Material{MaterialLaw::neoHookean, std::nan(""), 0.3, 1000.0, 0.0}));
  CHECK(validate(Material{}));
}
