// SPDX-License-Identifier: Apache-2.0
#include "pointbased/plasticity.h"

#include <Eigen/LU>

#include "gradients.h"
#include "support/catch.h"

using namespace pointbased;
using namespace gradients;

namespace {

constexpr double kDt = 1.0 / 240.0;

Mat3 extension(double stretch) {  // volume-preserving
  return Vec3(stretch, 1.0 / std::sqrt(stretch), 1.0 / std::sqrt(stretch)).asDiagonal();
}
Mat3 pureShear(double s) { return Vec3(std::exp(s), std::exp(-s), 1.0).asDiagonal(); }

double plasticNorm(const Mat3 &plasticInverse) { return henckyStrain(plasticInverse.transpose()).norm(); }

Material neoHookean() { return Material{MaterialLaw::neoHookean, 6000.0, 0.4, 1000.0, 0.0}; }

}  // namespace

TEST_CASE("what cannot flow is elastic bit for bit") {
  shapes::Random random(41);
  const double inf = Plasticity::kNever;
  for (const Plasticity &plastic : {Plasticity{}, Plasticity{inf, 1.0, 0.01, inf}, Plasticity{0.0, 0.0, 0.01, inf},
                                    Plasticity{0.0, 1.0, 0.01, 0.0}}) {
    CHECK_FALSE(plastic.enabled());
    Mat3 inverse = Mat3::Identity();
    for (int k = 0; k < 20; ++k) CHECK_FALSE(plasticFlow(plastic, stretched(random, 3.0), 1.0, inverse));
    CHECK(inverse == Mat3::Identity());
    const Mat3 F = stretched(random, 2.0);
    CHECK(elastoplasticStress(neoHookean(), F, inverse) == firstPiolaStress(neoHookean(), F));
    CHECK(elastoplasticEnergyDensity(neoHookean(), F, inverse) == energyDensity(neoHookean(), F));
  }
  CHECK(Plasticity{0.0, 1.0, 0.01, 1.0}.enabled());
}

TEST_CASE("below yield nothing flows, above it something does") {
  const Plasticity plastic{0.1, 0.5, 0.01, Plasticity::kNever};
  for (const double s : {0.0, 0.01, 0.05, 0.0999}) {
    Mat3 inverse = Mat3::Identity();
    CHECK_FALSE(plasticFlow(plastic, pureShear(s / std::sqrt(2.0)), kDt, inverse));
    CHECK(inverse == Mat3::Identity());
    CHECK_FALSE(plasticFlow(plastic, 1.7 * pureShear(s / std::sqrt(2.0)), kDt, inverse));  // swelling is no deviator
  }
  for (const double s : {0.1001, 0.2, 1.5}) {
    Mat3 inverse = Mat3::Identity();
    FlowResult result;
    CHECK(plasticFlow(plastic, pureShear(s / std::sqrt(2.0)), kDt, inverse, &result));
    const double share = 1.0 - std::pow(0.5, kDt / 0.01);
    CHECK_THAT(result.flowed, WithinRel(share * (s - 0.1), 1e-9));
    CHECK_THAT(plasticNorm(inverse), WithinRel(share * (s - 0.1), 1e-9));
    CHECK_THAT(result.plasticStrain, WithinRel(plasticNorm(inverse), 1e-9));
    CHECK_THAT(deviatoricHenckyNorm(pureShear(s / std::sqrt(2.0)) * inverse), WithinRel(result.elasticStrain, 1e-12));
  }
  Mat3 inverse = Mat3::Identity();
  CHECK_FALSE(plasticFlow(plastic, pureShear(1.0), 0.0, inverse));
}

TEST_CASE("the norms are those of the closed forms") {
  CHECK_THAT(deviatoricHenckyNorm(extension(1.7)), WithinRel(std::sqrt(1.5) * std::log(1.7), 1e-12));
  CHECK_THAT(deviatoricHenckyNorm(2.0 * pureShear(0.3)), WithinRel(std::sqrt(2.0) * 0.3, 1e-12));
  // Simple shear stretches by exp(± asinh(g/2)).
  CHECK_THAT(deviatoricHenckyNorm(shear(0.9)), WithinRel(std::sqrt(2.0) * std::asinh(0.45), 1e-12));
  CHECK(std::isnan(deviatoricHenckyNorm(Vec3(1, 1, -1).asDiagonal())));
}

TEST_CASE("loading, unloading and reloading follow perfect plasticity in tension and shear") {
  const double yield = 0.08;
  const Plasticity plastic{yield, 1.0, 0.01, Plasticity::kNever};
  struct Mode {
    Mat3 (*at)(double);  // of a logarithmic strain
    double factor;       // norm per strain
  };
  const Mode modes[] = {{[](double e) { return extension(std::exp(e)); }, std::sqrt(1.5)}, {pureShear, std::sqrt(2.0)}};
  for (const Mode &mode : modes) {
    const double yieldStrain = yield / mode.factor;
    Mat3 inverse = Mat3::Identity();
    double flowed = 0.0, expectedPlastic = 0.0;
    // To 0.5, back through 0.5 - 2 yield (elastic) to 0.1 (flows backwards), to 0.3 again.
    double e = 0.0;
    for (const double target : {0.5, 0.5 - 1.9 * yieldStrain, 0.1, 0.3}) {
      const double from = e;
      for (int k = 1; k <= 200; ++k) {
        e = from + (target - from) * k / 200.0;
        FlowResult result;
        plasticFlow(plastic, mode.at(e), kDt, inverse, &result);
        flowed += result.flowed / mode.factor;
        // Elastic strain stays within ± yield of the plastic one.
        expectedPlastic = std::min(std::max(expectedPlastic, e - yieldStrain), e + yieldStrain);
        const Mat3 elastic = mode.at(e) * inverse;
        REQUIRE(deviatoricHenckyNorm(elastic) <= yield * (1.0 + 1e-10));
        REQUIRE((inverse - mode.at(-expectedPlastic)).norm() < 1e-12 * 200);  // round-off of as many steps
      }
      e = target;
    }
    // The remaining deformation after release: the stress-free state is the plastic one.
    CHECK_THAT(expectedPlastic, WithinRel(0.3 - yieldStrain, 1e-12));
    CHECK(elastoplasticStress(neoHookean(), mode.at(expectedPlastic), inverse).norm() < 1e-9 * 6000.0);
    const double there = 0.5 - yieldStrain, back = 0.5 - 0.1 - 2.0 * yieldStrain, again = 0.3 - 0.1 - 2.0 * yieldStrain;
    CHECK_THAT(flowed, WithinRel(there + back + again, 1e-9));
  }
}

TEST_CASE("simple shear never holds more than the yield stress") {
  const double yield = 0.05;
  const Plasticity plastic{yield, 1.0, 0.01, Plasticity::kNever};
  const Material material = neoHookean();
  Mat3 inverse = Mat3::Identity();
  for (int k = 1; k <= 600; ++k) {
    const Mat3 F = shear(0.005 * k);
    plasticFlow(plastic, F, kDt, inverse);
    const Mat3 Fe = F * inverse;
    REQUIRE(deviatoricHenckyNorm(Fe) <= yield * (1.0 + 1e-10));
    if (k < 100) continue;
    // Elastic stretches e^±s, s = yield/sqrt(2), when the flow has settled: Kirchhoff shear mu (e^2s - e^-2s)/2.
    const Mat3 kirchhoff = elastoplasticStress(material, F, inverse) * F.transpose();
    const double limit = material.mu() * std::sinh(2.0 * yield / std::sqrt(2.0));
    CHECK(kirchhoff(0, 1) <= limit * (1.0 + 1e-9));
    CHECK(kirchhoff(0, 1) > 0.99 * limit);  // its axes lag behind by about half the yield strain, squared
  }
}

TEST_CASE("without yield and with creep one no force against a change of shape remains") {
  shapes::Random random(42);
  const Plasticity plastic{0.0, 1.0, 0.01, Plasticity::kNever};
  for (const MaterialLaw law : kObjectiveLaws) {
    Material material = neoHookean();
    material.law = law;
    Mat3 inverse = Mat3::Identity();
    for (int k = 0; k < 30; ++k) {
      const Mat3 F = stretched(random, 1.8);
      CHECK(plasticFlow(plastic, F, kDt, inverse));
      const Mat3 kirchhoff = elastoplasticStress(material, F, inverse) * F.transpose();
      const Mat3 deviator = kirchhoff - kirchhoff.trace() / 3.0 * Mat3::Identity();
      CHECK(deviator.norm() < 1e-9 * (kirchhoff.norm() + material.youngsModulus));
    }
  }
}

TEST_CASE("flow keeps the volume over 100 000 random steps") {
  shapes::Random random(43);
  for (const double max : {Plasticity::kNever, 0.7}) {
    const Plasticity plastic{0.02, 0.7, 0.004, max};
    Mat3 inverse = Mat3::Identity();
    double worst = 0.0;
    int flows = 0;
    Mat3 F = Mat3::Identity();
    for (int k = 0; k < 100000; ++k) {
      if (k % 4 == 0) F = stretched(random, 1.7);
      flows += plasticFlow(plastic, F, kDt, inverse);
      worst = std::max(worst, std::abs(inverse.determinant() - 1.0));
    }
    CHECK(flows > 90000);
    CHECK(worst < 1e-14 * 100);  // round-off of one determinant of stretched entries, not of the steps before
    CHECK(plasticNorm(inverse) < (max < Plasticity::kNever ? max + 1e-9 : 3.0));
  }
}

TEST_CASE("how much flows does not depend on the step") {
  for (const double creep : {0.05, 0.5, 0.95}) {
    const Plasticity plastic{0.03, creep, 1.0 / 60.0, Plasticity::kNever};
    // Constant: exact.
    const auto held = [&](int steps) {
      Mat3 inverse = Mat3::Identity();
      for (int k = 0; k < steps; ++k) plasticFlow(plastic, shear(0.4), 0.05 / steps, inverse);
      return inverse;
    };
    CHECK((held(1) - held(10)).norm() < 1e-12);
    CHECK((held(1) - held(1000)).norm() < 1e-11);
    // Moving, 1/60 s against a tenth: within one per cent at the end of a shear to and fro.
    const auto moved = [&](int perFrame) {
      Mat3 inverse = Mat3::Identity();
      const int steps = 60 * perFrame;
      for (int k = 1; k <= steps; ++k)
        plasticFlow(plastic, shear(0.8 * std::sin(2.5 * k / steps)), 1.0 / steps, inverse);
      return inverse;
    };
    // Backward Euler of the excess: an error of half a step's motion, 1/120 s, which strong creep notices most.
    const Mat3 coarse = moved(4), fine = moved(40);
    CHECK((coarse - fine).norm() < 0.01 * (fine - Mat3::Identity()).norm());
  }
}

TEST_CASE("flow never gives energy") {
  shapes::Random random(44);
  // The corotated law loses its force on the path to collapse, where stretch and stress no longer have the same order.
  struct Range {
    MaterialLaw law;
    double stretch;
  };
  for (const Range &range : {Range{MaterialLaw::corotated, 1.1}, Range{MaterialLaw::neoHookean, 1.5}})
    for (const double max : {Plasticity::kNever, 0.3}) {
      Material material = neoHookean();
      material.law = range.law;
      const Plasticity plastic{0.05, 0.6, 0.01, max};
      Mat3 inverse = Mat3::Identity();
      double dissipated = 0.0;
      for (int k = 0; k < 2000; ++k) {
        const Mat3 F = stretched(random, range.stretch);
        const double before = elastoplasticEnergyDensity(material, F, inverse);
        plasticFlow(plastic, F, kDt, inverse);
        const double loss = before - elastoplasticEnergyDensity(material, F, inverse);
        CHECK(loss >= -1e-11 * (before + material.youngsModulus));
        dissipated += loss;
      }
      CHECK(dissipated > 0.0);
    }
}

TEST_CASE("the plastic strain stops at its cap, and what goes beyond is elastic again") {
  const Plasticity plastic{0.02, 1.0, 0.01, 0.15};
  Mat3 inverse = Mat3::Identity();
  FlowResult result;
  for (int k = 1; k <= 100; ++k) plasticFlow(plastic, pureShear(0.005 * k), kDt, inverse, &result);
  CHECK(result.capped);
  CHECK_THAT(plasticNorm(inverse), WithinRel(0.15, 1e-9));
  CHECK_THAT(deviatoricHenckyNorm(pureShear(0.5) * inverse), WithinRel(std::sqrt(2.0) * 0.5 - 0.15, 1e-9));
  CHECK_THAT(result.elasticStrain, WithinRel(std::sqrt(2.0) * 0.5 - 0.15, 1e-9));
}

TEST_CASE("flow does not see a rotation of space") {
  shapes::Random random(45);
  const Plasticity plastic{0.05, 0.6, 0.01, 0.5};
  Mat3 still = Mat3::Identity(), turned = Mat3::Identity();
  for (int k = 0; k < 50; ++k) {
    const Mat3 F = stretched(random, 1.4), Q = rotation(random);
    plasticFlow(plastic, F, kDt, still);
    plasticFlow(plastic, Q * F, kDt, turned);
    CHECK((still - turned).norm() < 1e-10);
    const Mat3 P = elastoplasticStress(neoHookean(), F, still);
    CHECK((elastoplasticStress(neoHookean(), Q * F, turned) - Q * P).norm() < 1e-7 * 6000.0);
    CHECK((P * F.transpose() - F * P.transpose()).norm() < 1e-9 * 6000.0);
  }
}

TEST_CASE("inverted, flat and broken points do not flow") {
  const Plasticity plastic{0.0, 1.0, 0.01, Plasticity::kNever};
  for (const Mat3 &F : {Mat3(Vec3(1, 1, -1).asDiagonal()), Mat3(Vec3(1, 1, 0).asDiagonal()), Mat3(Mat3::Zero()),
                        Mat3(Vec3(1, 1, 0.5 * kSmallestFlowRatio).asDiagonal()), Mat3(Mat3::Constant(std::nan("")))}) {
    Mat3 inverse = Mat3::Identity();
    CHECK_FALSE(plasticFlow(plastic, F, kDt, inverse));
    CHECK(inverse == Mat3::Identity());
  }
}

TEST_CASE("stress, energy and differential of a body that has flowed belong together") {
  shapes::Random random(46);
  for (const MaterialLaw law : kLaws) {
    Material material = neoHookean();
    material.law = law;
    const Plasticity plastic{0.02, 1.0, 0.01, 0.4};
    for (int k = 0; k < 10; ++k) {
      Mat3 inverse = Mat3::Identity();
      plasticFlow(plastic, stretched(random, 1.5), kDt, inverse);
      const Mat3 F = stretched(random, 1.5), d = any(random);
      const Mat3 P = elastoplasticStress(material, F, inverse);
      const double h = 1e-5;
      const double slope = (elastoplasticEnergyDensity(material, F + h * d, inverse) -
                            elastoplasticEnergyDensity(material, F - h * d, inverse)) /
                           (2.0 * h);
      CHECK_THAT(dot(P, d), WithinAbs(slope, 1e-6 * (P.norm() + 6000.0)));  // h² of the third derivative
      const Mat3 dP = elastoplasticStressDifferential(material, F, inverse, d);
      const Mat3 difference =
          (elastoplasticStress(material, F + h * d, inverse) - elastoplasticStress(material, F - h * d, inverse)) /
          (2.0 * h);
      CHECK((dP - difference).norm() < 1e-6 * (dP.norm() + 6000.0));
      CHECK(elastoplasticTangentRatio(material, F, inverse) >= 1.0);
    }
  }
}
