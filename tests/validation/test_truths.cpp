// SPDX-License-Identifier: Apache-2.0
// The point-based engine against finite elements: truths/truths.json.
#include <cmath>
#include <functional>
#include <numbers>
#include <sstream>
#include <tuple>

#include "../unit/pointbased/shapes.h"
#include "solid_shapes.h"
#include "solved_body.h"
#include "support/catch.h"
#include "truth_file.h"
#include "truth_problems.h"
#include "validation_table.h"

using namespace pointbased;
using namespace validation;

namespace {

using enum MaterialLaw;

std::string layers(int n) { return ", " + std::to_string(n) + " layers"; }

using Limit = std::optional<double>;

/// One row: the named reference value against `ours`; none where the file lacks the value.
void compare(const std::string &truthName, const std::string &sampling, double ours, double milliseconds,
             const Limit &limit) {
  const auto known = truth(truthName);
  if (!known) return remark(truthName + sampling, "has no truth in truths.json");
  const std::size_t dot = truthName.rfind('.');
  judge(truthName.substr(0, dot) + sampling, truthName.substr(dot + 1) + ", " + known->unit,
        {.truth = known->value,
         .uncertainty = known->uncertainty,
         .ours = ours,
         .limit = limit,
         .milliseconds = milliseconds});
}

using Measure = std::function<double(SolvedBody &)>;
using Quantities = std::vector<std::tuple<std::string, Measure, Limit>>;

/// Solves and compares; a problem without a solution becomes a row of plain words and a failed test.
void solveAndCompare(const Problem &problem, const std::string &truthCase, const Quantities &quantities,
                     const std::string &sampling) {
  bool asked = false;
  for (const auto &[name, measure, limit] : quantities) asked = asked || limit.has_value();
  try {
    SolvedBody body(problem);
    const std::string size = sampling + " (" + std::to_string(body.rest().phyxelCount()) + ")";
    for (const auto &[name, measure, limit] : quantities)
      compare(truthCase + "." + name, size, measure(body), body.milliseconds(), limit);
  } catch (const std::runtime_error &failure) {
    noSolution(truthCase + sampling, failure.what(), asked);
  }
}
void solveAndCompare(const Problem &problem, const std::string &truthCase, const std::vector<std::string> &quantities,
                     const std::string &sampling, const Limit &limit, double length = kLength) {
  Quantities all;
  for (const std::string &name : quantities)
    all.emplace_back(
        name, [=](SolvedBody &body) { return quantityOf(body, name, length); }, limit);
  solveAndCompare(problem, truthCase, all, sampling);
}

double beamLimit(int n) { return n <= 3 ? 0.01 : 0.003; }
double cubeLimit(int n) { return n <= 6 ? 0.03 : 0.015; }

}  // namespace

TEST_CASE("solid shapes: the surface encloses the volume, outwards", "[truth]") {
  const auto volumeOf = [](const Surface &s) {
    double sum = 0.0;
    for (const auto &t : s.triangles) sum += s.positions[t[0]].dot(s.positions[t[1]].cross(s.positions[t[2]])) / 6.0;
    return sum;
  };
  // 96 sides about a circle enclose 0.07 % less.
  for (const BodyShape &shape :
       {beam(), solids::ball(Vec3(1, 2, 3), 0.05), solids::halfBall(0.05), solids::ellipsoid(Vec3(0.06, 0.04, 0.03)),
        solids::ringQuarter(0.1, 0.04), solids::cylinder(0.02, 0.1), solids::tube(0.01, 0.02, 0.2),
        solids::slantedBox(Vec3(0, -0.02, -0.02), Vec3(0.2, 0.02, 0.02), 0.5)})
    CHECK_THAT(volumeOf(shape.surface), WithinRel(shape.volume, 2e-3));
}

TEST_CASE("beams: 1 % with three layers, 0.3 % with five", "[truth]") {
  for (const MaterialLaw law : {stVenantKirchhoff, neoHookean})
    for (const int n : {3, 5}) {
      const double spacing = kWidth / n;
      const Limit limit{beamLimit(n)};
      const std::string of = std::string(".") + nameOf(law);
      solveAndCompare(cantilever(spacing, law, -1.6e-3), "beam_shear" + of, {"tip_mean_u_z"}, layers(n), limit);
      solveAndCompare(cantilever(spacing, law, -0.055), "beam_large_shear" + of, {"tip_mean_u_z", "tip_mean_u_x"},
                      layers(n), limit);
      solveAndCompare(twisted(spacing, law), "beam_twist" + of, {"torque"}, layers(n), limit);
      solveAndCompare(sagging(spacing, law, 0.4), "beam_sag_g0.4" + of, {"tip_mean_u_z"}, layers(n), limit);
      solveAndCompare(cantilever(spacing, law, -1.6e-3, 0.4), "slender_beam_shear" + of, {"tip_mean_u_z"}, layers(n),
                      limit, 0.4);
    }
  for (const char *g : {"1", "2"})
    solveAndCompare(sagging(kWidth / 5, neoHookean, std::atof(g)), std::string("beam_sag_g") + g + ".neo_hookean",
                    {"tip_mean_u_z"}, layers(5), {beamLimit(5)});
}

TEST_CASE("beams at the phyxels, after Müller: for the record", "[truth]") {
  for (const int n : {3, 5}) {
    solveAndCompare(cantilever(kWidth / n, stVenantKirchhoff, -1.6e-3).atPhyxels(), "beam_shear.stvk", {"tip_mean_u_z"},
                    layers(n) + ", phyxels", {});
    solveAndCompare(twisted(kWidth / n, stVenantKirchhoff).atPhyxels(), "beam_twist.stvk", {"torque"},
                    layers(n) + ", phyxels", {});
  }
  solveAndCompare(bondedCube(0.1 / 6, neoHookean, Vec3(0, 0, -0.02)).atPhyxels(), "cube_compressed_20.neo_hookean",
                  {"force_z"}, layers(6) + ", phyxels", {});
}

TEST_CASE("bonded cube: 3 % with six layers, 1.5 % with ten", "[truth]") {
  for (const MaterialLaw law : {stVenantKirchhoff, neoHookean, corotated})
    for (const int n : {6, 10}) {
      const std::string of = std::string(".") + nameOf(law);
      const Limit limit{cubeLimit(n)};
      solveAndCompare(bondedCube(0.1 / n, law, Vec3(0, 0, -0.02)), "cube_compressed_20" + of, {"force_z", "bulge"},
                      layers(n), limit);
      solveAndCompare(bondedCube(0.1 / n, law, Vec3(0, 0, 0.02)), "cube_stretched_20" + of, {"force_z", "bulge"},
                      layers(n), limit);
      solveAndCompare(bondedCube(0.1 / n, law, Vec3(0.02, 0, 0)), "cube_sheared_20" + of, {"force_x"}, layers(n),
                      limit);
    }
}

TEST_CASE("near incompressible cube: within twice the error at nu = 0.3", "[truth]") {
  // The larger error of the two loads counts: a single one may be small by chance.
  struct Loading {
    const char *name, *quantity;
    Vec3 move;
  };
  const Loading loadings[] = {{"cube_compressed_10", "force_z", Vec3(0, 0, -0.01)},
                              {"cube_sheared_10", "force_x", Vec3(0.01, 0, 0)}};
  const int n = 6;
  double largest = 0.0;
  for (const char *nu : {"0.3", "0.45", "0.49", "0.4999"})
    for (const Loading &loading : loadings) {
      const std::string name = std::string(loading.name) + "_nu" + nu + ".neo_hookean";
      const auto known = truth(name + "." + loading.quantity);
      SolvedBody body(bondedCube(0.1 / n, neoHookean, loading.move, std::atof(nu)));
      const double ours = quantityOf(body, loading.quantity, kLength);
      const bool first = std::string(nu) == "0.3";
      if (first && known) largest = std::max(largest, std::abs(ours / known->value - 1.0));
      compare(name + "." + loading.quantity, layers(n), ours, body.milliseconds(),
              {first ? cubeLimit(n) : 2.0 * largest});
    }
}

TEST_CASE("curved bodies: 5 % with 160 phyxels, 1.5 % with 550", "[truth]") {
  for (const MaterialLaw law : {stVenantKirchhoff, neoHookean})
    for (const std::size_t count : {160u, 550u}) {
      const Limit limit{count == 160 ? 0.05 : 0.015};
      const std::string of = std::string(".") + nameOf(law), sampling = ", " + std::to_string(count) + " phyxels";
      const double s = 0.05 * std::numbers::sqrt2 / 2;
      solveAndCompare(halfBall(count, law), "half_ball" + of,
                      {{"top_u_x", [](SolvedBody &b) { return b.displacementAt(Vec3(0, 0, 0.05))[0]; }, limit},
                       {"mean_u_x", [](SolvedBody &b) { return b.meanWithin(Region())[0]; }, limit},
                       // A sum of parts of either sign, a quarter of the lateral displacement there.
                       {"side_u_z", [=](SolvedBody &b) { return b.displacementAt(Vec3(s, 0, s))[2]; }, {}}},
                      sampling);
      const auto tip = [](int axis) { return [axis](SolvedBody &b) { return b.meanOver(face(0, 0.0))[axis]; }; };
      solveAndCompare(ringQuarter(count, law, Vec3(0, 0, -0.02)), "ring_transverse" + of,
                      {{"tip_mean_u_z", tip(2), limit}}, sampling);
      solveAndCompare(ringQuarter(count, law, Vec3(0, -0.03, 0)), "ring_in_plane" + of,
                      {{"tip_mean_u_y", tip(1), limit}, {"tip_mean_u_x", tip(0), limit}}, sampling);
      const auto sag = truth("ellipsoid" + of + ".bottom_u_z");
      solveAndCompare(hangingEllipsoid(count, law, sag ? sag->gravity[2] : -9.81), "ellipsoid" + of,
                      {{"bottom_u_z", [](SolvedBody &b) { return b.displacementAt(Vec3(0, 0, -0.03))[2]; }, limit},
                       {"mean_u_z", [](SolvedBody &b) { return b.meanWithin(slab(2, -1.0, 0.024))[2]; }, limit}},
                      sampling);
    }
}

// Of first order the same bodies have up to 10 % (see the case before).
TEST_CASE("of second order, curved bodies are right: 2 % with 160 phyxels, 1 % with 550", "[truth]") {
  for (const MaterialLaw law : {stVenantKirchhoff, neoHookean})
    for (const std::size_t count : {160u, 550u}) {
      const Limit limit{count == 160 ? 0.02 : 0.01};
      const std::string of = std::string(".") + nameOf(law),
                        sampling = ", " + std::to_string(count) + " phyxels, second order";
      Problem ball = halfBall(count, law), transverse = ringQuarter(count, law, Vec3(0, 0, -0.02)),
              inPlane = ringQuarter(count, law, Vec3(0, -0.03, 0));
      for (Problem *problem : {&ball, &transverse, &inPlane}) problem->recipe.sampling.order = LatticeOrder::quadratic;
      solveAndCompare(ball, "half_ball" + of,
                      {{"top_u_x", [](SolvedBody &b) { return b.displacementAt(Vec3(0, 0, 0.05))[0]; }, limit},
                       {"mean_u_x", [](SolvedBody &b) { return b.meanWithin(Region())[0]; }, limit}},
                      sampling);
      const auto tip = [](int axis) { return [axis](SolvedBody &b) { return b.meanOver(face(0, 0.0))[axis]; }; };
      solveAndCompare(transverse, "ring_transverse" + of, {{"tip_mean_u_z", tip(2), limit}}, sampling);
      solveAndCompare(inPlane, "ring_in_plane" + of, {{"tip_mean_u_y", tip(1), limit}, {"tip_mean_u_x", tip(0), limit}},
                      sampling);
    }
}

TEST_CASE("tubes and bars with slanted faces bend right: 2.5 % with three layers, 1 % with five", "[truth]") {
  const auto along = [](int axis) { return [axis](SolvedBody &b) { return b.meanOver(face(0, kLength))[axis]; }; };
  for (const LatticeOrder order : {LatticeOrder::linear, LatticeOrder::quadratic})
    for (const int n : {3, 5}) {
      const std::string sampling = layers(n) + (order == LatticeOrder::quadratic ? ", second order" : "");
      const Limit limit{n == 3 ? 0.025 : 0.01};  // measured: 2.1 and 0.2 %
      Problem tube = bentTube(kWidth / n, stVenantKirchhoff), bar = slantedBar(kWidth / n, stVenantKirchhoff);
      tube.recipe.sampling.order = bar.recipe.sampling.order = order;
      solveAndCompare(tube, "tube_shear.stvk", {{"tip_mean_u_z", along(2), limit}}, sampling);
      solveAndCompare(bar, "slanted_bar_shear.stvk",
                      {{"tip_mean_u_z", along(2), limit}, {"tip_mean_u_y", along(1), limit}}, sampling);
    }
}

TEST_CASE("indentation by a bonded patch: 3 % with ten layers", "[truth]") {
  for (const char *name :
       {"indentation_2mm_nu0.3.stvk", "indentation_2mm_nu0.45.stvk", "indentation_2mm_nu0.3.neo_hookean",
        "indentation_2mm_nu0.45.neo_hookean", "indentation_5mm_nu0.3.neo_hookean"}) {
    const std::string of = name;
    const Problem problem = indentation(0.005, of.ends_with("stvk") ? stVenantKirchhoff : neoHookean,
                                        of.find("0.45") != std::string::npos ? 0.45 : 0.3,
                                        of.find("5mm") != std::string::npos ? 0.005 : 0.002);
    solveAndCompare(problem, of, {"force_z"}, layers(10), {0.03});
  }
}

// The edge of the patch is at 0.4 and 0.6 of a cell, on corners, and oblique to the cells of the face and of the depth.
TEST_CASE("a bonded patch may lie anywhere on the lattice: 5 % with eight layers and more", "[truth]") {
  const auto compared = [](const Problem &problem, const std::string &sampling) {
    solveAndCompare(problem, "indentation_2mm_nu0.3.neo_hookean", {"force_z"}, sampling, {0.05});
  };
  for (const int n : {8, 12, 14}) {
    compared(indentation(0.05 / n, neoHookean, 0.3, 0.002), layers(n));
    compared(indentation(0.05 / n, neoHookean, 0.3, 0.002, true), layers(n) + ", by hand");
  }
  for (const double degrees : {15.0, 45.0})
    for (const auto &[name, axis] : {std::pair("x", Vec3(Vec3::UnitX())), std::pair("z", Vec3(Vec3::UnitZ()))}) {
      Problem problem = indentation(0.05 / 8, neoHookean, 0.3, 0.002);
      problem.recipe.sampling.axes = Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, axis).toRotationMatrix();
      compared(problem,
               layers(8) + ", lattice turned " + std::to_string(static_cast<int>(degrees)) + "° about " + name);
    }
}

// The patch and a layer below it. One of 1.2 mm is thinner than a quarter of a cell of eight and ten layers.
TEST_CASE("a held layer below a punch: 10 % with eight layers and more", "[truth]") {
  for (const int n : {8, 10})
    for (const char *thickness : {"1.2", "3"}) {
      Problem problem = indentation(0.05 / n, neoHookean, 0.3, 0.002);
      auto &box = std::get<BoxRegion>(problem.recipe.fixes.back().region);
      box.min[2] = 0.05 - 1e-3 * std::atof(thickness);
      box.max[2] = 0.06;
      // Ten layers of 5 mm with 3 mm: 12 %.
      const bool isThick = n == 10 && box.min[2] < 0.048;
      solveAndCompare(problem, std::string("embedded_punch_") + thickness + "mm.neo_hookean", {"force_z"}, layers(n),
                      isThick ? Limit() : Limit(0.1));
    }
}

TEST_CASE("pressure that follows its face, and two materials", "[truth]") {
  for (const bool follows : {true, false}) {
    solveAndCompare(pressedBeam(0.02 / 5, follows),
                    follows ? "pressure_follower.neo_hookean" : "pressure_dead.neo_hookean",
                    {"tip_mean_u_z", "tip_mean_u_x"}, layers(5), {beamLimit(5)});
  }
}

TEST_CASE("the lattice need not fit the beam: offset, jittered, turned", "[truth]") {
  const auto compared = [](Problem problem, const std::string &sampling, double limit) {
    solveAndCompare(problem, "beam_shear.stvk", {"tip_mean_u_z"}, sampling, {limit});
  };
  // Spacings that divide neither width nor length.
  for (const char *layers : {"3.1", "3.3", "3.4", "3.7", "4.1", "4.7", "5.3"})
    compared(cantilever(kWidth / std::atof(layers), stVenantKirchhoff, -1.6e-3), std::string(", ") + layers + " layers",
             0.01);
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    Problem problem = cantilever(kWidth / 5, stVenantKirchhoff, -1.6e-3);
    problem.recipe.sampling.jitter = 0.2;
    problem.recipe.sampling.seed = seed;
    compared(problem, layers(5) + ", jitter 0.2, seed " + std::to_string(seed), 0.01);
  }
  const std::pair<const char *, Vec3> axes[] = {
      {"x", Vec3::UnitX()}, {"y", Vec3::UnitY()}, {"z", Vec3::UnitZ()}, {"(1,1,1)", Vec3(1, 1, 1).normalized()}};
  for (const auto &[name, axis] : axes) {
    Problem problem = cantilever(kWidth / 5, stVenantKirchhoff, -1.6e-3);
    problem.recipe.sampling.axes = Eigen::AngleAxisd(std::numbers::pi / 6, axis).toRotationMatrix();
    compared(problem, layers(5) + ", turned 30° about " + name, 0.02);
    Problem twist = twisted(kWidth / 5, stVenantKirchhoff);
    twist.recipe.sampling.axes = problem.recipe.sampling.axes;
    solveAndCompare(twist, "beam_twist.stvk", {"torque"}, layers(5) + ", turned 30° about " + name, {0.02});
  }
}

// Of first order the tip of the beam at 45° has -8.1 % with three layers and -3.2 % with five. What is left is in part
// from moments of cut cells by 4³ points: with 8³ the bending of 45° in tests/validation/studies/oblique_beam.py is 0.8 %
// nearer to the exact one.
TEST_CASE("of second order, a beam oblique to its lattice is right: 4 % with three layers, 1.5 % with five",
          "[truth]") {
  const std::pair<const char *, Mat3> turns[] = {
      {"30° about y", Eigen::AngleAxisd(std::numbers::pi / 6, Vec3::UnitY()).toRotationMatrix()},
      {"45° about y", Eigen::AngleAxisd(std::numbers::pi / 4, Vec3::UnitY()).toRotationMatrix()},
      {"30° about z", Eigen::AngleAxisd(std::numbers::pi / 6, Vec3::UnitZ()).toRotationMatrix()},
      {"40° about (1,2,-½)", Eigen::AngleAxisd(0.7, Vec3(1, 2, -0.5).normalized()).toRotationMatrix()}};
  for (const int n : {3, 5})
    for (const auto &[name, turn] : turns) {
      const std::string sampling = layers(n) + ", second order, " + name;
      const Limit limit{n == 3 ? 0.04 : 0.015};
      Problem bent = cantilever(kWidth / n, stVenantKirchhoff, -1.6e-3), twist = twisted(kWidth / n, stVenantKirchhoff);
      for (Problem *problem : {&bent, &twist}) {
        problem->recipe.sampling.axes = turn;
        problem->recipe.sampling.order = LatticeOrder::quadratic;
      }
      solveAndCompare(bent, "beam_shear.stvk", {"tip_mean_u_z"}, sampling, limit);
      solveAndCompare(twist, "beam_twist.stvk", {"torque"}, sampling, limit);
    }
}

// Not run by default: the table of docs/theory/lattice.md.
TEST_CASE("thirty random directions of the lattice, first and second order", "[.directions]") {
  const std::vector<Mat3> turns = randomDirections(30);
  for (const int n : {3, 5})
    for (const LatticeOrder order : {LatticeOrder::linear, LatticeOrder::quadratic})
      for (std::size_t k = 0; k < turns.size(); ++k) {
        Problem bent = cantilever(kWidth / n, stVenantKirchhoff, -1.6e-3),
                twist = twisted(kWidth / n, stVenantKirchhoff);
        for (Problem *problem : {&bent, &twist}) {
          problem->recipe.sampling.axes = turns[k];
          problem->recipe.sampling.order = order;
        }
        const std::string sampling =
            layers(n) + (order == LatticeOrder::linear ? ", first order, " : ", second order, ") + std::to_string(k);
        solveAndCompare(bent, "beam_shear.stvk", {"tip_mean_u_z"}, sampling, {});
        solveAndCompare(twist, "beam_twist.stvk", {"torque"}, sampling, {});
      }
}

TEST_CASE("a tube and a slanted bar in thirty random directions of the lattice", "[.directions]") {
  const std::vector<Mat3> turns = randomDirections(30);
  for (const int n : {3, 5})
    for (const LatticeOrder order : {LatticeOrder::linear, LatticeOrder::quadratic})
      for (std::size_t k = 0; k < turns.size(); ++k) {
        Problem tube = bentTube(kWidth / n, stVenantKirchhoff), bar = slantedBar(kWidth / n, stVenantKirchhoff);
        for (Problem *problem : {&tube, &bar}) {
          problem->recipe.sampling.axes = turns[k];
          problem->recipe.sampling.order = order;
        }
        const std::string sampling =
            layers(n) + (order == LatticeOrder::linear ? ", first order, " : ", second order, ") + std::to_string(k);
        solveAndCompare(tube, "tube_shear.stvk", {"tip_mean_u_z"}, sampling, {});
        solveAndCompare(bar, "slanted_bar_shear.stvk", {"tip_mean_u_z"}, sampling, {});
      }
}

TEST_CASE("a turned beam bends as the straight one: 1.5 % with three layers, 0.7 % with five", "[truth]") {
  const Vec3 axes[] = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ(), Vec3(1, 1, 1).normalized(),
                       Vec3(1, 2, -0.5).normalized()};
  const double angles[] = {30, 30, 45, 30, 70};
  for (const int n : {3, 5})
    for (std::size_t k = 0; k < 5; ++k) {
      const Mat3 turn = Eigen::AngleAxisd(angles[k] * std::numbers::pi / 180.0, axes[k]).toRotationMatrix();
      const Vec3 along = turn.col(0);
      // Half-spaces slightly beyond the end faces hold and load these.
      const Region root = HalfSpaceRegion{1e-7 * along, along}, tip = HalfSpaceRegion{(kLength - 1e-7) * along, -along};
      std::ostringstream sampling;
      sampling << layers(n) << ", body turned by " << angles[k] << "° about (" << axes[k].transpose() << ")";
      const Limit limit{n == 3 ? 0.015 : 0.007};
      Problem bent = Problem::rubber(shapes::turned(beam(), turn), kWidth / n).hold(root);
      bent.pull(tip, turn * Vec3(0, 0, -1.6e-3));
      solveAndCompare(bent, "beam_shear.stvk",
                      {{"tip_mean_u_z", [=](SolvedBody &b) { return turn.col(2).dot(b.meanOver(tip)); }, limit}},
                      sampling.str());
    }
}

TEST_CASE("a cube bonded between turned faces: 3 % with six layers", "[truth]") {
  const Mat3 turn = Eigen::AngleAxisd(0.9, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();
  const Vec3 up = turn.col(2);
  for (const MaterialLaw law : {stVenantKirchhoff, neoHookean, corotated}) {
    Problem problem = Problem::rubber(shapes::turned(cube(), turn), 0.1 / 6, law);
    problem.hold(HalfSpaceRegion{1e-7 * up, up}).move(HalfSpaceRegion{(0.1 - 1e-7) * up, -up}, -0.02 * up);
    solveAndCompare(problem, std::string("cube_compressed_20.") + nameOf(law),
                    {{"force_z", [=](SolvedBody &b) { return up.dot(b.reaction(1).force); }, Limit{cubeLimit(6)}}},
                    layers(6) + ", body turned");
  }
}
