// SPDX-License-Identifier: Apache-2.0
#include "pointbased/adaptive_sampling.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lattice_cases.h"
#include "pointbased/simulator.h"
#include "pointbased/stop_request.h"
#include "support/catch.h"
#include "surfaces.h"

using namespace pointbased;
using Catch::Matchers::Contains;

namespace {

constexpr double kEdge = 0.1;  // m, of the block
const Vec3 kMiddle(0.05, 0.05, 0.07);

/// A block fixed at its lower face; a small ball inside it is displaced sideways.
struct LedBlock {
  BodyShape shape = shapes::box(Vec3::Zero(), Vec3::Constant(kEdge), 8);
  BodyRecipe recipe{.fixes = {{.region = HalfSpaceRegion{Vec3::Zero(), Vec3::UnitZ()}},
                              {.region = SphereRegion{kMiddle, 0.012}, .displacement = Vec3(0.01, 0, 0)}}};
  Constitution constitution{{{.youngsModulus = 1e4, .poissonRatio = 0.45}}, kLatticeStabilisation};
  explicit LedBlock(std::size_t count) { recipe.sampling.count = count; }
  [[nodiscard]] AccuracyProblem problem() const { return {shape, recipe, constitution}; }
  [[nodiscard]] AdaptiveSampling adapted(const ParallelFor &parallelFor = serialFor()) const {
    auto out = adaptSampling(problem(), parallelFor);
    REQUIRE(out.has_value());
    return *out;
  }
};

TrialSolution solved(const LedBlock &block, const LatticeSampling &sampling, const SurfacePoints &samples) {
  LedBlock other = block;
  other.recipe.sampling = sampling;
  const auto out = solveTrial(other.problem(), samples, serialFor());
  REQUIRE(out.has_value());
  return *out;
}

Vec3 middleOf(const FinerCells &cells, std::size_t i) {
  const auto &k = cells.places[i];
  return cells.corner + cells.edge * (cells.axes * (Vec3(k[0], k[1], k[2]) + Vec3::Constant(0.5)));
}

class Raised final : public StopRequest {
 public:
  [[nodiscard]] bool isRaised() const noexcept override { return true; }
};

}  // namespace

TEST_CASE("a cell of the list is halved, alone") {
  const BodyShape block = lattice_cases::box(Vec3::Zero(), Vec3::Constant(kEdge));
  LatticeSampling sampling = lattice_cases::withSpacing(0.02);
  sampling.axes = Mat3::Identity();
  const LatticeBody even = lattice_cases::filled(block, sampling);
  sampling.finer = {even.origin + even.corner, Mat3::Identity(), even.spacing, {{2, 2, 2}}, 0.5 * even.spacing};
  const LatticeBody finer = lattice_cases::filled(block, sampling);
  // Its centre is a phyxel; corners on its edges and faces hang on the larger adjacent cells.
  CHECK(finer.positions.size() == even.positions.size() + 1);
  CHECK(finer.stencils.pointCount() == even.stencils.pointCount() + 7);
  CHECK(lattice_cases::consistencyOf(finer).worst() < 1e-11);
  CHECK(sampling.finer.holds(Vec3(0.041, 0.059, 0.05)));
  CHECK_FALSE(sampling.finer.holds(Vec3(0.039, 0.05, 0.05)));
  CHECK_FALSE(sampling.finer.holds(Vec3(1e300, 0.05, 0.05)));
  // Twice as fine as a whole: the cells in its region are finer by the same factor as before.
  sampling.spacing *= 0.5;
  sampling.finer.spacing *= 0.5;
  LatticeSampling twice = sampling;
  twice.finer = {};
  CHECK(lattice_cases::filled(block, sampling).stencils.pointCount() ==
        lattice_cases::filled(block, twice).stencils.pointCount() + 8 * 7);
}

TEST_CASE("cells are halved where a body is led, for as many phyxels and a smaller error") {
  const LedBlock block(2000);
  const AdaptiveSampling adapted = block.adapted();
  REQUIRE(adapted.halved > 0);
  CHECK(adapted.halved < adapted.cells / 5);
  CHECK(adapted.share > 0.72);
  CHECK(adapted.uniform.empty());
  // Many are around the ball, in a tenth of the volume; the others at the edges of the lower face, where the strain is
  // also unbounded.
  std::size_t near = 0;
  for (std::size_t i = 0; i < adapted.halved; ++i)
    near += (middleOf(adapted.sampling.finer, i) - kMiddle).norm() < 0.03 ? 1 : 0;
  CHECK(3 * near > adapted.halved);

  const SurfacePoints samples = skinSamples(block.shape.surface, block.recipe.fixes, 500);
  const TrialSolution even = solved(block, block.recipe.sampling, samples);
  const TrialSolution finer = solved(block, adapted.sampling, samples);
  CHECK(static_cast<double>(finer.phyxels) == Approx(static_cast<double>(even.phyxels)).epsilon(0.1));
  const LatticeSampling fine{.count = 20000};
  const TrialSolution truth = solved(block, fine, samples);
  CHECK(skinDifference(finer, truth) < 0.8 * skinDifference(even, truth));  // 0.72
}

TEST_CASE("where the error is even, cells of one size stay") {
  // A bar that hangs from its whole upper face.
  LedBlock block(1000);
  block.recipe.fixes.resize(1);
  block.recipe.fixes.front().region = HalfSpaceRegion{Vec3(0, 0, kEdge), -Vec3::UnitZ()};
  block.constitution.materials.front().poissonRatio = 0.0;  // no edges that prevent lateral contraction
  const auto adapted =
      adaptSampling({block.shape, block.recipe, block.constitution, {}, Vec3(0, 0, -9.81)}, serialFor());
  REQUIRE(adapted.has_value());
  CHECK(adapted->halved == 0);
  CHECK(adapted->sampling.finer.places.empty());
  CHECK(adapted->sampling.count == 1000);
  CHECK(adapted->sampling.spacing == 0.0);
  CHECK_THAT(adapted->uniform, Contains("too evenly") && Contains("72 % are needed"));
}

TEST_CASE("a spacing that is wished stays that of the coarsest cells") {
  LedBlock block(0);
  block.recipe.sampling.spacing = 0.01;
  const AdaptiveSampling adapted = block.adapted();
  REQUIRE(adapted.halved > 0);
  CHECK(adapted.sampling.spacing == 0.01);
  CHECK(adapted.sampling.finer.edge == Approx(0.01));
  const SurfacePoints samples = skinSamples(block.shape.surface, block.recipe.fixes, 100);
  const auto even = static_cast<double>(solved(block, block.recipe.sampling, samples).phyxels);
  CHECK(static_cast<double>(solved(block, adapted.sampling, samples).phyxels) == Approx(even / 0.6).epsilon(0.1));
}

TEST_CASE("finer cells are the same for any number of threads, and are not sought when nobody wants them") {
  const LedBlock block(1500);
  const AdaptiveSampling once = block.adapted(), again = block.adapted(lattice_cases::threadedFor(3));
  CHECK(once.sampling.finer.places == again.sampling.finer.places);
  CHECK(once.share == again.share);
  const Raised stop;
  CHECK_THROWS_AS(adaptSampling(block.problem(), serialFor(), &stop), Stopped);
}

TEST_CASE("small stiff cells get a little more inertia and their body its long explicit steps") {
  // A stiff shell around the ball, thinner than the cells: halved cells contain more of it and need shorter steps.
  LedBlock block(1500);
  Material stiff = block.constitution.materials.front();
  stiff.youngsModulus = 1000.0 * stiff.youngsModulus;
  block.constitution.materials.push_back(stiff);
  block.recipe.sampling.materials = {{SphereRegion{kMiddle, 0.014}, 1}};
  const AdaptiveSampling adapted = block.adapted();
  REQUIRE(adapted.halved > 0);
  BodyRecipe recipe = block.recipe;
  const auto bodyOf = [&](const LatticeSampling &sampling) {
    recipe.sampling = sampling;
    return Body("b", *buildRestState(block.shape, recipe, {}, serialFor()), block.constitution, serialFor());
  };
  // The predicted step of uniform cells is about that of these cells.
  CHECK(adapted.evenStep == Approx(bodyOf(block.recipe.sampling).stableStepAtRest()).epsilon(0.5));
  Body body = bodyOf(adapted.sampling);
  const double shortStep = body.stableStepAtRest();
  const auto sum = [](std::span<const double> values) { return std::accumulate(values.begin(), values.end(), 0.0); };
  const double mass = sum(body.masses()), weight = sum(body.weights());
  CHECK(body.addedMass() == std::pair(0.0, std::size_t{0}));
  CHECK(std::ranges::equal(body.masses(), body.restMasses()));

  body.scaleMasses(2.0 * shortStep, serialFor());
  CHECK(body.stableStepAtRest() == Approx(2.0 * shortStep).epsilon(0.02));
  const auto [added, phyxels] = body.addedMass();
  double movable = 0.0, more = 0.0;
  for (std::size_t i = 0; i < body.masses().size(); ++i) {
    CHECK(body.masses()[i] >= body.restMasses()[i]);
    if (body.heldMask()[i] != 0) continue;
    movable += body.restMasses()[i];
    more += body.masses()[i] - body.restMasses()[i];
    CHECK(body.inverseMasses()[i] == 1.0 / body.masses()[i]);
    CHECK(body.gravityShares()[i] * body.masses()[i] == Approx(body.weights()[i]));
  }
  CHECK(added == Approx(more));
  CHECK((added > 0.0 && added <= 0.0501 * movable));
  CHECK((phyxels > 0 && phyxels < body.masses().size() / 4));
  CHECK(sum(body.restMasses()) == Approx(mass));
  CHECK(sum(body.weights()) == weight);
  // Lasts, and ends.
  body.setConstitution(Constitution(body.constitution()), serialFor());
  CHECK(body.addedMass().first == Approx(added));
  body.scaleMasses(0.0, serialFor());
  CHECK(body.stableStepAtRest() == shortStep);
  CHECK(sum(body.masses()) == Approx(mass));

  // Never more than a twentieth, however long the requested step. A uniformly stiff body gets no added mass: many cells
  // need the same step.
  body.scaleMasses(1e3 * shortStep, serialFor());
  CHECK(body.addedMass().first <= 0.0501 * movable);
  Body even("e", *buildRestState(block.shape, LedBlock(1500).recipe, {}, serialFor()), LedBlock(1500).constitution,
            serialFor());
  even.scaleMasses(2.0 * even.stableStepAtRest(), serialFor());
  CHECK(even.addedMass().first == 0.0);
}

TEST_CASE("mass scaling changes no weight, and slows a swing by half of the added mass at most") {
  LedBlock block(800);
  Material stiff = block.constitution.materials.front();
  stiff.youngsModulus = 100.0 * stiff.youngsModulus;
  block.constitution.materials.push_back(stiff);
  block.recipe.sampling.materials = {{SphereRegion{Vec3(0.05, 0.05, 0.05), 0.01}, 1}};
  block.recipe.fixes.resize(1);
  // To the first turning point of a standing block that begins to lean: time, s, and distance, m.
  const auto swing = [&](double factor) {
    Simulator simulator;
    simulator.setWorld({.gravity = Vec3(0, 1.0, 0), .integrator = Integrator::explicitVerlet});
    auto body = std::make_unique<Body>("b", *buildRestState(block.shape, block.recipe, {}, serialFor()),
                                       block.constitution, serialFor());
    body->scaleMasses(factor * body->stableStepAtRest(), serialFor());
    CHECK((body->addedMass().first > 0.0) == (factor > 0.0));
    const std::size_t id = simulator.addBody(std::move(body));
    const State &state = simulator.body(id)->state();
    // Of the centre of mass, without the motion of single phyxels.
    const auto meanOf = [&](std::span<const Vec3> field) {
      double sum = 0.0;
      for (const Vec3 &v : field) sum += v.y();
      return sum / static_cast<double>(field.size());
    };
    do REQUIRE(simulator.step());
    while (meanOf(state.velocities) > 0.0);
    return std::pair(simulator.time(), meanOf(state.displacements));
  };
  const auto [time, way] = swing(0.0);
  const auto [laterTime, laterWay] = swing(2.0);
  CHECK(laterTime > time);
  CHECK(laterTime == Approx(time).epsilon(0.025));
  CHECK(laterWay == Approx(way).epsilon(0.01));  // twice the distance to rest, which the weights alone determine
}
