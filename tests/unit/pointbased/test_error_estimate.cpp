// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "lattice_cases.h"
#include "pointbased/error_estimate.h"
#include "support/catch.h"

using namespace pointbased;
using lattice_cases::rotation;

namespace {

std::shared_ptr<const RestState> latticeRest(const BodyShape &shape, const LatticeSampling &sampling) {
  return shapes::restState(shape, {.sampling = sampling});
}

Material solid(double poissonRatio, MaterialLaw law = MaterialLaw::neoHookean) {
  return Material{.law = law, .youngsModulus = 1e4, .poissonRatio = poissonRatio};
}

std::unique_ptr<Body> bodyOf(std::shared_ptr<const RestState> rest, std::vector<Material> materials) {
  const double control = rest->evaluation == Evaluation::stressPoints ? kLatticeStabilisation : kCloudStabilisation;
  return std::make_unique<Body>("body", std::move(rest), Constitution{std::move(materials), control}, serialFor());
}

template <class Displacement>
void displace(Body &body, const Displacement &u) {
  for (std::size_t i = 0; i < body.rest().phyxelCount(); ++i)
    body.state().displacements[i] = u(Vec3(body.rest().origin + body.rest().positions[i]));
  body.computeGradients(serialFor());
}

struct Case {
  std::string name;
  std::shared_ptr<const RestState> rest;
};

std::vector<Case> bodies() {
  const BodyShape beam = lattice_cases::box(Vec3::Zero(), Vec3(0.2, 0.04, 0.04));
  LatticeSampling turned = lattice_cases::withSpacing(0.012);
  turned.axes = rotation(0, 20) * rotation(1, 35);
  return {{"beam", latticeRest(beam, lattice_cases::withSpacing(0.01))},
          {"beam of one layer", latticeRest(beam, lattice_cases::withSpacing(0.04))},
          {"beam, lattice turned", latticeRest(beam, turned)},
          {"ball, lattice turned", latticeRest(lattice_cases::ball(Vec3::Zero(), 0.05), turned)},
          {"cell", latticeRest(lattice_cases::box(Vec3::Zero(), Vec3::Constant(0.1)), lattice_cases::withSpacing(0.1))},
          {"cloud", shapes::restState(beam, 0.01)}};
}

/// The volume-weighted mean square of the colour-mapped quantity.
double rootMeanSquare(const Body &body, const std::vector<double> &perPhyxel) {
  const StencilSet &s = body.rest().stencils;
  double sum = 0.0, volume = 0.0;
  for (std::size_t q = 0; q < s.pointCount(); ++q) {
    const bool lattice = s.isLattice();
    const Index first = s.phyxels.offsets[q], last = lattice ? s.phyxels.offsets[q + 1] : first + 1;
    for (Index e = first; e < last; ++e) {
      const double value = perPhyxel[s.phyxels.indices[e]], share = s.volumes[q] / (last - first);
      sum += share * value * value;
      volume += share;
    }
  }
  return std::sqrt(sum / volume);
}

Vec3 wavy(const Vec3 &x) {
  return 0.004 * Vec3(std::sin(40.0 * x[1] + 10.0 * x[0]), std::sin(30.0 * x[0]), std::cos(25.0 * x[1] + 35.0 * x[2]));
}

std::unique_ptr<Body> bentBeam(int layers, Evaluation evaluation) {
  BodyRecipe recipe{.evaluation = evaluation, .sampling = {.spacing = 0.04 / layers}};
  recipe.fixes.resize(1);
  recipe.fixes[0].region = HalfSpaceRegion{Vec3::Zero(), Vec3::UnitX()};
  recipe.loads.resize(1);
  recipe.loads[0].region = HalfSpaceRegion{Vec3(0.2, 0, 0), -Vec3::UnitX()};
  recipe.loads[0].force = Vec3(0, 0, -1.6e-3);
  const auto rest = shapes::restState(lattice_cases::box(Vec3::Zero(), Vec3(0.2, 0.04, 0.04)), recipe);
  return bodyOf(rest, {solid(0.3)});
}

}  // namespace

TEST_CASE("a body that is only moved has no error, and neither has one at rest") {
  const Mat3 R = rotation(0, 70) * rotation(2, 130);
  for (const Case &c : bodies()) {
    INFO(c.name);
    const auto body = bodyOf(c.rest, {solid(0.3)});
    displace(*body, [](const Vec3 &) { return Vec3(Vec3::Zero()); });
    const ErrorEstimate rest = estimateError(*body);
    CHECK(rest.relative == 0.0);
    CHECK(rest.stabilisationShare == 0.0);
    displace(*body, [&](const Vec3 &x) { return Vec3(R * x - x + Vec3(0.3, -2.0, 1.0)); });
    std::vector<double> perPhyxel;
    // Displacements of two metres leave strains of 1e-14 over a cell of a centimetre, against a floor of 1e-9.
    CHECK(estimateError(*body, &perPhyxel).relative < 1e-4);
    for (const double value : perPhyxel) CHECK(value < 1e-3);
  }
}

TEST_CASE("affine states have no error, however the surface cuts the cells") {
  Mat3 F;
  F << 1.2, 0.1, -0.05, 0.02, 0.9, 0.03, 0.04, -0.1, 1.05;
  F = rotation(1, 50) * F;
  for (const Case &c : bodies())
    for (const MaterialLaw law :
         {MaterialLaw::linear, MaterialLaw::stVenantKirchhoff, MaterialLaw::corotated, MaterialLaw::neoHookean}) {
      INFO(c.name << ", law " << static_cast<int>(law));
      const auto body = bodyOf(c.rest, {solid(0.3, law)});
      displace(*body, [&](const Vec3 &x) { return Vec3(F * x - x); });
      const ErrorEstimate estimate = estimateError(*body);
      CHECK(estimate.relative < 1e-10);  // round-off of strains of 0.1 to 1
      CHECK(estimate.stabilisationShare < 1e-20);
    }
}

TEST_CASE("a strain that grows along its own direction is what a cell misses, to the last digit") {
  // u_x = a x²/2, nu = 0: eps_xx = a x. The points have its value at their centres and lack ½ E a² d²/12 per volume.
  const double d = 0.01, a = 0.3, length = 0.2;
  const BodyShape beam = lattice_cases::box(Vec3::Zero(), Vec3(length, 0.04, 0.04));
  const auto expected = [&](double factor) {
    // U of the points: mean of (a x)² minus the missing part.
    const double missed = factor * factor * d * d / 12.0, energy = length * length / 3.0 - d * d / 12.0;
    return std::sqrt(missed / (energy + missed));
  };
  const auto grows = [&](const Vec3 &x) { return Vec3(0.5 * a * x[0] * x[0], 0.0, 0.0); };
  auto body = bodyOf(latticeRest(beam, lattice_cases::withSpacing(d)), {solid(0.0, MaterialLaw::linear)});
  displace(*body, grows);
  CHECK_THAT(estimateError(*body).relative, WithinRel(expected(kLatticeErrorFactor), 1e-9));

  // The modes of a cell represent bending: u_x = a x z, u_z = -a x²/2 strains eps_xx = a z alone.
  displace(*body, [&](const Vec3 &x) { return Vec3(a * x[0] * x[2], 0.0, -0.5 * a * x[0] * x[0]); });
  const ErrorEstimate bending = estimateError(*body);
  CHECK(bending.relative < 1e-9);
  CHECK(bending.stabilisationShare > 0.01);
}

TEST_CASE("a cloud misses every slope of the strain") {
  // The same bending; the phyxels, half a spacing inside, have eps_xx = a z and lack ½ E a² d²/12.
  const double d = 0.01, a = 0.3, height = 0.04;
  const auto body =
      bodyOf(shapes::restState(shapes::box(Vec3::Zero(), Vec3(0.2, 0.04, 0.04)), d), {solid(0.0, MaterialLaw::linear)});
  displace(*body, [&](const Vec3 &x) {
    const double z = x[2] - 0.5 * height;
    return Vec3(a * x[0] * z, 0.0, -0.5 * a * x[0] * x[0]);
  });
  const double missed = kCloudErrorFactor * kCloudErrorFactor * d * d, energy = height * height - d * d;
  // One-sided fits at the surface change strains there by second order: a fifth of the whole at four layers.
  CHECK_THAT(estimateError(*body).relative, WithinRel(std::sqrt(missed / (energy + missed)), 0.2));
}

TEST_CASE("a jump of the strain between two materials is no error") {
  const BodyShape beam = lattice_cases::box(Vec3::Zero(), Vec3(0.2, 0.04, 0.04));
  LatticeSampling sampling = lattice_cases::withSpacing(0.01);
  sampling.materials = {{BoxRegion{Vec3(0.1, -1, -1), Vec3(1, 1, 1)}, 1}};
  Material stiff = solid(0.0, MaterialLaw::linear);
  stiff.youngsModulus *= 10.0;
  const auto stretched = [](const Vec3 &x) {
    return Vec3(0.1 * std::min(x[0], 0.1) + 0.01 * std::max(x[0] - 0.1, 0.0), 0, 0);
  };
  auto body = bodyOf(latticeRest(beam, sampling), {solid(0.0, MaterialLaw::linear), stiff});
  displace(*body, stretched);
  CHECK(estimateError(*body).relative < 1e-10);
  // Within one material the same jump is one.
  body = bodyOf(latticeRest(beam, lattice_cases::withSpacing(0.01)), {solid(0.0, MaterialLaw::linear)});
  displace(*body, stretched);
  CHECK(estimateError(*body).relative > 0.05);
}

TEST_CASE("bodies that have no strain to compare have no error, and never a number that is none") {
  const std::vector<std::vector<Vec3>> clouds = {
      {Vec3::Zero()},
      {Vec3::Zero(), Vec3(0.01, 0, 0)},
      {Vec3::Zero(), Vec3(0.01, 0, 0), Vec3(0, 0.01, 0), Vec3(0.01, 0.01, 0), Vec3(0.02, 0.01, 0), Vec3(0.02, 0, 0)}};
  for (const auto &points : clouds) {
    INFO(points.size() << " phyxels");
    const auto body = bodyOf(shapes::restState(points, 0.01), {solid(0.3)});
    displace(*body, [](const Vec3 &x) { return Vec3(20.0 * x[0] * x[0], 0.1 * x[1], 3.0 * x[0]); });
    std::vector<double> perPhyxel;
    CHECK(estimateError(*body, &perPhyxel).relative == 0.0);
    CHECK(perPhyxel == std::vector<double>(points.size(), 0.0));
  }
  for (const Case &c : bodies()) {
    INFO(c.name);
    const auto body = bodyOf(c.rest, {solid(0.3)});
    displace(*body, [](const Vec3 &x) { return Vec3(-x); });  // squashed to a point
    CHECK(std::isfinite(estimateError(*body).relative));
    displace(*body, [](const Vec3 &) { return Vec3(Vec3::Constant(std::numeric_limits<double>::quiet_NaN())); });
    CHECK(estimateError(*body).relative == 1.0);
  }
}

TEST_CASE("the errors of the phyxels add up to that of the body") {
  for (const Case &c : bodies()) {
    INFO(c.name);
    const auto body = bodyOf(c.rest, {solid(0.3)});
    displace(*body, wavy);
    std::vector<double> perPhyxel;
    const double relative = estimateError(*body, &perPhyxel).relative;
    CHECK_THAT(rootMeanSquare(*body, perPhyxel), WithinRel(relative, 1e-12));
    if (c.name == "cell") {
      CHECK(relative < 1e-9);  // a single cell has no estimate of its error
    } else {
      CHECK(relative > 0.05);
    }
  }
}

TEST_CASE("the stabilisation's share is told for each phyxel too") {
  for (const Case &c : bodies()) {
    INFO(c.name);
    const auto body = bodyOf(c.rest, {solid(0.3)});
    // Bent to the left of the middle, stretched evenly to the right of it.
    displace(*body, [](const Vec3 &x) {
      const double l = std::min(x[0] - 0.1, 0.0);
      return Vec3(0.01 * x[0] + 2.0 * l * x[2], 0.0, -1.0 * l * l);
    });
    ErrorScratch scratch;
    std::vector<double> shares;
    const ErrorEstimate estimate = estimateError(*body, nullptr, scratch, serialFor());
    stabilisationShares(*body, scratch, shares);
    REQUIRE(shares.size() == c.rest->phyxelCount());
    CHECK(estimate.stabilisationShare > 0.001);
    CHECK(*std::max_element(shares.begin(), shares.end()) >= estimate.stabilisationShare);
    const double reach = 2.0 * c.rest->spacing;
    for (std::size_t i = 0; i < shares.size(); ++i)
      if (c.rest->origin[0] + c.rest->positions[i][0] > 0.1 + reach) CHECK(shares[i] < 1e-9);
  }
}

TEST_CASE("turning the deformed body changes nothing, and so do threads and used memory") {
  const Mat3 R = rotation(0, 70) * rotation(2, 130);
  ErrorScratch scratch;
  for (const Case &c : bodies()) {
    INFO(c.name);
    const auto body = bodyOf(c.rest, {solid(0.3)});
    displace(*body, wavy);
    std::vector<double> alone, threaded;
    const ErrorEstimate here = estimateError(*body, &alone);
    const ErrorEstimate again = estimateError(*body, &threaded, scratch, lattice_cases::threadedFor(3));
    CHECK(again.relative == here.relative);
    CHECK(again.stabilisationShare == here.stabilisationShare);
    CHECK(alone == threaded);
    displace(*body, [&](const Vec3 &x) { return Vec3(R * (x + wavy(x)) - x); });
    const ErrorEstimate turned = estimateError(*body);
    CHECK_THAT(turned.relative, WithinAbs(here.relative, 1e-9));
    CHECK_THAT(turned.stabilisationShare, WithinAbs(here.stabilisationShare, 1e-9));
  }
}

TEST_CASE("the estimate of a bending beam is within a factor of two of its error, and marks the clamp") {
  // True errors: against 16 layers, by bench_error.
  struct Known {
    Evaluation evaluation;
    int layers;
    double error;
  };
  for (const Known &known : {Known{Evaluation::stressPoints, 3, 0.107}, Known{Evaluation::stressPoints, 5, 0.070},
                             Known{Evaluation::phyxels, 3, 0.39}, Known{Evaluation::phyxels, 5, 0.24}}) {
    INFO((known.evaluation == Evaluation::phyxels ? "phyxels, " : "stress points, ") << known.layers << " layers");
    auto owned = bentBeam(known.layers, known.evaluation);
    Simulator simulator;
    simulator.setWorld({.integrator = Integrator::quasiStatic, .loadSteps = 1});
    const std::size_t id = simulator.addBody(std::move(owned));
    while (!simulator.finished()) REQUIRE(simulator.step());
    Body &body = *simulator.body(id);
    body.computeGradients(serialFor());
    std::vector<double> perPhyxel;
    const double relative = estimateError(body, &perPhyxel).relative;
    CHECK(relative > 0.5 * known.error);
    CHECK(relative < 2.0 * known.error);
    const auto largest = std::max_element(perPhyxel.begin(), perPhyxel.end());
    const auto worst = static_cast<std::size_t>(largest - perPhyxel.begin());
    CHECK(body.rest().origin[0] + body.rest().positions[worst][0] < 0.05);
  }
}
