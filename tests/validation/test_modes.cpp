// SPDX-License-Identifier: Apache-2.0
// Natural frequencies of the discretised body against finite elements and series.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "natural_modes.h"
#include "solid_shapes.h"
#include "solved_body.h"
#include "support/catch.h"
#include "truth_file.h"
#include "truth_problems.h"
#include "validation_table.h"

using namespace pointbased;
using namespace validation;

namespace {

constexpr double kPi = std::numbers::pi, kE = 1e4, kDensity = 1000.0;

Problem vibrating(const BodyShape &shape, double spacing) {
  Problem problem = Problem::rubber(shape, spacing);
  problem.world.integrator = Integrator::explicitVerlet;
  return problem;
}

/// Frequencies of the continuum's modes, Hz: without the rigid motions of a free body and without rattling modes.
/// `lowest`: of all but the rigid motions.
std::vector<double> elasticOnes(Body &body, int count, bool isFree, double *lowest = nullptr) {
  const std::vector<Mode> modes = naturalModes(body, count);
  std::vector<double> out;
  for (std::size_t i = isFree ? 6 : 0; i < modes.size(); ++i)
    if (!modes[i].rattles()) out.push_back(modes[i].frequency);
  if (lowest) *lowest = modes[isFree ? 6 : 0].frequency;
  out.resize(std::max<std::size_t>(out.size(), 24), std::nan(""));
  return out;
}

}  // namespace

TEST_CASE("frequencies of a free cube", "[truth][slow]") {
  const double a = 0.1, speed = std::sqrt(kE / 2.6 / kDensity);
  for (const int n : {6, 10}) {
    SolvedBody body(vibrating(solids::box(Vec3::Zero(), Vec3::Constant(a)), a / n));
    const Stopwatch watch;
    double lowest = 0.0;
    const std::vector<double> f = elasticOnes(body.body(), 48, true, &lowest);
    judge("free cube, " + std::to_string(n) + " layers (" + std::to_string(body.rest().phyxelCount()) + ")",
          "lowest of all, Hz",
          {.truth = 2.8562 * speed / a / (2 * kPi),
           .ours = lowest,
           .limit = n <= 6 ? 0.03 : 0.015,
           .milliseconds = watch.milliseconds()});
    // ω a / c_s
    for (const auto &[i, omega] : {std::pair(0u, 2.8562), std::pair(2u, 3.8460), std::pair(5u, 3.9113)})
      // As of the bonded cube.
      judge("free cube, " + std::to_string(n) + " layers (" + std::to_string(body.rest().phyxelCount()) + ")",
            "f_" + std::to_string(i) + ", Hz",
            {.truth = omega * speed / a / (2 * kPi),
             .ours = f[i],
             .limit = n <= 6 ? 0.03 : 0.015,
             .milliseconds = watch.milliseconds()});
  }
}

TEST_CASE("Lamé's mode of a free cube", "[truth]") {
  const double a = 0.1, k = kPi / a, speed = std::sqrt(kE / 2.6 / kDensity);
  for (const int n : {6, 10}) {
    SolvedBody body(vibrating(solids::box(Vec3::Zero(), Vec3::Constant(a)), a / n));
    const Vec3 origin = body.rest().origin;
    const Stopwatch watch;
    const double ours = frequencyOfShape(body.body(), [&](const Vec3 &local) {
      const Vec3 X = local + origin;
      return Vec3(std::cos(k * X[0]) * std::sin(k * X[1]), -std::sin(k * X[0]) * std::cos(k * X[1]), 0.0);
    });
    judge("free cube, " + std::to_string(n) + " layers (" + std::to_string(body.rest().phyxelCount()) + ")",
          "Lamé's mode, Hz",
          {.truth = speed / (a * std::numbers::sqrt2),
           .ours = ours,
           .limit = n <= 6 ? 0.03 : 0.015,
           .milliseconds = watch.milliseconds()});
  }
}

TEST_CASE("frequencies of a free ball", "[truth]") {
  const double R = 0.05, slow = std::sqrt(kE / 2.6 / kDensity), fast = slow * std::sqrt(2 * 0.7 / 0.4);
  // Spherical Bessel functions over powers of r, times the corresponding field.
  const auto torsional = [=](const Vec3 &X) -> Vec3 {
    const double k = std::max(2.50113 * X.norm() / R, 1e-3);
    const double j2 = (3 / (k * k * k) - 1 / k) * std::sin(k) - 3 * std::cos(k) / (k * k);
    return j2 / (k * k) * X[2] * Vec3(-X[1], X[0], 0);
  };
  const auto breathing = [=](const Vec3 &X) -> Vec3 {
    const double k = std::max(2.67021 * X.norm() / R, 1e-3);
    return (std::sin(k) / (k * k) - std::cos(k) / k) / k * X;
  };
  for (const std::size_t count : {160u, 550u}) {
    Problem problem = vibrating(solids::ball(Vec3::Zero(), R), 0.0);
    problem.recipe.sampling.count = count;
    SolvedBody body(problem);
    const Vec3 origin = body.rest().origin;
    const auto frequency = [&](const auto &shape) {
      return frequencyOfShape(body.body(), [&](const Vec3 &X) { return shape(X + origin); });
    };
    const std::string name = "free ball (" + std::to_string(body.rest().phyxelCount()) + ")";
    const double limit = count == 160 ? 0.05 : 0.015;
    const Stopwatch watch;
    double inertia = 0.0;  // about the z axis
    for (std::size_t i = 0; i < body.rest().phyxelCount(); ++i)
      inertia += body.body().masses()[i] * (body.rest().positions[i] + origin).head<2>().squaredNorm();
    judge(name, "inertia / (0.4 m R²)",
          {.truth = 1.0,
           .ours = inertia / (0.4 * body.body().totalMass() * R * R),
           .limit = limit,
           .milliseconds = watch.milliseconds()});
    judge(name, "torsional l = 2, Hz",
          {.truth = 2.50113 * slow / R / (2 * kPi),
           .ours = frequency(torsional),
           .limit = limit,
           .milliseconds = watch.milliseconds()});
    judge(name, "breathing, Hz",
          {.truth = 2.67021 * fast / R / (2 * kPi),
           .ours = frequency(breathing),
           .limit = limit,
           .milliseconds = watch.milliseconds()});
    judge(name, "lowest of all, Hz",
          {.truth = 2.50113 * slow / R / (2 * kPi),
           .ours = naturalModes(body.body(), 8)[6].frequency,
           .limit = limit,
           .milliseconds = watch.milliseconds()});
  }
}

TEST_CASE("frequencies of a cantilever and a free bar", "[truth]") {
  const double a = 0.04;
  const char *names[] = {"f_bending_1", "f_torsion_1", "f_bending_2", "f_axial_1"};
  const std::size_t at[] = {0, 2, 3, 5};
  for (const int n : {3, 5}) {
    Problem problem = vibrating(solids::box(Vec3(0, -a / 2, -a / 2), Vec3(0.2, a / 2, a / 2)), a / n);
    problem.hold(face(0, 0.0));
    SolvedBody body(problem);
    const Stopwatch watch;
    const std::vector<double> f = elasticOnes(body.body(), 24, false);
    const std::string name =
        "cantilever 5 : 1, " + std::to_string(n) + " layers (" + std::to_string(body.rest().phyxelCount()) + ")";
    for (std::size_t i = 0; i < 4; ++i) {
      const auto known = truth(std::string("beam_frequencies.") + names[i]);
      if (!known) {
        remark(name, std::string(names[i]) + " has no truth in truths.json");
        continue;
      }
      judge(name, std::string(names[i]) + ", Hz",
            {.truth = known->value,
             .uncertainty = known->uncertainty,
             .ours = f[at[i]],
             .limit = n <= 3 ? 0.01 : 0.003,
             .milliseconds = watch.milliseconds()});
    }
  }
  // A free bar 4 : 1 : 1 of side 1: ω a / c_s of the published Ritz solution, four digits.
  const double speed = std::sqrt(kE / 2.6 / kDensity);
  for (const int n : {3, 5}) {
    SolvedBody body(vibrating(solids::box(Vec3::Zero(), Vec3(4 * a, a, a)), a / n));
    const Stopwatch watch;
    const std::vector<double> f = elasticOnes(body.body(), 32, true);
    for (const auto &[i, omega] :
         {std::pair(0u, 0.5471), std::pair(2u, 0.7213), std::pair(3u, 1.2188), std::pair(5u, 1.2603)})
      judge("free bar 4 : 1, " + std::to_string(n) + " layers (" + std::to_string(body.rest().phyxelCount()) + ")",
            "f_" + std::to_string(i) + ", Hz",
            {.truth = omega * speed / a / (2 * kPi),
             .uncertainty = 1e-4 * omega * speed / a / (2 * kPi),
             .ours = f[i],
             .limit = n <= 3 ? 0.01 : 0.003,
             .milliseconds = watch.milliseconds()});
  }
}

TEST_CASE("frequencies in thirty random directions of the lattice, first and second order", "[.directions]") {
  const std::pair<const char *, std::size_t> modes[] = {{"f_bending_1", 0}, {"f_bending_1", 1}, {"f_torsion_1", 2}};
  const std::vector<Mat3> turns = randomDirections(30);
  for (const LatticeOrder order : {LatticeOrder::linear, LatticeOrder::quadratic})
    for (std::size_t k = 0; k < turns.size(); ++k) {
      Problem problem = vibrating(beam(), kWidth / 3);
      problem.recipe.sampling.axes = turns[k];
      problem.recipe.sampling.order = order;
      SolvedBody body(problem.hold(face(0, 0.0)));
      const std::vector<double> f = elasticOnes(body.body(), 6, false);
      const std::string name = std::string("cantilever 5 : 1, 3 layers, ") +
                               (order == LatticeOrder::linear ? "first" : "second") + " order, " + std::to_string(k);
      for (const auto &[mode, at] : modes)
        if (const auto known = truth(std::string("beam_frequencies.") + mode))
          judge(name, std::string(mode) + ", Hz",
                {.truth = known->value, .uncertainty = known->uncertainty, .ours = f[at]});
    }
}
