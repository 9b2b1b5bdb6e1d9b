// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "contact_cases.h"
#include "lattice_cases.h"
#include "shapes.h"
#include "support/catch.h"

using namespace pointbased;
using namespace shapes;

namespace {

constexpr double kEdge = 0.06;                 // m
constexpr double kArea = 6.0 * kEdge * kEdge;  // m²
constexpr double kStiffness = 1e4;             // Pa/m
constexpr Foundation kEven{kStiffness, kStiffness, 0.0};
constexpr Foundation kUneven{kStiffness, 3e3, 0.0};

std::unique_ptr<Body> cube(const Material &material, const Foundation &foundation,
                           const Vec3 &at = Vec3(0.4, -0.2, 0.1)) {
  auto body = latticeBox(at, at + Vec3(kEdge, kEdge, kEdge), 0.02, material);
  REQUIRE(body->setFoundation(foundation));
  return body;
}
std::unique_ptr<Body> cube(double youngsModulus, const Foundation &foundation, const Vec3 &at = Vec3(0.4, -0.2, 0.1)) {
  return cube(rubber(youngsModulus), foundation, at);
}

// A ball as a cloud of phyxels: bound by moving least squares, with weights below 0.
std::unique_ptr<Body> cloud(const Foundation &foundation) {
  const BodyRecipe recipe{.evaluation = Evaluation::phyxels, .sampling = {.spacing = 0.02}};
  const BodyShape shape = lattice_cases::ball(Vec3(0.1, 0.0, 0.0), 0.05);
  auto body = shapes::makeBody(shapes::restState(shape, recipe), {rubber(1e4)});
  REQUIRE(body->setFoundation(foundation));
  return body;
}

std::vector<std::unique_ptr<Body>> kinds() {
  std::vector<std::unique_ptr<Body>> all;
  for (const Foundation &foundation : {kEven, kUneven}) {
    all.push_back(cube(1e4, foundation));
    all.push_back(cloud(foundation));
  }
  return all;
}

std::vector<Vec3> noise(std::size_t n, double amplitude, std::uint64_t seed) {
  Random random{seed};
  std::vector<Vec3> field(n);
  for (Vec3 &v : field) v = amplitude * random.vector();
  return field;
}

std::vector<Vec3> forcesAt(const Body &body, std::span<const Vec3> u, std::span<const Vec3> v = {},
                           const ParallelFor &parallelFor = serialFor()) {
  std::vector<Vec3> forces(u.size(), Vec3::Zero());
  body.foundation().addForces(u, v, forces, parallelFor);
  return forces;
}

}  // namespace

TEST_CASE("The forces of a foundation are minus the gradient of its energy", "[foundation]") {
  for (const auto &body : kinds()) {
    std::vector<Vec3> u = noise(body->rest().phyxelCount(), 2e-3, 3);
    const std::vector<Vec3> forces = forcesAt(*body, u);
    const double step = 1e-5;
    double worst = 0.0;
    for (std::size_t i = 0; i < u.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        const double at = u[i][c];
        u[i][c] = at + step;
        const double plus = body->foundation().energy(u);
        u[i][c] = at - step;
        const double minus = body->foundation().energy(u);
        u[i][c] = at;
        worst = std::max(worst, std::abs((plus - minus) / (2 * step) + forces[i][c]));
      }
    // Central differences of a quadratic function are exact but for rounding: 1e-16 of the energy over the step.
    CHECK(worst < 1e-9 * largest(forces));
  }
}

TEST_CASE("Products, blocks and triplets are the exact differential of a foundation's forces", "[foundation]") {
  for (const auto &body : kinds()) {
    const ElasticFoundation &foundation = body->foundation();
    const std::size_t n = body->rest().phyxelCount();
    const std::vector<Vec3> u = noise(n, 2e-3, 3), du = noise(n, 1e-3, 4);
    std::vector<Vec3> sum(n), product(n, Vec3::Zero());
    for (std::size_t i = 0; i < n; ++i) sum[i] = u[i] + du[i];
    foundation.addProduct(1.0, du, product, serialFor());
    const std::vector<Vec3> before = forcesAt(*body, u), after = forcesAt(*body, sum);
    const double size = largest(product);
    for (std::size_t i = 0; i < n; ++i) CHECK((after[i] - before[i] + product[i]).norm() < 1e-12 * size);

    std::vector<Eigen::Triplet<double>> triplets;
    foundation.addTriplets(1.0, triplets);
    const auto rows = static_cast<Eigen::Index>(3 * n);
    Eigen::SparseMatrix<double> matrix(rows, rows);
    matrix.setFromTriplets(triplets.begin(), triplets.end());
    CHECK(Eigen::MatrixXd(matrix).isApprox(Eigen::MatrixXd(matrix).transpose(), 1e-12));
    const Eigen::Map<const Eigen::VectorXd> flat(du.front().data(), rows);
    const Eigen::VectorXd whole = matrix * flat;
    std::vector<Mat3> blocks(n, Mat3::Zero());
    foundation.addBlocks(1.0, blocks);
    for (std::size_t i = 0; i < n; ++i) {
      const auto at = static_cast<Eigen::Index>(3 * i);
      CHECK((whole.segment<3>(at) - product[i]).norm() < 1e-12 * size);
      CHECK((Mat3(Eigen::MatrixXd(matrix.block(at, at, 3, 3))) - blocks[i]).norm() <
            1e-12 * std::max(1.0, blocks[i].norm()));
    }
  }
}

TEST_CASE("A foundation does nothing in the reference, exactly", "[foundation]") {
  for (const auto &body : kinds()) {
    const std::vector<Vec3> rest(body->rest().phyxelCount(), Vec3::Zero());
    for (const Vec3 &f : forcesAt(*body, rest, rest)) CHECK(f == Vec3(Vec3::Zero()));
    CHECK(body->foundation().energy(rest) == 0.0);
  }
  Simulator simulator;
  const std::size_t id = simulator.addBody(cube(1e4, kEven));
  const std::uint64_t before = simulator.stateHash();
  for (int i = 0; i < 200; ++i) REQUIRE(simulator.step());
  CHECK(simulator.stateHash() == before);
  CHECK(simulator.diagnostics().energy(id).foundation == 0.0);
}

TEST_CASE("A foundation holds a rigid translation with its stiffness times the area", "[foundation]") {
  const Vec3 way(1e-3, -2e-3, 5e-4);
  for (const Foundation &foundation : {kEven, kUneven}) {
    const auto body = cube(1e4, foundation);
    const std::vector<Vec3> u(body->rest().phyxelCount(), way);
    // Of a cube a third of the surface faces each way.
    const double k = (foundation.stiffness + 2.0 * foundation.tangential) / 3.0;
    CHECK((total(forcesAt(*body, u)) + k * kArea * way).norm() < 1e-9 * k * kArea * way.norm());
    CHECK(body->foundation().energy(u) == Approx(0.5 * k * kArea * way.squaredNorm()).epsilon(1e-9));
    body->state().displacements = u;
    const Reaction reaction = body->foundationReaction();
    CHECK((reaction.force + k * kArea * way).norm() < 1e-9 * k * kArea * way.norm());
    // Uniform around the centre: no torque.
    CHECK(reaction.torque.norm() < 1e-9 * reaction.force.norm() * kEdge);
  }
}

TEST_CASE("A stiff block on a foundation swings at the root of k A / m", "[foundation]") {
  auto body = cube(1e7, kEven);
  const double mass = body->totalMass(), omega = std::sqrt(kStiffness * kArea / mass);
  const Vec3 speed(0.02, 0.05, -0.03);
  body->setInitialVelocity(speed, Vec3::Zero());
  Simulator simulator;
  const std::size_t id = simulator.addBody(std::move(body));
  double worst = 0.0;
  const double amplitude = speed.norm() / omega;
  while (simulator.time() < 3.0 * 2.0 * std::numbers::pi / omega) {
    REQUIRE(simulator.step());
    const Vec3 expected = std::sin(omega * simulator.time()) / omega * speed;
    worst = std::max(worst, (meanDisplacement(*simulator.body(id)) - expected).norm());
  }
  // The block itself yields by about k L / E, 6e-5 of it, which shifts the phase.
  CHECK(worst < 0.01 * amplitude);
  const Diagnostics::Energy energy = simulator.diagnostics().energy(id);
  CHECK(energy.kinetic + energy.elastic + energy.stabilisation + energy.foundation ==
        Approx(0.5 * mass * speed.squaredNorm()).epsilon(1e-3));
}

TEST_CASE("Implicit steps swing a block on its foundation, and damp it, as explicit ones do", "[foundation]") {
  const double tau = 5e-3;
  const auto run = [&](Integrator integrator, double dt) {
    auto body = cube(1e6, {kStiffness, kStiffness, tau});
    const double omega = std::sqrt(kStiffness * kArea / body->totalMass()), zeta = 0.5 * tau * omega;
    body->setInitialVelocity(Vec3(0.0, 0.05, 0.0), Vec3::Zero());
    Simulator simulator;
    simulator.setWorld({.integrator = integrator, .dt = dt});
    const std::size_t id = simulator.addBody(std::move(body));
    const double damped = omega * std::sqrt(1.0 - zeta * zeta);
    double worst = 0.0;
    while (simulator.time() < 2.0 * std::numbers::pi / omega) {
      REQUIRE(simulator.step());
      const double t = simulator.time();
      const double expected = 0.05 / damped * std::exp(-zeta * omega * t) * std::sin(damped * t);
      worst = std::max(worst, std::abs(meanDisplacement(*simulator.body(id))[1] - expected));
    }
    return worst * omega / 0.05;
  };
  CHECK(run(Integrator::explicitVerlet, 0.0) < 0.01);
  // About (omega dt)²/12 of the amplitude per radian.
  CHECK(run(Integrator::implicitSdirk, 4e-3) < 0.02);
  CHECK(run(Integrator::implicitMidpoint, 4e-3) < 0.02);
}

TEST_CASE("A force moves a stiff block by F over k A until its foundation carries it", "[foundation]") {
  const double edge = kEdge;
  const BodyRecipe recipe{.sampling = {.spacing = 0.02},
                          .loads = {{EverywhereRegion{}, Vec3(0.3, 0.0, -0.1), 0.0, true, 0.0}}};
  BodyShape shape = lattice_cases::box(Vec3(0, 0, 0), Vec3(edge, edge, edge));
  auto body = shapes::makeBody(shapes::restState(shape, recipe), {rubber(1e7)});
  REQUIRE(body->setFoundation(kEven));
  Simulator simulator;
  simulator.setWorld({.integrator = Integrator::quasiStatic});
  const std::size_t id = simulator.addBody(std::move(body));
  while (!simulator.finished()) REQUIRE(simulator.step());
  const Vec3 expected = Vec3(0.3, 0.0, -0.1) / (kStiffness * kArea);
  CHECK((meanDisplacement(*simulator.body(id)) - expected).norm() < 1e-3 * expected.norm());
  CHECK((simulator.body(id)->foundationReaction().force + Vec3(0.3, 0.0, -0.1)).norm() < 1e-6);
  CHECK(simulator.diagnostics().events().empty());
}

TEST_CASE("The stable step bounds what a foundation asks for", "[foundation]") {
  const double bare = cube(1e4, {})->stableStepAtRest();
  double last = bare;
  for (const double k : {1e6, 1e8, 1e10}) {
    const Foundation foundation{k, 0.3 * k, 0.0};
    auto body = cube(1e4, foundation);
    const double step = body->stableStepAtRest();
    CHECK(step < last);
    last = step;
    // Not far below the necessary step: the lightest phyxels on the surface oscillate at no less than a third of the
    // bound.
    std::vector<Mat3> blocks(body->rest().phyxelCount(), Mat3::Zero());
    body->foundation().addBlocks(1.0, blocks);
    double fastest = 0.0;
    for (std::size_t i = 0; i < blocks.size(); ++i)
      fastest = std::max(fastest, blocks[i].diagonal().maxCoeff() / body->masses()[i]);
    CHECK(2.0 / std::sqrt(fastest) >= step);
    if (k > 1e7) CHECK(2.0 / std::sqrt(fastest) < 4.0 * step);

    const std::vector<Vec3> pushed = noise(body->rest().phyxelCount(), 0.01, 11);
    Simulator simulator;
    simulator.setWorld({.dt = 0.98 * step});
    const std::size_t id = simulator.addBody(std::move(body));
    simulator.body(id)->state().velocities = pushed;
    const double start = simulator.diagnostics().energy(id).kinetic;
    for (int i = 0; i < 3000; ++i) REQUIRE(simulator.step());
    const Diagnostics::Energy energy = simulator.diagnostics().energy(id);
    CHECK(energy.kinetic + energy.elastic + energy.stabilisation + energy.foundation < 3.0 * start);
  }
}

TEST_CASE("Damping of a foundation shrinks the stable step and takes energy", "[foundation]") {
  const double without = cube(1e4, {1e8, 1e8, 0.0})->stableStepAtRest();
  auto body = cube(1e4, {1e8, 1e8, 1e-2});
  CHECK(body->stableStepAtRest() < without);
  body->setInitialVelocity(Vec3(0.5, 0, 0), Vec3::Zero());
  Simulator simulator;
  const std::size_t id = simulator.addBody(std::move(body));
  double last = simulator.diagnostics().energy(id).kinetic;
  for (int round = 0; round < 10; ++round) {
    for (int i = 0; i < 100; ++i) REQUIRE(simulator.step());
    const Diagnostics::Energy energy = simulator.diagnostics().energy(id);
    const double now = energy.kinetic + energy.elastic + energy.stabilisation + energy.foundation;
    CHECK(now < last);
    last = now;
  }
}

TEST_CASE("Forces of a foundation have the same bits for any division of the loop", "[foundation]") {
  for (const Foundation &foundation : {kEven, kUneven}) {
    auto body = latticeBox(Vec3(0, 0, 0), Vec3(0.2, 0.15, 0.1), 0.01, rubber(1e4), 30);
    REQUIRE(body->setFoundation(foundation));
    const std::size_t n = body->rest().phyxelCount();
    const std::vector<Vec3> u = noise(n, 1e-3, 5), v = noise(n, 1.0, 6);
    const std::vector<Vec3> serial = forcesAt(*body, u, v);
    for (const std::size_t threads : {2, 3, 5})
      CHECK(forcesAt(*body, u, v, lattice_cases::threadedFor(threads)) == serial);
  }
}

TEST_CASE("A body that is pulled away and let go comes back to its place and sleeps there", "[foundation]") {
  Simulator simulator;
  simulator.setWorld({.sleep = true});
  const std::size_t id = simulator.addBody(cube(rubber(3e4, 20.0), {kStiffness, kStiffness, 0.02}));
  Body &body = *simulator.body(id);
  const Vec3 home = body.rest().origin;
  Grab grab;
  for (Index i = 0; i < body.rest().phyxelCount(); ++i) grab.phyxels.push_back(i);
  grab.weights.assign(grab.phyxels.size(), 1.0 / static_cast<double>(grab.phyxels.size()));
  Vec3 centre = Vec3::Zero();
  for (const Vec3 &X : body.rest().positions) centre += X / static_cast<double>(body.rest().phyxelCount());
  grab.target = home + centre + Vec3(0.03, 0.0, 0.0);
  simulator.stepper().setGrab(id, grab);
  while (simulator.time() < 0.5) REQUIRE(simulator.step());
  CHECK(meanDisplacement(body)[0] > 0.01);
  simulator.stepper().releaseGrab(id);
  while (simulator.time() < 4.0 && !simulator.stepper().asleep(id)) REQUIRE(simulator.step());
  CHECK(simulator.stepper().asleep(id));
  CHECK(meanDisplacement(body).norm() < 1e-5);
  // Another stiffness wakes it.
  REQUIRE(simulator.world().setFoundation(id, kEven));
  CHECK_FALSE(simulator.stepper().asleep(id));
}

TEST_CASE("What a foundation cannot be is refused with what is accepted", "[foundation]") {
  const auto body = cube(1e4, kEven);
  const auto refusal = [&](Body &of, const Foundation &foundation) {
    const auto set = of.setFoundation(foundation);
    return set ? std::string() : set.error();
  };
  CHECK(refusal(*body, {-1.0, 0.0, 0.0}).find("-1 Pa/m; accepted: a finite number >= 0") != std::string::npos);
  CHECK(refusal(*body, {0.0, NAN, 0.0}).find("tangential") != std::string::npos);
  CHECK(refusal(*body, {0.0, 0.0, -2.0}).find("retardation time") != std::string::npos);
  CHECK(body->foundation().settings() == kEven);
  Body points("points", restState(horseshoe(), 0.03), Constitution{{rubber(1e4)}, kCloudStabilisation}, serialFor());
  CHECK(refusal(points, kEven).find("no surface") != std::string::npos);
  CHECK(refusal(points, {}).empty());
}

TEST_CASE("A rigid body stands in its reference, costs nothing, and its stable step is nobody's", "[rigid]") {
  Simulator simulator;
  simulator.setWorld({.gravity = Vec3(0, -9.81, 0)});
  const std::size_t bone = simulator.addBody(cube(1e3, {})), vessel = simulator.addBody(cube(1e4, {}, Vec3(1, 0, 0)));
  const double together = simulator.stepper().stepSize();
  CHECK(together == Approx(kStepSafety * simulator.body(bone)->stableStepAtRest()));
  for (int i = 0; i < 50; ++i) REQUIRE(simulator.step());
  simulator.world().setRigid(bone, true);
  CHECK(simulator.stepper().stepSize() == Approx(kStepSafety * simulator.body(vessel)->stableStepAtRest()));
  CHECK(simulator.stepper().stepSize() < 0.5 * together);
  const std::vector<Vec3> rest(simulator.body(bone)->rest().phyxelCount(), Vec3::Zero());
  CHECK(simulator.body(bone)->state().displacements == rest);
  const Grab grab{.phyxels = {0}, .weights = {1.0}};
  simulator.stepper().setGrab(bone, grab);
  const double before = meanDisplacement(*simulator.body(vessel))[1];
  for (int i = 0; i < 20; ++i) REQUIRE(simulator.step());
  CHECK(simulator.body(bone)->state().displacements == rest);
  CHECK(simulator.body(bone)->state().velocities == rest);
  CHECK(meanDisplacement(*simulator.body(vessel))[1] < before);
  CHECK(simulator.stepper().predictedCost(bone).first == 0.0);

  // Without the vessel it remains static; made deformable again, it falls from there.
  REQUIRE(simulator.removeBody(vessel));
  for (int i = 0; i < 5; ++i) REQUIRE(simulator.step());
  CHECK_FALSE(simulator.failed());
  simulator.world().setRigid(bone, false);
  for (int i = 0; i < 5; ++i) REQUIRE(simulator.step());
  CHECK(meanDisplacement(*simulator.body(bone))[1] < 0.0);
}
