// SPDX-License-Identifier: Apache-2.0
#include "pointbased/displacement_field.h"

#include <Eigen/Geometry>
#include <numbers>

#include "contact_cases.h"
#include "pointbased/fields.h"
#include "pointbased/simulator.h"
#include "shapes.h"
#include "support/catch.h"
#include "surfaces.h"

using namespace pointbased;

namespace {

const Vec3 kMin(0.2, -0.1, 0.3), kMax(0.26, -0.02, 0.35);

// Oblique, with uneven steps, around the box and beyond.
FieldGrid obliqueGrid() {
  FieldGrid grid{.size = {40, 36, 44}};
  grid.steps.col(0) = Vec3(0.0039, 0.0008, 0.0);
  grid.steps.col(1) = Vec3(-0.0006, 0.0047, 0.0003);
  grid.steps.col(2) = Vec3(0.0, -0.0002, 0.0031);
  grid.origin = Vec3(0.16, -0.15, 0.26);
  return grid;
}

std::unique_ptr<Body> body(Evaluation evaluation) {
  if (evaluation == Evaluation::stressPoints) return shapes::latticeBox(kMin, kMax, 0.01, shapes::rubber(1e4));
  BodyShape shape = shapes::box(kMin, kMax);
  return shapes::makeBody(shapes::restState(shape, 0.01), {shapes::rubber(1e4)});
}

}  // namespace

TEST_CASE("the field of an affine motion leads every point back to where its material was") {
  const Evaluation evaluation = GENERATE(Evaluation::stressPoints, Evaluation::phyxels);
  const auto made = body(evaluation);
  Mat3 A;
  A << 1.1, 0.2, -0.05, -0.1, 0.9, 0.15, 0.02, -0.12, 1.05;
  const Vec3 b(0.004, -0.003, 0.002), about = 0.5 * (kMin + kMax);
  for (std::size_t i = 0; i < made->rest().phyxelCount(); ++i) {
    const Vec3 X = made->rest().origin + made->rest().positions[i];
    made->state().displacements[i] = about + A * (X - about) + b - X;
  }
  made->computeGradients(serialFor());
  const FieldGrid grid = obliqueGrid();
  DisplacementField field(grid);
  field.add(*made, bindPoints(made->rest()));
  std::vector<float> u(3 * grid.count());
  field.write(0.0, u);
  std::size_t within = 0;
  for (std::size_t p = 0; p < grid.count(); ++p) {
    const Vec3 index(static_cast<double>(p % grid.size[0]), static_cast<double>(p / grid.size[0] % grid.size[1]),
                     static_cast<double>(p / grid.size[0] / grid.size[1]));
    const Vec3 x = grid.origin + grid.steps * index, X = about + A.inverse() * (x - about - b);
    const Vec3 found(u[3 * p], u[3 * p + 1], u[3 * p + 2]);
    const bool inside = (X.array() >= kMin.array()).all() && (X.array() <= kMax.array()).all();
    if (inside || found.norm() > 0.0) {
      // Floats of some centimetres.
      REQUIRE((x - found - X).norm() < 1e-8);
      within += inside ? 1 : 0;
    }
    // No point farther away than a spacing and a half is displaced.
    if ((X - X.cwiseMax(kMin).cwiseMin(kMax)).norm() > 0.015) REQUIRE(found.norm() == 0.0);
  }
  CHECK(within > 3000);
}

// A pulled brain appeared to pass through its skull in spikes 70 mm long; none of its tissue was there.
TEST_CASE("a corner that only a sliver of the body reaches does not lead the field away with it") {
  constexpr double kRadius = 0.05, kFar = 0.2;
  const auto rest = shapes::restState(shapes::inside(shapes::ballSurface(Vec3::Zero(), kRadius, 40)),
                                      {.sampling = {.spacing = 0.0127}});
  Body ball("ball", rest, Constitution{{shapes::rubber(1e4)}, kLatticeStabilisation}, serialFor());
  const std::vector<double> &volumes = rest->volumes;
  const auto lightest = static_cast<std::size_t>(std::min_element(volumes.begin(), volumes.end()) - volumes.begin());
  REQUIRE(volumes[lightest] < 0.01 * std::pow(0.0127, 3));
  ball.state().displacements[lightest] = kFar * rest->positions[lightest].normalized();
  ball.computeGradients(serialFor());
  std::vector<Vec3> moved(rest->surfels.count());
  updateSurfels(rest->surfels, {}, rest->positions, ball.state().displacements, moved, {}, serialFor());
  double tissue = 0.0;
  for (std::size_t p = 0; p < moved.size(); ++p)
    tissue = std::max(tissue, (moved[p] - rest->surfels.position(p, rest->positions)).norm());
  REQUIRE(tissue > 0.0);

  const FieldGrid grid{.size = {60, 60, 60}, .origin = Vec3::Constant(-0.1475), .steps = 0.005 * Mat3::Identity()};
  DisplacementField field(grid);
  field.add(ball, bindPoints(*rest));
  std::vector<float> u(3 * grid.count());
  field.write(0.0, u);
  double farthest = 0.0;
  for (std::size_t p = 0; p < grid.count(); ++p)
    farthest = std::max(farthest, static_cast<double>(Eigen::Vector3f(u[3 * p], u[3 * p + 1], u[3 * p + 2]).norm()));
  CAPTURE(tissue, farthest);
  CHECK(farthest > 0.0);
  CHECK(farthest < 2.0 * tissue);  // points outside the body continue its displacement
}

TEST_CASE("what lies beside a body goes with it as far as its cells there are wide") {
  constexpr double kSide = 0.06, kCoarse = 0.02, kFine = 0.005;
  const BodyRecipe recipe{.sampling = {.spacing = kCoarse,
                                       .refinements = {{HalfSpaceRegion{Vec3(0.04, 0, 0), -Vec3::UnitX()}, kFine}},
                                       .axes = Mat3(Mat3::Identity())}};
  const Surface box = shapes::boxSurface(Vec3::Zero(), Vec3::Constant(kSide), 12);
  const auto rest = shapes::restState(shapes::inside(box), recipe);
  Body body("box", rest, Constitution{{shapes::rubber(1e4)}, kLatticeStabilisation}, serialFor());
  const Vec3 way(0.0, 0.001, 0.0);
  for (Vec3 &displacement : body.state().displacements) displacement = way;
  // A line through the middle, half a millimetre from point to point.
  const FieldGrid line{
      .size = {201, 1, 1}, .origin = Vec3(-0.02, 0.5 * kSide, 0.5 * kSide), .steps = 0.0005 * Mat3::Identity()};
  DisplacementField field(line);
  field.add(body, bindPoints(*rest));
  std::vector<float> u(3 * line.count());
  field.write(0.0, u);
  double first = 1.0, last = -1.0;
  for (std::size_t p = 0; p < line.count(); ++p) {
    const double x = line.origin[0] + 0.0005 * static_cast<double>(p);
    if (x >= 0.0 && x <= kSide) REQUIRE(u[3 * p + 1] == Approx(way[1]));
    if (!(u[3 * p + 1] > 0.0F)) continue;
    first = std::min(first, x);
    last = std::max(last, x);
  }
  CHECK(first < -0.25 * kCoarse);
  CHECK(last > kSide);
  CHECK(last < kSide + kFine);
}

TEST_CASE("the rim of a displacement field falls to nothing within its width, and bodies at rest displace nothing") {
  const auto made = body(Evaluation::stressPoints);
  const FieldGrid grid{.size = {60, 60, 60}, .origin = Vec3(0.11, -0.18, 0.2), .steps = 0.004 * Mat3::Identity()};
  std::vector<float> u(3 * grid.count(), 1.0F);
  DisplacementField atRest(grid);
  atRest.add(*made, bindPoints(made->rest()));
  atRest.write(0.02, u);
  CHECK(*std::max_element(u.begin(), u.end()) < 1e-9F);

  for (Vec3 &displacement : made->state().displacements) displacement = Vec3(0.006, 0, 0);
  DisplacementField field(grid);
  field.add(*made, bindPoints(made->rest()));
  field.write(0.02, u);
  // Along x through the middle: whole, falling, nothing.
  const std::size_t j = 30, k = 31;
  double before = 0.0;
  std::size_t whole = 0, falling = 0;
  for (std::size_t i = 0; i < 31; ++i) {
    const double now = u[3 * (i + 60 * (j + 60 * k))];
    CHECK(now >= before - 1e-9);
    const double x = grid.origin[0] + 0.004 * static_cast<double>(i);
    if (x < kMin[0] + 0.006 - 0.04) CHECK(now == 0.0);
    if (x > kMin[0] + 0.007) CHECK(now == Approx(0.006));
    whole += now > 0.00599 ? 1 : 0;
    falling += now > 1e-6 && now < 0.00599 ? 1 : 0;
    before = now;
  }
  CHECK(whole >= 3);
  CHECK(falling >= 3);
}

TEST_CASE("where a body lies over itself the field leads to one of the places, not to their mean") {
  const Evaluation evaluation = GENERATE(Evaluation::stressPoints, Evaluation::phyxels);
  const auto made = body(evaluation);
  // The upper half along y is folded onto the lower one, rotated by half a turn about z.
  const double fold = 0.5 * (kMin[1] + kMax[1]), middle = 0.5 * (kMin[0] + kMax[0]);
  const auto present = [&](const Vec3 &X) {
    return X[1] > fold ? Vec3(2.0 * middle - X[0], 2.0 * fold - X[1], X[2]) : X;
  };
  for (std::size_t i = 0; i < made->rest().phyxelCount(); ++i) {
    const Vec3 X = made->rest().origin + made->rest().positions[i];
    made->state().displacements[i] = present(X) - X;
  }
  made->computeGradients(serialFor());
  const FieldGrid grid{
      .size = {19, 16, 14}, .origin = kMin + Vec3(0.003, 0.0, 0.003), .steps = 0.003 * Mat3::Identity()};
  DisplacementField field(grid);
  field.add(*made, bindPoints(made->rest()));
  std::vector<float> u(3 * grid.count());
  field.write(0.0, u);
  std::size_t checked = 0, turned = 0;
  for (std::size_t p = 0; p < grid.count(); ++p) {
    const Vec3 index(static_cast<double>(p % grid.size[0]), static_cast<double>(p / grid.size[0] % grid.size[1]),
                     static_cast<double>(p / grid.size[0] / grid.size[1]));
    const Vec3 x = grid.origin + grid.steps * index;
    // Nearer to the tear cells span both halves.
    if (x[1] > fold - 0.02) continue;
    const Vec3 X = x - Vec3(u[3 * p], u[3 * p + 1], u[3 * p + 2]);
    const Vec3 other(2.0 * middle - x[0], 2.0 * fold - x[1], x[2]);
    CAPTURE(x.transpose(), X.transpose());
    REQUIRE(std::min((X - x).norm(), (X - other).norm()) < 1e-7);
    turned += (X - other).norm() < 1e-7 ? 1 : 0;
    ++checked;
  }
  CHECK(checked > 500);
  CHECK(turned < checked);
}

TEST_CASE("where a body has gone away from, the gap tells how far, and at rest there is none") {
  const auto made = body(GENERATE(Evaluation::stressPoints, Evaluation::phyxels));
  const FieldGrid grid{.size = {60, 40, 40}, .origin = Vec3(0.15, -0.14, 0.25), .steps = 0.004 * Mat3::Identity()};
  std::vector<float> u(3 * grid.count()), gaps(grid.count(), 1.0F);
  DisplacementField atRest(grid, true);
  atRest.add(*made, bindPoints(made->rest()));
  atRest.write(0.02, u);
  atRest.writeGaps(u, gaps);
  CHECK(*std::max_element(gaps.begin(), gaps.end()) < 1e-9F);

  // By more than its own length: its old region is empty.
  constexpr double kWay = 0.09;
  for (Vec3 &displacement : made->state().displacements) displacement = Vec3(kWay, 0, 0);
  DisplacementField field(grid, true);
  field.add(*made, bindPoints(made->rest()));
  field.write(0.0, u);
  field.writeGaps(u, gaps);
  std::size_t left = 0;
  for (std::size_t p = 0; p < grid.count(); ++p) {
    const Vec3 x = grid.origin + 0.004 * Vec3(static_cast<double>(p % 60), static_cast<double>(p / 60 % 40),
                                              static_cast<double>(p / 2400));
    const auto distance = [&](double way) {
      const Vec3 shift(way, 0, 0);
      return (x - x.cwiseMax(kMin + shift).cwiseMin(kMax + shift)).norm();
    };
    // A margin of one spacing around the body belongs to it.
    if (distance(kWay) == 0.0) REQUIRE(gaps[p] == 0.0F);
    if (distance(0.0) == 0.0 && distance(kWay) > 0.016) {
      REQUIRE(gaps[p] == Approx(kWay));
      ++left;
    }
    if (distance(0.0) > 0.016) REQUIRE(gaps[p] == 0.0F);
  }
  CHECK(left > 1000);
}

namespace {

// A block fixed at its bottom, and a patch of its top that is displaced and rotated.
struct LedPatch {
  static constexpr double kSide = 0.1, kRamp = 0.05;  // m, s
  const Vec3 centre{0.5 * kSide, 0.5 * kSide, kSide}, way{0.01, 0.0, 0.005};
  Fix patch;
  Simulator simulator;
  std::size_t id = 0;

  LedPatch() {
    const Fix foot{.region = HalfSpaceRegion{Vec3(0, 0, 0.02), Vec3::UnitZ()}};
    patch = {.region = SphereRegion{centre, 0.02},
             .displacement = way,
             .rotation_deg = Vec3(0, 0, 20),
             .centre = centre,
             .ramp = kRamp};
    const BodyRecipe recipe{.sampling = {.spacing = 0.0125}, .fixes = {foot, patch}};
    const Vec3 low = Vec3::Zero(), high = Vec3::Constant(kSide);
    id = simulator.addBody(shapes::makeBody(
        shapes::restState(shapes::inside(shapes::boxSurface(low, high, 16)), recipe), {shapes::rubber(1e4)}));
    simulator.world().addProbe("inside", id, centre - Vec3(0.004, 0.003, 0.008));
    simulator.world().addProbe("on the border of the patch", id, centre + Vec3(0.0, 0.0199, 0.0));
    simulator.world().addProbe("below", id, Vec3(0.03, 0.03, 0.01));
  }
  void goTo(double time) {
    while (simulator.time() < time) REQUIRE(simulator.step());
  }
  [[nodiscard]] Vec3 led(const Vec3 &X) const {
    const double s = std::min(1.0, simulator.time() / kRamp), angle = s * 20.0 * std::numbers::pi / 180.0;
    return centre + Eigen::AngleAxisd(angle, Vec3::UnitZ()).toRotationMatrix() * (X - centre) + s * way;
  }
  [[nodiscard]] double distanceOfProbes() const {
    double most = 0.0;
    for (const Probe &probe : simulator.world().probes()) {
      const bool below = probe.name == "below";
      most = std::max(
          most,
          (simulator.world().probeState(probe).position - (below ? probe.reference : led(probe.reference))).norm());
    }
    return most;
  }
};

constexpr double kRoundOff = 1e-14;  // m, of some rotations of points at a decimetre

}  // namespace

TEST_CASE("what a support holds goes with it, wherever the phyxels beside its border go") {
  LedPatch block;
  CHECK(block.distanceOfProbes() < kRoundOff);
  block.goTo(0.6 * LedPatch::kRamp);
  CHECK(block.distanceOfProbes() < kRoundOff);
  const Checkpoint halfway = block.simulator.archive().checkpoint();
  const Probe &probe = block.simulator.world().probes().front();
  const World::ProbeState before = block.simulator.world().probeState(probe);
  const double time = block.simulator.time();
  REQUIRE(block.simulator.step());
  // The path rotates by less than 0.1 rad in a step.
  const Vec3 mean =
      (block.simulator.world().probeState(probe).position - before.position) / (block.simulator.time() - time);
  CHECK((before.velocity - mean).norm() < 0.05 * mean.norm());
  block.goTo(2.0 * LedPatch::kRamp);
  CHECK(block.distanceOfProbes() < kRoundOff);
  CHECK(block.simulator.world().probeState(probe).velocity.norm() == 0.0);

  // Surfels, in both precisions; those outside of the patch are free.
  const RestState &rest = block.simulator.body(block.id)->rest();
  const std::vector<Vec3> &u = block.simulator.body(block.id)->state().displacements;
  std::vector<Vec3> x, n, interpolated(rest.surfels.count());
  std::vector<Vec3f> onScreen, normals;
  block.simulator.world().surfels(block.id, x, n);
  block.simulator.world().surfels(block.id, onScreen, normals);
  updateSurfels(rest.surfels, {}, rest.positions, u, interpolated, {}, serialFor());
  std::size_t held = 0;
  double elsewhere = 0.0;
  for (std::size_t s = 0; s < x.size(); ++s) {
    const Vec3 X = rest.origin + rest.surfels.position(s, rest.positions);
    if (!contains(block.patch.region, X)) continue;
    ++held;
    CHECK((x[s] - block.led(X)).norm() < kRoundOff);
    for (int a = 0; a < 3; ++a) CHECK(onScreen[s][static_cast<std::size_t>(a)] == Approx(block.led(X)[a]).margin(1e-7));
    elsewhere = std::max(elsewhere, (rest.origin + interpolated[s] - block.led(X)).norm());
  }
  CHECK(held > 20);
  CHECK(elsewhere > 1e-3);

  // Material now at these points came from the patch.
  const FieldGrid grid{.size = {30, 30, 30},
                       .origin = block.centre + block.way - Vec3(0.03, 0.03, 0.04),
                       .steps = 0.002 * Mat3::Identity()};
  DisplacementField field(grid);
  field.add(*block.simulator.body(block.id), bindPoints(rest));
  std::vector<float> written(3 * grid.count());
  field.write(0.0, written);
  std::size_t within = 0;
  for (std::size_t p = 0; p < grid.count(); ++p) {
    const Vec3 place = grid.origin + grid.steps * Vec3(static_cast<double>(p % 30), static_cast<double>(p / 30 % 30),
                                                       static_cast<double>(p / 900));
    const Vec3 from = place - Vec3(written[3 * p], written[3 * p + 1], written[3 * p + 2]);
    const Vec3 material =
        block.centre + Eigen::AngleAxisd(-20.0 * std::numbers::pi / 180.0, Vec3::UnitZ()).toRotationMatrix() *
                           (place - block.centre - block.way);
    if (!contains(block.patch.region, material) || material[2] > LedPatch::kSide) continue;
    ++within;
    CHECK((from - material).norm() < 1e-8);  // floats of some millimetres
  }
  CHECK(within > 1000);

  // In the air around it, the reported material is at the distance by which the patch has been displaced.
  DisplacementField withGaps(grid, true);
  withGaps.add(*block.simulator.body(block.id), bindPoints(rest));
  withGaps.write(0.02, written);
  std::vector<float> gaps(grid.count());
  withGaps.writeGaps(written, gaps);
  std::size_t beside = 0;
  for (std::size_t p = 0; p < grid.count(); ++p) {
    const Vec3 place = grid.origin + grid.steps * Vec3(static_cast<double>(p % 30), static_cast<double>(p / 30 % 30),
                                                       static_cast<double>(p / 900));
    const Vec3 from = place - Vec3(written[3 * p], written[3 * p + 1], written[3 * p + 2]);
    // All corners of the cell of the grid around it are in the patch.
    if (gaps[p] == 0.0f || (from - block.centre).norm() > 0.02 - 0.002 * std::sqrt(3.0)) continue;
    ++beside;
    CHECK(std::abs(static_cast<double>(gaps[p]) - (block.led(from) - place).norm()) < 1e-6);
  }
  CAPTURE(beside);
  CHECK(beside > 20);

  REQUIRE(block.simulator.archive().restore(halfway));
  CHECK(block.distanceOfProbes() < kRoundOff);
  block.simulator.reset();
  CHECK(block.distanceOfProbes() < kRoundOff);
}
