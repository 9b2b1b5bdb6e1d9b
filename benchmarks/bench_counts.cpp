// SPDX-License-Identifier: Apache-2.0
// Workloads whose instructions callgrind counts (counts.cmake): neither the clock nor other programs disturb them.
//
//   bench_counts kernels                     small workloads, each once to warm up and once through c3deCounted(); prints
//                                            their names in order
//   bench_counts idle [--by-hand] --steps N  a body that falls and oscillates, by Simulator or by the elastic stages
//                                            alone; prints the hash of the state, which is the same
//
// The instruction set of the kernels is fixed at AVX2, the best one that callgrind supports.
#include <hwy/targets.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <utility>

#include "bench/bodies.h"
#include "bench/report.h"
#include "forces/kernels/cell_kernel.h"
#include "shapes.h"

// Callgrind counts only inside this function: its name is passed as an option.
extern "C" {
#if defined(__GNUC__)
__attribute__((noinline))
#elif defined(_MSC_VER)
__declspec(noinline)
#endif
void c3deCounted(const std::function<void()> &workload);
}

void c3deCounted(const std::function<void()> &workload) { workload(); }

namespace {

using namespace pointbased;

constexpr std::size_t kPhyxels = 500, kSurfelCount = 1000;

struct Named {
  std::string name;
  std::function<void()> run;
};

std::shared_ptr<Body> makeBody(const std::shared_ptr<const RestState> &rest, MaterialLaw law,
                               Precision precision = Precision::doublePrecision) {
  auto body = std::make_shared<Body>("ball", rest, bench::constitutionFor(*rest, law), serialFor());
  body->setPrecision(precision);
  bench::deform(*body);
  return body;
}

Named forces(std::string name, std::shared_ptr<Body> body) {
  return {std::move(name), [body = std::move(body)] { bench::evaluateForces(*body, serialFor()); }};
}

// The tangent of a state, and a product with it.
Named tangent(std::string name, std::shared_ptr<Body> body) {
  return {std::move(name), [body = std::move(body)] { body->linearise(serialFor()); }};
}
Named product(std::string name, const std::shared_ptr<Body> &body) {
  auto df = std::make_shared<std::vector<Vec3>>(body->rest().phyxelCount());
  body->linearise(serialFor());
  return {std::move(name), [=] { body->forceDifferential(body->state().displacements, 0.0, *df, serialFor()); }};
}

Named surfels(std::string name, const std::shared_ptr<Body> &body) {
  auto positions = std::make_shared<std::vector<Vec3>>(kSurfelCount),
       normals = std::make_shared<std::vector<Vec3>>(kSurfelCount);
  return {std::move(name), [=] {
            const RestState &rest = body->rest();
            updateSurfels(rest.surfels, rest.surfelNormals, rest.positions, body->state().displacements, *positions,
                          *normals, serialFor());
          }};
}

Obstacle ballBelow(double radius) {
  Obstacle ball;
  ball.name = "ball";
  const Vec3 centre(0.0, -2.0 * radius, 0.0);
  ball.closest = [centre, radius](std::span<const Vec3> points, std::span<const double> ranges,
                                  std::span<SurfacePoint> out) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 away = points[i] - centre;
      const double distance = away.norm() - radius;
      out[i] = {};
      if (std::abs(distance) > ranges[i]) continue;
      out[i].normal = away.normalized();
      out[i].distance = distance;
    }
  };
  return ball;
}

// A fresh search, and one a step later, which reuses the list of distant pairs.
Named contact(std::string name, const std::shared_ptr<Body> &body) {
  auto memory = std::make_shared<ContactState>();
  auto moved = std::make_shared<std::vector<Vec3>>();
  const std::span<const Vec3> from = body->contactPositions(serialFor());
  auto positions = std::make_shared<std::vector<Vec3>>(from.begin(), from.end());
  auto velocities = std::make_shared<std::vector<Vec3>>(positions->size(), Vec3(0.1, -1.0, 0.0));
  constexpr double kStep = 1e-4;
  for (std::size_t i = 0; i < positions->size(); ++i) moved->push_back((*positions)[i] + kStep * (*velocities)[i]);
  auto obstacles = std::make_shared<std::vector<Obstacle>>(1, ballBelow(bench::ballRadius(kPhyxels)));
  return {std::move(name), [=] {
            WorldBox box;
            box.enabled = true;
            box.min = Vec3::Constant(-1.02 * bench::ballRadius(kPhyxels));
            *memory = {};
            const std::span<const double> radii = body->rest().contact.radii;
            findContacts(*obstacles, box, 0.0, kStep, 1e-4, *positions, *velocities, radii, *memory, serialFor());
            findContacts(*obstacles, box, kStep, kStep, 1e-4, *moved, *velocities, radii, *memory, serialFor());
          }};
}

void countKernels(const bench::Options & /*options*/, bench::Report &report) {
  if ((hwy::SupportedTargets() & HWY_AVX2) != 0) {
    hwy::SetSupportedTargetsForTest(HWY_AVX2);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
  const auto lattice = bench::latticeBall(kPhyxels, kSurfelCount, serialFor());
  const auto cloud = bench::cloudBall(kPhyxels, kSurfelCount, serialFor());
  const auto touching = bench::cloudBall(kPhyxels, 0, serialFor());
  std::vector<Named> workloads;
  for (const auto &[law, name] :
       {std::pair{MaterialLaw::linear, "linear"}, std::pair{MaterialLaw::stVenantKirchhoff, "stvk"},
        std::pair{MaterialLaw::corotated, "corotated"}, std::pair{MaterialLaw::neoHookean, "neo_hookean"}}) {
    workloads.push_back(forces(std::string("forces, lattice, ") + name, makeBody(lattice, law)));
    workloads.push_back(forces(std::string("forces, cloud, ") + name, makeBody(cloud, law)));
  }
  workloads.push_back(forces("forces, lattice, neo_hookean, float",
                             makeBody(lattice, MaterialLaw::neoHookean, Precision::singlePrecision)));
  workloads.push_back(tangent("tangent, lattice", makeBody(lattice, MaterialLaw::neoHookean)));
  workloads.push_back(tangent("tangent, cloud", makeBody(cloud, MaterialLaw::neoHookean)));
  workloads.push_back(product("hessian product, lattice", makeBody(lattice, MaterialLaw::neoHookean)));
  workloads.push_back(product("hessian product, cloud", makeBody(cloud, MaterialLaw::neoHookean)));
  workloads.push_back(surfels("surfels, lattice", makeBody(lattice, MaterialLaw::neoHookean)));
  workloads.push_back(surfels("surfels, cloud", makeBody(cloud, MaterialLaw::neoHookean)));
  workloads.push_back(contact("contact search", makeBody(touching, MaterialLaw::neoHookean)));
  const std::shared_ptr<bench::World> falling = bench::fallingBall(lattice);
  workloads.push_back({"explicit substep, lattice", [falling] { falling->step(); }});
  report.note("compiler " + bench::compilerName() + "\ntarget " + kernels::kernelTarget());
  for (const Named &workload : workloads) {
    workload.run();
    c3deCounted(workload.run);
    report.note("counted " + workload.name);
  }
}

const Vec3 kGravity(0.0, -9.81, 0.0);  // m/s²

/// FNV-1a, as Simulator::stateHash().
std::uint64_t hashOf(const State &state) {
  std::uint64_t hash = 14695981039346656037ull;
  for (const auto *field : {&state.displacements, &state.velocities})
    for (const Vec3 &x : *field) {
      unsigned char bytes[3 * sizeof(double)];
      std::memcpy(bytes, x.data(), sizeof bytes);
      for (const unsigned char byte : bytes) hash = (hash ^ byte) * 1099511628211ull;
    }
  return hash;
}

/// Only half a kick, drift, forces and half a kick, and the stability bound of the step, which Verlet needs.
void stepByHand(Body &body, double dt, std::size_t steps) {
  const std::span<const double> inverse = body.inverseMasses();
  const std::size_t n = body.rest().phyxelCount();
  std::vector<Vec3> &u = body.state().displacements, &v = body.state().velocities;
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
  for (std::size_t step = 0; step < steps; ++step) {
    if (!(dt <= kStepSafety * body.stableStep()))
      throw std::runtime_error("step " + std::to_string(step) + " is not stable");
    kick();
    drift();
    evaluate();
    kick();
  }
}

// Without contact, supports, loads, viscosity or plastic flow, by velocity Verlet.
void stepIdle(const bench::Options &options, bench::Report &report) {
  BodyRecipe recipe;
  recipe.sampling.spacing = 0.01;
  const auto rest =
      bench::valueOf(buildRestState(shapes::box(Vec3::Zero(), Vec3(0.12, 0.06, 0.05)), recipe, {}, serialFor()));
  const auto made = [&] {
    auto body = std::make_unique<Body>("body", rest, bench::elastic(1e4, 0.45, 1000.0), serialFor());
    for (std::size_t i = 0; i < rest->phyxelCount(); ++i) {
      const Vec3 &X = rest->positions[i];
      body->state().velocities[i] = Vec3(1, 2, 0.5).cross(X) + 0.1 * Vec3(std::sin(40 * X[0]), 0, std::cos(30 * X[0]));
    }
    return body;
  };
  const std::size_t steps = options.count("--steps", 64);
  WorldSettings settings;
  settings.gravity = kGravity;
  settings.dt = 0.5 * made()->stableStepAtRest();
  std::uint64_t hash = 0;
  if (options.has("--by-hand")) {
    const auto body = made();
    stepByHand(*body, settings.dt, steps);
    hash = hashOf(body->state());
  } else {
    bench::World world(made(), settings);
    for (std::size_t i = 0; i < steps; ++i) world.step();
    hash = hashOf(world.body().state());
  }
  char text[120];
  std::snprintf(text, sizeof text, "%zu phyxels, %zu points, %zu steps, state %016llx", rest->phyxelCount(),
                rest->pointCount(), steps, static_cast<unsigned long long>(hash));
  report.note(text);
}

}  // namespace

int main(int argc, char **argv) {
  return bench::run("bench_counts", {{"kernels", "", countKernels}, {"idle", "[--by-hand] [--steps N]", stepIdle}},
                    argc, argv);
}
