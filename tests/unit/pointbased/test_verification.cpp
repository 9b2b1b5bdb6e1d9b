// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "lattice_cases.h"
#include "pointbased/verification.h"
#include "support/catch.h"

using namespace pointbased;
using lattice_cases::rotation;

namespace {

constexpr double kWidth = 0.04, kLength = 0.2;

/// A body in its own simulator, with its recipe.
struct Bench {
  BodyShape shape =
      lattice_cases::box(Vec3(0, -0.5 * kWidth, -0.5 * kWidth), Vec3(kLength, 0.5 * kWidth, 0.5 * kWidth));
  BodyRecipe recipe{.sampling = {.spacing = kWidth / 3}};
  Material material{.youngsModulus = 1e4, .poissonRatio = 0.3, .restDensity = 1000.0};
  WorldSettings world{.integrator = Integrator::quasiStatic};
  Simulator simulator;
  std::size_t id = 0;

  Bench &hold() {
    recipe.fixes.push_back({.region = BoxRegion{Vec3(-1e-7, -1, -1), Vec3(1e-7, 1, 1)}});
    return *this;
  }
  Bench &pull(const Vec3 &force) {
    recipe.loads.push_back(
        {.region = BoxRegion{Vec3(kLength - 1e-7, -1, -1), Vec3(kLength + 1e-7, 1, 1)}, .force = force});
    return *this;
  }
  Bench &build() {
    simulator.setWorld(world);
    id = simulator.addBody(shapes::makeBody(shapes::restState(shape, recipe), {material}, "bar"));
    return *this;
  }
  Bench &solve() {
    build();
    while (!simulator.finished())
      if (const auto done = simulator.step(); !done) throw std::runtime_error(done.error().text);
    return *this;
  }
  Bench &run(double until) {
    while (simulator.time() < until)
      if (const auto done = simulator.step(); !done) throw std::runtime_error(done.error().text);
    return *this;
  }
  [[nodiscard]] Body &body() { return *simulator.body(id); }
  [[nodiscard]] Result<Verification> verified(const VerifyProgress &progress = {}, const StopRequest *stop = nullptr,
                                              const VerifySettings &settings = {}) {
    return verify(verificationTarget(simulator, id), shape, recipe, serialFor(), progress, stop, settings);
  }
};

Verification good(Result<Verification> result) {
  INFO((result ? std::string() : result.error()));
  REQUIRE(result);
  return std::move(*result);
}

std::string said(const Verification &verified) {
  std::string out;
  for (const std::string &limit : verified.limits) out += limit + "\n";
  return out;
}

}  // namespace

TEST_CASE("verify: a bar that is stretched evenly has no error but the give of its support", "[verify]") {
  Bench bench;
  bench.material.poissonRatio = 0.0;
  bench.hold().pull(Vec3(1.0, 0, 0)).solve();
  const Verification verified = good(bench.verified());
  CHECK(verified.largestDisplacement > 0.01);
  // A patch yields by σ d/(60 E), 1/900 of the displacement, more at its rim, where a phyxel carries less of it.
  CHECK(verified.percent(verified.errorMax) < 0.5);
  CHECK(verified.percent(verified.errorRms) < 0.15);
  CHECK(verified.fineReferencePhyxels > 5 * verified.phyxels);
  CHECK_THAT(verified.fineReferenceSpacing, WithinRel(0.5 * verified.spacing, 1e-12));
  REQUIRE(verified.reactions.size() == 1);
  CHECK_THAT(verified.reactions[0].force[0], WithinRel(-1.0, 1e-4));
  CHECK_THAT(verified.fineReferenceReactions[0].force[0], WithinRel(-1.0, 1e-4));
  CHECK(verified.limits.empty());
}

TEST_CASE("verify: the error of a bent bar is that against a lattice of a quarter of the spacing", "[verify]") {
  Bench bench;
  bench.hold().pull(Vec3(0, 0, -1.6e-3)).solve();
  const Verification verified = good(bench.verified());
  const double coarse = verified.elasticEnergy;
  const VerifySettings finer{.refinement = 4.0};
  const Verification truth = good(bench.verified({}, nullptr, finer));
  // Its factor is for halves: of quarters the difference is 15/16 of the error.
  const double error = truth.errorRms * (16.0 / 15.0) / errorOverDifference(kFineReferenceRefinement);
  CHECK(verified.errorRms < 1.5 * error);
  CHECK(verified.errorRms > error / 1.5);
  CHECK(verified.errorMax >= verified.error95);
  CHECK(verified.error95 > 0.0);
  CHECK(verified.skinErrors.size() == bench.shape.surface.positions.size());
  CHECK(std::abs(verified.fineReferenceElasticEnergy / coarse - 1.0) < 0.05);
}

TEST_CASE("verify: a body that is only moved has no error", "[verify]") {
  Bench bench;
  bench.world.integrator = Integrator::explicitVerlet;
  bench.world.gravity = Vec3(0, 0, -9.81);
  bench.build();
  const Mat3 turn = rotation(1, 50.0);
  for (std::size_t i = 0; i < bench.body().rest().phyxelCount(); ++i) {
    const Vec3 &X = bench.body().rest().positions[i];
    bench.body().state().displacements[i] = turn * X + Vec3(0.3, 0.1, 0.2) - X;
  }
  const Verification verified = good(bench.verified());
  CHECK(verified.errorMax < 1e-6 * kLength);
  CHECK(verified.largestDisplacement < 1e-6 * kLength);
}

TEST_CASE("verify: a free body that swings keeps its place, and its error falls with the spacing", "[verify]") {
  const auto errorAt = [](int layers) {
    Bench bench;
    bench.recipe.sampling.spacing = kWidth / layers;
    bench.world.integrator = Integrator::explicitVerlet;
    bench.build();
    for (std::size_t i = 0; i < bench.body().rest().phyxelCount(); ++i) {
      // Approximately its first bending mode.
      const double x = bench.body().rest().positions[i][0] / kLength;
      bench.body().state().velocities[i] = Vec3(0, 0, 0.2 * (std::cos(2.0 * EIGEN_PI * x) - 0.1));
    }
    bench.run(0.1);
    const Verification verified = good(bench.verified());
    CHECK(verified.limits.size() == 1);
    // The centre of mass does not move.
    Vec3 coarse = Vec3::Zero(), fine = Vec3::Zero();
    double mass = 0.0, fineMass = 0.0;
    const RestState &rest = bench.body().rest(), &fineReference = *verified.fineReferenceRest;
    for (std::size_t i = 0; i < rest.phyxelCount(); ++i) {
      coarse += rest.volumes[i] * (rest.origin + rest.positions[i] + bench.body().state().displacements[i]);
      mass += rest.volumes[i];
    }
    for (std::size_t j = 0; j < fineReference.phyxelCount(); ++j) {
      fine += fineReference.volumes[j] *
              (fineReference.origin + fineReference.positions[j] + verified.fineReferenceDisplacements[j]);
      fineMass += fineReference.volumes[j];
    }
    CHECK((coarse / mass - fine / fineMass).norm() < 0.02 * verified.largestDisplacement);
    return verified.percent(verified.errorRms);
  };
  const double three = errorAt(3), five = errorAt(5);
  CHECK(three < 10.0);
  CHECK(five < 0.7 * three);
}

TEST_CASE("verify: what lies on a floor leaves its load there", "[verify]") {
  for (const Integrator integrator : {Integrator::explicitVerlet, Integrator::quasiStatic}) {
    Bench bench;
    bench.shape = lattice_cases::box(Vec3(-0.05, -0.05, 0.0), Vec3(0.05, 0.05, 0.1));
    bench.recipe.sampling.spacing = 0.1 / 5;
    bench.world = {.gravity = Vec3(0, 0, -1.0),
                   .box = {.enabled = true, .min = Vec3(-1, -1, 0), .max = Vec3(1, 1, 1)},
                   .integrator = integrator,
                   .damping = 20.0};
    if (integrator == Integrator::quasiStatic)
      bench.solve();
    else
      bench.build().run(1.0);
    const Verification verified = good(bench.verified());
    INFO((integrator == Integrator::quasiStatic ? "static" : "explicit"));
    // ρ g H²/2E = 0.5 mm, minus its mean.
    CHECK(verified.largestDisplacement > 0.2e-3);
    CHECK(verified.largestDisplacement < 0.5e-3);
    CHECK(verified.percent(verified.errorRms) < 10.0);
    CHECK(verified.limits.empty() == (integrator == Integrator::quasiStatic));
  }
}

TEST_CASE("verify: what lies on an edge neither slides nor tips over", "[verify]") {
  Bench bench;
  bench.recipe.sampling.spacing = kWidth / 2;
  bench.world = {.gravity = Vec3(0, 0, -5.0), .integrator = Integrator::explicitVerlet, .damping = 20.0};
  // A table below 3/5 of the bar; the rest overhangs.
  Obstacle table;
  table.name = "table";
  table.friction = 0.8;
  const double edge = 0.6 * kLength, top = -0.5 * kWidth;
  table.closest = [=](std::span<const Vec3> points, std::span<const double>, std::span<SurfacePoint> out) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 over(points[i][0] - edge, 0.0, points[i][2] - top);
      if (over[0] > 0.0 && over[2] > 0.0)
        out[i] = {over.normalized(), over.norm()};
      else
        out[i] = over[0] > over[2] ? SurfacePoint{Vec3::UnitX(), over[0]} : SurfacePoint{Vec3::UnitZ(), over[2]};
    }
  };
  bench.build();
  bench.simulator.addObstacle(table);
  bench.run(1.5);
  const Verification verified = good(bench.verified());
  CHECK(said(verified).find("only contact holds it") != std::string::npos);
  // Two layers: the overhanging end sinks, by slightly too little.
  CHECK(verified.largestDisplacement > 2e-3);
  CHECK(verified.percent(verified.error95) < 25.0);
  CHECK(verified.percent(verified.error95) > 0.5);
}

TEST_CASE("verify: plastic strain and relaxing stress are taken as they are, and it says so", "[verify]") {
  Bench bench;
  bench.world.integrator = Integrator::implicitSdirk;
  bench.world.damping = 5.0;
  bench.material.plastic = {.yield = 0.01, .creep = 0.5, .max = 0.2};
  bench.hold().pull(Vec3(0, 0, -0.02)).build().run(0.3);
  const Verification verified = good(bench.verified());
  CHECK(verified.limits.size() == 2);
  CHECK(verified.percent(verified.errorRms) < 10.0);
}

TEST_CASE("verify: the shadow of a cloud is a lattice", "[verify]") {
  Bench bench;
  bench.recipe.evaluation = Evaluation::phyxels;
  bench.recipe.neighbors = NeighborChoice{};
  bench.hold().pull(Vec3(0, 0, -1.6e-3)).solve();
  const Verification verified = good(bench.verified());
  CHECK(verified.fineReferenceRest->evaluation == Evaluation::stressPoints);
  // The reference value is 2.035 mm (truths.json, beam_shear): the reported error is that of the cloud.
  const double tip = 2.035e-3;
  CHECK_THAT(verified.largestDisplacement, WithinRel(tip, 0.03));
}

TEST_CASE("verify: where half the spacing is too much, two thirds tell about the same", "[verify]") {
  Bench bench;
  bench.hold().pull(Vec3(0, 0, -1.6e-3)).solve();
  const VerifySettings few{.maxPhyxels = 1000};
  const Verification half = good(bench.verified()), twoThirds = good(bench.verified({}, nullptr, few));
  CHECK_THAT(twoThirds.fineReferenceSpacing, WithinRel(bench.recipe.sampling.spacing / 1.5, 1e-12));
  CHECK(said(twoThirds).find("1.5 times finer") != std::string::npos);
  CHECK(said(half).find("times finer") == std::string::npos);
  // Errors of displacements are reported within a factor of 1.5, here as well.
  CHECK_THAT(twoThirds.error95 / half.error95, WithinRel(1.0, 0.5));
}

TEST_CASE("verify: what cannot be verified is refused, and nothing has changed", "[verify]") {
  Bench bench;
  bench.hold().pull(Vec3(0, 0, -1.6e-3)).solve();
  const std::uint64_t before = bench.simulator.stateHash();
  const auto refusal = [](const Result<Verification> &result) { return result ? std::string() : result.error(); };
  CHECK(refusal(bench.verified([](double, const std::string &) { return false; })) == "cancelled");
  // Also during its solution.
  CHECK(refusal(bench.verified([](double fraction, const std::string &) { return fraction < 0.3; })) == "cancelled");
  struct Raised final : StopRequest {
    [[nodiscard]] bool isRaised() const noexcept override { return true; }
  } raised;
  CHECK(refusal(bench.verified({}, &raised)) == "cancelled");
  const VerifySettings few{.maxPhyxels = 300};
  CHECK_THAT(refusal(bench.verified({}, nullptr, few)),
             Contains("phyxels at a spacing of 8.89 mm; accepted: at most 300"));
  REQUIRE(bench.verified());
  CHECK(bench.simulator.stateHash() == before);
  bench.body().stopped = GuardFinding{3, "a quantity", "help"};
  CHECK_THAT(refusal(bench.verified()), Contains("has stopped"));
  bench.body().stopped.reset();
  bench.simulator.world().setRigid(bench.id, true);
  CHECK_THAT(refusal(bench.verified()), Contains("rigid"));
}

TEST_CASE("verify: the same for any division of the loops", "[verify]") {
  Bench bench;
  bench.hold().pull(Vec3(0, 0, -1.6e-3)).solve();
  const VerificationTarget standing = verificationTarget(bench.simulator, bench.id);
  const auto one = verify(standing, bench.shape, bench.recipe, serialFor());
  const auto other = verify(standing, bench.shape, bench.recipe, lattice_cases::threadedFor(3));
  REQUIRE(one);
  REQUIRE(other);
  CHECK(one->fineReferenceDisplacements == other->fineReferenceDisplacements);
  CHECK(one->errorMax == other->errorMax);
}

TEST_CASE("the fine reference of a body of second order is of second order, whatever its recipe asks for") {
  Bench bench;
  bench.recipe.sampling.axes = rotation(0, 20) * rotation(1, 35);
  bench.recipe.sampling.order = LatticeOrder::quadratic;
  bench.hold().pull(Vec3(0, 0, -1e-3)).solve();
  REQUIRE(!bench.body().rest().stencils.quadratic.points.empty());
  bench.recipe.sampling.order = LatticeOrder::linear;
  const Verification verified = good(bench.verified());
  REQUIRE(verified.fineReferenceRest);
  CHECK(!verified.fineReferenceRest->stencils.quadratic.points.empty());
}
