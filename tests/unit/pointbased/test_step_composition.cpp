// SPDX-License-Identifier: Apache-2.0
// The composition of a step: the object that describes it, and the stages that actually ran.
#include <algorithm>
#include <set>

#include "lattice_cases.h"
#include "pointbased/simulator.h"
#include "support/catch.h"

using namespace pointbased;

namespace {

/// A box in a simulator, with additions.
struct Scene {
  BodyRecipe recipe;
  Material material;
  WorldSettings world;
  Foundation foundation;
  std::vector<Obstacle> obstacles;
  bool probed = false, grabbed = false, pushed = false;
  Integrator integrator = Integrator::explicitVerlet;
};

struct Stepped {
  std::set<std::string> said;   ///< stages of the composition that run
  std::set<std::string> clock;  ///< stages that the clock has recorded in steps
  StepComposition composition;
};

Stepped stepped(const Scene &scene) {
  Simulator simulator;
  WorldSettings world = scene.world;
  world.integrator = scene.integrator;
  simulator.setWorld(world);
  BodyRecipe recipe = scene.recipe;
  recipe.sampling.spacing = 0.02;
  auto body = shapes::makeBody(shapes::restState(lattice_cases::box(Vec3(0, 0, 0), Vec3(0.08, 0.06, 0.04)), recipe),
                               {scene.material});
  REQUIRE(body->setFoundation(scene.foundation));
  const std::size_t n = body->rest().phyxelCount();
  const std::size_t id = simulator.addBody(std::move(body));
  for (const Obstacle &obstacle : scene.obstacles) simulator.addObstacle(obstacle);
  if (scene.probed) (void)simulator.world().addProbe("tip", id, Vec3(0.08, 0.03, 0.02));
  if (scene.grabbed) {
    const Grab grab{.phyxels = {0}, .weights = {1.0}};
    simulator.stepper().setGrab(id, grab);
  }
  if (scene.pushed) simulator.stepper().setExternalForces(id, std::vector<Vec3>(n, Vec3(1e-5, 0, 0)));
  Stepped out;
  out.composition = simulator.stepper().compositionOf(id);
  for (int i = 0; i < 3; ++i) REQUIRE(simulator.step());
  for (const ComposedStage &stage : simulator.stepper().compositionOf(id).stages) {
    CHECK_FALSE(stage.why.empty());
    if (stage.runs) out.said.insert(stage.name);
  }
  for (const StageClock::Summary &stage : simulator.diagnostics().stageTimes()) out.clock.insert(stage.name);
  return out;
}

std::set<std::string> less(const std::set<std::string> &a, const std::set<std::string> &b) {
  std::set<std::string> out;
  std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::inserter(out, out.begin()));
  return out;
}

Obstacle farPlane() {
  Obstacle plane;
  plane.name = "block";
  plane.closest = [](std::span<const Vec3> points, std::span<const double>, std::span<SurfacePoint> out) {
    for (std::size_t i = 0; i < points.size(); ++i) out[i] = {Vec3::UnitZ(), points[i][2] + 1.0};
  };
  return plane;
}

Scene plain() {
  Scene scene;
  scene.material.law = MaterialLaw::neoHookean;
  scene.material.viscosity = 0.0;
  return scene;
}

using Names = std::set<std::string>;

}  // namespace

TEST_CASE("composition: what a scene adds, adds its stage and nothing else", "[composition]") {
  struct Addition {
    const char *stage, *why;
    std::function<void(Scene &)> add;
    Names clock;  ///< stages of the clock that belong to it
  };
  const Addition additions[] = {
      {"contact", "obstacle 'block'", [](Scene &s) { s.obstacles.push_back(farPlane()); }, {"contact"}},
      {"contact", "walls of the world", [](Scene &s) { s.world.box.enabled = true; }, {"contact"}},
      {"plastic_flow",
       "material 0: yield 0.05",
       [](Scene &s) { s.material.plastic = {.yield = 0.05, .creep = 0.5}; },
       {}},
      {"viscosity", "material 0: viscosity 2 Pa s", [](Scene &s) { s.material.viscosity = 2.0; }, {}},
      {"relaxation",
       "material 0: 1 Prony term",
       [](Scene &s) {
         s.material.prony[0] = {0.3, 0.1};
       },
       {}},
      {"surroundings",
       "1000 and 500 Pa/m",
       [](Scene &s) {
         s.foundation = {1000.0, 500.0, 0.0};
       },
       {}},
      {"hands", "1 hand", [](Scene &s) { s.grabbed = true; }, {}},
      {"outside_forces", "another plugin, or a load of the run", [](Scene &s) { s.pushed = true; }, {}},
      {"probes", "probe 'tip': read when somebody asks", [](Scene &s) { s.probed = true; }, {}},
      {"damping", "3 1/s", [](Scene &s) { s.world.damping = 3.0; }, {}},
      {"loads", "1 load", [](Scene &s) { s.recipe.loads.emplace_back().force = Vec3(0, 0, -1e-3); }, {}},
      {"supports",
       "1 fix",
       [](Scene &s) {
         s.recipe.fixes.emplace_back().region = BoxRegion{Vec3(-1, -1, -1), Vec3(1e-7, 1, 1)};
       },
       {"supports"}},
      {"sleep", "solver.sleep", [](Scene &s) { s.world.sleep = true; }, {}},
  };
  for (const Integrator integrator : {Integrator::explicitVerlet, Integrator::implicitSdirk}) {
    Scene scene = plain();
    scene.integrator = integrator;
    const Stepped before = stepped(scene);
    const bool isExplicit = integrator == Integrator::explicitVerlet;
    CHECK(before.said == (isExplicit ? Names{"integrate", "internal_forces", "guard", "surfels"}
                                     : Names{"solve", "internal_forces", "guard", "surfels"}));
    CHECK(before.clock ==
          (isExplicit ? Names{"integrate", "internal_forces", "guard"} : Names{"solve", "internal_forces", "guard"}));
    for (const Addition &addition : additions) {
      INFO(addition.stage << (isExplicit ? ", explicit" : ", implicit"));
      Scene more = scene;
      addition.add(more);
      const Stepped after = stepped(more);
      CHECK(less(after.said, before.said) == Names{addition.stage});
      CHECK(less(before.said, after.said).empty());
      CHECK(after.composition.stage(addition.stage)->why == addition.why);
      CHECK(less(after.clock, before.clock) == (isExplicit ? addition.clock : Names{}));
      CHECK(less(before.clock, after.clock).empty());
    }
  }
}

TEST_CASE("composition: stage by stage, where vector kernels do not go", "[composition]") {
  // Clouds that flow.
  Scene scene = plain();
  scene.recipe.evaluation = Evaluation::phyxels;
  scene.material.plastic = {.yield = 0.05, .creep = 0.5};
  const Stepped out = stepped(scene);
  CHECK(out.clock ==
        Names{"integrate", "deformation_gradients", "plastic_flow", "stresses", "internal_forces", "guard"});
  for (const char *stage : {"deformation_gradients", "plastic_flow", "stresses"}) CHECK(out.said.contains(stage));
}

TEST_CASE("composition: what does not step has no stage, and says why", "[composition]") {
  Simulator simulator;
  const std::size_t id = simulator.addBody(shapes::makeBody(
      shapes::restState(lattice_cases::box(Vec3(0, 0, 0), Vec3(0.08, 0.06, 0.04)), BodyRecipe{}), {Material{}}));
  simulator.world().setRigid(id, true);
  for (const ComposedStage &stage : simulator.stepper().compositionOf(id).stages)
    if (stage.runs) CHECK(stage.name == "surfels");
  CHECK(simulator.stepper().compositionOf(id).stage("internal_forces")->why == "rigid: it stands as it is");
  CHECK(simulator.stepper().compositionOf(99).stages.empty());
}
