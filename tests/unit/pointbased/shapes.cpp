// SPDX-License-Identifier: Apache-2.0
#include "shapes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "c3de/core/thread_pool.h"

namespace shapes {

using namespace pointbased;

BodyShape box(const Vec3 &min, const Vec3 &max) {
  BodyShape shape;
  shape.min = min;
  shape.max = max;
  shape.volume = (max - min).prod();
  shape.inside = [=](std::span<const Vec3> points, std::span<double> inside) {
    for (std::size_t i = 0; i < points.size(); ++i)
      inside[i] = (points[i].array() > min.array()).all() && (points[i].array() < max.array()).all() ? 1.0 : 0.0;
  };
  shape.surfaceDistance = [=](std::span<const Vec3> points, std::span<double> distances) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 outside = (min - points[i]).cwiseMax(points[i] - max);
      distances[i] = outside.maxCoeff() > 0.0 ? outside.cwiseMax(0.0).norm() : -outside.maxCoeff();
    }
  };
  return shape;
}

BodyShape ball(const Vec3 &centre, double radius) {
  BodyShape shape;
  shape.min = centre - Vec3::Constant(radius);
  shape.max = centre + Vec3::Constant(radius);
  shape.volume = 4.0 / 3.0 * EIGEN_PI * radius * radius * radius;
  shape.inside = [=](std::span<const Vec3> points, std::span<double> inside) {
    for (std::size_t i = 0; i < points.size(); ++i) inside[i] = (points[i] - centre).norm() < radius ? 1.0 : 0.0;
  };
  shape.surfaceDistance = [=](std::span<const Vec3> points, std::span<double> distances) {
    for (std::size_t i = 0; i < points.size(); ++i) distances[i] = std::abs((points[i] - centre).norm() - radius);
  };
  return shape;
}

BodyShape horseshoe() {
  BodyShape shape;
  shape.min = Vec3(0, 0, 0);
  shape.max = Vec3(0.3, 0.2, 0.1);
  shape.volume = 0.3 * 0.2 * 0.1 - 0.1 * 0.1 * 0.1;
  shape.inside = [](std::span<const Vec3> points, std::span<double> inside) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 &p = points[i];
      const bool outer = p.minCoeff() > 0.0 && p[0] < 0.3 && p[1] < 0.2 && p[2] < 0.1;
      const bool slot = p[0] > 0.1 && p[0] < 0.2 && p[1] > 0.1;
      inside[i] = outer && !slot ? 1.0 : 0.0;
    }
  };
  return shape;
}

BodyShape turned(BodyShape shape, const Mat3 &turn) {
  const auto back = [turn](std::span<const Vec3> points) {
    std::vector<Vec3> out;
    for (const Vec3 &x : points) out.push_back(turn.transpose() * x);
    return out;
  };
  if (shape.inside)
    shape.inside = [back, ask = shape.inside](std::span<const Vec3> points, std::span<double> out) {
      ask(back(points), out);
    };
  if (shape.surfaceDistance)
    shape.surfaceDistance = [back, ask = shape.surfaceDistance](std::span<const Vec3> points, std::span<double> out) {
      ask(back(points), out);
    };
  if (shape.crosses)
    shape.crosses = [back, ask = shape.crosses](std::span<const Vec3> from, std::span<const Vec3> to,
                                                std::span<std::uint8_t> out) { ask(back(from), back(to), out); };
  shape.min = Vec3::Constant(std::numeric_limits<double>::max());
  shape.max = -shape.min;
  for (Vec3 &x : shape.surface.positions) {
    x = turn * x;
    shape.min = shape.min.cwiseMin(x);
    shape.max = shape.max.cwiseMax(x);
  }
  return shape;
}

PhyxelCloud filled(const BodyShape &shape, double spacing) {
  const auto cloud = fill(shape, {spacing, 0}, serialFor());
  if (!cloud) throw std::runtime_error(cloud.error());
  return *cloud;
}

std::shared_ptr<const RestState> restState(const BodyShape &shape, double spacing, const NeighborChoice &choice) {
  return buildRestState(filled(shape, spacing), choice, shape.volume, Surface{}, {}, serialFor());
}

std::shared_ptr<const RestState> restState(const std::vector<Vec3> &points, double spacing,
                                           const NeighborChoice &choice) {
  PhyxelCloud cloud;
  cloud.spacing = spacing;
  cloud.positions = points;
  cloud.volumes.assign(points.size(), spacing * spacing * spacing);
  cloud.contactRadii.assign(points.size(), 0.5 * spacing);
  return buildRestState(cloud, choice, static_cast<double>(points.size()) * spacing * spacing * spacing, Surface{}, {},
                        serialFor());
}

std::shared_ptr<const RestState> restState(const BodyShape &shape, const BodyRecipe &recipe,
                                           const std::vector<Vec3> &normals) {
  auto rest = buildRestState(shape, recipe, normals, serialFor());
  if (!rest) throw std::runtime_error(rest.error());
  return *rest;
}

std::unique_ptr<Body> makeBody(std::shared_ptr<const RestState> rest, std::vector<Material> materials,
                               const std::string &name) {
  const double stabilisation = rest->evaluation == Evaluation::phyxels ? kCloudStabilisation : kLatticeStabilisation;
  return std::make_unique<Body>(name, std::move(rest), Constitution{std::move(materials), stabilisation}, serialFor());
}

ParallelFor loopsOf(c3de::ThreadPool &pool) {
  return [&pool](std::size_t n, std::size_t grain, const std::function<void(std::size_t, std::size_t)> &body) {
    pool.parallelFor(n, grain, body);
  };
}

double largest(std::span<const Vec3> field) {
  double norm = 0.0;
  for (const Vec3 &v : field) norm = std::max(norm, v.norm());
  return norm;
}

Vec3 total(std::span<const Vec3> field) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3 &v : field) sum += v;
  return sum;
}

void evaluate(Body &body) {
  body.computeGradients(serialFor());
  body.computeStresses(0.0, serialFor());
  body.computeForces(0.0, serialFor());
}

double forceError(Body &body, double step) {
  evaluate(body);
  const std::vector<Vec3> forces(body.forces().begin(), body.forces().end());
  double largest = 0.0;
  for (const Vec3 &f : forces) largest = std::max(largest, f.norm());
  double error = 0.0;
  const auto energyAt = [&] {
    body.computeGradients(serialFor());
    const ElasticEnergy e = body.elasticEnergy();
    return e.strain + e.stabilisation;
  };
  for (std::size_t i = 0; i < forces.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      double &u = body.state().displacements[i][c];
      const double at = u;
      // Fourth order, so that the truncation error is below the tolerance at a step that does not cancel.
      u = at + step;
      const double p1 = energyAt();
      u = at - step;
      const double m1 = energyAt();
      u = at + 2 * step;
      const double p2 = energyAt();
      u = at - 2 * step;
      const double m2 = energyAt();
      u = at;
      const double derivative = (8.0 * (p1 - m1) - (p2 - m2)) / (12.0 * step);
      error = std::max(error, std::abs(derivative + forces[i][c]));
    }
  evaluate(body);
  return error / largest;
}

}  // namespace shapes
