// SPDX-License-Identifier: Apache-2.0
// Measures the cost of contact between skins.
//
//   bench_contact [--balls | --pressed] [--phyxels N]
//
// Four balls, first apart, then falling on each other and resting: milliseconds of contact and of forces per step, one
// thread. Then a slab bent over itself, with the given number of vertices in self-contact: the cost of a step while the
// list of near pairs is valid, and the cost of building the list. Then two blocks pressed together: the cost of a
// sixtieth of a second in explicit and in implicit steps, and the cost while they are apart. For explicit steps also
// per pressing vertex and substep, next to the value that the cost model assumes (MachineSpeed::touch_ns).
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>

#include "contact/skin_pair.h"
#include "pointbased/machine_speed.h"
#include "pointbased/simulator.h"
#include "shapes.h"
#include "surfaces.h"

using namespace pointbased;
using namespace pointbased::detail;

namespace {

double millisecondsOf(const std::function<void()> &run, int repetitions) {
  double best = 1e300;
  for (int k = 0; k < repetitions; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    run();
    best = std::min(best, std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
  }
  return best;
}

// Skins whose vertices are their phyxels: two sheets of n x n squares, one half an offset and margin above the other.
std::shared_ptr<const ContactSkin> foldedSheet(int n, double edge, double gap) {
  std::vector<Vec3> points;
  std::vector<std::array<Index, 3>> triangles;
  for (const int layer : {0, 1}) {
    const auto first = static_cast<Index>(points.size());
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i)
        points.push_back(Vec3((i + 0.3 * layer) * edge, (j + 0.2 * layer) * edge,
                              layer * gap + 0.02 * edge * std::sin(1.3 * i) * std::cos(0.9 * j)));
    const auto at = [&](int i, int j) { return first + static_cast<Index>(j * (n + 1) + i); };
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        std::array<Index, 3> lower{at(i, j), at(i + 1, j), at(i + 1, j + 1)},
            upper{at(i, j), at(i + 1, j + 1), at(i, j + 1)};
        if (layer == 1) {
          std::swap(lower[1], lower[2]);
          std::swap(upper[1], upper[2]);
        }
        triangles.push_back(lower);
        triangles.push_back(upper);
      }
  }
  // At rest the second sheet is far away.
  Interpolation binding;
  binding.phyxels.offsets.assign(1, 0);
  for (std::size_t p = 0; p < points.size(); ++p) {
    binding.positions.push_back(points[p] + (p >= points.size() / 2 ? Vec3(0, 0, 1000.0 * edge) : Vec3(Vec3::Zero())));
    binding.phyxels.indices.push_back(static_cast<Index>(p));
    binding.phyxels.offsets.push_back(static_cast<Index>(p + 1));
    binding.weights.push_back(1.0);
    binding.gradients.push_back(Vec3::Zero());
  }
  return makeContactSkin(std::move(binding), std::move(triangles), {1e9}, {}, {});
}

void sheets() {
  std::printf("\n%-10s %12s %14s %12s %16s\n", "vertices", "contacts", "ms a step", "ms a list", "us a vertex, step");
  for (const int n : {30, 60, 86, 160, 222}) {
    constexpr double kEdge = 1.0;
    const auto skin = foldedSheet(n, kEdge, 0.035);
    std::vector<Vec3> u(skin->count(), Vec3::Zero()), v(skin->count(), Vec3::Zero());
    for (std::size_t p = skin->count() / 2; p < skin->count(); ++p) {
      u[p] = Vec3(0, 0, -1000.0 * kEdge);
      v[p] = Vec3(0, 0, -1e-3);
    }
    MovingSkin moving(skin, Vec3::Zero(), 2.0 * kEdge);
    SkinPairSettings settings;
    settings.offset = settings.margin = 0.02 * kEdge;
    settings.stiffness = 50.0;
    settings.thickness = 0.015 * kEdge;
    moving.setModuli(std::vector<double>(skin->count(), 1e4));
    settings.apart = 3.0 * kEdge;
    settings.leastReach = 0.3 * kEdge;
    std::size_t contacts = 0;
    const double list = millisecondsOf(
        [&] {
          SkinPair fresh(moving, moving, settings);
          moving.move(u, v, {}, 1.0);
          fresh.find(1.0);
        },
        3);
    SkinPair pair(moving, moving, settings);
    const double step = millisecondsOf(
        [&] {
          moving.move(u, v, {}, 1.0);
          pair.find(1.0);
          contacts = pair.active().size();
        },
        7);
    std::printf("%-10zu %12zu %14.2f %12.1f %16.3f\n", skin->count(), contacts, step, list,
                1e3 * step / static_cast<double>(skin->count()));
  }
}

std::unique_ptr<Body> ballOf(const Vec3 &centre, double spacing) {
  BodyRecipe recipe;
  recipe.sampling.spacing = spacing;
  auto rest = buildRestState(shapes::inside(shapes::ballSurface(centre, 0.05, 24)), recipe, {}, serialFor());
  if (!rest) std::exit(1);
  Material material;
  material.law = MaterialLaw::neoHookean;
  material.youngsModulus = 1e4;
  material.poissonRatio = 0.4;
  return std::make_unique<Body>("ball", *rest, Constitution{{material}, kLatticeStabilisation}, serialFor());
}

void balls(double spacing) {
  std::printf("%-10s %10s %10s %14s %14s %10s\n", "", "phyxels", "vertices", "forces, ms", "contact, ms",
              "contact/all");
  for (const double until : {0.0, 0.5, 1.5}) {
    const bool together = until > 0.0;
    Simulator simulator;
    WorldSettings world;
    world.damping = 20.0;
    // Towards the middle: gravity cannot change sign, so a box that is too narrow presses the blocks together.
    world.box.enabled = together;
    world.box.min = Vec3(-0.11, -0.11, -0.06);
    world.box.max = Vec3(0.11, 0.11, 0.06);
    world.gravity = together ? Vec3(0, -9.81, 0) : Vec3(Vec3::Zero());
    simulator.setWorld(world);
    const double away = together ? 0.0502 : 0.3;
    std::size_t phyxels = 0, vertices = 0;
    for (const Vec3 &side : {Vec3(1, 1, 0), Vec3(1, -1, 0), Vec3(-1, 1, 0), Vec3(-1, -1, 0)}) {
      const std::size_t id = simulator.addBody(ballOf(away * side, spacing));
      phyxels += simulator.body(id)->rest().phyxelCount();
      vertices += simulator.body(id)->rest().surfels.count();
    }
    while (simulator.time() < std::max(0.5, until))
      if (!simulator.step()) return;
    double forces = 0.0, contact = 0.0;
    for (const auto &stage : simulator.diagnostics().stageTimes()) {
      if (stage.name == "internal_forces") forces = stage.median_ms;
      if (stage.name == "contact") contact = stage.median_ms;
    }
    std::printf("%-10s %10zu %10zu %14.3f %14.3f %10.2f\n",
                until == 0.0   ? "apart"
                : until == 0.5 ? "bouncing"
                               : "at rest",
                phyxels, vertices, forces, contact, contact / (contact + forces));
  }
}

std::unique_ptr<Body> blockOf(const Vec3 &low, const Vec3 &high, double spacing, double modulus, double pressure) {
  BodyShape shape = shapes::box(low, high);
  shape.surface = shapes::boxSurface(low, high, static_cast<int>(std::lround((high - low)[0] / spacing)));
  BodyRecipe recipe;
  recipe.sampling.spacing = spacing;
  if (pressure > 0.0) {
    Load load;
    load.region = HalfSpaceRegion{Vec3(0, high[1], 0), -Vec3::UnitY()};
    load.force = Vec3(0, -pressure * (high - low)[0] * (high - low)[2], 0);
    recipe.loads.push_back(load);
  } else {
    Fix ground;
    ground.region = HalfSpaceRegion{Vec3(0, low[1], 0), Vec3::UnitY()};
    recipe.fixes.push_back(ground);
  }
  auto rest = buildRestState(shape, recipe, {}, serialFor());
  if (!rest) std::exit(1);
  Material material;
  material.law = MaterialLaw::neoHookean;
  material.youngsModulus = modulus;
  material.poissonRatio = 0.3;
  return std::make_unique<Body>(pressure > 0.0 ? "upper" : "lower", *rest,
                                Constitution{{material}, kLatticeStabilisation}, serialFor());
}

struct FrameCost {
  double ms = 0.0;        // 0: over the time limit, or not solved
  double vertices = 0.0;  // vertices that press
  double substeps = 0.0;  // explicit
};

// For the same scene with or without contact.
FrameCost costOfFrame(Integrator integrator, double spacing, double modulus, bool touches) {
  constexpr double kEdge = 0.04, kFrame = 1.0 / 60.0, kSettles = 0.2;
  Simulator simulator;
  WorldSettings world;
  world.integrator = integrator;
  world.dt = kFrame;
  world.damping = 20.0;
  simulator.setWorld(world);
  ContactSettings contact;
  contact.enabled = touches;
  simulator.world().setContact(contact);
  const double half = 0.5 * kEdge, gap = 0.01 * spacing;
  simulator.addBody(blockOf(Vec3(-half, 0, -half), Vec3(half, kEdge, half), spacing, modulus, 0.0));
  simulator.addBody(blockOf(Vec3(-half + 0.3 * spacing, kEdge + gap, -half),
                            Vec3(half + 0.3 * spacing, 2.0 * kEdge + gap, half), spacing, modulus, 0.005 * modulus));
  const auto begin = std::chrono::steady_clock::now();
  const auto passed = [&] {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  };
  double settled = -1.0;
  std::uint64_t steps = 0;
  while (simulator.time() < 2.0 * kSettles && passed() < 60e3) {
    if (settled < 0.0 && simulator.time() >= kSettles) {
      settled = passed();
      steps = simulator.steps();
    }
    if (!simulator.step()) return {};
  }
  FrameCost cost;
  if (settled < 0.0) return cost;
  cost.ms = (passed() - settled) / static_cast<double>(simulator.steps() - steps);
  for (const ContactSummary &pair : simulator.diagnostics().contacts())
    cost.vertices += static_cast<double>(pair.points);
  for (const std::size_t id : simulator.bodyIds())
    cost.substeps = std::max(cost.substeps, std::ceil(kFrame / (kStepSafety * simulator.body(id)->stableStepAtRest())));
  return cost;
}

void pressed() {
  std::printf("\n%-10s %10s %14s %14s %14s %14s %10s %12s\n", "modulus", "phyxels", "explicit, ms", "implicit, ms",
              "expl. apart", "impl. apart", "impl/expl", "ns a vertex");
  for (const double spacing : {0.008, 0.004})
    for (const double modulus : {2e4, 1e6, 3e7}) {
      const auto n = static_cast<std::size_t>(std::lround(0.04 / spacing)) + 1;
      const FrameCost explicitly = costOfFrame(Integrator::explicitVerlet, spacing, modulus, true);
      const double implicitly = costOfFrame(Integrator::implicitSdirk, spacing, modulus, true).ms,
                   apart = costOfFrame(Integrator::explicitVerlet, spacing, modulus, false).ms;
      std::printf("%-10.0g %10zu %14.2f %14.2f %14.2f %14.2f %10.1f %12.0f\n", modulus, 2 * n * n * n, explicitly.ms,
                  implicitly, apart, costOfFrame(Integrator::implicitSdirk, spacing, modulus, false).ms,
                  explicitly.ms > 0.0 ? implicitly / explicitly.ms : 0.0,
                  1e6 * (explicitly.ms - apart) / std::max(1.0, explicitly.substeps * explicitly.vertices));
      std::fflush(stdout);
    }
  std::printf("reckoned with by the dial: %.0f ns a vertex\n", measureSpeed(serialFor(), 1).touch_ns);
}

}  // namespace

int main(int argc, char **argv) {
  double spacing = 0.0105;
  bool all = true, onlyPressed = false;
  for (int k = 1; k < argc; ++k) {
    if (std::strcmp(argv[k], "--phyxels") == 0 && k + 1 < argc)
      spacing = std::cbrt(5.3e-4 / std::max(100.0, std::atof(argv[++k])));
    else if (std::strcmp(argv[k], "--balls") == 0)
      all = false;
    else if (std::strcmp(argv[k], "--pressed") == 0)
      onlyPressed = true;
  }
  if (!onlyPressed) balls(spacing);
  if (all && !onlyPressed) sheets();
  if (all) pressed();
  return 0;
}
