// SPDX-License-Identifier: Apache-2.0
#include "bench/bodies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <numeric>

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
  const auto rest = buildRestState(shape, recipe, directions(points), parallelFor);
  if (!rest) {
    std::fprintf(stderr, "a ball of %zu phyxels: %s\n", phyxels, rest.error().c_str());
    std::exit(1);
  }
  return *rest;
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

void evaluateForces(Body &body, const ParallelFor &parallelFor) { body.evaluate(0.0, 0.0, parallelFor); }

}  // namespace bench
