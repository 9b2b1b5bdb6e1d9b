// SPDX-License-Identifier: Apache-2.0
// Two jaws: where they contact skin, how they close, and their squeezing force.
#include <functional>
#include <set>

#include "instruments/grab_patch.h"
#include "instruments/grasp.h"
#include "lattice_cases.h"
#include "support/catch.h"
#include "tools/force_curve.h"

using namespace pointbased;

namespace {

/// A slab of 100 x 60 x 20 mm; its upper side is at z = 20 mm.
BodyShape slab() { return lattice_cases::box(Vec3::Zero(), Vec3(0.1, 0.06, 0.02)); }
const Vec3 kOnTop(0.05, 0.03, 0.02);

std::string errorAt(const Vec3 &at, const Vec3 &axis, const GraspSettings &settings = {}) {
  const auto places = findJaws(slab().surface, at, Vec3::UnitZ(), axis, settings);
  return places ? std::string() : places.error();
}

std::unique_ptr<Body> softSlab(double spacing) {
  BodyRecipe recipe;
  recipe.sampling = lattice_cases::withSpacing(spacing);
  recipe.fixes.emplace_back();
  recipe.fixes.back().region = HalfSpaceRegion{Vec3::Zero(), Vec3::UnitZ()};
  const BodyShape shape = slab();
  std::vector<Vec3> normals(shape.surface.positions.size(), Vec3::UnitX());
  auto rest = buildRestState(shape, recipe, normals, serialFor());
  if (!rest) throw std::runtime_error(rest.error());
  Material material;
  material.youngsModulus = 6e3;
  material.poissonRatio = 0.4;
  return std::make_unique<Body>("slab", *rest, Constitution{{material}, kLatticeStabilisation}, serialFor());
}

}  // namespace

TEST_CASE("Jaws stand on the skin, half the opening to either side of the place", "[grasp]") {
  const Surface skin = slab().surface;
  // The part of the axis that points out of the skin is ignored.
  const auto places = findJaws(skin, kOnTop, Vec3::UnitZ(), Vec3(1, 0, 0.5).normalized(), {});
  REQUIRE(places);
  CHECK((places->axis - Vec3::UnitX()).norm() < 1e-12);
  CHECK((places->points[0].at(skin.positions) - Vec3(0.04, 0.03, 0.02)).norm() < 1e-12);
  CHECK((places->points[1].at(skin.positions) - Vec3(0.06, 0.03, 0.02)).norm() < 1e-12);
}

TEST_CASE("Where jaws find no skin is told in words, with the numbers", "[grasp]") {
  CHECK(errorAt(kOnTop, Vec3::UnitX()).empty());
  CHECK_THAT(errorAt(Vec3(0.094, 0.03, 0.02), Vec3::UnitX()),
             Contains("one of the jaws misses the body, which ends 6 mm beside that place") && Contains("10 mm"));
  CHECK_THAT(errorAt(Vec3(0.006, 0.03, 0.02), Vec3::UnitX()), Contains("ends 6 mm beside"));
  const GraspSettings wide{.jaw = 0.01, .opening = 0.08, .closed = 0.01};
  CHECK_THAT(errorAt(kOnTop, Vec3::UnitY(), wide), Contains("the body is 60 mm wide there") && Contains("80 mm"));
  CHECK_THAT(errorAt(kOnTop, Vec3(0, 0.1, 1).normalized()), Contains("is perpendicular to the skin"));
}

TEST_CASE("Sizes of jaws that cannot be are told with what is accepted", "[grasp]") {
  CHECK(problemOf(GraspSettings{}).empty());
  CHECK_THAT(problemOf({.jaw = 0.0}), Contains("0 mm; accepted: above 0"));
  CHECK_THAT(problemOf({.jaw = 0.03, .opening = 0.02}), Contains("jaws of 30 mm") && Contains("opening of 20 mm"));
  CHECK_THAT(problemOf({.closed = 0.03}), Contains("close to 30 mm; accepted: 0 to their opening, 20 mm"));
  CHECK_THAT(problemOf({.forceLimit = -1.0}), Contains("-1 N"));
}

TEST_CASE("Jaws that hold most of a body, or the same of it, do not grasp", "[grasp]") {
  const auto body = softSlab(0.005);
  const RestState &rest = body->rest();
  const auto problem = [&](const GraspSettings &settings) {
    return problemOf(rest, *findJaws(slab().surface, kOnTop, Vec3::UnitZ(), Vec3::UnitX(), settings), settings);
  };
  CHECK(problem({}).empty());
  CHECK_THAT(problem({.jaw = 0.09, .opening = 0.09}),
             Contains("a jaw of 90 mm would hold") && Contains("% of the body"));
  // However small the jaws are, they hold two spacings.
  CHECK_THAT(problem({.jaw = 0.001, .opening = 0.001, .closed = 0.0}),
             Contains("the same phyxels") && Contains("10 mm"));
}

TEST_CASE("Jaws are led to their gap within three tenths of a second, and beyond where springs yield", "[grasp]") {
  Grasp grasp;
  grasp.settings = {.jaw = 0.01, .opening = 0.02, .closed = 0.008, .forceLimit = 0.5};
  grasp.initialGap = grasp.targetGap = grasp.commandedGap = 0.02;
  // Tissue that yields by a fifth of the closing of the jaws.
  const auto follow = [&](double seconds, double squeeze) {
    for (int k = 0; k < std::lround(seconds / 0.001); ++k)
      advanceClosing(grasp, {.squeeze = squeeze, .gap = 0.02 - 0.2 * (0.02 - grasp.commandedGap)}, 0.001);
    return 0.02 - 0.2 * (0.02 - grasp.commandedGap);
  };
  const double half = follow(0.15, 0.1);
  CHECK(half > 0.014);
  CHECK(half < 0.0165);
  // At the force limit they close no farther.
  CHECK(follow(0.5, 0.5) == half);
  CHECK(std::abs(follow(0.6, 0.1) - 0.008) < 1e-4);
  // Above the limit they open by the excess, here by half of the springs' extension.
  CHECK(follow(1.0, 1.0) > half);
  CHECK(std::abs(follow(1.0, 0.1) - 0.008) < 1e-4);
  // Where tissue has suddenly yielded, they open again.
  advanceClosing(grasp, {.squeeze = 0.1, .gap = 0.004}, 0.001);
  const double before = grasp.commandedGap;
  advanceClosing(grasp, {.squeeze = 0.1, .gap = 0.004}, 0.001);
  CHECK(grasp.commandedGap > before);
}

TEST_CASE("Springs of held tissue have stiffnesses in proportion to its load shares", "[grasp]") {
  const std::unique_ptr<Body> body = softSlab(0.005);
  const RestState &rest = body->rest();
  const GraspSettings settings{.jaw = 0.018, .opening = 0.02};
  const auto places = findJaws(slab().surface, kOnTop, Vec3::UnitZ(), Vec3::UnitX(), settings);
  REQUIRE(places);
  Grab grab = beginGrasp(1, *body, *places, settings).grabs[0];
  REQUIRE(grab.phyxels.size() > 10);
  REQUIRE(rest.heldVolumes.empty());
  const double radius = 0.5 * settings.jaw;
  const auto loadAt = [&](std::size_t k) {
    const Index i = grab.phyxels[k];
    const double distance = (rest.positions[i] - places->points[0].at(slab().surface.positions)).norm();
    return rest.weightVolumes[i] * kernelWeight(distance, radius);  // no support holds a part of them
  };
  for (std::size_t k = 0; k < grab.phyxels.size(); ++k)
    CHECK(grab.weights[k] * loadAt(0) == Approx(grab.weights[0] * loadAt(k)));
  const Vec3 step(1e-4, -2e-4, 3e-4);
  grab.target += step;
  body->grabs.push_back({1, grab, {}});
  for (Vec3 &force : body->forces()) force.setZero();
  applyGrabs(*body, 1e9);
  const Vec3 expected =
      10.0 * body->material().youngsModulus * 2.0 * radius * step;  // ten times the tissue's stiffness
  for (std::size_t k = 0; k < grab.phyxels.size(); ++k)
    CHECK((body->forces()[grab.phyxels[k]] - grab.weights[k] * expected).norm() < 1e-9 * expected.norm());
  CHECK((body->grabs[0].status.force - expected).norm() < 1e-9 * expected.norm());
}

TEST_CASE("What jaws pull and squeeze with is told apart, also when they are turned", "[grasp]") {
  Grasp grasp;
  grasp.jaws.axis = Vec3::UnitX();
  grasp.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // a quarter turn about z: the axis is y
  std::array<GrabStatus, 2> grabs;
  grabs[0].force = Vec3(0.1, 0.7, 0.2);
  grabs[1].force = Vec3(0.1, -0.5, 0.2);
  grabs[1].point = Vec3(0.3, 0.01, 0);
  const GraspForces forces = forcesOf(grasp, grabs);
  CHECK((forces.pull - Vec3(0.2, 0.2, 0.4)).norm() < 1e-15);
  CHECK(std::abs(forces.squeeze - 0.6) < 1e-15);
  CHECK(std::abs(forces.gap - 0.01) < 1e-15);
  grasp.middle = Vec3(0, 0, 1);
  grasp.commandedGap = 0.02;
  for (Vec3 &offset : grasp.offsets) offset = Vec3(0, 0.001, 0);
  grasp.updateTargets();
  CHECK((grasp.grabs[0].target - Vec3(-0.001, -0.01, 1)).norm() < 1e-15);
  CHECK((grasp.grabs[1].target - Vec3(-0.001, 0.01, 1)).norm() < 1e-15);
}

TEST_CASE("Jaws squeeze a fold of a slab together and lift it", "[grasp]") {
  Simulator simulator;
  WorldSettings world;
  world.gravity = Vec3::Zero();
  world.damping = 20.0;
  world.integrator = Integrator::explicitVerlet;
  simulator.setWorld(world);
  const std::size_t id = simulator.addBody(softSlab(0.005));
  const GraspSettings settings{.jaw = 0.01, .opening = 0.02, .closed = 0.015};
  const auto places = findJaws(slab().surface, kOnTop, Vec3::UnitZ(), Vec3::UnitX(), settings);
  Grasp grasp = beginGrasp(id, *simulator.body(id), *places, settings);
  const auto setGrabs = [&] {
    for (std::uint64_t jaw = 0; jaw < 2; ++jaw) {
      simulator.stepper().moveGrab(id, grasp.grabs[jaw].target, jaw);
      simulator.stepper().turnGrab(id, grasp.rotation, jaw);
    }
  };
  const auto forces = [&] {
    return forcesOf(grasp, {*simulator.stepper().grabStatus(id, 0), *simulator.stepper().grabStatus(id, 1)});
  };
  for (std::uint64_t jaw = 0; jaw < 2; ++jaw) simulator.stepper().setGrab(id, grasp.grabs[jaw], jaw);
  const auto go = [&](double seconds) {
    for (const double end = simulator.time() + seconds; simulator.time() < end;) {
      REQUIRE(simulator.step());
      advanceClosing(grasp, forces(), simulator.stepper().stepSize());
      grasp.updateTargets();
      setGrabs();
    }
  };
  // Grasping moves nothing.
  REQUIRE(simulator.step());
  CHECK(forces().pull.norm() < 1e-9);
  CHECK(std::abs(forces().squeeze) < 1e-9);
  go(1.5);
  CHECK(forces().gap < 0.0151);
  CHECK(forces().gap > 0.0140);
  CHECK(forces().squeeze > 0.02);
  CHECK(forces().pull.norm() < 0.1 * forces().squeeze);
  const double squeeze = forces().squeeze;
  grasp.middle += Vec3(0, 0, 0.03);
  go(1.0);
  // The lifting force appears at the support; damping carries a little of it.
  const Vec3 reaction = simulator.diagnostics().reactions(id).front().force;
  CHECK(forces().pull[2] > 0.02);
  CHECK(std::abs(reaction[2] + forces().pull[2]) < 0.05 * forces().pull[2]);
  CHECK(forces().squeeze > 0.5 * squeeze);
}

TEST_CASE("A hand's own largest force is taken where it is below what tissue bears", "[grasp]") {
  const auto body = softSlab(0.005);
  const PinchSettings settings{.radius_mm = 18.0};
  const double bears = grabAround(body->rest(), 0, settings, 6e3).maxForce;
  CHECK(std::abs(bears - 4.0 * 6e3 * 0.018 * 0.018) < 1e-9);
  PinchSettings limited = settings;
  limited.largestForce = 2.0;
  CHECK(grabAround(body->rest(), 0, limited, 6e3).maxForce == 2.0);
  limited.largestForce = 100.0;
  CHECK(grabAround(body->rest(), 0, limited, 6e3).maxForce == bears);
}

TEST_CASE("A hand pulls with what the tissue bears that it holds", "[grasp]") {
  const auto one = softSlab(0.005);
  RestState rest = one->rest();
  const std::size_t n = rest.phyxelCount();
  const auto bodyOf = [&](const std::function<bool(std::size_t)> &isStiff) {
    rest.materialShares.clear();
    for (std::size_t i = 0; i < n; ++i)
      rest.materialShares.insert(rest.materialShares.end(), {isStiff(i) ? 0.0 : 1.0, isStiff(i) ? 1.0 : 0.0});
    Material stiff = one->material();
    stiff.youngsModulus *= 3.0;
    return Body("two", std::make_shared<const RestState>(rest),
                Constitution{{one->material(), stiff}, kLatticeStabilisation}, serialFor());
  };
  const Grab held = grabAround(one->rest(), 0, {.radius_mm = 18.0}, 6e3);
  const auto limitOf = [&](const Body &body, double own = 0.0) {
    Grab grab = held;
    limitToTissue(grab, body, own);
    return grab.maxForce / held.maxForce;
  };
  CHECK(limitOf(*one) == 1.0);
  CHECK_THAT(limitOf(bodyOf([](std::size_t) { return true; })), WithinAbs(3.0, 1e-12));
  CHECK_THAT(limitOf(bodyOf([](std::size_t) { return false; })), WithinAbs(1.0, 1e-12));
  // Half of its weight in each: the harmonic mean of 1 and 3.
  double weight = 0.0;
  std::set<Index> stiff;
  for (std::size_t k = 0; k < held.phyxels.size() && weight < 0.5; ++k) {
    stiff.insert(held.phyxels[k]);
    weight += held.weights[k];
  }
  const double expected = 1.0 / (weight / 3.0 + 1.0 - weight);
  CHECK(expected < 2.0);
  const Body half = bodyOf([&](std::size_t i) { return stiff.contains(static_cast<Index>(i)); });
  CHECK_THAT(limitOf(half), WithinAbs(expected, 1e-12));
  CHECK_THAT(limitOf(half, 2.0), WithinAbs(2.0 / held.maxForce, 1e-12));
  CHECK_THAT(limitOf(half, 1e3), WithinAbs(expected, 1e-12));
}

TEST_CASE("What is horizontal on the screen follows from two places of the mouse", "[grasp]") {
  // View along -z, rotated by 30° about the view: right is (cos, sin), down is (sin, -cos).
  const double c = std::sqrt(0.75), s = 0.5;
  const Vec3 right(c, s, 0), down(s, -c, 0), view = -Vec3::UnitZ();
  for (const auto &[x, y] : {std::pair{10.0, 0.0}, std::pair{-3.0, 7.0}, std::pair{0.0, 5.0}})
    CHECK((screenRight(0.002 * (x * right + y * down), x, y, view) - right).norm() < 1e-12);
}

TEST_CASE("The curve of a force is even in simulated time, ten seconds long, and begins anew after Undo", "[grasp]") {
  ForceCurve curve;
  for (int k = 0; k <= 400; ++k) curve.addSample(k, k / 30.0 + 1e-9);
  CHECK(curve.values().size() == ForceCurve::kMaxSamples);
  CHECK(curve.values().back() == 400.0);
  CHECK(curve.values().front() == 101.0);
  CHECK(curve.largest() == 400.0);
  // A step of a tenth of a second is three intervals.
  curve.clear();
  curve.addSample(1.0, 20.0);
  curve.addSample(2.0, 20.1 + 1e-9);
  CHECK(curve.values() == std::vector<double>{1.0, 2.0, 2.0, 2.0});
  curve.addSample(3.0, 5.0);
  curve.addSample(4.0, 5.0 + 1.0 / 30.0 + 1e-9);
  CHECK(curve.values().size() == 6);
}

TEST_CASE("A jaw is drawn as a closed disc on its outer side", "[grasp]") {
  const Vec3 at(0.01, 0.02, 0.03);
  const Surface disc = discOf(at, -Vec3::UnitX(), 0.01);
  double volume = 0.0;
  for (const auto &[a, b, c] : disc.triangles)
    volume += (disc.positions[a] - at).dot((disc.positions[b] - at).cross(disc.positions[c] - at)) / 6.0;
  // A prism of 24 sides, 2 mm thick, of 10 mm; outwards, otherwise the sign differs.
  const double area = 0.5 * 24 * 25e-6 * std::sin(2.0 * EIGEN_PI / 24);
  CHECK(std::abs(volume - 0.002 * area) < 1e-12);
  for (const Vec3 &x : disc.positions) CHECK(x[0] <= at[0] + 1e-15);
}
