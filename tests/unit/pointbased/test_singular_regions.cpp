// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lattice_cases.h"
#include "pointbased/occupancy.h"
#include "pointbased/simulator.h"
#include "pointbased/singular_regions.h"
#include "solution_strains.h"
#include "support/catch.h"

using namespace pointbased;

namespace {

struct Solved {
  Simulator simulator;
  std::size_t id = 0;
  [[nodiscard]] Body &body() { return *simulator.body(id); }
};

struct Problem {
  BodyShape shape;
  std::vector<Fix> fixes;
  std::vector<Load> loads;
  double poissonRatio = 0.0;
};

std::unique_ptr<Body> bodyOf(const Problem &problem, double spacing) {
  const Material material{.youngsModulus = 1e4, .poissonRatio = problem.poissonRatio};
  return shapes::makeBody(
      shapes::restState(problem.shape,
                        {.sampling = {.spacing = spacing}, .fixes = problem.fixes, .loads = problem.loads}),
      {material});
}

std::unique_ptr<Solved> solved(const Problem &problem, double spacing) {
  auto out = std::make_unique<Solved>();
  const WorldSettings world{.integrator = Integrator::quasiStatic, .loadSteps = 1};
  out->simulator.setWorld(world);
  out->id = out->simulator.addBody(bodyOf(problem, spacing));
  while (!out->simulator.finished()) REQUIRE(out->simulator.step());
  out->body().computeGradients(serialFor());
  return out;
}

Fix held(const Region &region, const Vec3 &displacement = Vec3::Zero()) {
  return Fix{.region = region, .displacement = displacement};
}

Problem bending() {
  Problem out;
  out.shape = lattice_cases::box(Vec3::Zero(), Vec3(0.2, 0.04, 0.04));
  out.fixes = {held(HalfSpaceRegion{Vec3::Zero(), Vec3::UnitX()})};
  out.loads.resize(1);
  out.loads[0].region = HalfSpaceRegion{Vec3(0.2, 0, 0), -Vec3::UnitX()};
  out.loads[0].force = Vec3(0, 0, -1.6e-3);
  out.poissonRatio = 0.3;
  return out;
}

Problem bonded() {
  Problem out;
  out.shape = lattice_cases::box(Vec3::Zero(), Vec3::Constant(0.1));
  out.fixes = {held(HalfSpaceRegion{Vec3::Zero(), Vec3::UnitZ()}),
               held(HalfSpaceRegion{Vec3(0, 0, 0.1), -Vec3::UnitZ()}, Vec3(0, 0, -0.01))};
  out.poissonRatio = 0.3;
  return out;
}

Vec3 centreOf(const Body &body, std::size_t q) { return body.rest().origin + body.rest().pointCentres[q]; }

/// Energy norm of the error of a body's strains against those of a finer one, relative to the norm of these, in the
/// cells of the coarser one that are not excluded.
double trueErrorOutside(const Body &coarse, const Body &fine, const SingularRegions &places) {
  const auto [points, volumes] = solution_strains::samplesOf(fine.rest());
  std::vector<std::size_t> cells;
  const std::vector<Mat3> here = solution_strains::strainsAt(coarse, points, &cells);
  const std::vector<Mat3> truth = solution_strains::strainsAt(fine, points);
  double difference = 0.0, whole = 0.0;
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (places.points[cells[p]] != 0) continue;
    difference += volumes[p] * solution_strains::energyOf(fine.material(), here[p] - truth[p]);
    whole += volumes[p] * solution_strains::energyOf(fine.material(), truth[p]);
  }
  return std::sqrt(difference / whole);
}

}  // namespace

TEST_CASE("the edge of a support is left out, two spacings around it, and no more") {
  const double d = 0.008;
  const auto body = bodyOf(bending(), d);
  const SingularRegions places = findSingularRegions(*body, {});
  CHECK(places.fixes == std::vector<std::size_t>{0});
  CHECK_FALSE(places.contact);
  CHECK_FALSE(places.grabs);
  REQUIRE(places.points.size() == body->rest().pointCount());
  for (std::size_t q = 0; q < places.points.size(); ++q) {
    const Vec3 x = centreOf(*body, q);
    // The rim is the border of the face x = 0.
    const double toSide = std::min({x[1], 0.04 - x[1], x[2], 0.04 - x[2]});
    const double toRim = std::hypot(x[0], toSide);
    INFO("at " << x.transpose());
    // Points of the skin are up to half a spacing off the rim itself.
    if (toRim < (kSingularSpacings - 0.6) * d) CHECK(places.points[q] == 1);
    if (x[0] > kSingularSpacings * d) CHECK(places.points[q] == 0);
  }
  CHECK(places.volumePart > 0.02);
  CHECK(places.volumePart < 2.0 * d / 0.2 + 1e-9);
}

TEST_CASE("a part held inside of a body is singular along its edges, not on its faces") {
  Problem free;
  free.shape = lattice_cases::box(Vec3::Zero(), Vec3::Constant(0.1));
  const double d = 0.005;
  CHECK(findSingularRegions(*bodyOf(free, d), {}).volumePart == 0.0);

  Problem inside = free;
  inside.fixes = {held(BoxRegion{Vec3::Constant(0.02), Vec3::Constant(0.08)})};
  const auto body = bodyOf(inside, d);
  const SingularRegions places = findSingularRegions(*body, {});
  CHECK(places.fixes.size() == 1);
  std::size_t atEdges = 0, onFaces = 0;
  for (std::size_t q = 0; q < places.points.size(); ++q) {
    Vec3 off = ((centreOf(*body, q) - Vec3::Constant(0.05)).cwiseAbs() - Vec3::Constant(0.03));
    std::sort(off.data(), off.data() + 3);
    INFO("at " << centreOf(*body, q).transpose());
    // Of an edge: the two larger distances to the faces.
    const double toEdge = std::hypot(std::max(off[0], 0.0), off[1], off[2]);
    if (toEdge < (kSingularSpacings - 0.1) * d) {
      ++atEdges;
      CHECK(places.points[q] == 1);
    }
    if (toEdge > (kSingularSpacings + 0.1) * d) CHECK(places.points[q] == 0);
    if (std::abs(off[2]) < d && off[1] < -3.0 * d) ++onFaces;
  }
  CHECK(atEdges > 100);
  CHECK(onFaces > 100);

  inside.fixes = {held(SphereRegion{Vec3::Constant(0.05), 0.03})};
  CHECK(findSingularRegions(*bodyOf(inside, d), {}).volumePart == 0.0);
}

TEST_CASE("a tissue of a label map that is held is singular where it ends on the skin") {
  const double d = 0.005, voxel = 0.0025;
  const std::vector<float> fill(40 * 40 * 20, 1.0f);
  const Occupancy lower{
      .size = {40, 40, 20}, .fill = fill, .origin = Vec3::Constant(0.5 * voxel), .steps = voxel * Mat3::Identity()};
  Problem problem;
  problem.shape = lattice_cases::box(Vec3::Zero(), Vec3::Constant(0.1));
  problem.fixes = {held(regionOf(lower).value())};
  const auto body = bodyOf(problem, d);
  const SingularRegions places = findSingularRegions(*body, {});
  CHECK(places.fixes.size() == 1);
  std::size_t atRim = 0;
  for (std::size_t q = 0; q < places.points.size(); ++q) {
    const Vec3 x = centreOf(*body, q);
    const double toSide = std::min({x[0], 0.1 - x[0], x[1], 0.1 - x[1]}), off = std::abs(x[2] - 0.05);
    INFO("at " << x.transpose());
    if (toSide < d && off < d) {
      ++atRim;
      CHECK(places.points[q] == 1);
    }
    if (toSide > 3.0 * d || off > 4.0 * d) CHECK(places.points[q] == 0);
  }
  CHECK(atRim > 50);
}

TEST_CASE("contact is left out at its edge, not in its middle") {
  Problem plain;
  plain.shape = lattice_cases::box(Vec3::Zero(), Vec3(0.2, 0.2, 0.05));
  const double d = 0.01;
  const auto body = bodyOf(plain, d);
  std::vector<double> pressures(body->rest().phyxelCount(), 0.0);
  const Vec3 middle(0.1, 0.1, 0.05);
  for (std::size_t j = 0; j < pressures.size(); ++j) {
    const Vec3 x = body->rest().origin + body->rest().positions[j];
    if (x[2] > 0.05 - 0.1 * d && (x - middle).head<2>().norm() < 0.06) pressures[j] = 100.0;
  }
  const SingularRegions places = findSingularRegions(*body, pressures);
  CHECK(places.contact);
  CHECK(places.fixes.empty());
  std::size_t edge = 0;
  for (std::size_t q = 0; q < places.points.size(); ++q) {
    const Vec3 x = centreOf(*body, q);
    const double r = (x - middle).head<2>().norm();
    if (x[2] < 0.05 - d) continue;
    if (r < 0.03 || r > 0.09) CHECK(places.points[q] == 0);
    if (std::abs(r - 0.06) < 0.5 * d) {
      ++edge;
      CHECK(places.points[q] == 1);
    }
  }
  CHECK(edge > 20);
}

TEST_CASE("outside of singular places the figure is within a factor of two of the true error of the strains") {
  struct Case {
    const char *name;
    Problem problem;
    double spacing;
  };
  for (const Case &c : {Case{"bending", bending(), 0.04 / 3}, Case{"bonded cube", bonded(), 0.1 / 8}}) {
    const auto coarse = solved(c.problem, c.spacing), fine = solved(c.problem, c.spacing / 3.0);
    ErrorScratch scratch;
    const double whole = estimateError(coarse->body(), nullptr, scratch, serialFor()).relative;
    const SingularRegions places = findSingularRegions(coarse->body(), {});
    const double outside = relativeErrorOutside(coarse->body(), scratch, places);
    const double error = trueErrorOutside(coarse->body(), fine->body(), places);
    INFO(c.name << ": whole " << whole << ", outside " << outside << ", true " << error << ", left out "
                << places.volumePart);
    CHECK(places.volumePart < 0.5);
    CHECK(outside < whole);
    CHECK(outside > 0.5 * error);
    CHECK(outside < 2.0 * error);
  }
}
