// SPDX-License-Identifier: Apache-2.0
// Counts the instructions of fixed kernels: a performance regression gate that neither the clock nor other programs
// disturb.
//
//   bench_counts
//
// Runs small workloads, each once to warm up and once through c3deCounted(), and prints their names in order.
// instruction_counts.cmake runs it under callgrind, which writes its counts after every c3deCounted(), and compares
// with instruction_counts.json. The instruction set is fixed at AVX2, the best one that callgrind supports.
#include <hwy/targets.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/bodies.h"
#include "bench/machine.h"
#include "forces/kernels/cell_kernel.h"
#include "pointbased/simulator.h"

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

Named substep(std::string name, const std::shared_ptr<const RestState> &rest) {
  auto simulator = std::make_shared<Simulator>();
  auto body = std::make_unique<Body>("ball", rest, bench::constitutionFor(*rest), serialFor());
  WorldSettings world;
  world.gravity = Vec3(0, -9.81, 0);
  world.dt = 0.5 * body->stableStepAtRest();
  simulator->setWorld(world);
  bench::deform(*simulator->body(simulator->addBody(std::move(body))));
  return {std::move(name), [simulator] { (void)simulator->step(); }};
}

}  // namespace

int main() {
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
  workloads.push_back(substep("explicit substep, lattice", lattice));
  std::printf("compiler %s\ntarget %s\n", bench::build().compiler.c_str(), kernels::kernelTarget());
  for (const Named &workload : workloads) {
    workload.run();
    c3deCounted(workload.run);
    std::printf("counted %s\n", workload.name.c_str());
  }
  return 0;
}
