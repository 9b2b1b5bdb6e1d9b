// SPDX-License-Identifier: Apache-2.0
// External material laws: their preconditions, and that a body with one moves as with the built-in law of the core.
#include <algorithm>

#include "pointbased/engine.h"
#include "support/catch.h"
#include "support/outside_law.h"
#include "vector_cases.h"

using namespace vector_cases;
using support::OutsideNeoHookean;

namespace {

const Material &ours() {
  static const Material material = materialOf(MaterialLaw::neoHookean);
  return material;
}

std::shared_ptr<const CheckedLaw> outside(bool bounds) {
  auto law = checked(std::make_shared<OutsideNeoHookean>(ours().lambda(), ours().mu(), bounds));
  if (!law) throw std::runtime_error(law.error());
  return *law;
}

Material theirs(bool bounds = true) {
  Material m = ours();
  setLaw(m, outside(bounds));
  return m;
}

Constitution constitutionOf(const Material &material, const RestState &rest) {
  return {{material}, rest.stencils.isLattice() ? kLatticeStabilisation : kCloudStabilisation};
}

/// A law with one mistake; everything else is correct.
class Wrong : public OutsideNeoHookean {
 public:
  enum class In {
    restEnergy,
    restStress,
    stress,
    differential,
    symmetry,
    linearity,
    objectivity,
    isotropy,
    bounds,
    batches,
    number,
    answer,
    softRest
  };
  explicit Wrong(In in)
      : OutsideNeoHookean(in == In::softRest ? -ours().mu() : ours().lambda(), ours().mu(), true), in_(in) {}

  Result<void> energies(std::span<const Mat3> F, std::span<double> W) const override {
    if (in_ == In::answer) return tl::unexpected<std::string>("the table ends at 1.1");
    auto done = OutsideNeoHookean::energies(F, W);
    for (std::size_t i = 0; i < F.size(); ++i) {
      if (in_ == In::restEnergy) W[i] += 1.0;
      if (in_ == In::objectivity) W[i] += 1e-3 * mu_ * (F[i] - Mat3::Identity()).squaredNorm();
      if (in_ == In::isotropy) W[i] += 1e-3 * mu_ * std::pow(F[i].col(0).squaredNorm() - 1.0, 2);
      if (in_ == In::number && F[i].norm() > 1.9) W[i] = std::nan("");
    }
    return done;
  }
  Result<void> stresses(std::span<const Mat3> F, std::span<Mat3> P) const override {
    auto done = OutsideNeoHookean::stresses(F, P);
    for (std::size_t i = 0; i < F.size(); ++i) {
      if (in_ == In::restStress) P[i] += Mat3::Identity();
      if (in_ == In::stress) P[i] *= 1.001;
      if (in_ == In::batches && F.size() > 1 && i == 0) P[i] *= 1.0 + 1e-15;
    }
    return done;
  }
  Result<void> differentials(std::span<const Mat3> F, std::span<const Mat3> dF, std::span<Mat3> dP) const override {
    auto done = OutsideNeoHookean::differentials(F, dF, dP);
    for (std::size_t i = 0; i < F.size(); ++i) {
      const bool atRest = F[i] == Mat3::Identity();
      if (in_ == In::differential && !atRest) dP[i] *= 1.001;
      if (in_ == In::symmetry && !atRest) dP[i](0, 1) += 1e-7 * mu_ * dF[i](0, 0);
      if (in_ == In::linearity && !atRest) dP[i](0, 0) += 1e-6 * mu_ * dF[i](0, 0) * dF[i](0, 0);
    }
    return done;
  }
  Result<void> bounds(std::span<const Mat3> F, std::span<TangentBound> out) const override {
    auto done = OutsideNeoHookean::bounds(F, out);
    for (TangentBound &b : out)
      if (in_ == In::bounds) b.all *= 0.5;
    return done;
  }

 private:
  In in_;
};

}  // namespace

TEST_CASE("a law from outside that is right is taken, with its moduli at rest", "[law]") {
  for (const bool bounds : {true, false}) {
    const auto law = outside(bounds);
    CHECK(law->lambda() == Approx(ours().lambda()).epsilon(1e-12));
    CHECK(law->mu() == Approx(ours().mu()).epsilon(1e-12));
    CHECK(law->atRest().wave == Approx(ours().waveModulus()).epsilon(1e-12));
    CHECK(law->atRest().all == Approx(3.0 * ours().lambda() + 2.0 * ours().mu()).epsilon(1e-12));
  }
  CHECK(theirs().youngsModulus == Approx(ours().youngsModulus).epsilon(1e-12));
  CHECK(theirs().poissonRatio == Approx(ours().poissonRatio).epsilon(1e-12));
}

TEST_CASE("a law from outside with a mistake is refused with its numbers", "[law]") {
  using In = Wrong::In;
  const std::pair<In, const char *> mistakes[] = {{In::restEnergy, "W(I) = 1 J/m³"},
                                                  {In::restStress, "|P(I)| = 1.73 Pa"},
                                                  {In::stress, "differences of P"},
                                                  {In::differential, "differs from the differences of P"},
                                                  {In::symmetry, "not symmetric"},
                                                  {In::linearity, "not linear"},
                                                  {In::objectivity, "not objective"},
                                                  {In::isotropy, "not isotropic"},
                                                  {In::bounds, "bounds"},
                                                  {In::batches, "otherwise than in a batch"},
                                                  {In::number, "no number"},
                                                  {In::answer, "the table ends at 1.1"},
                                                  {In::softRest, "not stiff at rest"}};
  for (const auto &[in, said] : mistakes) {
    const auto law = checked(std::make_shared<Wrong>(in));
    INFO(said);
    REQUIRE(!law);
    INFO(law.error());
    CHECK(law.error().find(said) != std::string::npos);
    CHECK(law.error().find("law 'neo-Hookean' of 'outside' is not accepted") == 0);
  }
}

TEST_CASE("a law from outside does not combine with what divides a law into parts", "[law]") {
  Material m = theirs();
  CHECK(validate(m));
  m.plastic.yield = 0.1;
  m.plastic.creep = 1.0;
  REQUIRE(!validate(m));
  CHECK(validate(m).error().find("law 'neo-Hookean' of 'outside' does not combine") != std::string::npos);
  m = theirs();
  m.prony[0] = {0.3, 1.0};
  CHECK(!validate(m));
}

TEST_CASE("forces, energies and their changes by a law from outside are those of the core's own", "[law]") {
  for (const bool lattice : {true, false})
    for (const Case &c : lattice ? bodies() : clouds())
      for (const bool more : {false, true}) {
        Material own = ours(), other = theirs();
        if (more) own.viscosity = other.viscosity = 20.0, own.volumeStiffness = other.volumeStiffness = 3e3;
        Body a("a", c.rest, constitutionOf(own, *c.rest), serialFor());
        Body b("b", c.rest, constitutionOf(other, *c.rest), serialFor());
        CHECK(!b.vectorised());
        INFO(c.name << (more ? ", viscous and with volume stiffness" : ""));
        CHECK(b.stableStepAtRest() == Approx(a.stableStepAtRest()).epsilon(1e-6));
        for (Body *body : {&a, &b}) {
          deform(*body, 0.1, 0.02, 7);
          support::Random random(13);
          for (Vec3 &v : body->state().velocities) v = Vec3(1, 2, 3) + random.vector();
          shapes::evaluate(*body);
        }
        // Two forms of one formula: the round-off of sums of terms ten times larger than their difference.
        CHECK(relativeDifference(a.forces(), b.forces()) < 1e-12);
        const ElasticEnergy of = a.elasticEnergy(), other2 = b.elasticEnergy();
        CHECK(other2.strain == Approx(of.strain).epsilon(1e-11));
        CHECK(b.stableStep() <= 1.001 * a.stableStep());

        const StencilSet &s = c.rest->stencils;
        support::Random random(17);
        std::vector<Vec3> du(c.rest->phyxelCount()), one(du.size()), two(du.size());
        for (Vec3 &d : du) d = random.vector();
        TangentScratch scratch;
        const double viscousScale = more ? 60.0 : 0.0;
        for (const auto &[body, df] : {std::pair(&a, &one), std::pair(&b, &two)})
          forceDifferential(body->constitution(), s, c.rest->positions, body->state().displacements, body->gradients(),
                            {}, 0.0, viscousScale, du, scratch, *df, inPieces());
        CHECK(relativeDifference(one, two) < 1e-12);
      }
}

TEST_CASE("a body of a law from outside moves as one of the core's own", "[law]") {
  const bool lattice = GENERATE(true, false);
  const Case c = lattice ? bodies().front() : clouds().front();
  for (const Integrator integrator : {Integrator::explicitVerlet, Integrator::implicitSdirk}) {
    std::vector<Vec3> ends[2];
    for (const bool outsideLaw : {false, true}) {
      Simulator simulator;
      simulator.setWorld({.gravity = Vec3(0, -9.81, 0),
                          .box = {.enabled = true, .min = Vec3(-1.0, 0.145, -1.0)},
                          .integrator = integrator,
                          .dt = integrator == Integrator::explicitVerlet ? 2e-4 : 1.0 / 60.0,
                          .tolerance = 1e-9});
      const auto id = simulator.addBody(
          std::make_unique<Body>("b", c.rest, constitutionOf(outsideLaw ? theirs() : ours(), *c.rest), serialFor()));
      while (simulator.time() < 0.1 - 1e-9) REQUIRE(simulator.step());
      ends[outsideLaw ? 1 : 0] = simulator.body(id)->state().displacements;
      CHECK(!simulator.body(id)->stopped);
    }
    INFO((lattice ? "lattice" : "cloud") << ", integrator " << static_cast<int>(integrator));
    // It falls, touches the floor and is pressed: round-off grows by contact, to far below a micrometre.
    CHECK(largest(ends[0]) > 0.01);
    std::vector<Vec3> off = ends[0];
    for (std::size_t i = 0; i < off.size(); ++i) off[i] -= ends[1][i];
    CHECK(largest(off) < (integrator == Integrator::explicitVerlet ? 1e-10 : 1e-7));
  }
}

TEST_CASE("a body may be of a law from outside in one part and of the core's own in another", "[law]") {
  LatticeSampling sampling{.count = 400};
  sampling.materials.emplace_back(BoxRegion{Vec3(0.1, 0.0, -1.0), Vec3(1.0, 1.0, 1.0)}, std::uint16_t{1});
  const auto rest = latticeBody(shapes::ball(Vec3(0.1, 0.2, -0.1), 0.05), sampling);
  Material second = materialOf(MaterialLaw::corotated);
  Body a("a", rest, Constitution{{ours(), second}, kLatticeStabilisation}, serialFor());
  Body b("b", rest, Constitution{{theirs(), second}, kLatticeStabilisation}, serialFor());
  Body d("d", rest, Constitution{{second, theirs()}, kLatticeStabilisation}, serialFor());
  Body e("e", rest, Constitution{{second, ours()}, kLatticeStabilisation}, serialFor());
  for (Body *body : {&a, &b, &d, &e}) {
    deform(*body, 0.1, 0.02, 7);
    body->evaluate(0.0, 0.0, serialFor());
  }
  CHECK(relativeDifference(a.forces(), b.forces()) < 1e-12);
  CHECK(relativeDifference(d.forces(), e.forces()) < 1e-12);
  CHECK(b.elasticEnergy().strain == Approx(a.elasticEnergy().strain).epsilon(1e-11));
  CHECK(d.elasticEnergy().strain == Approx(e.elasticEnergy().strain).epsilon(1e-11));
}

TEST_CASE("a law from outside that fails stops its body, and the message names it", "[law]") {
  class Tears : public OutsideNeoHookean {
   public:
    Tears() : OutsideNeoHookean(ours().lambda(), ours().mu(), true) {}
    Result<void> stresses(std::span<const Mat3> F, std::span<Mat3> P) const override {
      for (const Mat3 &f : F)
        if (f.norm() > 2.3) return tl::unexpected<std::string>("stretched beyond what was measured");
      return OutsideNeoHookean::stresses(F, P);
    }
  };
  auto law = checked(std::make_shared<Tears>());
  REQUIRE(law);
  Material m = ours();
  setLaw(m, *law);
  const Case c = bodies().front();
  for (const Integrator integrator : {Integrator::explicitVerlet, Integrator::implicitSdirk}) {
    Simulator simulator;
    simulator.setWorld({.integrator = integrator});
    const auto id = simulator.addBody(std::make_unique<Body>("b", c.rest, constitutionOf(m, *c.rest), serialFor()));
    Body &body = *simulator.body(id);
    const Vec3 centre(0.1, 0.2, -0.1);
    for (std::size_t i = 0; i < body.rest().phyxelCount(); ++i)
      body.state().velocities[i] = 100.0 * (body.rest().origin + body.rest().positions[i] - centre);
    for (int i = 0; i < 300 && !body.stopped; ++i)
      if (!simulator.step()) break;
    REQUIRE(body.stopped);
    INFO(body.stopMessage());
    CHECK(body.stopMessage().find("law 'neo-Hookean' of 'outside': the stress: stretched beyond what was measured") !=
          std::string::npos);
  }
}
