// SPDX-License-Identifier: Apache-2.0
#include "contact/skin_pair.h"

#include <cmath>

#include "bench/bodies.h"
#include "pointbased/machine_speed.h"
#include "shapes.h"
#include "steps/questions.h"
#include "surfaces.h"

using namespace pointbased;
using namespace pointbased::detail;

namespace {

double leastOf(int repetitions, const std::function<void()> &run) {
  std::vector<double> samples_ms;
  for (int k = 0; k < repetitions; ++k) {
    const double begin_ms = bench::wall_ms();
    run();
    samples_ms.push_back(bench::wall_ms() - begin_ms);
  }
  return bench::summaryOf(samples_ms).least_ms;
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

std::unique_ptr<Body> ballOf(const Vec3 &centre, double spacing) {
  BodyRecipe recipe;
  recipe.sampling.spacing = spacing;
  const BodyShape shape = shapes::inside(shapes::ballSurface(centre, 0.05, 24));
  return std::make_unique<Body>("ball", bench::valueOf(buildRestState(shape, recipe, {}, serialFor())),
                                bench::elastic(1e4, 0.4), serialFor());
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
    recipe.fixes.push_back(bench::heldIn(HalfSpaceRegion{Vec3(0, low[1], 0), Vec3::UnitY()}));
  }
  return std::make_unique<Body>(pressure > 0.0 ? "upper" : "lower",
                                bench::valueOf(buildRestState(shape, recipe, {}, serialFor())),
                                bench::elastic(modulus, 0.3), serialFor());
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
  const double begin = bench::wall_ms();
  const auto passed = [&] { return bench::wall_ms() - begin; };
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

}  // namespace

void bench::measureSheet(const Options & /*options*/, Report &report) {
  report.table("sheet",
               "vertices; contacts; step_ms=ms a step:2; list_ms=ms a list:1; us_per_vertex=us a vertex, step");
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
    settings.sameTissueDistance = 3.0 * kEdge;
    settings.minReach = 0.3 * kEdge;
    std::size_t contacts = 0;
    const double list = leastOf(3, [&] {
      SkinPair fresh(moving, moving, settings);
      moving.move(u, v, {}, 1.0);
      fresh.find(1.0);
    });
    SkinPair pair(moving, moving, settings);
    const double step = leastOf(7, [&] {
      moving.move(u, v, {}, 1.0);
      pair.find(1.0);
      contacts = pair.active().size();
    });
    report.row({skin->count(), contacts, step, list, 1e3 * step / static_cast<double>(skin->count())});
  }
}

void bench::measureBalls(const Options &options, Report &report) {
  const double spacing =
      options.has("--phyxels") ? std::cbrt(5.3e-4 / std::max(100.0, options.number("--phyxels", 0.0))) : 0.0105;
  report.table("balls", "state; phyxels; vertices; forces_ms=forces, ms; contact_ms=contact, ms; share=contact/all:2");
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
    while (simulator.time() < std::max(0.5, until)) valueOf(simulator.step());
    double forces = 0.0, contact = 0.0;
    for (const auto &stage : simulator.diagnostics().stageTimes()) {
      if (stage.name == "internal_forces") forces = stage.median_ms;
      if (stage.name == "contact") contact = stage.median_ms;
    }
    report.row({until == 0.0   ? "apart"
                : until == 0.5 ? "bouncing"
                               : "at rest",
                phyxels, vertices, forces, contact, contact / (contact + forces)});
  }
}

void bench::measurePressed(const Options & /*options*/, Report &report) {
  report.table("pressed",
               "modulus_Pa=modulus:0; phyxels; explicit_ms=explicit, ms:2; implicit_ms=implicit, ms:2; "
               "explicit_apart_ms=expl. apart:2; implicit_apart_ms=impl. apart:2; ratio=impl/expl:1; "
               "ns_per_vertex=ns a vertex:0");
  for (const double spacing : {0.008, 0.004})
    for (const double modulus : {2e4, 1e6, 3e7}) {
      const auto n = static_cast<std::size_t>(std::lround(0.04 / spacing)) + 1;
      const FrameCost explicitly = costOfFrame(Integrator::explicitVerlet, spacing, modulus, true);
      const double implicitly = costOfFrame(Integrator::implicitSdirk, spacing, modulus, true).ms,
                   apart = costOfFrame(Integrator::explicitVerlet, spacing, modulus, false).ms;
      report.row({modulus, 2 * n * n * n, explicitly.ms, implicitly, apart,
                  costOfFrame(Integrator::implicitSdirk, spacing, modulus, false).ms,
                  explicitly.ms > 0.0 ? implicitly / explicitly.ms : 0.0,
                  1e6 * (explicitly.ms - apart) / std::max(1.0, explicitly.substeps * explicitly.vertices)});
    }
  const double assumed = measureSpeed(serialFor(), 1).touch_ns;
  report.note("assumed by the accuracy setting: " + std::to_string(std::lround(assumed)) + " ns a vertex");
  report.fact("touch_ns", assumed);
}
