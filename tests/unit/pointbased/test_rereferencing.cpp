// SPDX-License-Identifier: Apache-2.0
#include "rereferencing/rereferencing.h"

#include <cmath>

#include "c3de/core/thread_pool.h"
#include "contact_cases.h"
#include "pointbased/plasticity.h"
#include "shapes.h"
#include "support/catch.h"
#include "surfaces.h"

using namespace pointbased;

namespace {

constexpr double kEdge = 0.06;

Material clay(double yield, double poissonRatio = 0.4) {
  Material material{MaterialLaw::neoHookean, 2e4, poissonRatio, 1000.0, 5.0};
  material.plastic = {yield, 0.9, 1.0 / 60.0, Plasticity::kNever};
  return material;
}

std::unique_ptr<Body> filledBody(const BodyShape &shape, const Surface &surface, const Material &material,
                                 double spacing, const std::vector<Fix> &fixes = {},
                                 const std::vector<Load> &loads = {}) {
  BodyShape whole = shape;
  whole.surface = surface;
  return shapes::makeBody(
      shapes::restState(
          whole, {.evaluation = Evaluation::phyxels, .sampling = {.spacing = spacing}, .fixes = fixes, .loads = loads}),
      {material});
}

std::unique_ptr<Body> block(const Material &material, double spacing = 0.012, const std::vector<Fix> &fixes = {},
                            const std::vector<Load> &loads = {}) {
  const Vec3 min(0, 0, 0), max(kEdge, kEdge, kEdge);
  return filledBody(shapes::box(min, max), shapes::boxSurface(min, max, 6), material, spacing, fixes, loads);
}

/// Flattened, bent, rotated, and partly flowed.
void knead(Body &body, const Mat3 &rotation = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix()) {
  shapes::Random random(5);
  for (std::size_t i = 0; i < body.rest().phyxelCount(); ++i) {
    const Vec3 &X = body.rest().positions[i];
    const Vec3 x = rotation * Vec3(1.5 * X[0] + 4.0 * X[1] * X[1], 0.7 * X[1], X[2] / 1.0 + 2.0 * X[0] * X[1]);
    body.state().displacements[i] = x - X + 2e-4 * random.vector();
    body.state().velocities[i] = 0.3 * random.vector();
  }
  body.computeGradients(serialFor());
  body.computeFlow(0.02, serialFor());
  body.computeStresses(0.0, serialFor());
}

Mat3 cauchy(const Body &body, std::size_t q) {
  const Mat3 &F = body.gradients()[q];
  return body.stresses()[q] * F.transpose() / (body.rest().stencils.volumes[q]);  // J σ: the volume at rest counts
}

void rereference(Body &body) {
  auto renewal = rereferenced(body, serialFor());
  REQUIRE(renewal);
  body.rereference(renewal->rest, renewal->state, serialFor());
}

double skinVolume(Simulator &simulator, std::size_t id) {
  std::vector<Vec3> x, n;
  simulator.world().surfels(id, x, n);
  double volume = 0.0;
  for (const auto &t : simulator.body(id)->rest().skin) volume += x[t[0]].dot(x[t[1]].cross(x[t[2]])) / 6.0;
  return volume;
}

}  // namespace

TEST_CASE("a renewed reference keeps stress, strain energy, mass and both momenta") {
  Material material = clay(0.05);
  material.viscosity = 0.0;
  material.prony[0] = {0.3, 0.1};
  auto body = block(material);
  knead(*body);
  body->computeStresses(0.05, serialFor());  // something has relaxed
  body->computeStresses(0.0, serialFor());
  const double energy = body->elasticEnergy().strain, mass = body->totalMass();
  const shapes::Momenta momenta = shapes::momenta(*body);
  std::vector<Mat3> stresses;
  double largest = 0.0;
  for (std::size_t q = 0; q < body->rest().pointCount(); ++q) {
    stresses.push_back(cauchy(*body, q));
    largest = std::max(largest, stresses.back().norm());
  }
  const auto before = body->sharedRest();
  rereference(*body);
  CHECK(body->rest().positions != before->positions);
  CHECK(body->rest().volumes == before->volumes);
  CHECK(body->totalMass() == mass);
  CHECK(shapes::momenta(*body).linear == momenta.linear);
  // X + u is rounded once.
  CHECK((shapes::momenta(*body).angular - momenta.angular).norm() < 1e-14 * momenta.angular.norm());
  CHECK(body->elasticEnergy().strain == Approx(energy).epsilon(1e-11));
  body->computeStresses(0.0, serialFor());
  for (std::size_t q = 0; q < stresses.size(); ++q) CHECK((cauchy(*body, q) - stresses[q]).norm() < 1e-10 * largest);
  // The energy stored in the control is released, never increased.
  CHECK(body->elasticEnergy().stabilisation < 1e-20);
}

TEST_CASE("forces of a renewed body are the negative gradient of its energy, and turn with it") {
  auto body = block(clay(0.05), 0.02);
  knead(*body);
  rereference(*body);
  std::fill(body->state().velocities.begin(), body->state().velocities.end(), Vec3::Zero());  // no viscous forces
  shapes::Random random(9);
  for (Vec3 &u : body->state().displacements) u += 1e-3 * random.vector();
  CHECK(shapes::forceError(*body, 1e-6) < 1e-7);  // of fourth-order differences
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  double size = 0.0;
  for (std::size_t i = 0; i < body->rest().phyxelCount(); ++i) {
    force += body->forces()[i];
    torque += (body->rest().positions[i] + body->state().displacements[i]).cross(body->forces()[i]);
    size += body->forces()[i].norm();
  }
  CHECK(force.norm() < 1e-12 * size);
  CHECK(torque.norm() < 1e-12 * size * kEdge);
}

TEST_CASE("the force differential of a renewed body is the derivative of its forces") {
  auto body = block(clay(0.05), 0.02);
  knead(*body);
  rereference(*body);
  shapes::Random random(3);
  const std::size_t n = body->rest().phyxelCount();
  std::vector<Vec3> du(n), df(n);
  for (Vec3 &d : du) d = random.vector();
  const std::vector<Vec3> u0 = body->state().displacements;
  const auto forcesAt = [&](double s) {
    for (std::size_t i = 0; i < n; ++i) body->state().displacements[i] = u0[i] + s * du[i];
    body->computeGradients(serialFor());
    body->computeElasticStresses(serialFor());
    body->computeInternalForces(serialFor());
    return std::vector<Vec3>(body->forces().begin(), body->forces().end());
  };
  const double h = 1e-6;
  const std::vector<Vec3> up = forcesAt(h), down = forcesAt(-h);
  (void)forcesAt(0.0);
  TangentScratch scratch;
  forceDifferential(body->constitution(), body->rest().stencils, body->rest().positions, body->state().displacements,
                    body->gradients(), body->state().history, 0.0, 0.0, du, scratch, df, serialFor());
  double worst = 0.0, size = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    worst = std::max(worst, (df[i] - (up[i] - down[i]) / (2.0 * h)).norm());
    size = std::max(size, df[i].norm());
  }
  CHECK(worst < 1e-5 * size);  // of central differences
}

TEST_CASE("the cap of plastic strain counts what flowed before the reference was renewed") {
  Material material = clay(0.0);
  material.plastic.max = 0.8;
  auto body = block(material);
  const auto stretch = [&](double by) {
    const Mat3 A = Vec3(by, 1.0 / std::sqrt(by), 1.0 / std::sqrt(by)).asDiagonal();
    for (std::size_t i = 0; i < body->rest().phyxelCount(); ++i)
      body->state().displacements[i] = A * body->rest().positions[i] - body->rest().positions[i];
    body->computeGradients(serialFor());
    for (int k = 0; k < 50; ++k) body->computeFlow(0.1, serialFor());
  };
  stretch(1.6);
  rereference(*body);
  stretch(1.6);
  for (std::size_t q = 0; q < body->rest().pointCount(); ++q)
    CHECK(henckyStrain(body->state().history.allFlow(q).transpose()).norm() == Approx(0.8).epsilon(1e-9));
  // The rest is elastic.
  const double whole = std::sqrt(1.5) * 2.0 * std::log(1.6);
  const Mat3 Fe = body->gradients()[0] * body->state().history.plasticInverse[0];
  CHECK(deviatoricHenckyNorm(Fe) == Approx(whole - 0.8).epsilon(1e-6));
}

TEST_CASE("a reference is worn when flow has gone far, not when strain has") {
  auto body = block(clay(10.0));
  knead(*body);
  CHECK_FALSE(needsRereferencing(*body));
  auto soft = block(clay(0.0));
  for (const double stretch : {1.4, 1.6}) {
    const Mat3 A = Vec3(stretch, 1.0 / std::sqrt(stretch), 1.0 / std::sqrt(stretch)).asDiagonal();
    for (std::size_t i = 0; i < soft->rest().phyxelCount(); ++i)
      soft->state().displacements[i] = A * soft->rest().positions[i] - soft->rest().positions[i];
    soft->computeGradients(serialFor());
    soft->computeFlow(1.0, serialFor());
    CHECK(needsRereferencing(*soft) == (stretch > 1.5));
  }
  Material linear = clay(0.0);
  linear.law = MaterialLaw::linear;
  soft->setConstitution({{linear}, kCloudStabilisation}, serialFor());
  CHECK_FALSE(needsRereferencing(*soft));
}

namespace {

/// A block compressed to half its height between the floor and a plate, which then retracts.
struct Press {
  Simulator simulator;
  std::size_t id = 0;

  explicit Press(ParallelFor parallelFor = serialFor(), bool renewing = true) : simulator(std::move(parallelFor)) {
    simulator.setWorld({.box = {true, Vec3(-1, 0, -1), Vec3(1, 1, 1), 0.1}, .damping = 2.0, .rereference = renewing});
    Obstacle plate = shapes::halfSpace(Vec3(0, kEdge, 0), Vec3(0, -1, 0), 0.1);
    plate.motion = [](double t) {
      const double down = t < 0.5 ? t / 0.5 : t < 0.6 ? 1.0 : std::max(-1.0, 1.0 - (t - 0.6) / 0.2);
      return RigidMotion{.displacement = Vec3(0, -0.5 * kEdge * down, 0)};
    };
    simulator.addObstacle(plate);
    id = simulator.addBody(block(clay(0.01)));
  }
  void run(double until) {
    while (simulator.time() < until) REQUIRE(simulator.step());
  }
};

}  // namespace

TEST_CASE("a clay block pressed to half its height keeps its volume and its shape when released") {
  Press press;
  const double volume = skinVolume(press.simulator, press.id);
  press.run(1.2);
  const Body &body = *press.simulator.body(press.id);
  const shapes::Extent height = shapes::extent(*press.simulator.body(press.id), Vec3(0, 1, 0));
  INFO("rereferenceCount " << body.rereferenceCount() << ", volume " << skinVolume(press.simulator, press.id) / volume
                           << ", height " << (height.high - height.low) / kEdge);
  CHECK(body.rereferenceCount() >= 1);
  CHECK_FALSE(body.stopped);
  CHECK(skinVolume(press.simulator, press.id) / volume == Approx(1.0).margin(0.01));
  CHECK(height.high - height.low <
        0.55 * kEdge);  // springs back by the elastic strain, 1 %, and a little at the corners
  CHECK(height.high - height.low > 0.45 * kEdge);
  CHECK(shapes::momenta(body).linear[0] ==
        Approx(0.0).margin(1e-5));  // kg m/s: only friction has pushed it aside, whose solutions end
                                    // at 5e-3 of the velocities that change
}

TEST_CASE("a state that was kept before the reference was renewed is taken up with its own reference", "[checkpoint]") {
  Press press;
  press.simulator.world().addProbe("corner", press.id, Vec3(kEdge, 0.5 * kEdge, kEdge));
  press.run(0.1);
  const Checkpoint kept = press.simulator.archive().checkpoint();
  const Body &body = *press.simulator.body(press.id);
  const auto rest = body.sharedRest();
  const std::size_t rereferenceCount = body.rereferenceCount();
  const std::uint64_t hash = press.simulator.stateHash();
  press.run(0.4);
  const Vec3 corner = press.simulator.world().probeState(press.simulator.world().probes()[0]).position;
  REQUIRE(body.rereferenceCount() > rereferenceCount);
  REQUIRE(press.simulator.archive().restore(kept));
  CHECK(body.sharedRest() == rest);
  CHECK(body.rereferenceCount() == rereferenceCount);
  CHECK(press.simulator.stateHash() == hash);
  press.run(0.4);
  // Forces are recomputed at the start, and plastic material does so once more: some nanometres of a step's 10 µm.
  CHECK((press.simulator.world().probeState(press.simulator.world().probes()[0]).position - corner).norm() < 1e-5);
}

TEST_CASE("renewing does not depend on threads, and a reset leads back to the first reference bit for bit") {
  Press one;
  const std::uint64_t start = one.simulator.stateHash();
  const auto first = one.simulator.body(one.id)->sharedRest();
  one.simulator.world().addProbe("corner", one.id, Vec3(kEdge, 0.5 * kEdge, kEdge));
  one.run(0.4);
  const std::uint64_t end = one.simulator.stateHash();
  REQUIRE(one.simulator.body(one.id)->rereferenceCount() >= 1);
  c3de::ThreadPool pool(3);
  Press three(shapes::loopsOf(pool));
  three.run(0.4);
  CHECK(three.simulator.stateHash() == end);
  one.simulator.reset();
  CHECK(one.simulator.stateHash() == start);
  CHECK(one.simulator.body(one.id)->sharedRest() == first);
  CHECK(one.simulator.body(one.id)->rereferenceCount() == 0);
  CHECK((one.simulator.world().probeState(one.simulator.world().probes()[0]).position - Vec3(kEdge, 0.5 * kEdge, kEdge))
            .norm() < 1e-15);
  one.run(0.4);
  CHECK(one.simulator.stateHash() == end);
}

TEST_CASE("probes, supports and gravity go on through a renewal without a jump") {
  const Fix floor{.region = BoxRegion{Vec3(-1, -1, -1), Vec3(1, 0.001, 1)}};
  const Fix lid{
      .region = BoxRegion{Vec3(-1, kEdge - 0.001, -1), Vec3(1, 1, 1)}, .displacement = Vec3(0.08, 0, 0), .ramp = 0.4};
  Simulator simulator;
  simulator.setWorld({.gravity = Vec3(0, -9.81, 0), .damping = 2.0});
  const std::size_t id = simulator.addBody(block(clay(0.01), 0.012, {floor, lid}));
  simulator.world().addProbe("lid", id, Vec3(0.5 * kEdge, kEdge, 0.5 * kEdge));
  simulator.world().addProbe("middle", id, Vec3(0.5 * kEdge, 0.5 * kEdge, 0.5 * kEdge));
  Body &body = *simulator.body(id);
  double jump = 0.0, gravityJump = 0.0;
  Vec3 last = simulator.world().probeState(simulator.world().probes()[1]).position;
  double lastGravity = 0.0;
  while (simulator.time() < 0.6) {
    const std::size_t before = body.rereferenceCount();
    REQUIRE(simulator.step());
    const Vec3 now = simulator.world().probeState(simulator.world().probes()[1]).position;
    const double gravity = simulator.diagnostics().energy(id).gravity;
    if (body.rereferenceCount() > before) {
      jump = std::max(jump, (now - last).norm());
      gravityJump = std::max(gravityJump, std::abs(gravity - lastGravity));
    }
    last = now;
    lastGravity = gravity;
  }
  CHECK(body.rereferenceCount() >= 1);
  CHECK(jump < 1e-3);         // its travel in a step at 0.1 m/s
  CHECK(gravityJump < 1e-4);  // the same, of 0.2 kg
  const Vec3 lidNow = simulator.world().probeState(simulator.world().probes()[0]).position;
  CHECK((lidNow - Vec3(0.5 * kEdge + 0.08, kEdge, 0.5 * kEdge)).norm() < 2e-3);  // patches hold compliantly
}

TEST_CASE("a follower pressure goes on with the surface it has after a renewal, a dead one with its own") {
  Load press{.region = BoxRegion{Vec3(-1, kEdge - 1e-6, -1), Vec3(1, kEdge + 1e-6, 1)}, .pressure = 100.0};
  for (const bool follower : {true, false}) {
    press.follower = follower;
    auto body = block(clay(0.0), 0.012, {}, {press});
    const Mat3 A = Vec3(1.5, 1.0, 1.0).asDiagonal();
    for (std::size_t i = 0; i < body->rest().phyxelCount(); ++i)
      body->state().displacements[i] = A * body->rest().positions[i] - body->rest().positions[i];
    body->computeGradients(serialFor());
    const auto total = [&] {
      std::vector<Vec3> f(body->rest().phyxelCount(), Vec3::Zero());
      addLoadForces(press, body->rest().conditions.loaded[0], 1.0, body->state().displacements, f);
      Vec3 sum = Vec3::Zero();
      for (const Vec3 &v : f) sum += v;
      return sum;
    };
    const Vec3 before = total();
    CHECK(before[1] == Approx(-100.0 * kEdge * kEdge * (follower ? 1.5 : 1.0)));
    rereference(*body);
    CHECK((total() - before).norm() < 1e-9 * before.norm());
  }
}

TEST_CASE("a drop that may flow without end spreads over the floor, its volume kept, its height falling all the way") {
  std::array<double, 2> share{}, step{};
  for (const bool renewing : {true, false}) {
    const double radius = 0.04;
    const Vec3 centre(0, radius + 0.001, 0);
    Simulator simulator;
    simulator.setWorld({.gravity = Vec3(0, -9.81, 0),
                        .box = {true, Vec3(-1, 0, -1), Vec3(1, 1, 1), 0.3},
                        .damping = 1.0,
                        .rereference = renewing});
    const std::size_t id = simulator.addBody(
        filledBody(shapes::ball(centre, radius), shapes::ballSurface(centre, radius, 12), clay(0.002), 0.012));
    Body &body = *simulator.body(id);
    const double mass = body.totalMass(), volume = skinVolume(simulator, id), first = body.stableStepAtRest();
    double height = 1.0;
    for (int k = 1; k <= 5; ++k) {
      while (simulator.time() < 0.25 * k) REQUIRE(simulator.step());
      const double now = shapes::extent(body, Vec3(0, 1, 0)).high;
      CHECK(now < height);
      height = now;
    }
    CHECK(body.totalMass() == mass);
    CHECK_FALSE(body.stopped);
    const auto energy = simulator.diagnostics().energy(id);
    share[renewing] = energy.stabilisation / (energy.elastic + energy.stabilisation);
    step[renewing] = body.stableStep() / first;
    INFO("rereferenceCount " << body.rereferenceCount() << ", height " << height << ", volume "
                             << skinVolume(simulator, id) / volume << ", share of the control " << share[renewing]
                             << ", stable step " << step[renewing]);
    CHECK(skinVolume(simulator, id) / volume == Approx(1.0).margin(0.025));
    CHECK((body.rereferenceCount() > 0) == renewing);
    CHECK(height < 0.5 * 2.0 * radius);
  }
  // The effect of the first reference: the control, which does not flow, holds nine tenths of the energy, and the step
  // falls.
  CHECK(share[0] > 0.85);
  CHECK(share[1] < 0.8);
  CHECK(step[0] < 0.3);
  CHECK(step[1] > 0.4);
}
