// SPDX-License-Identifier: Apache-2.0
// Lattices that are refilled inside their current skin.
#include <cmath>

#include "c3de/core/thread_pool.h"
#include "contact_cases.h"
#include "rereferencing/rereferencing.h"
#include "shapes.h"
#include "support/catch.h"
#include "surfaces.h"

using namespace pointbased;

namespace {

constexpr double kRadius = 0.04;

Material clay(double yield) {
  Material material{MaterialLaw::neoHookean, 2e4, 0.4, 1000.0, 5.0};
  material.plastic = {yield, 0.9, 1.0 / 60.0, Plasticity::kNever};
  return material;
}

std::unique_ptr<Body> lattice(const Surface &surface, double spacing, double yield,
                              const std::vector<Fix> &fixes = {}) {
  BodyRecipe recipe{.sampling = {.spacing = spacing}, .fixes = fixes};
  recipe.reshape = [](const Surface &skin) -> Result<BodyShape> { return shapes::inside(skin); };
  return shapes::makeBody(shapes::restState(shapes::inside(surface), recipe), {clay(yield)});
}

std::unique_ptr<Body> block(double spacing = 0.012, double yield = 0.05, const std::vector<Fix> &fixes = {}) {
  return lattice(shapes::boxSurface(Vec3::Zero(), Vec3::Constant(0.06), 5), spacing, yield, fixes);
}

Surface skinOf(const Body &body) {
  Surface out;
  out.triangles = body.rest().skin;
  out.positions.resize(body.rest().surfels.count());
  updateSurfels(body.rest().surfels, {}, body.rest().positions, body.state().displacements, out.positions, {},
                serialFor());
  for (Vec3 &x : out.positions) x += body.rest().origin;
  return out;
}

struct Moments {
  double mass = 0.0;
  Vec3 centre = Vec3::Zero(), linear = Vec3::Zero(), angular = Vec3::Zero();
};
Moments momentsOf(const Body &body) {
  Moments out;
  for (std::size_t i = 0; i < body.rest().phyxelCount(); ++i) {
    const Vec3 x = body.rest().origin + body.rest().positions[i] + body.state().displacements[i];
    const Vec3 p = body.masses()[i] * body.state().velocities[i];
    out.mass += body.masses()[i];
    out.centre += body.masses()[i] * x;
    out.linear += p;
    out.angular += x.cross(p);
  }
  out.centre /= out.mass;
  return out;
}

/// Stretched out, bent and rotated, half of it flowed; spinning and stretching.
void knead(Body &body) {
  const Mat3 R = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  for (std::size_t i = 0; i < body.rest().phyxelCount(); ++i) {
    const Vec3 &X = body.rest().positions[i];
    const Vec3 x = R * Vec3(1.4 * X[0] + 3.0 * X[1] * X[1], 0.8 * X[1], 0.9 * X[2] + 1.5 * X[0] * X[1]);
    body.state().displacements[i] = x - X;
    body.state().velocities[i] =
        Vec3(0.1, 0.2, -0.1) + Vec3(3, -1, 2).cross(x) + Vec3(2.0 * x[0], -x[1], 5.0 * x[0] * x[1]);
  }
  body.computeGradients(serialFor());
  body.computeFlow(0.02, serialFor());
  body.computeElasticStresses(serialFor());
}

void rereference(Body &body) {
  auto renewal = rereferenced(body, serialFor());
  REQUIRE(renewal);
  body.rereference(renewal->rest, renewal->state, serialFor());
}

}  // namespace

TEST_CASE("a lattice that is filled anew keeps mass, both momenta and its skin, and its energies nearly") {
  for (const double spacing : {0.012, 0.009}) {
    auto body = block(spacing);
    knead(*body);
    const Moments before = momentsOf(*body);
    const double strain = body->elasticEnergy().strain, kinetic = body->kineticEnergy();
    const Surface skin = skinOf(*body);
    rereference(*body);
    const Moments after = momentsOf(*body);
    CHECK(after.mass == Approx(before.mass).epsilon(1e-13));
    CHECK((after.linear - before.linear).norm() < 1e-13 * before.linear.norm());
    CHECK((after.angular - before.angular).norm() < 1e-12 * before.angular.norm());
    const Surface now = skinOf(*body);
    double moved = 0.0;
    for (std::size_t i = 0; i < skin.positions.size(); ++i)
      moved = std::max(moved, (now.positions[i] - skin.positions[i]).norm());
    CHECK(moved < 1e-12);
    double volume = 0.0, rest = 0.0;
    for (std::size_t q = 0; q < body->rest().pointCount(); ++q) {
      volume += body->rest().stencils.volumes[q] * body->gradients()[q].determinant();
      rest += body->rest().stencils.volumes[q];
    }
    CHECK(rest == Approx(0.06 * 0.06 * 0.06).epsilon(1e-3));  // without strain: its initial volume
    INFO("spacing " << spacing << ": strain energy " << body->elasticEnergy().strain / strain << ", kinetic "
                    << body->kineticEnergy() / kinetic << ", centre of mass "
                    << (after.centre - before.centre).norm() / spacing << " spacings, volume "
                    << volume / shapes::volumeOf(skin));
    CHECK(volume == Approx(shapes::volumeOf(skin)).epsilon(0.02));
    CHECK(body->elasticEnergy().strain == Approx(strain).epsilon(0.03));
    CHECK(body->kineticEnergy() == Approx(kinetic).epsilon(0.03));
    CHECK((after.centre - before.centre).norm() < 0.05 * spacing);
    CHECK(body->elasticEnergy().stabilisation < 1e-20);
  }
}

TEST_CASE("forces of a lattice that was filled anew are the negative gradient of its energy") {
  auto body = block(0.02);
  knead(*body);
  rereference(*body);
  std::fill(body->state().velocities.begin(), body->state().velocities.end(), Vec3::Zero());  // no viscous forces
  shapes::Random random(9);
  for (Vec3 &u : body->state().displacements) u += 1e-3 * random.vector();
  CHECK(shapes::forceError(*body, 1e-6) < 1e-7);  // of fourth-order differences
}

namespace {

struct Drop {
  Simulator simulator;
  std::size_t id = 0;

  explicit Drop(bool renewing, ParallelFor parallelFor = serialFor()) : simulator(std::move(parallelFor)) {
    simulator.setWorld({.gravity = Vec3(0, -9.81, 0),
                        .box = {true, Vec3(-1, 0, -1), Vec3(1, 1, 1), 0.3},
                        .damping = 1.0,
                        .rereference = renewing});
    id = simulator.addBody(lattice(shapes::ballSurface(Vec3(0, kRadius + 0.001, 0), kRadius, 8), 0.014, 0.002));
  }
  void run(double until) {
    while (simulator.time() < until) REQUIRE(simulator.step());
  }
  Body &body() { return *simulator.body(id); }
};

}  // namespace

TEST_CASE("a lattice drop that may flow without end spreads on, its volume and its step kept") {
  std::array<double, 2> share{}, step{}, gravity{}, lost{};
  for (const bool renewing : {true, false}) {
    Drop drop(renewing);
    Body &body = drop.body();
    const double mass = body.totalMass(), volume = shapes::volumeOf(skinOf(body)), first = body.stableStepAtRest();
    double height = 1.0;
    for (int k = 1; k <= 5; ++k) {
      drop.run(0.3 * k);
      const double now = shapes::extent(body, Vec3(0, 1, 0)).high;
      CHECK(now < height);
      height = now;
    }
    const auto energy = drop.simulator.diagnostics().energy(drop.id);
    share[renewing] = energy.stabilisation / (energy.elastic + energy.stabilisation);
    step[renewing] = body.stableStep() / first;
    gravity[renewing] = energy.gravity;
    INFO("rereferenceCount " << body.rereferenceCount() << ", height " << height << ", volume "
                             << shapes::volumeOf(skinOf(body)) / volume << ", share of the control " << share[renewing]
                             << ", stable step " << step[renewing] << ", gravity " << energy.gravity);
    CHECK(body.totalMass() == Approx(mass).epsilon(1e-13));
    CHECK_FALSE(body.stopped);
    lost[renewing] = 1.0 - shapes::volumeOf(skinOf(body)) / volume;
    CHECK(std::abs(lost[renewing]) < 0.02);  // 0.3 % of it under its weight; the rest are coarse facets that flatten
    CHECK((body.rereferenceCount() >= 2) == renewing);
  }
  // In its first cells it is supported by the control, which does not flow, and its step falls to less than half.
  CHECK(share[0] > 0.85);
  CHECK(step[0] < 0.5);
  CHECK(step[1] > 0.6);
  CHECK(gravity[1] < gravity[0]);
  CHECK(std::abs(lost[1]) < std::abs(lost[0]) + 1e-3);
}

TEST_CASE("a lattice is filled anew the same way on any number of threads, and a reset leads back bit for bit") {
  Drop one(true);
  const std::uint64_t start = one.simulator.stateHash();
  one.run(0.15);
  const std::uint64_t end = one.simulator.stateHash();
  REQUIRE(one.body().rereferenceCount() >= 1);
  c3de::ThreadPool pool(3);
  Drop three(true, shapes::loopsOf(pool));
  three.run(0.15);
  CHECK(three.simulator.stateHash() == end);
  one.simulator.reset();
  CHECK(one.simulator.stateHash() == start);
  one.run(0.15);
  CHECK(one.simulator.stateHash() == end);
}

TEST_CASE("a lattice with supports flows on in its first cells, and says so") {
  const Fix floor{.region = BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1e-6, 1)}};
  const Fix lid{
      .region = BoxRegion{Vec3(-1, 0.06 - 1e-6, -1), Vec3(1, 1, 1)}, .displacement = Vec3(0.12, 0, 0), .ramp = 0.2};
  Simulator simulator;
  const std::size_t id = simulator.addBody(block(0.02, 0.01, {floor, lid}));
  while (simulator.time() < 0.2) REQUIRE(simulator.step());
  CHECK(needsRereferencing(*simulator.body(id)));
  CHECK(simulator.body(id)->rereferenceCount() == 0);
  std::size_t told = 0;
  for (const SimulationEvent &event : simulator.diagnostics().events())
    told += event.text.find("supports and loads are given in its first shape") != std::string::npos ? 1 : 0;
  CHECK(told == 1);
}
