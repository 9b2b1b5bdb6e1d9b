// SPDX-License-Identifier: Apache-2.0
// The vector kernels against the scalar engine, which stays as the slower, plainer way to the same forces.
#include <algorithm>
#include <cmath>

#include "pointbased/lattice.h"
#include "shapes.h"
#include "support/catch.h"

using namespace pointbased;

namespace {

struct Case {
  const char *name;
  std::shared_ptr<const RestState> rest;
};

std::shared_ptr<const RestState> latticeBody(const BodyShape &shape, LatticeSampling sampling, std::vector<Fix> fixes = {}) {
  BodyRecipe recipe;
  recipe.sampling = std::move(sampling);
  recipe.fixes = std::move(fixes);
  auto rest = buildRestState(shape, recipe, {}, serialFor());
  if (!rest) throw std::runtime_error(rest.error());
  return *rest;
}

std::vector<Case> bodies() {
  const BodyShape ball = shapes::ball(Vec3(0.1, 0.2, -0.1), 0.05);
  LatticeSampling plain, turned, refined;
  plain.count = turned.count = 400;
  turned.axes = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  refined.spacing = 0.02;
  refined.refinements.push_back({BoxRegion{Vec3(0.05, 0.1, -0.2), Vec3(0.1, 0.3, 0.0)}, 0.01});
  return {{"cut cells", latticeBody(ball, plain)},
          {"turned lattice", latticeBody(ball, turned)},
          {"refined lattice", latticeBody(ball, refined)},
          {"two lobes", latticeBody(shapes::horseshoe(), plain)}};
}

Material materialOf(MaterialLaw law) {
  Material m;
  m.youngsModulus = 6000.0;
  m.poissonRatio = 0.45;
  m.law = law;
  return m;
}

// A stretch, a turn and some noise.
void deform(Body &body, double size, double noise, std::uint64_t seed) {
  support::Random random(seed);
  Mat3 A;
  for (int c = 0; c < 3; ++c) A.col(c) = size * random.vector();
  const Mat3 R = Eigen::AngleAxisd(2.0 * size, Vec3(1, -1, 2).normalized()).toRotationMatrix();
  const Mat3 H = R * (Mat3::Identity() + A) - Mat3::Identity();
  for (std::size_t i = 0; i < body.rest().phyxelCount(); ++i)
    body.state().displacements[i] =
        H * body.rest().positions[i] + noise * body.rest().spacing * random.vector() + Vec3(0.01, -0.02, 0.03);
}

double largest(std::span<const Vec3> field) {
  double most = 0.0;
  for (const Vec3 &v : field) most = std::max(most, v.norm());
  return most;
}

// Largest difference of the two ways, over the largest force; and of the stable step.
struct Difference {
  double forces, step;
};
Difference difference(Body &body) {
  REQUIRE(body.vectorised());
  body.evaluate(0.0, 0.0, serialFor());
  const std::vector<Vec3> fast(body.forces().begin(), body.forces().end());
  const double step = body.stableStep();
  shapes::evaluate(body);
  std::vector<Vec3> off;
  for (std::size_t i = 0; i < fast.size(); ++i) off.push_back(fast[i] - body.forces()[i]);
  return {largest(off) / largest(body.forces()), std::abs(step - body.stableStep()) / body.stableStep()};
}

constexpr MaterialLaw kLaws[] = {MaterialLaw::linear, MaterialLaw::stVenantKirchhoff, MaterialLaw::corotated,
                                 MaterialLaw::neoHookean};

}  // namespace

TEST_CASE("vector kernels give the forces of the scalar engine in double precision", "[kernels]") {
  for (const Case &c : bodies())
    for (const MaterialLaw law : kLaws)
      for (const double stabilisation : {kLatticeStabilisation, 0.0})
        for (const double volumeStiffness : {0.0, 1e4})
          for (const double size : {1e-6, 0.05, 0.4}) {
            Material m = materialOf(law);
            m.volumeStiffness = volumeStiffness;
            Body body("b", c.rest, Constitution{{m}, stabilisation}, serialFor());
            deform(body, size, 0.2 * size, 7);
            INFO(c.name << ", law " << static_cast<int>(law) << ", strain " << size << ", k_v " << volumeStiffness);
            const Difference d = difference(body);
            // Round-off of displacements of centimetres over strains of 1e-6 (the smallest case), times the condition of F.
            CHECK(d.forces < (size < 1e-3 ? 1e-8 : 1e-12));
            CHECK(d.step < 0.01);  // both are upper bounds, which the kernel takes in another way
          }
}
