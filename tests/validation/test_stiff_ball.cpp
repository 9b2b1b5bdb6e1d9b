// SPDX-License-Identifier: Apache-2.0
// A ball 100 times stiffer than the cylinder around it, against axisymmetric finite elements (truths/stiff_ball.py).
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "../unit/pointbased/shapes.h"
#include "pointbased/adaptive_sampling.h"
#include "pointbased/simulator.h"
#include "solid_shapes.h"
#include "support/catch.h"

using namespace pointbased;

namespace {

constexpr double kRadius = 0.01, kModulus = 1e4, kPressure = 1.0;  // m, Pa

std::map<std::string, double> truth() {
  std::ifstream in(C3DE_STIFF_BALL);
  REQUIRE(in);
  const nlohmann::json all = nlohmann::json::parse(in);
  return all.at("values").get<std::map<std::string, double>>();
}

Material soft(double modulus) {
  return Material{.law = MaterialLaw::linear, .youngsModulus = modulus, .poissonRatio = 0.3};
}

struct Solved {
  std::size_t phyxels = 0;
  /// Displacements under the pressure, times the cylinder's modulus over pressure and radius of the ball.
  std::map<std::string, double> ways;
};

// @param adaptive  finer cells where the error arises, for as many phyxels
Solved solved(double spacing, bool adaptive = false) {
  const Vec3 middle(0, 0, 2.0 * kRadius);
  BodyRecipe recipe{.sampling = {.spacing = spacing,
                                 .axes = Mat3(Mat3::Identity()),
                                 .materials = {{SphereRegion{middle, kRadius}, 1}}},
                    .fixes = {{.region = HalfSpaceRegion{Vec3(0, 0, 1e-6), Vec3::UnitZ()}}},
                    .loads = {{.region = HalfSpaceRegion{Vec3(0, 0, 4.0 * kRadius - 1e-6), -Vec3::UnitZ()},
                               .force = Vec3(0, 0, -kPressure * 3.14159265358979323846 * 4.0 * kRadius * kRadius),
                               .follower = false}}};
  const BodyShape cylinder = solids::cylinder(2.0 * kRadius, 4.0 * kRadius);
  const Constitution constitution{.materials = {soft(kModulus), soft(100.0 * kModulus)},
                                  .stabilisation = kLatticeStabilisation};
  if (adaptive) {
    const auto adapted = adaptSampling({cylinder, recipe, constitution}, serialFor());
    INFO((adapted ? adapted->uniform : adapted.error()));
    REQUIRE((adapted.has_value() && adapted->halved > 0));
    recipe.sampling = adapted->sampling;
  }
  const auto rest = shapes::restState(cylinder, recipe);
  Simulator simulator;
  simulator.setWorld({.integrator = Integrator::quasiStatic, .loadSteps = 1});
  const std::size_t id = simulator.addBody(std::make_unique<Body>("cylinder", rest, constitution, serialFor()));
  while (!simulator.finished()) REQUIRE(simulator.step());
  const Body &body = *simulator.body(id);
  const std::vector<Vec3> places = {middle, middle + kRadius * Vec3::UnitZ(), middle + 2.0 * kRadius * Vec3::UnitZ(),
                                    middle + 2.0 * kRadius * Vec3::UnitX()};
  std::vector<Vec3> points;
  for (const Vec3 &x : places) points.push_back(x - body.rest().origin);
  std::vector<Vec3> ways(points.size());
  interpolateDisplacements(body.rest().bind(points, std::vector<Vec3>(points.size(), Vec3::UnitZ())),
                           body.rest().positions, body.state().displacements, ways, serialFor());
  const double unit = kModulus / (kPressure * kRadius);
  return {rest->phyxelCount(),
          {{"ball_middle_z", unit * ways[0][2]},
           {"ball_pole_z", unit * ways[1][2]},
           {"top_axis_z", unit * ways[2][2]},
           {"side_r", unit * ways[3][0]}}};
}

}  // namespace

// Two materials of a cell are layers with a plane border (docs/theory/lattice.md, several materials). With one strain
// for both the ball was too large by a part of a cell, and its centre moved 15, 10 and 7.4 % too little. The lattice is
// the cylinder's, and the ball cuts its cells anywhere.
TEST_CASE("a ball 100 times stiffer than what is around it: errors fall with the spacing") {
  const std::map<std::string, double> fine = truth();
  std::map<std::string, double> before;
  struct Allowed {
    double cells, ball, top, side;
  };
  for (const Allowed &allowed :
       {Allowed{2.0, 0.045, 0.065, 0.08}, {3.0, 0.03, 0.04, 0.08}, {4.0, 0.025, 0.035, 0.065}}) {
    for (const auto &[name, value] : solved(kRadius / allowed.cells).ways) {
      CAPTURE(allowed.cells, name, value);
      const double error = std::abs(value / fine.at(name) - 1.0);
      CHECK(error < (name.starts_with("ball") ? allowed.ball : name == "side_r" ? allowed.side : allowed.top));
      if (before.contains(name) && name != "side_r") CHECK(error < before[name]);
      before[name] = error;
    }
  }
}

// At 4 cells over the radius with cells of uniform size the side is 6.3 % off, and 4.5 % at 8 (30 000 phyxels).
TEST_CASE("a ball 100 times stiffer than what is around it is within 5 % with finer cells where the error arises") {
  const std::map<std::string, double> fine = truth();
  const Solved even = solved(kRadius / 4.0);
  struct Allowed {
    double cells, ball, top, side;
  };
  for (const Allowed &allowed :
       {Allowed{2.0, 0.025, 0.055, 0.095}, {3.0, 0.02, 0.03, 0.05}, {4.0, 0.0125, 0.025, 0.05}}) {
    const Solved halved = solved(kRadius / allowed.cells, true);
    for (const auto &[name, value] : halved.ways) {
      CAPTURE(allowed.cells, name, value, halved.phyxels, even.phyxels);
      const double error = std::abs(value / fine.at(name) - 1.0);
      CHECK(error < (name.starts_with("ball") ? allowed.ball : name == "side_r" ? allowed.side : allowed.top));
      if (allowed.cells != 3.0) continue;
      CHECK(halved.phyxels < even.phyxels);
      CHECK(error < std::abs(even.ways.at(name) / fine.at(name) - 1.0));
    }
  }
}
