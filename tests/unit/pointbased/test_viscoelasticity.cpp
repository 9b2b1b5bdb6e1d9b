// SPDX-License-Identifier: Apache-2.0
#include "pointbased/viscoelasticity.h"

#include <Eigen/LU>
#include <Eigen/SVD>

#include "gradients.h"
#include "support/catch.h"

using namespace pointbased;
using namespace gradients;

namespace {

constexpr double kPi = 3.14159265358979323846;

Material relaxing(MaterialLaw law, std::array<PronyTerm, 2> prony, double nu = 0.45) {
  Material m{law, 6000.0, nu, 1060.0, 0.0};
  m.prony = prony;
  return m;
}

constexpr std::array<PronyTerm, 2> kOneTerm{PronyTerm{0.4, 5.0}, PronyTerm{}};
constexpr std::array<PronyTerm, 2> kTwoTerms{PronyTerm{0.3, 0.05}, PronyTerm{0.25, 2.0}};

// G(t)/G0
double relaxation(const std::array<PronyTerm, 2> &prony, double t) {
  double g = 1.0;
  for (const PronyTerm &term : prony)
    if (term.share > 0.0) g -= term.share * (1.0 - std::exp(-t / term.time));
  return g;
}

// The relaxing part of the instantaneous stress, from its closed form.
Mat3 relaxingPart(const Material &material, const Mat3 &F) {
  const double mu = material.mu();
  const auto deviator = [](const Mat3 &e) { return Mat3(e - e.trace() / 3.0 * Mat3::Identity()); };
  switch (material.law) {
    case MaterialLaw::linear: return mu * deviator(F + F.transpose());
    case MaterialLaw::stVenantKirchhoff: return 2.0 * mu * F * deviator(greenStrain(F));
    case MaterialLaw::corotated: {
      const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);  // det F > 0
      const Mat3 R = svd.matrixU() * svd.matrixV().transpose();
      return 2.0 * mu * R * deviator(R.transpose() * F);
    }
    case MaterialLaw::custom:
    case MaterialLaw::neoHookean: break;
  }
  return mu * deviator(F * F.transpose()) * F.inverse().transpose();
}

// P at the end of a path F(t) from rest, in equal steps.
template <class Path>
Mat3 stressAfter(const Material &material, Path &&path, double duration, int steps) {
  PronyPoint point;
  Mat3 P = pronyStress(material, path(0.0), 0.0, point, point);
  for (int k = 1; k <= steps; ++k)
    P = pronyStress(material, path(duration * k / steps), duration / steps, point, point);
  return P;
}

}  // namespace

TEST_CASE("a held strain relaxes as G(t) says, whatever the step") {
  for (const auto &prony : {kOneTerm, kTwoTerms})
    for (const MaterialLaw law : kLaws) {
      const Material material = relaxing(law, prony);
      const Mat3 F =
          law == MaterialLaw::linear ? Mat3(shear(0.02)) : Mat3(shear(0.6) * Vec3(1.1, 0.8, 1.05).asDiagonal());
      const Mat3 instant = firstPiolaStress(material, F);
      const Mat3 deviator = relaxingPart(material, F);
      for (const double t : {0.0, 0.01, 0.5, 5.0, 1000.0})
        for (const int steps : {1, 7, 100}) {
          const Mat3 P = stressAfter(
              material, [&](double) { return F; }, t, steps);
          const Mat3 expected = instant - (1.0 - relaxation(prony, t)) * deviator;
          // The recursion is exact for a constant strain: round-off.
          CHECK((P - expected).norm() < 1e-12 * instant.norm());
        }
    }
}

TEST_CASE("shearing at a constant rate has the closed form of linear viscoelasticity") {
  const Material material = relaxing(MaterialLaw::linear, kTwoTerms);
  const double rate = 0.3, t = 1.7;
  double expected = rate * t;
  for (const PronyTerm &term : kTwoTerms)
    expected -= term.share * rate * (t - term.time * (1.0 - std::exp(-t / term.time)));
  for (const int steps : {1, 10, 333}) {
    // Exact for a stress that is linear in time.
    const Mat3 P = stressAfter(
        material, [&](double s) { return shear(rate * s); }, t, steps);
    CHECK_THAT(P(0, 1), WithinRel(material.mu() * expected, 1e-12));
  }
}

TEST_CASE("a strain that swings costs what the loss modulus says") {
  const double size = 0.01, duration = 40.0;
  for (const MaterialLaw law : {MaterialLaw::linear, MaterialLaw::neoHookean})
    for (const double omega : {0.2, 2.0 * kPi / 5.0, 20.0}) {
      const Material material = relaxing(law, kTwoTerms);
      double loss = 0.0, storage = 1.0;
      for (const PronyTerm &term : kTwoTerms) {
        const double wt = omega * term.time;
        loss += term.share * wt / (1.0 + wt * wt);
        storage -= term.share / (1.0 + wt * wt);
      }
      // After the transient has decayed, one period of 400 steps.
      const double period = 2.0 * kPi / omega, dt = period / 400.0;
      const int before = 400 * static_cast<int>(std::ceil(duration / period));
      PronyPoint point;
      double work = 0.0, inPhase = 0.0;
      Mat3 P = Mat3::Zero();
      for (int k = 1; k <= before + 400; ++k) {
        const double strain = size * std::sin(omega * k * dt), last = size * std::sin(omega * (k - 1) * dt);
        const Mat3 old = P;
        P = pronyStress(material, shear(strain), dt, point, point);
        if (k <= before) continue;
        work += 0.5 * (P(0, 1) + old(0, 1)) * (strain - last);
        inPhase += P(0, 1) * std::sin(omega * k * dt) * 2.0 / 400.0;
      }
      // (omega dt)²/12 = 2e-5 of a trapezoidal sum; strain² = 1e-4 of the neo-Hookean law.
      CHECK_THAT(work, WithinRel(kPi * material.mu() * loss * size * size, 1e-3));
      CHECK_THAT(inPhase, WithinRel(material.mu() * storage * size, 1e-3));
    }
}

TEST_CASE("relaxation is of second order in the step and hardly depends on it") {
  for (const MaterialLaw law : kObjectiveLaws) {
    const Material material = relaxing(law, kTwoTerms);
    const auto path = [](double t) {
      return Mat3(shear(0.5 * std::sin(3.0 * t)) * Vec3(1.0 + 0.2 * t, 1.0 - 0.1 * t * t, 1.0).asDiagonal());
    };
    const Mat3 fine = stressAfter(material, path, 1.0, 20000);
    const double at50 = (stressAfter(material, path, 1.0, 50) - fine).norm();
    const double at100 = (stressAfter(material, path, 1.0, 100) - fine).norm();
    const double at200 = (stressAfter(material, path, 1.0, 200) - fine).norm();
    CHECK(at50 < 0.01 * fine.norm());
    CHECK_THAT(at50 / at100, WithinAbs(4.0, 0.3));  // and the next power of the step
    CHECK_THAT(at100 / at200, WithinAbs(4.0, 0.2));
  }
}

TEST_CASE("time that stands still relaxes nothing, and without terms the elastic stress comes out bit for bit") {
  const Material material = relaxing(MaterialLaw::neoHookean, kTwoTerms);
  PronyPoint point, next;
  (void)pronyStress(material, shear(0.4), 0.3, point, point);
  const Mat3 P = pronyStress(material, shear(0.4), 0.0, point, next);
  CHECK(next.internal[0] == point.internal[0]);
  CHECK(next.internal[1] == point.internal[1]);
  CHECK(next.previous == point.previous);
  CHECK(P == pronyStress(material, shear(0.4), 0.0, next, next));
  const Material elastic = relaxing(MaterialLaw::neoHookean, {});
  CHECK(pronyStress(elastic, shear(0.4), 0.3, PronyPoint(), next) == firstPiolaStress(elastic, shear(0.4)));
  // And the instantaneous response to a jump is the elastic one.
  CHECK(pronyStress(material, shear(0.4), 0.0, PronyPoint(), next) == firstPiolaStress(material, shear(0.4)));
}

TEST_CASE("steps of any length are stable and end at the long-term stress") {
  for (const MaterialLaw law : kObjectiveLaws) {
    const Material material = relaxing(law, {PronyTerm{0.6, 1e-3}, PronyTerm{0.399, 10.0}});
    const Mat3 F = shear(0.8);
    const Mat3 instant = firstPiolaStress(material, F);
    for (const double dt : {1.0, 1e3, 1e9}) {
      PronyPoint point;
      Mat3 P;
      for (int k = 0; k < 200; ++k) P = pronyStress(material, F, dt, point, point);
      CHECK((P - (instant - 0.999 * relaxingPart(material, F))).norm() < 1e-8 * instant.norm());
    }
  }
}

TEST_CASE("a change of volume does not relax") {
  for (const MaterialLaw law : kLaws) {
    Material material = relaxing(law, kTwoTerms);
    material.volumeStiffness = 2000.0;
    const Mat3 F = 0.9 * Mat3::Identity();
    const Mat3 P = stressAfter(
        material, [&](double) { return F; }, 100.0, 10);
    CHECK((P - firstPiolaStress(material, F)).norm() < 1e-12 * P.norm());
    // Nor does a history of shear leave a pressure: tr(P F^T) of the neo-Hookean law is the elastic one.
    if (law != MaterialLaw::neoHookean) continue;
    PronyPoint point;
    (void)pronyStress(material, shear(0.8), 3.0, point, point);
    const Mat3 G = Vec3(1.3, 0.9, 1.1).asDiagonal();
    CHECK_THAT(dot(pronyStress(material, G, 0.1, point, point), G),
               WithinAbs(dot(firstPiolaStress(material, G), G), 1e-11 * 6000.0));
  }
}

TEST_CASE("relaxation follows a rotation of space and makes no torque") {
  shapes::Random random(31);
  for (const MaterialLaw law : kObjectiveLaws) {
    const Material material = relaxing(law, kTwoTerms);
    PronyPoint still, turned;
    for (int k = 0; k < 30; ++k) {
      const Mat3 F = stretched(random, 1.6), Q = rotation(random);
      const Mat3 P = pronyStress(material, F, 0.1, still, still);
      const Mat3 QP = pronyStress(material, Q * F, 0.1, turned, turned);
      CHECK((QP - Q * P).norm() < 1e-11 * (P.norm() + 6000.0));
      const Mat3 kirchhoff = P * F.transpose();
      CHECK((kirchhoff - kirchhoff.transpose()).norm() < 1e-11 * (P.norm() + 6000.0));
    }
    // A rotation from rest stays stress-free.
    PronyPoint point;
    for (int k = 0; k < 20; ++k)
      CHECK(pronyStress(material, rotation(random), 0.1, point, point).norm() < 1e-11 * 6000.0);
  }
}

TEST_CASE("no closed loop of strain gives work back") {
  shapes::Random random(32);
  for (const MaterialLaw law : kLaws)
    for (int loop = 0; loop < 30; ++loop) {
      const Material material = relaxing(law, kTwoTerms);
      const double largest = law == MaterialLaw::linear ? 0.02 : 0.25, duration = std::pow(10.0, 1.5 * random());
      Mat3 a = any(random), b = any(random);
      const auto path = [&](double s) {  // starts and ends at rest
        const double w = 2.0 * kPi * s;
        const Mat3 shape = std::sin(w) * a + (1.0 - std::cos(w)) * 0.5 * b + std::sin(2 * w) * 0.3 * (a - b);
        return Mat3(Mat3::Identity() + largest * shape);
      };
      const int steps = 400;
      PronyPoint point;
      Mat3 P = Mat3::Zero(), F = Mat3::Identity();
      double work = 0.0, turnover = 0.0;
      for (int k = 1; k <= steps; ++k) {
        const Mat3 nextF = path(static_cast<double>(k) / steps);
        const Mat3 nextP = pronyStress(material, nextF, duration / steps, point, point);
        const double part = 0.5 * dot(P + nextP, nextF - F);
        work += part;
        turnover += std::abs(part);
        F = nextF;
        P = nextP;
      }
      CHECK(turnover > 0.0);
      CHECK(work > -1e-3 * turnover);  // trapezoidal sum of 400 steps
    }
}

TEST_CASE("the algorithmic differential is the derivative of the relaxing stress") {
  shapes::Random random(33);
  for (const MaterialLaw law : kLaws)
    for (const double dt : {0.0, 0.01, 3.0})
      for (int k = 0; k < 12; ++k) {
        Material material = relaxing(law, kTwoTerms, 0.4);
        material.volumeStiffness = 500.0;
        PronyPoint past;
        (void)pronyStress(material, stretched(random, 1.5), 0.4, past, past);
        // The last third is in the range where the neo-Hookean drive fades, one of them inverted.
        const Mat3 F = k < 8 ? stretched(random, 1.6) : Mat3(withStretches(random, {0.9, 1.1, k == 11 ? -0.3 : 0.12}));
        const Mat3 dF = any(random);
        const PronyStep step = pronyStep(material, dt);
        PronyPoint at, unused;
        (void)pronyStress(material, step, F, past, at);
        const Mat3 dP = pronyStressDifferential(material, step, F, at, dF);
        const double h = 1e-6;
        const Mat3 slope = (pronyStress(material, step, F + h * dF, past, unused) -
                            pronyStress(material, step, F - h * dF, past, unused)) /
                           (2.0 * h);
        CHECK((dP - slope).norm() < 2e-6 * (dP.norm() + material.youngsModulus));  // h² of third derivatives
        // Symmetric, as conjugate gradients require; the neo-Hookean law's only for steps that are short against the
        // times.
        if (dt > 0.0 && law == MaterialLaw::neoHookean) continue;
        const Mat3 B = any(random);
        const Mat3 dB = pronyStressDifferential(material, step, F, at, B);
        CHECK(std::abs(dot(dP, B) - dot(dF, dB)) < 1e-10 * (dP.norm() + dB.norm()));
      }
}

TEST_CASE("an inverted relaxing point stays finite, forgets and recovers") {
  shapes::Random random(34);
  const Material material = relaxing(MaterialLaw::neoHookean, kTwoTerms, 0.3);
  for (const Vec3 &s : {Vec3(1, 1, -1), Vec3(1, 1, 0), Vec3(0, 0, 0), Vec3(1, 1, 1e-9), Vec3(-2, -1, -0.5)}) {
    PronyPoint point;
    (void)pronyStress(material, stretched(random, 1.8), 1.0, point, point);
    Mat3 F = Mat3(s.asDiagonal()) + 1e-3 * any(random);
    const double stiffest = 3.0 * material.lambda() + 2.0 * material.mu();
    for (int k = 0; k < 4000; ++k) {
      const Mat3 P = pronyStress(material, F, 0.01, point, point);
      REQUIRE(P.allFinite());
      F -= 0.3 / (stiffest * tangentRatio(material, F)) * P;
    }
    CHECK(F.determinant() > 0.99);
    CHECK(greenStrain(F).norm() < 0.01);
  }
}
