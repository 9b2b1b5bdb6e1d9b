// SPDX-License-Identifier: Apache-2.0
// Measures the overhead that unused features add to an elastic step.
//
//   bench_idle_cost simulator|by_hand STEPS
//
// A free body falls and oscillates, without contact, supports, loads, viscosity or plastic flow, by velocity Verlet:
// once through Simulator, and once by the elastic stages alone, written out below. Both end in the same bits, whose
// hash is printed: they are the same steps. Callgrind counts the instructions; the count of a shorter run is subtracted
// from that of STEPS steps, so that building the body does not count. idle_cost.cmake does this and evaluates the
// result.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "pointbased/simulator.h"

namespace {

using namespace pointbased;

const Vec3 kGravity(0.0, -9.81, 0.0);  // m/s²

std::shared_ptr<const RestState> restState() {
  const Vec3 max(0.12, 0.06, 0.05);
  BodyShape shape;
  shape.max = max;
  shape.volume = max.prod();
  shape.inside = [max](std::span<const Vec3> points, std::span<double> inside) {
    for (std::size_t i = 0; i < points.size(); ++i)
      inside[i] = (points[i].array() > 0.0).all() && (points[i].array() < max.array()).all() ? 1.0 : 0.0;
  };
  shape.surfaceDistance = [max](std::span<const Vec3> points, std::span<double> distances) {
    for (std::size_t i = 0; i < points.size(); ++i)
      distances[i] = std::abs(points[i].cwiseMin(max - points[i]).minCoeff());
  };
  BodyRecipe recipe;
  recipe.sampling.spacing = 0.01;
  auto rest = buildRestState(shape, recipe, {}, serialFor());
  if (!rest) {
    std::fprintf(stderr, "bench_idle_cost: %s\n", rest.error().c_str());
    std::exit(1);
  }
  return *rest;
}

Constitution constitution() {
  Material material;
  material.law = MaterialLaw::neoHookean;
  material.youngsModulus = 1e4;
  material.poissonRatio = 0.45;
  material.restDensity = 1000.0;
  return {{material}, kLatticeStabilisation};
}

Vec3 velocityAt(const Vec3 &X) {
  return Vec3(1, 2, 0.5).cross(X) + 0.1 * Vec3(std::sin(40 * X[0]), 0, std::cos(30 * X[0]));
}

/// FNV-1a, as Simulator::stateHash().
std::uint64_t hashOf(std::span<const Vec3> u, std::span<const Vec3> v) {
  std::uint64_t hash = 14695981039346656037ull;
  for (const auto field : {u, v})
    for (const Vec3 &x : field) {
      unsigned char bytes[3 * sizeof(double)];
      std::memcpy(bytes, x.data(), sizeof bytes);
      for (const unsigned char byte : bytes) hash = (hash ^ byte) * 1099511628211ull;
    }
  return hash;
}

std::uint64_t bySimulator(const std::shared_ptr<const RestState> &rest, double dt, int steps) {
  Simulator simulator;
  WorldSettings world;
  world.gravity = kGravity;
  world.dt = dt;
  simulator.setWorld(world);
  const std::size_t id = simulator.addBody(std::make_unique<Body>("body", rest, constitution(), serialFor()));
  Body &body = *simulator.body(id);
  for (std::size_t i = 0; i < rest->phyxelCount(); ++i) body.state().velocities[i] = velocityAt(rest->positions[i]);
  for (int i = 0; i < steps; ++i)
    if (const auto done = simulator.step(); !done) {
      std::fprintf(stderr, "bench_idle_cost: %s\n", done.error().text.c_str());
      std::exit(1);
    }
  return hashOf(body.state().displacements, body.state().velocities);
}

/// Only half a kick, drift, forces and half a kick, and the stability bound of the step, which Verlet needs.
std::uint64_t byHand(const std::shared_ptr<const RestState> &rest, double dt, int steps) {
  Body body("body", rest, constitution(), serialFor());
  const std::span<const double> inverse = body.inverseMasses();
  const std::size_t n = rest->phyxelCount();
  std::vector<Vec3> &u = body.state().displacements, &v = body.state().velocities;
  for (std::size_t i = 0; i < n; ++i) v[i] = velocityAt(rest->positions[i]);
  const auto evaluate = [&] { body.evaluate(0.0, dt, serialFor()); };
  const auto kick = [&] {
    for (std::size_t i = 0; i < n; ++i) v[i] += 0.5 * dt * (inverse[i] * body.forces()[i] + kGravity);
  };
  const auto drift = [&] {
    const auto numbers = static_cast<Eigen::Index>(3 * n);
    Eigen::Map<Eigen::VectorXd>(u.front().data(), numbers) +=
        dt * Eigen::Map<const Eigen::VectorXd>(v.front().data(), numbers);
  };
  evaluate();
  for (int step = 0; step < steps; ++step) {
    if (!(dt <= kStepSafety * body.stableStep())) {
      std::fprintf(stderr, "bench_idle_cost: step %d is not stable\n", step);
      std::exit(1);
    }
    kick();
    drift();
    evaluate();
    kick();
  }
  return hashOf(u, v);
}

}  // namespace

int main(int argc, char **argv) {
  const std::string mode = argc == 3 ? argv[1] : "";
  const int steps = argc == 3 ? std::atoi(argv[2]) : 0;
  if ((mode != "simulator" && mode != "by_hand") || steps <= 0) {
    std::fprintf(stderr, "usage: bench_idle_cost simulator|by_hand STEPS\n");
    return 2;
  }
  const auto rest = restState();
  const double dt = 0.5 * Body("body", rest, constitution(), serialFor()).stableStepAtRest();
  const std::uint64_t hash = mode == "simulator" ? bySimulator(rest, dt, steps) : byHand(rest, dt, steps);
  std::printf("%s: %zu phyxels, %zu points, %d steps, state %016llx\n", mode.c_str(), rest->phyxelCount(),
              rest->pointCount(), steps, static_cast<unsigned long long>(hash));
  return 0;
}
