// SPDX-License-Identifier: Apache-2.0
// A cantilever on the point-based core, without a host: a closed surface made here becomes a body, one end is held, the
// other is loaded, and the tip is compared with the beam formula. Walked through in docs/plugin/index.md.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <stdexcept>

#include "pointbased/simulator.h"

namespace {

using namespace pointbased;

constexpr double kLength_m = 0.1, kSide_m = 0.02;
constexpr double kYoungsModulus_Pa = 50e3, kPoissonRatio = 0.3, kDensity_kg_m3 = 1000.0;
constexpr double kForce_N = 2e-3;  // downwards, at the tip

/// The surface of a box from the origin: eight corners, twelve triangles, outwards.
Surface boxSurface(const Vec3 &edges) {
  Surface surface;
  for (int corner = 0; corner < 8; ++corner)
    surface.positions.emplace_back(corner & 1 ? edges[0] : 0.0, corner & 2 ? edges[1] : 0.0,
                                   corner & 4 ? edges[2] : 0.0);
  const Index quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto &q : quads) {
    surface.triangles.push_back({q[0], q[1], q[2]});
    surface.triangles.push_back({q[0], q[2], q[3]});
  }
  return surface;
}

/// Each edge divided in the middle, so that four triangles take the place of one.
Surface refined(const Surface &coarse) {
  Surface fine{coarse.positions, {}};
  std::map<std::pair<Index, Index>, Index> middles;
  const auto middle = [&](Index a, Index b) {
    const auto [at, isNew] = middles.try_emplace(std::minmax(a, b), static_cast<Index>(fine.positions.size()));
    if (isNew) fine.positions.push_back(0.5 * (coarse.positions[a] + coarse.positions[b]));
    return at->second;
  };
  for (const auto &[a, b, c] : coarse.triangles) {
    const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    for (const std::array<Index, 3> &t :
         {std::array{a, ab, ca}, std::array{ab, b, bc}, std::array{ca, bc, c}, std::array{ab, bc, ca}})
      fine.triangles.push_back(t);
  }
  return fine;
}

/// Solid angle of all triangles over 4 pi: 1 inside of a closed surface, 0 outside.
double windingNumber(const Surface &surface, const Vec3 &x) {
  double sum = 0.0;
  for (const auto &[i, j, k] : surface.triangles) {
    const Vec3 a = surface.positions[i] - x, b = surface.positions[j] - x, c = surface.positions[k] - x;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (4.0 * EIGEN_PI);
}

/// Any closed surface, outwards, as a body to fill. The core reads no files: what is inside is asked of us.
BodyShape bodyInside(const Surface &surface) {
  BodyShape shape;
  shape.surface = surface;
  shape.min = shape.max = surface.positions.front();
  for (const Vec3 &x : surface.positions) {
    shape.min = shape.min.cwiseMin(x);
    shape.max = shape.max.cwiseMax(x);
  }
  for (const auto &[i, j, k] : surface.triangles)
    shape.volume += surface.positions[i].dot(surface.positions[j].cross(surface.positions[k])) / 6.0;
  shape.inside = [surface](std::span<const Vec3> points, std::span<double> inside) {
    for (std::size_t i = 0; i < points.size(); ++i) inside[i] = windingNumber(surface, points[i]);
  };
  return shape;
}

/// The part of the body between two planes across its length, m.
Region between(double low, double high) { return BoxRegion{Vec3(low, -1.0, -1.0), Vec3(high, 1.0, 1.0)}; }

/// What is refused says what, which value, and what is accepted.
[[noreturn]] void refuse(const std::string &why) { throw std::runtime_error(why); }

/// How far the tip goes down, m.
double solve(Integrator integrator, double until_s) {
  BodyRecipe recipe;
  recipe.sampling.spacing = kSide_m / 4.0;
  Fix root;
  root.region = between(-1e-6, 1e-6);
  recipe.fixes.push_back(root);
  Load tip;
  tip.region = between(kLength_m - 1e-6, kLength_m + 1e-6);
  tip.force = Vec3(0.0, 0.0, -kForce_N);
  recipe.loads.push_back(tip);
  const Surface surface = refined(boxSurface({kLength_m, kSide_m, kSide_m}));
  const auto rest = buildRestState(bodyInside(surface), recipe, {}, serialFor());
  if (!rest) refuse(rest.error());

  Material material;
  material.youngsModulus = kYoungsModulus_Pa;
  material.poissonRatio = kPoissonRatio;
  material.restDensity = kDensity_kg_m3;
  if (const auto valid = validate(material); !valid) refuse(valid.error());

  Simulator simulator;
  WorldSettings world;
  world.integrator = integrator;
  world.damping = 15.0;  // 1/s, about what brings the first mode (2.3 Hz) to rest soonest; of no effect on statics
  simulator.setWorld(world);
  const std::size_t body = simulator.addBody(
      std::make_unique<Body>("beam", *rest, Constitution{{material}, kLatticeStabilisation}, serialFor()));
  simulator.world().addProbe("tip", body, Vec3(kLength_m, 0.5 * kSide_m, 0.5 * kSide_m));
  while (!simulator.finished() && (simulator.quasiStatic() || simulator.time() < until_s))
    if (const auto step = simulator.step(); !step) refuse(step.error().text);
  return 0.5 * kSide_m - simulator.world().probeState(simulator.world().probes().front()).position[2];
}

}  // namespace

int main() try {
  const double area = kSide_m * kSide_m, inertia = area * area / 12.0;
  const double shearModulus = kYoungsModulus_Pa / (2.0 * (1.0 + kPoissonRatio));
  const double bending = kForce_N * std::pow(kLength_m, 3) / (3.0 * kYoungsModulus_Pa * inertia);
  const double shear = kForce_N * kLength_m / (5.0 / 6.0 * shearModulus * area);
  const double formula = bending + shear;
  std::printf("cantilever %g x %g x %g mm, E %g kPa, %g mN at the tip\n", 1e3 * kLength_m, 1e3 * kSide_m, 1e3 * kSide_m,
              1e-3 * kYoungsModulus_Pa, 1e3 * kForce_N);
  std::printf("beam formula  tip %.4f mm (bending and shear)\n", 1e3 * formula);
  bool isGood = true;
  const auto show = [&](const char *name, double tip) {
    const double off = tip / formula - 1.0;
    std::printf("%-13s tip %.4f mm, %+.2f %% of the formula\n", name, 1e3 * tip, 1e2 * off);
    isGood = isGood && std::abs(off) < 0.03;
  };
  show("quasi-static", solve(Integrator::quasiStatic, 0.0));
  show("explicit", solve(Integrator::explicitVerlet, 1.5));
  if (!isGood) std::fprintf(stderr, "more than 3 %% from the formula\n");
  return isGood ? EXIT_SUCCESS : EXIT_FAILURE;
} catch (const std::exception &e) {
  std::fprintf(stderr, "%s\n", e.what());
  return EXIT_FAILURE;
}
