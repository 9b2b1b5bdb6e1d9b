// SPDX-License-Identifier: Apache-2.0
#include "bench/bodies.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "surfaces.h"
#include "thin_shapes.h"

namespace bench {

using namespace pointbased;

namespace {

std::vector<Vec3> directions(const std::vector<Vec3> &points) {
  std::vector<Vec3> out;
  out.reserve(points.size());
  for (const Vec3 &p : points) out.push_back(p.normalized());
  return out;
}

BodyShape ballShape(double radius) {
  BodyShape shape;
  shape.min = Vec3::Constant(-radius);
  shape.max = Vec3::Constant(radius);
  shape.volume = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
  shape.inside = [radius](std::span<const Vec3> points, std::span<double> inside) {
    for (std::size_t i = 0; i < points.size(); ++i) inside[i] = points[i].norm() < radius ? 1.0 : 0.0;
  };
  shape.surfaceDistance = [radius](std::span<const Vec3> points, std::span<double> distances) {
    for (std::size_t i = 0; i < points.size(); ++i) distances[i] = std::abs(points[i].norm() - radius);
  };
  return shape;
}

}  // namespace

ParallelFor parallelForOf(c3de::ThreadPool &pool) {
  return [&pool](std::size_t n, std::size_t grain, const std::function<void(std::size_t, std::size_t)> &body) {
    pool.parallelFor(n, grain, body);
  };
}

PhyxelCloud ballCloud(std::size_t count) {
  const int half = static_cast<int>(std::ceil(0.63 * std::cbrt(static_cast<double>(count)))) + 2;
  std::vector<Vec3> points;
  // Off the lattice's own centre, so that no two shells tie at the cut.
  const Vec3 centre(0.13, 0.29, 0.37);
  for (int z = -half; z <= half; ++z)
    for (int y = -half; y <= half; ++y)
      for (int x = -half; x <= half; ++x) points.emplace_back(x, y, z);
  std::nth_element(
      points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count), points.end(),
      [&](const Vec3 &a, const Vec3 &b) { return (a - centre).squaredNorm() < (b - centre).squaredNorm(); });
  points.resize(count);
  // Along Morton's curve, the order of fill().
  const auto code = [half](const Vec3 &p) {
    std::uint64_t bits = 0;
    for (int b = 0; b < 20; ++b)
      for (int c = 0; c < 3; ++c)
        bits |= (static_cast<std::uint64_t>(std::lround(p[c]) + half) >> b & 1u) << (3 * b + c);
    return bits;
  };
  std::sort(points.begin(), points.end(), [&](const Vec3 &a, const Vec3 &b) { return code(a) < code(b); });
  PhyxelCloud cloud;
  cloud.spacing = kSpacing;
  for (const Vec3 &p : points) cloud.positions.push_back(kSpacing * p);
  cloud.volumes.assign(count, kSpacing * kSpacing * kSpacing);
  cloud.contactRadii.assign(count, 0.5 * kSpacing);
  return cloud;
}

double ballRadius(std::size_t count) {
  return kSpacing * std::cbrt(0.75 / std::numbers::pi * static_cast<double>(count));
}

std::vector<Vec3> sphere(std::size_t count, double radius) {
  std::vector<Vec3> points;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (std::size_t i = 0; i < count; ++i) {
    const double y = 1.0 - 2.0 * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double r = std::sqrt(1.0 - y * y);
    const double phi = golden * static_cast<double>(i);
    points.emplace_back(radius * r * std::cos(phi), radius * y, radius * r * std::sin(phi));
  }
  return points;
}

std::shared_ptr<const RestState> cloudBall(std::size_t phyxels, std::size_t surfels, const ParallelFor &parallelFor) {
  const PhyxelCloud cloud = ballCloud(phyxels);
  const double volume = std::accumulate(cloud.volumes.begin(), cloud.volumes.end(), 0.0);
  const std::vector<Vec3> points = sphere(surfels, ballRadius(phyxels));
  return buildRestState(cloud, kNeighbours, volume, Surface{points, {}}, directions(points), parallelFor);
}

std::shared_ptr<const RestState> latticeBall(std::size_t phyxels, std::size_t surfels, const ParallelFor &parallelFor) {
  // Phyxels are the corners of the cells that the ball cuts: about as many as fill one larger by 1.2 spacings.
  const double cells = std::max(0.5, std::cbrt(0.75 / std::numbers::pi * static_cast<double>(phyxels)) - 1.2);
  const double radius = kSpacing * cells;
  BodyShape shape = ballShape(radius);
  const std::vector<Vec3> points = sphere(surfels, radius);
  shape.surface = Surface{points, {}};
  BodyRecipe recipe;
  recipe.evaluation = Evaluation::stressPoints;
  recipe.sampling.spacing = kSpacing;
  return valueOf(buildRestState(shape, recipe, directions(points), parallelFor));
}

Constitution constitutionFor(const RestState &rest, MaterialLaw law) {
  Material material;
  material.law = law;
  return {{material}, rest.evaluation == Evaluation::stressPoints ? kLatticeStabilisation : kCloudStabilisation};
}

std::string evaluationName(const Body &body) {
  const bool lattice = body.rest().evaluation == Evaluation::stressPoints;
  return std::string(lattice ? "stress points" : "phyxels") +
         (body.precision() == Precision::singlePrecision ? ", float" : "");
}

void deform(Body &body) {
  const RestState &rest = body.rest();
  const double turn = 0.4 / ballRadius(rest.phyxelCount());  // 1/m
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i) {
    const Vec3 &X = rest.positions[i];
    body.state().displacements[i] =
        0.05 * X.cwiseProduct(Vec3(1, -0.5, 0.3)) + 0.1 * turn * Vec3(X[1] * X[2], X[0] * X[2], X[0] * X[1]);
  }
}

World::World(std::unique_ptr<Body> body, const WorldSettings &settings, const ParallelFor &parallelFor)
    : simulator(parallelFor) {
  simulator.setWorld(settings);
  id = simulator.addBody(std::move(body));
}

void World::solve() {
  while (!simulator.finished()) step();
  if (body().stopped) throw std::runtime_error(body().stopMessage());
}

std::unique_ptr<World> fallingBall(const std::shared_ptr<const RestState> &rest, Precision precision,
                                   const ParallelFor &parallelFor) {
  auto body = std::make_unique<Body>("ball", rest, constitutionFor(*rest), parallelFor);
  WorldSettings settings;
  settings.gravity = Vec3(0, -9.81, 0);
  settings.dt = 0.5 * body->stableStepAtRest();
  auto world = std::make_unique<World>(std::move(body), settings, parallelFor);
  world->body().setPrecision(precision);
  deform(world->body());
  return world;
}

Constitution elastic(double youngsModulus, double poissonRatio, double density) {
  return {{Material{MaterialLaw::neoHookean, youngsModulus, poissonRatio, density}}, kLatticeStabilisation};
}

Fix heldIn(const Region &region, const Vec3 &displacement) {
  Fix fix;
  fix.region = region;
  fix.displacement = displacement;
  return fix;
}

Surface surfaceNamed(const std::string &name, int rings, int around) {
  const auto deformedBall = [&](const std::function<Vec3(const Vec3 &)> &moved) {
    return validation::latheSurface(rings, around, [&](int ring, double phi) {
      const double theta = std::numbers::pi * ring / rings;
      return moved(Vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), -std::cos(theta)));
    });
  };
  if (name == "box" || name == "beam") return shapes::boxSurface(Vec3::Zero(), Vec3(0.2, 0.04, 0.04));
  if (name == "tube") return validation::tubeSurface(0.012, 0.004, 0.12);
  if (name == "liver")
    return deformedBall([](const Vec3 &n) {
      return Vec3(0.11 * n[0], (0.045 + 0.03 * n[0]) * n[1] + 0.02 * n[0] * n[0], (0.07 - 0.03 * n[0] * n[0]) * n[2]);
    });
  if (name == "kidney")
    return deformedBall(
        [](const Vec3 &n) { return Vec3(0.06 * n[0], 0.028 * n[1] + 0.025 * n[0] * n[0], 0.022 * n[2]); });
  throw std::invalid_argument("there is no body '" + name + "'; accepted: box, beam, liver, kidney, tube");
}

Timing measureSurfelUpdate(double seconds, const Body &body, const ParallelFor &parallelFor) {
  const RestState &rest = body.rest();
  std::vector<Vec3f> x(rest.surfels.count()), normals(rest.surfels.count());
  ScreenPhyxels scratch;
  return measure(seconds, [&] {
    updateSurfels(rest.surfels, rest.surfelNormals, rest.origin, rest.positions, body.state().displacements, scratch, x,
                  normals, parallelFor);
  });
}

void evaluateForces(Body &body, const ParallelFor &parallelFor) { body.evaluate(0.0, 0.0, parallelFor); }

}  // namespace bench
