// SPDX-License-Identifier: Apache-2.0
// Adjoint sensitivities of static solutions against central differences of solutions.
#include <chrono>
#include <cmath>

#include "lattice_cases.h"
#include "pointbased/equilibrium_sensitivity.h"
#include "shapes.h"
#include "support/catch.h"
#include "surfaces.h"

using namespace pointbased;
using Catch::Matchers::Contains;

namespace {

// Of the parameters of a problem; each enters the solution in one way.
struct Parameters {
  Vec3 force{0.3, -0.9, 0.5};  // N, on the probe
  Vec3 moved{0.004, 0.002, -0.003};
  Vec3 turned{0.02, -0.05, 0.04};  // rad
  double normal = 3e4, tangential = 1e4;
  std::vector<double> moduli{2e4, 6e4};
};

struct Problem {
  const char *name;
  MaterialLaw law = MaterialLaw::neoHookean;
  Evaluation evaluation = Evaluation::stressPoints;
  bool isCutByFix = false, hasFoundation = false;
  double volumeStiffness = 0.0;
};

const Vec3 kProbe(0.11, 0.031, 0.012), kWatched(0.082, 0.012, 0.028);
const Vec3 kDirection(0.4, 1.0, -0.7);
constexpr double kLength = 0.12, kWidth = 0.04;

// A beam of two tissues, of which one end is moved and turned, with a force on its other end.
struct Solved {
  std::unique_ptr<Body> body;
  Interpolation watched;
  double objective = 0.0;  // m², of the displacement of a material point
  std::vector<Vec3> gradient;
};

Environment environmentOf(const ParallelFor &loops, StageClock &clock) {
  return {.gravity = Vec3(0.4, -1.5, 0.8), .tolerance = 1e-13, .parallelFor = &loops, .clock = &clock};
}

std::unique_ptr<Body> bodyOf(const Problem &problem, const Parameters &p) {
  const double border = problem.isCutByFix ? 0.013 : 0.0;
  Fix fix{.region = BoxRegion{Vec3(-1, -1, -1), Vec3(border, 1, 1)}};
  if (problem.evaluation == Evaluation::phyxels) fix.region = BoxRegion{Vec3(-1, -1, -1), Vec3(0.018, 1, 1)};
  fix.displacement = p.moved;
  fix.rotationVector = p.turned;
  fix.centre = Vec3(0.0, 0.02, 0.02);
  BodyRecipe recipe{.evaluation = problem.evaluation, .sampling = {.spacing = 0.0137}, .fixes = {fix}};
  if (problem.evaluation == Evaluation::stressPoints)
    recipe.sampling.materials = {{BoxRegion{Vec3(-1, -1, -1), Vec3(0.05, 1, 0.03)}, 1}};
  recipe.loads.push_back(
      {.region = BoxRegion{Vec3(0.05, 0.03, -1), Vec3(1, 1, 1)}, .pressure = 40.0, .follower = false});
  std::vector<Material> materials;
  for (const double modulus : p.moduli)
    materials.push_back({.law = problem.law,
                         .youngsModulus = modulus,
                         .poissonRatio = 0.38,
                         .volumeStiffness = problem.volumeStiffness});
  auto body = shapes::makeBody(shapes::restState(shapes::box(Vec3::Zero(), Vec3(kLength, kWidth, kWidth), 4), recipe),
                               materials);
  body->quasiStatic = true;
  if (problem.hasFoundation) REQUIRE(body->setFoundation({p.normal, p.tangential, 0.0}));
  return body;
}

Solved solve(const Problem &problem, const Parameters &p, double tolerance = 1e-13) {
  Solved out{bodyOf(problem, p), {}, 0.0, {}};
  Body &body = *out.body;
  const RestState &rest = body.rest();
  std::vector<Vec3> forces(rest.phyxelCount(), Vec3::Zero());
  const Interpolation probe = rest.bind(std::vector{Vec3(kProbe - rest.origin)}, {});
  spreadForces(probe, std::vector{p.force}, forces);
  body.swapExternalForces(forces);
  NewtonSolver solver;
  const ParallelFor loops = serialFor();
  StageClock clock(stageNames());
  Environment environment = environmentOf(loops, clock);
  environment.tolerance = tolerance;
  const ImplicitResult result = quasiStaticStep(body, solver, environment, 0.0, 1.0);
  REQUIRE(result.failure == "");
  out.watched = rest.bind(std::vector{Vec3(kWatched - rest.origin)}, {});
  std::vector<Vec3> u(1);
  interpolateField(out.watched, body.state().displacements, u, loops);
  const double along = kDirection.dot(u[0]);
  out.objective = 0.5 * along * along;
  out.gradient.assign(rest.phyxelCount(), Vec3::Zero());
  spreadForces(out.watched, std::vector{Vec3(along * kDirection)}, out.gradient);
  return out;
}

Result<EquilibriumSensitivity> sensitivityOf(Solved &solved, const ParallelFor &loops = serialFor(),
                                             const SensitivitySettings &settings = {.tolerance = 1e-11}) {
  StageClock clock(stageNames());
  const Environment environment = environmentOf(loops, clock);
  EquilibriumSensitivitySolver solver;
  return solver.solve(*solved.body, environment, 1.0, solved.gradient, settings);
}

// Fourth-order central difference of the objective.
template <class Change>
double difference(const Problem &problem, double step, const Change &change) {
  const auto at = [&](double h) {
    Parameters p;
    change(p, h);
    return solve(problem, p).objective;
  };
  return (8.0 * (at(step) - at(-step)) - (at(2.0 * step) - at(-2.0 * step))) / (12.0 * step);
}

const std::vector<Problem> &problems() {
  static const std::vector<Problem> all{
      {"linear", MaterialLaw::linear},
      {"StVK, on a foundation", MaterialLaw::stVenantKirchhoff, Evaluation::stressPoints, false, true},
      {"neo-Hookean, fix across cells, foundation", MaterialLaw::neoHookean, Evaluation::stressPoints, true, true},
      {"neo-Hookean with volume stiffness", MaterialLaw::neoHookean, Evaluation::stressPoints, true, false, 5e4},
      {"corotated, fix across cells", MaterialLaw::corotated, Evaluation::stressPoints, true},
      {"cloud, neo-Hookean, foundation", MaterialLaw::neoHookean, Evaluation::phyxels, false, true},
      {"cloud, StVK", MaterialLaw::stVenantKirchhoff, Evaluation::phyxels},
  };
  return all;
}

}  // namespace

// The differences have an error of about 1e-9 by truncation and by the tolerance of the solutions.
TEST_CASE("adjoint sensitivities are those of central differences of static solutions", "[sensitivity]") {
  for (const Problem &problem : problems()) {
    CAPTURE(problem.name);
    Solved solved = solve(problem, {});
    const auto found = sensitivityOf(solved);
    REQUIRE((found ? "" : found.error()) == "");
    const auto agrees = [&](const char *what, double is, double should, double scale) {
      CAPTURE(what, is, should, scale);
      CHECK(std::abs(is - should) <= 1e-6 * std::max(std::abs(should), scale));
    };
    std::vector<Vec3> atProbe(1);
    const RestState &rest = solved.body->rest();
    interpolateField(rest.bind(std::vector{Vec3(kProbe - rest.origin)}, {}), found->forces, atProbe, serialFor());
    REQUIRE(found->supports.size() == 1);
    for (int a = 0; a < 3; ++a) {
      CAPTURE(a);
      agrees("force", atProbe[0][a], difference(problem, 1e-2, [a](Parameters &p, double h) { p.force[a] += h; }),
             0.1 * atProbe[0].norm());
      const EquilibriumSensitivity::Support &support = found->supports[0];
      agrees("motion", support.displacement[a],
             difference(problem, 1e-4, [a](Parameters &p, double h) { p.moved[a] += h; }),
             0.1 * support.displacement.norm());
      // A further rotation about an axis of the world, after that of the fix.
      const auto turn = [a](Parameters &p, double h) {
        const Eigen::AngleAxisd own(p.turned.norm(), p.turned.normalized());
        const Eigen::AngleAxisd both(Eigen::AngleAxisd(h, Vec3::Unit(a)) * own);
        p.turned = both.angle() * both.axis();
      };
      agrees("rotation", support.rotation[a], difference(problem, 1e-3, turn), 0.1 * support.rotation.norm());
    }
    if (problem.hasFoundation) {
      agrees("normal", found->foundationStiffness,
             difference(problem, 300.0, [](Parameters &p, double h) { p.normal += h; }), 0.0);
      agrees("tangential", found->foundationTangential,
             difference(problem, 100.0, [](Parameters &p, double h) { p.tangential += h; }), 0.0);
    } else {
      CHECK(found->foundationStiffness == 0.0);
    }
    REQUIRE(found->youngsModuli.size() == 2);
    for (std::size_t m = 0; m < 2; ++m) {
      CAPTURE(m);
      agrees("modulus", found->youngsModuli[m],
             difference(problem, 200.0, [m](Parameters &p, double h) { p.moduli[m] += h; }), 0.0);
    }
    if (problem.evaluation == Evaluation::stressPoints) {
      CHECK(found->youngsModuli[0] != 0.0);
      CHECK(found->youngsModuli[1] != 0.0);
    }
  }
}

TEST_CASE("a sensitivity leaves the body unchanged and has the same bits for any threads", "[sensitivity]") {
  const Problem &problem = problems()[2];
  Solved solved = solve(problem, {});
  const std::vector<Vec3> u = solved.body->state().displacements;
  const std::vector<Vec3> forces(solved.body->forces().begin(), solved.body->forces().end());
  const auto one = sensitivityOf(solved);
  const auto several = sensitivityOf(solved, lattice_cases::threadedFor(3));
  REQUIRE((one && several));
  CHECK(one->forces == several->forces);
  CHECK(one->youngsModuli == several->youngsModuli);
  CHECK(one->supports[0].rotation == several->supports[0].rotation);
  CHECK(solved.body->state().displacements == u);
  CHECK(std::equal(forces.begin(), forces.end(), solved.body->forces().begin()));
}

TEST_CASE("states without a sensitivity are refused with the reason", "[sensitivity]") {
  const Problem plain{"plain"};
  Solved solved = solve(plain, {});
  const ParallelFor loops = serialFor();
  StageClock clock(stageNames());
  Environment environment = environmentOf(loops, clock);
  EquilibriumSensitivitySolver solver;
  const auto errorOf = [&](Body &body) {
    const std::vector<Vec3> objective(body.rest().phyxelCount(), Vec3(1.0, 0.0, 0.0));
    const auto found = solver.solve(body, environment, 1.0, objective);
    return found ? std::string() : found.error();
  };
  CHECK(errorOf(*solved.body) == "");
  solved.body->state().displacements.back() += Vec3(1e-3, 0.0, 0.0);
  CHECK_THAT(errorOf(*solved.body), Contains("not in equilibrium"));
  solved = solve(plain, {});
  environment.box.enabled = true;
  CHECK_THAT(errorOf(*solved.body), Contains("contact"));
  environment.box.enabled = false;

  Constitution flowing = solved.body->constitution();
  flowing.materials[0].plastic = {.yield = 0.1, .creep = 1.0};
  solved.body->setConstitution(flowing, loops);
  CHECK_THAT(errorOf(*solved.body), Contains("plastic flow"));

  const Load pressure{.region = BoxRegion{Vec3(0.05, 0.03, -1), Vec3(1, 1, 1)}, .pressure = 40.0};
  const BodyShape shape = shapes::box(Vec3::Zero(), Vec3(kLength, kWidth, kWidth), 4);
  auto pressed =
      shapes::makeBody(shapes::restState(shape, {.sampling = {.spacing = 0.02}, .loads = {pressure}}), {Material{}});
  CHECK_THAT(errorOf(*pressed), Contains("load 0") && Contains("follower"));
  auto free = shapes::makeBody(shapes::restState(shape, {.sampling = {.spacing = 0.02}}), {Material{}});
  environment.gravity.setZero();
  CHECK_THAT(errorOf(*free), Contains("nothing"));
  std::vector<Vec3> objective(free->rest().phyxelCount(), Vec3::Zero());
  objective[2][1] = std::nan("");
  const auto found = solver.solve(*free, environment, 1.0, objective);
  REQUIRE(!found);
  CHECK_THAT(found.error(), Contains("phyxel 2"));
  free->setRigid(true);
  CHECK_THAT(errorOf(*free), Contains("rigid"));
}

// Several repetitions, because other programs share the machine.
TEST_CASE("all sensitivities of a solution cost less than one and a half solutions", "[sensitivity]") {
  const BodyShape shape = shapes::box(Vec3::Zero(), Vec3(0.12, 0.06, 0.06), 4);
  Material material{.youngsModulus = 2e4, .poissonRatio = 0.4};
  auto body = shapes::makeBody(
      shapes::restState(shape, {.sampling = {.spacing = 0.006},
                                .fixes = {{.region = BoxRegion{Vec3(-1, -1, -1), Vec3(0.001, 1, 1)}}}}),
      {material});
  body->quasiStatic = true;
  const ParallelFor loops = serialFor();
  StageClock clock(stageNames());
  const Environment environment{.gravity = Vec3(0, -9.81, 0), .parallelFor = &loops, .clock = &clock};
  const auto secondsOf = [](const auto &work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  double least = 1e9, solution = 0.0, sensitivity = 0.0;
  for (int k = 0; k < 4; ++k) {
    body->reset();
    NewtonSolver solver;
    EquilibriumSensitivitySolver sensitivities;
    std::vector<Vec3> objective(body->rest().phyxelCount(), Vec3::Zero());
    objective.back() = Vec3(0, 1, 0);
    const double solving =
        secondsOf([&] { REQUIRE(quasiStaticStep(*body, solver, environment, 0.0, 1.0).failure == ""); });
    const double differentiating = secondsOf([&] { REQUIRE(sensitivities.solve(*body, environment, 1.0, objective)); });
    if (differentiating / solving < least) {
      least = differentiating / solving;
      solution = solving;
      sensitivity = differentiating;
    }
  }
  INFO(body->rest().phyxelCount() << " phyxels: solution " << solution << " s, sensitivities " << sensitivity << " s");
  CHECK(least < 1.5);
}
