// SPDX-License-Identifier: Apache-2.0
// Pressure near incompressibility: tests for alternation from cell to cell.
#include "pressure_field.h"
#include "solid_shapes.h"
#include "support/catch.h"
#include "validation_table.h"

using namespace pointbased;
using namespace validation;

namespace {

const Vec3 kMin(-0.05, -0.05, 0.0), kMax(0.05, 0.05, 0.1);

enum class Kind { compressed, sheared, sagging, punched };

Problem cube(Kind kind, int layers, double poissonRatio) {
  Problem problem = Problem::rubber(solids::box(kMin, kMax), 0.1 / layers, MaterialLaw::neoHookean);
  problem.material.poissonRatio = poissonRatio;
  problem.hold(face(2, 0.0));
  switch (kind) {
    case Kind::compressed: problem.move(face(2, 0.1), Vec3(0, 0, -0.02)); break;
    case Kind::sheared: problem.move(face(2, 0.1), Vec3(0.02, 0, 0)); break;
    case Kind::sagging: problem.world.gravity = Vec3(0, 0, -9.81); break;
    case Kind::punched:
      problem.move(Region(BoxRegion{Vec3(-0.02, -0.02, 0.1 - 1e-7), Vec3(0.02, 0.02, 0.1 + 1e-7)}), Vec3(0, 0, -0.005));
  }
  return problem;
}

struct Looked {
  Roughness points, phyxels;
};

Looked look(Kind kind, int layers, double poissonRatio) {
  SolvedBody body(cube(kind, layers, poissonRatio));
  static const char *const names[] = {"compressed by 20 %", "sheared by 20 %", "hanging on itself",
                                      "under a bonded punch"};
  char name[100];
  std::snprintf(name, sizeof name, "cube %s, ν = %g, %d layers", names[static_cast<int>(kind)], poissonRatio, layers);
  // Two cells from every face: edges of supports are singular, and a singular field is rough in any computation.
  const auto at = [&](PressureAt where) { return pressureRoughness(body, where, kMin, kMax, 0.1 / layers, 2); };
  const Looked out{at(PressureAt::points), at(PressureAt::phyxels)};
  const auto record = [&](const char *what, double value, std::optional<double> limit) {
    judge(name, what, {.ours = value, .limit = limit, .milliseconds = body.milliseconds(), .scale = 1.0});
  };
  // In shear the cells of the layers alternate like a checkerboard, see the theory page.
  record("(-1)^(i+j+k) at points", out.points.checkerboard, 0.02);
  record("in planes, at points", out.points.planes, kind == Kind::sheared ? std::optional<double>() : 0.1);
  record("(-1)^(i+j+k) at phyxels", out.phyxels.checkerboard, 0.01);
  record("in planes, at phyxels", out.phyxels.planes, 0.1);
  return out;
}

}  // namespace

TEST_CASE("pressure to Poisson's ratio 0.4999: no checkerboard in what is handed out, and it falls with the spacing",
          "[pressure]") {
  for (const double nu : {0.3, 0.49, 0.4999})
    for (const Kind kind : {Kind::compressed, Kind::sagging, Kind::punched})
      if (kind != Kind::punched || nu < 0.4999) (void)look(kind, 6, nu);
  for (const double nu : {0.3, 0.49, 0.4999}) {
    const Looked coarse = look(Kind::sheared, 6, nu), fine = look(Kind::sheared, 10, nu);
    CHECK(fine.points.planes < coarse.points.planes);
    CHECK(fine.phyxels.planes < 0.6 * coarse.phyxels.planes);
    // The exported values follow the smooth part: its size is that at the points, without the checkerboard.
    CHECK(fine.phyxels.offLinear < 0.6 * coarse.phyxels.offLinear);
  }
}
