// SPDX-License-Identifier: Apache-2.0
// Cells that flow and relax by vector kernels, against the scalar engine.
#include <cmath>

#include "support/catch.h"
#include "vector_cases.h"

using namespace vector_cases;

namespace {

constexpr double kStep = 2e-3;  // s

struct Memory {
  const char *name;
  bool flows;
  int terms;
};
constexpr Memory kMemories[] = {
    {"plastic", true, 0}, {"one term", false, 1}, {"two terms", false, 2}, {"plastic, two terms", true, 2}};

Material materialOf(MaterialLaw law, const Memory &memory) {
  Material m = vector_cases::materialOf(law);
  if (memory.flows) m.plastic = {.yield = 0.04, .creep = 0.8, .max = 0.3};
  if (memory.terms > 0) m.prony[0] = {0.4, 0.01};
  if (memory.terms > 1) m.prony[1] = {0.2, 0.1};
  return m;
}

void evaluateByStages(Body &body, double dt) {
  body.computeGradients(serialFor());
  if (dt > 0.0) body.computeFlow(dt, serialFor());
  body.computeStresses(dt, serialFor());
  body.computeForces(0.0, serialFor());
}

// Largest difference of all numbers of two histories over the largest number.
template <class Records>
double differenceOf(const Records &a, const Records &b) {
  REQUIRE(a.size() == b.size());
  if (a.empty()) return 0.0;
  const std::size_t numbers = a.size() * sizeof(a[0]) / sizeof(double);
  const auto *x = reinterpret_cast<const double *>(a.data()), *y = reinterpret_cast<const double *>(b.data());
  double most = 0.0, off = 0.0;
  for (std::size_t i = 0; i < numbers; ++i) {
    most = std::max(most, std::abs(y[i]));
    // A NaN must not be lost.
    if (!(std::abs(x[i] - y[i]) <= off)) off = std::abs(x[i] - y[i]);
  }
  return off / most;
}
double differenceOf(const PointHistory &a, const PointHistory &b) {
  return std::max({differenceOf(a.plasticInverse, b.plasticInverse), differenceOf(a.prony, b.prony),
                   differenceOf(a.modes, b.modes)});
}

bool sameBits(const PointHistory &a, const PointHistory &b) { return differenceOf(a, b) == 0.0; }

}  // namespace

TEST_CASE("cells flow and relax over many steps as by the scalar engine", "[kernels]") {
  for (const Case &c : bodies())
    for (const MaterialLaw law : kLaws)
      for (const Memory &memory : kMemories)
        for (const double stabilisation : {kLatticeStabilisation, 0.0}) {
          Material m = materialOf(law, memory);
          m.viscosity = 20.0;
          const Constitution constitution{{m}, stabilisation};
          Body fast("b", c.rest, constitution, serialFor()), plain("b", c.rest, constitution, serialFor());
          REQUIRE(fast.vectorised());
          CHECK_FALSE(fast.vectorisedTangent());
          INFO(c.name << ", law " << static_cast<int>(law) << ", " << memory.name << ", stabilisation "
                      << stabilisation);
          support::Random random(17);
          for (int step = 0; step < 12; ++step) {
            for (Body *body : {&fast, &plain}) {
              deform(*body, 0.02 * step, 0.1, static_cast<std::uint64_t>(7 + step / 4));
              for (Vec3 &v : body->state().velocities) v.setZero();
            }
            for (std::size_t i = 0; i < c.rest->phyxelCount(); ++i)
              fast.state().velocities[i] = plain.state().velocities[i] = random.vector();
            const double dt = step % 5 == 4 ? 0.0 : kStep * (1 + step % 3);
            fast.evaluate(0.0, dt, serialFor());
            evaluateByStages(plain, dt);
            // Round-off of strains of 0.1, over moduli ten times that of shear.
            CHECK(relativeDifference(plain.forces(), fast.forces()) < 1e-11);
            CHECK(differenceOf(fast.state().history, plain.state().history) < 1e-11);
            CHECK(fast.stableStep() > 0.99 * plain.stableStep());
          }
          const ElasticEnergy byKernels = fast.elasticEnergy(serialFor()), byPoints = plain.elasticEnergy();
          CHECK(byKernels.strain == Approx(byPoints.strain).epsilon(1e-10));
          CHECK(byKernels.stabilisation == Approx(byPoints.stabilisation).epsilon(1e-10));
          // Later reports refer to the end of the step.
          std::vector<Vec3> stresses, others;
          for (std::size_t q = 0; q < c.rest->pointCount(); ++q)
            for (int k = 0; k < 3; ++k) {
              stresses.push_back(fast.stresses()[q].col(k));
              others.push_back(plain.stresses()[q].col(k));
            }
          CHECK(relativeDifference(others, stresses) < 1e-10);
        }
}

TEST_CASE("collapsed and mirrored cells flow and relax as by the scalar engine", "[kernels]") {
  const Case c = bodies()[1];
  for (const MaterialLaw law : kLaws)
    for (const Memory &memory : kMemories) {
      const Constitution constitution{{materialOf(law, memory)}, kLatticeStabilisation};
      Body fast("b", c.rest, constitution, serialFor()), plain("b", c.rest, constitution, serialFor());
      INFO("law " << static_cast<int>(law) << ", " << memory.name);
      for (int step = 0; step < 4; ++step) {
        // J between -1 and 1, smoothly along the body.
        support::Random random(5);
        for (std::size_t i = 0; i < c.rest->phyxelCount(); ++i) {
          const Vec3 &X = c.rest->positions[i];
          fast.state().displacements[i] = plain.state().displacements[i] =
              Vec3(-(10.0 + 3.0 * step) * X.x() * X.x(), 0.1 * X.z(), 0.0) + 1e-4 * random.vector();
        }
        fast.evaluate(0.0, kStep, serialFor());
        evaluateByStages(plain, kStep);
        // Near a singular F the rotation of the corotated law is accurate to fewer digits.
        CHECK(relativeDifference(plain.forces(), fast.forces()) < 1e-8);
        CHECK(differenceOf(fast.state().history, plain.state().history) < 1e-8);
      }
    }
}

TEST_CASE("only the material that flows or relaxes does so", "[kernels]") {
  LatticeSampling sampling{.count = 400};
  sampling.materials.emplace_back(BoxRegion{Vec3(0.115, 0.1, -0.2), Vec3(0.2, 0.3, 0.0)}, std::uint16_t{1});
  const auto rest = latticeBody(shapes::ball(Vec3(0.1, 0.2, -0.1), 0.05), sampling);
  const Material elastic = vector_cases::materialOf(MaterialLaw::corotated);
  // Auxetic: no kernel implements its neo-Hookean energy, the scalar engine computes it.
  Material auxetic = materialOf(MaterialLaw::neoHookean, kMemories[3]);
  auxetic.poissonRatio = -0.3;
  for (const Material &other : {elastic, auxetic}) {
    const Constitution constitution{{materialOf(MaterialLaw::neoHookean, kMemories[3]), other}, kLatticeStabilisation};
    Body fast("b", rest, constitution, serialFor()), plain("b", rest, constitution, serialFor());
    REQUIRE(fast.vectorised());
    for (int step = 0; step < 5; ++step) {
      for (Body *body : {&fast, &plain}) deform(*body, 0.05 * step, 0.05, 3);
      fast.evaluate(0.0, kStep, serialFor());
      evaluateByStages(plain, kStep);
      CHECK(relativeDifference(plain.forces(), fast.forces()) < 1e-11);
      CHECK(differenceOf(fast.state().history, plain.state().history) < 1e-11);
    }
    CHECK(fast.elasticEnergy(serialFor()).strain == Approx(plain.elasticEnergy().strain).epsilon(1e-10));
  }
}

TEST_CASE("memories have the same bits however loops are cut, and on all instruction sets with a fused multiply-add",
          "[kernels]") {
  const InstructionSets sets;
  for (const Case &c : bodies())
    for (const MaterialLaw law : kLaws) {
      const Constitution constitution{{materialOf(law, kMemories[3])}, kLatticeStabilisation};
      const auto run = [&](const ParallelFor &parallelFor) {
        auto body = std::make_unique<Body>("b", c.rest, constitution, serialFor());
        for (int step = 0; step < 5; ++step) {
          deform(*body, 0.05 * step, 0.05, 3);
          body->evaluate(0.0, kStep, parallelFor);
        }
        return body;
      };
      const auto whole = run(serialFor());
      const double energy = whole->elasticEnergy(serialFor()).strain;
      INFO(c.name << ", law " << static_cast<int>(law));
      const auto check = [&](Body &other) {
        CHECK(std::equal(whole->forces().begin(), whole->forces().end(), other.forces().begin()));
        CHECK(other.stableStep() == whole->stableStep());
        CHECK(sameBits(other.state().history, whole->state().history));
        CHECK(other.elasticEnergy(serialFor()).strain == energy);
      };
      check(*run(inPieces()));
      for (const std::int64_t target : sets.fused()) {
        sets.use(target);
        check(*run(serialFor()));
      }
    }
}
