// SPDX-License-Identifier: Apache-2.0
// Errors of the caller are reported with the function and its precondition, before anything is read or written.
#include <stdexcept>

#include "contact_cases.h"
#include "pointbased/precondition.h"
#include "support/catch.h"

using namespace pointbased;

namespace {

/// Broken preconditions throw exceptions during its lifetime.
class Thrown {
 public:
  Thrown()
      : before_(setPreconditionHandler([](const char *condition, const char *text, const char *function) {
          throw std::logic_error(std::string(function) + ": " + text + ": " + condition);
        })) {}
  ~Thrown() { setPreconditionHandler(before_); }
  Thrown(const Thrown &) = delete;
  Thrown &operator=(const Thrown &) = delete;

 private:
  PreconditionHandler before_;
};

template <class Call>
std::string brokenBy(const Call &call) {
  const Thrown thrown;
  try {
    call();
  } catch (const std::logic_error &error) {
    return error.what();
  }
  return "nothing";
}

std::unique_ptr<Body> cube() {
  return shapes::latticeBox(Vec3::Zero(), Vec3::Constant(0.04), 0.02, shapes::rubber(1e4));
}

}  // namespace

TEST_CASE("A body needs a rest state, and a material for every number that its points have") {
  CHECK_THAT(brokenBy([] {
               Body("none", nullptr, Constitution{{Material()}, 1.0}, serialFor());
             }),
             Contains("Body: a rest state"));
  const auto body = cube();
  CHECK_THAT(brokenBy([&] {
               body->setConstitution(Constitution{{}, 1.0}, serialFor());
             }),
             Contains("setConstitution") && Contains("a material for every number"));
  CHECK(body->constitution().materials.size() == 1);
  CHECK_THAT(brokenBy([] { Simulator().addBody(nullptr); }), Contains("addBody: a body"));
}

TEST_CASE("Fields of the wrong size are refused by what they go through") {
  const auto body = cube();
  const std::size_t n = body->rest().phyxelCount(), surfels = body->rest().surfels.count();
  REQUIRE(surfels > 0);
  const std::vector<Vec3> u(n, Vec3::Zero()), normals(surfels, Vec3::UnitX()), shorter(n - 1, Vec3::Zero());
  std::vector<Vec3> out(surfels), few(surfels - 1);
  const auto update = [&](std::span<const Vec3> displacements, std::span<Vec3> positions, std::span<Vec3> directions) {
    return brokenBy([&] {
      updateSurfels(body->rest().surfels, normals, body->rest().positions, displacements, positions, directions,
                    serialFor());
    });
  };
  CHECK(update(u, out, {}) == "nothing");
  CHECK_THAT(update(u, few, {}), Contains("updateSurfels: one position per surfel"));
  CHECK_THAT(update(u, out, few), Contains("one normal per surfel"));
  CHECK_THAT(update(shorter, out, {}), Contains("one displacement per phyxel"));

  const ContactPoints &points = body->rest().contact;
  std::vector<Vec3> ways(points.count() + 1);
  CHECK_THAT(brokenBy([&] { interpolateField(points.binding, u, ways, serialFor()); }),
             Contains("interpolateField: one result per point"));
  CHECK_THAT(brokenBy([&] { (void)contactEnergy(points, body->contact, ContactPenalty(), u, u); }),
             Contains("one modulus per contact point"));
}

TEST_CASE("Springs of patches and of the surroundings take fields of their phyxels alone") {
  PatchSolver patches;
  Csr row;
  row.indices = {0, 7};
  row.offsets = {0, 2};
  const std::vector<double> weights = {0.5, 0.5}, stiffness = {1e3}, masses(5, 1.0);
  CHECK_THAT(brokenBy([&] { patches.set(row, weights, stiffness, masses); }),
             Contains("set: rows name phyxels that there are"));
  row.indices = {0, 4};
  CHECK_THAT(brokenBy([&] { patches.set(row, {}, stiffness, masses); }), Contains("one weight per entry"));
  patches.set(row, weights, stiffness, masses);
  std::vector<Vec3> u(5, Vec3::Zero()), v = u;
  CHECK_THAT(brokenBy([&] { patches.correct(1e-3, {}, u, v); }), Contains("one target per patch"));
  CHECK_THAT(brokenBy([&] { patches.correct(0.0, std::vector<Vec3>(1), u, v); }), Contains("correct: a step"));

  const auto body = cube();
  const Foundation foundation{.stiffness = 1e4};
  REQUIRE(body->setFoundation(foundation));
  REQUIRE(body->foundation().acts());
  CHECK_THAT(brokenBy([&] { (void)body->foundation().energy(u); }), Contains("energy: one displacement per phyxel"));
}

TEST_CASE("The engine takes fields of all phyxels and all evaluation points") {
  const auto body = cube();
  const RestState &rest = body->rest();
  const Constitution &constitution = body->constitution();
  const std::vector<Vec3> u(rest.phyxelCount(), Vec3::Zero()), shorter(u.size() - 1, Vec3::Zero());
  std::vector<Mat3> F(rest.pointCount()), stresses(rest.pointCount());
  std::vector<double> ratios(rest.pointCount());
  CHECK_THAT(brokenBy([&] { deformationGradients(rest.stencils, shorter, F, serialFor()); }),
             Contains("deformationGradients: one displacement per phyxel"));
  CHECK(brokenBy([&] { deformationGradients(rest.stencils, u, F, serialFor()); }) == "nothing");
  const auto stress = [&](const Constitution &of, std::span<const Mat3> gradients) {
    return brokenBy([&] {
      (void)pointStresses(of, rest.stencils, gradients, {}, PointHistory(), 0.0, nullptr, stresses, ratios,
                          serialFor());
    });
  };
  CHECK(stress(constitution, F) == "nothing");
  CHECK_THAT(stress(constitution, std::span(F).first(1)), Contains("one gradient per evaluation point"));
  CHECK_THAT(stress(Constitution{{}, 1.0}, F), Contains("pointStresses: a material"));
  std::vector<Vec3> entries(rest.stencils.phyxels.indices.size()), forces(u.size());
  CHECK_THAT(brokenBy([&] {
               internalForces(constitution, rest.stencils, rest.positions, u, F, stresses, std::span(entries).first(3),
                              forces, serialFor());
             }),
             Contains("internalForcesOf: room for every entry and every phyxel"));
  TangentScratch scratch;
  CHECK_THAT(brokenBy([&] {
               forceDifferential(constitution, rest.stencils, rest.positions, u, F, PointHistory(), 0.0, 0.0, shorter,
                                 scratch, forces, serialFor());
             }),
             Contains("forceDifferential: one change of place and of force per phyxel"));
}

TEST_CASE("A hand holds phyxels that there are") {
  Simulator simulator;
  const std::size_t id = simulator.addBody(cube());
  const auto count = static_cast<Index>(simulator.body(id)->rest().phyxelCount());
  Grab grab{.phyxels = {0, count}, .weights = {0.5, 0.5}};
  CHECK_THAT(brokenBy([&] { simulator.stepper().setGrab(id, grab); }),
             Contains("setGrab: grabs phyxels that there are"));
  grab.phyxels = {0, count - 1};
  grab.weights = {1.0};
  CHECK_THAT(brokenBy([&] { simulator.stepper().setGrab(id, grab); }), Contains("one weight per grabbed phyxel"));
  CHECK(simulator.body(id)->grabs.empty());
  grab.weights = {0.5, 0.5};
  simulator.stepper().setGrab(id, grab);
  CHECK(simulator.body(id)->grabs.size() == 1);
}
