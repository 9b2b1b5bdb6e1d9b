// SPDX-License-Identifier: Apache-2.0
// The error reported by verify(), against the error by truths/truths.json.
#include <cmath>
#include <cstdio>

#include "pointbased/accuracy.h"
#include "support/catch.h"
#include "truth_file.h"
#include "truth_problems.h"
#include "validation_table.h"

using namespace pointbased;
using namespace validation;

namespace {

using enum MaterialLaw;

struct Case {
  std::string truth;  ///< without its quantities
  std::string sampling;
  Problem problem;
  std::vector<std::string> quantities;
  double length = kLength;
};

std::string layers(int n) { return ", " + std::to_string(n) + " layers"; }

void addBeams(std::vector<Case> &cases) {
  for (const MaterialLaw law : {stVenantKirchhoff, neoHookean})
    for (const int n : {3, 5}) {
      const double spacing = kWidth / n;
      const std::string of = std::string(".") + nameOf(law);
      cases.push_back({"beam_shear" + of, layers(n), cantilever(spacing, law, -1.6e-3), {"tip_mean_u_z"}});
      cases.push_back(
          {"beam_large_shear" + of, layers(n), cantilever(spacing, law, -0.055), {"tip_mean_u_z", "tip_mean_u_x"}});
      cases.push_back({"beam_twist" + of, layers(n), twisted(spacing, law), {"torque"}});
      cases.push_back({"beam_sag_g0.4" + of, layers(n), sagging(spacing, law, 0.4), {"tip_mean_u_z"}});
      cases.push_back(
          {"slender_beam_shear" + of, layers(n), cantilever(spacing, law, -1.6e-3, 0.4), {"tip_mean_u_z"}, 0.4});
    }
}

void addBlocks(std::vector<Case> &cases) {
  for (const int n : {6, 10})
    for (const MaterialLaw law : {stVenantKirchhoff, neoHookean, corotated}) {
      const std::string of = std::string(".") + nameOf(law);
      const auto add = [&](const char *name, const Vec3 &move, const std::vector<std::string> &quantities) {
        cases.push_back({name + of, layers(n), bondedCube(0.1 / n, law, move), quantities});
      };
      add("cube_compressed_20", Vec3(0, 0, -0.02), {"force_z", "bulge"});
      add("cube_stretched_20", Vec3(0, 0, 0.02), {"force_z", "bulge"});
      add("cube_sheared_20", Vec3(0.02, 0, 0), {"force_x"});
    }
  for (const double nu : {0.3, 0.45}) {
    const std::string of = nu < 0.4 ? "0.3" : "0.45";
    cases.push_back({"indentation_2mm_nu" + of + ".neo_hookean",
                     layers(10),
                     indentation(0.005, neoHookean, nu, 0.002),
                     {"force_z"}});
  }
}

void addPressed(std::vector<Case> &cases) {
  for (const bool follows : {true, false})
    cases.push_back({follows ? "pressure_follower.neo_hookean" : "pressure_dead.neo_hookean",
                     layers(5),
                     pressedBeam(0.02 / 5, follows),
                     {"tip_mean_u_z", "tip_mean_u_x"}});
}

void addCurved(std::vector<Case> &cases) {
  for (const MaterialLaw law : {stVenantKirchhoff, neoHookean})
    for (const std::size_t count : {160u, 550u}) {
      const std::string of = std::string(".") + nameOf(law), sampling = ", " + std::to_string(count) + " phyxels";
      cases.push_back({"half_ball" + of, sampling, halfBall(count, law), {"top_u_x", "mean_u_x"}});
      cases.push_back(
          {"ring_transverse" + of, sampling, ringQuarter(count, law, Vec3(0, 0, -0.02)), {"tip_mean_u_z"}, 0.0});
      cases.push_back({"ring_in_plane" + of,
                       sampling,
                       ringQuarter(count, law, Vec3(0, -0.03, 0)),
                       {"tip_mean_u_y", "tip_mean_u_x"},
                       0.0});
      if (const auto sag = truth("ellipsoid" + of + ".bottom_u_z"))
        cases.push_back(
            {"ellipsoid" + of, sampling, hangingEllipsoid(count, law, sag->gravity[2]), {"bottom_u_z", "mean_u_z"}});
    }
}

}  // namespace

namespace {

struct Judged {
  std::size_t rows = 0, within = 0;
};

/// A line of the table; for the record where the reference value is not accurate enough for a comparison.
void judge(const Case &one, const std::string &quantity, double coarse, double fine, Judged &certain,
           Judged &uncertain) {
  constexpr double kAsked = 1.5;
  const auto known = truth(one.truth + "." + quantity);
  REQUIRE(known);
  const double error = (known->value - coarse) / std::abs(known->value);
  const double told = errorOverDifference(kFineReferenceRefinement) * (fine - coarse) / std::abs(known->value);
  const double ratio = told / error, unsure = known->uncertainty / std::abs(known->value);
  const bool isCertain = std::abs(error) > 3.0 * unsure, isWithin = ratio > 1.0 / kAsked && ratio < kAsked;
  Judged &sum = isCertain ? certain : uncertain;
  ++sum.rows;
  sum.within += isWithin ? 1 : 0;
  std::printf("%-36s %-14s %-13s %9.3f %9.3f %8.2f %8.3f  %s\n", one.truth.c_str(), one.sampling.substr(2).c_str(),
              quantity.c_str(), 100.0 * error, 100.0 * told, ratio, 100.0 * unsure,
              !isCertain ? "truth too uncertain"
              : isWithin ? ""
                         : "outside of 1.5");
  std::fflush(stdout);
}

}  // namespace

TEST_CASE("verify: its error is within a factor of 1.5 of the true one", "[verify][slow]") {
  std::vector<Case> cases;
  addBeams(cases);
  addCurved(cases);
  addBlocks(cases);
  addPressed(cases);
  Judged certain, uncertain;
  std::printf("%-36s %-14s %-13s %9s %9s %8s %8s\n", "case", "sampling", "quantity", "true, %", "told, %", "ratio",
              "truth +-");
  for (const Case &one : cases) {
    SolvedBody body(one.problem);
    const Verification verified = body.verify(one.problem);
    SolvedBody fineReference(one.problem, verified);
    for (const std::string &quantity : one.quantities)
      judge(one, quantity, quantityOf(body, quantity, one.length), quantityOf(fineReference, quantity, one.length),
            certain, uncertain);
  }
  std::printf(
      "within a factor of 1.5: %zu of %zu; where the error is below three times the truth's uncertainty: %zu of "
      "%zu\n",
      certain.within, certain.rows, uncertain.within, uncertain.rows);
  CHECK(certain.rows >= 60);
  // The exceptions: the beams' twist, whose errors of two kinds cancel, and ellipsoids of 160 phyxels, thinner than
  // their lattice where they are held.
  CHECK(10 * certain.within >= 9 * certain.rows);
}

TEST_CASE("the displacement figure before a verification bounds the true error of four of five", "[statement]") {
  std::vector<Case> cases;
  addBeams(cases);
  addCurved(cases);
  addPressed(cases);
  std::size_t rows = 0, bounded = 0;
  double worst = 0.0, sumOfLogs = 0.0;
  std::printf("%-36s %-14s %-13s %10s %10s %8s\n", "case", "sampling", "quantity", "true, mm", "figure, mm", "ratio");
  for (const Case &one : cases) {
    SolvedBody body(one.problem);
    const auto survey = surveyAccuracy({one.problem.shape,
                                        one.problem.recipe,
                                        Constitution{{one.problem.material}, kLatticeStabilisation},
                                        {},
                                        one.problem.world.gravity},
                                       serialFor());
    if (!survey || survey->supposed) continue;
    double largest = 0.0;
    for (const Vec3 &u : body.body().state().displacements) largest = std::max(largest, u.norm());
    const double figure = predictError(*survey, body.rest().spacing).likely * largest;
    for (const std::string &quantity : one.quantities) {
      if (quantity.find("u_") == std::string::npos) continue;
      const auto known = truth(one.truth + "." + quantity);
      REQUIRE(known);
      const double error = std::abs(known->value - quantityOf(body, quantity, one.length));
      if (error < 3.0 * known->uncertainty) continue;
      ++rows;
      bounded += error <= figure ? 1 : 0;
      worst = std::max(worst, error / figure);
      sumOfLogs += std::log(figure / error);
      std::printf("%-36s %-14s %-13s %10.4f %10.4f %8.2f\n", one.truth.c_str(), one.sampling.substr(2).c_str(),
                  quantity.c_str(), 1e3 * error, 1e3 * figure, figure / error);
    }
  }
  const double typical = std::exp(sumOfLogs / static_cast<double>(rows));
  std::printf("bounded: %zu of %zu; the worst is %.2f of its figure; figures are %.1f times the error in the mean\n",
              bounded, rows, worst, typical);
  CHECK(rows >= 15);
  // All of the others are beams.
  CHECK(5 * bounded >= 4 * rows);
  CHECK(worst < 2.0);
  // A bound that is always far too large would be useless.
  CHECK(typical < 8.0);
}
