// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lattice_cases.h"
#include "pointbased/fields.h"
#include "support/catch.h"

using namespace pointbased;

namespace {

constexpr MaterialLaw kLaws[] = {MaterialLaw::neoHookean, MaterialLaw::stVenantKirchhoff, MaterialLaw::corotated,
                                 MaterialLaw::linear};

std::shared_ptr<const RestState> beam(std::vector<std::pair<Region, std::uint16_t>> materials = {}) {
  BodyRecipe recipe{.sampling = lattice_cases::withSpacing(0.011)};
  recipe.sampling.materials = std::move(materials);
  return shapes::restState(lattice_cases::box(Vec3::Zero(), Vec3(0.1, 0.04, 0.04)), recipe);
}

Material of(double youngsModulus, MaterialLaw law = MaterialLaw::neoHookean) {
  return Material{.law = law, .youngsModulus = youngsModulus, .poissonRatio = 0.3};
}

std::unique_ptr<Body> bodyOf(std::shared_ptr<const RestState> rest, std::vector<Material> materials) {
  return std::make_unique<Body>("body", std::move(rest), Constitution{std::move(materials), kLatticeStabilisation},
                                serialFor());
}

void deform(Body &body, const Mat3 &F) {
  for (std::size_t i = 0; i < body.rest().phyxelCount(); ++i)
    body.state().displacements[i] = (F - Mat3::Identity()) * body.rest().positions[i];
  body.computeGradients(serialFor());
}

std::vector<Mat3> cauchy(const Body &body) {
  StressScratch scratch;
  std::vector<Mat3> out(body.rest().pointCount());
  cauchyStresses(body, out, scratch, serialFor());
  return out;
}

std::vector<Mat3> secondPiola(const Body &body) {
  StressScratch scratch;
  std::vector<Mat3> out(body.rest().pointCount());
  secondPiolaStresses(body, out, scratch, serialFor());
  return out;
}

/// Stretch along x and a lateral contraction, rotated by 40 degrees.
Mat3 stretch(double along, double across) {
  return lattice_cases::rotation(2, 40) * Vec3(along, across, across).asDiagonal();
}

}  // namespace

TEST_CASE("Stresses of points are those of the law at their gradient, whatever the law") {
  for (const MaterialLaw law : kLaws) {
    const Material material = of(1e4, law);
    const auto body = bodyOf(beam(), {material});
    const Mat3 F = stretch(1.2, 0.95);
    deform(*body, F);
    const Mat3 S = secondPiolaStress(material, F);
    const Mat3 sigma = law == MaterialLaw::linear ? S : Mat3(F * S * F.transpose() / F.determinant());
    const auto piola = secondPiola(*body), stresses = cauchy(*body);
    INFO("law " << static_cast<int>(law));
    for (std::size_t q = 0; q < stresses.size(); ++q) {
      // Round-off of the gradients times the moduli.
      REQUIRE((piola[q] - S).norm() < 1e-6);
      REQUIRE((stresses[q] - sigma).norm() < 1e-6);
    }
  }
}

TEST_CASE("Each point of a body of several materials has the stress of its own") {
  const auto rest = beam({{BoxRegion{Vec3(0.05, -1, -1), Vec3(1, 1, 1)}, 1}});
  REQUIRE(!rest->stencils.materials.empty());
  const Material soft = of(5e3), stiff = of(4e4);
  const auto body = bodyOf(rest, {soft, stiff});
  const Mat3 F = stretch(1.1, 1.0);
  deform(*body, F);
  const Mat3 expected[] = {secondPiolaStress(soft, F), secondPiolaStress(stiff, F)};
  std::size_t counts[] = {0, 0};
  const auto stresses = secondPiola(*body);
  for (std::size_t q = 0; q < stresses.size(); ++q) {
    const std::uint16_t m = rest->stencils.materials[q];
    REQUIRE((stresses[q] - expected[m]).norm() < 1e-6);
    ++counts[m];
  }
  CHECK(counts[0] > 10);
  CHECK(counts[1] > 10);
  // Phyxels away from the border have the value of their side.
  std::vector<Mat3> means(rest->phyxelCount());
  phyxelMeans(*rest, stresses, means);
  for (std::size_t i = 0; i < means.size(); ++i) {
    const double x = rest->origin[0] + rest->positions[i][0];
    if (std::abs(x - 0.05) > 2.0 * rest->spacing) REQUIRE((means[i] - expected[x > 0.05 ? 1 : 0]).norm() < 1e-6);
  }
}

TEST_CASE("Strain that has flowed carries no stress") {
  Material material = of(1e4);
  material.plastic.yield = 0.01;
  material.plastic.creep = 1.0;
  const auto body = bodyOf(beam(), {material});
  const Mat3 F = Vec3(1.3, 1.0 / std::sqrt(1.3), 1.0 / std::sqrt(1.3)).asDiagonal();
  deform(*body, F);
  const double elastic = vonMises(cauchy(*body).front());
  body->state().history.plasticInverse.assign(body->rest().pointCount(), Mat3(F.inverse()));
  CHECK(elastic > 1e3);
  for (const Mat3 &sigma : cauchy(*body)) REQUIRE(sigma.norm() < 1e-6);
}

TEST_CASE("An inverted point has no stress instead of a wrong one") {
  const auto body = bodyOf(beam(), {of(1e4)});
  deform(*body, Vec3(-0.5, 1.0, 1.0).asDiagonal());
  for (const Mat3 &sigma : cauchy(*body)) REQUIRE(sigma.norm() == 0.0);
}

TEST_CASE("The von Mises stress is that of a bar, and pressure has none") {
  CHECK(vonMises(Vec3(-7.0, 0, 0).asDiagonal()) == Approx(7.0));
  CHECK(vonMises(Vec3(5.0, 5.0, 5.0).asDiagonal()) == Approx(0.0).margin(1e-12));
  Mat3 shear = Mat3::Zero();
  shear(0, 1) = shear(1, 0) = 2.0;
  CHECK(vonMises(shear) == Approx(2.0 * std::sqrt(3.0)));
}

TEST_CASE("Evaluation points move with the body and lie inside it") {
  const auto body = bodyOf(beam(), {of(1e4)});
  const Mat3 F = stretch(1.4, 0.8);
  deform(*body, F);
  const RestState &rest = body->rest();
  const Interpolation points = bindPoints(rest);
  std::vector<Vec3> moved(points.count());
  REQUIRE(moved.size() == rest.pointCount());
  interpolateDisplacements(points, rest.positions, body->state().displacements, moved, serialFor());
  for (std::size_t q = 0; q < moved.size(); ++q) {
    REQUIRE((rest.pointCentres[q] + moved[q] - F * rest.pointCentres[q]).norm() < 1e-12);
    const Vec3 X = rest.origin + rest.pointCentres[q];
    REQUIRE((X.minCoeff() > 0.0 && X[0] < 0.1 && X[1] < 0.04 && X[2] < 0.04));
  }
}

TEST_CASE("Interpolated scalars follow affine fields and never leave the values around") {
  const auto rest = beam();
  std::vector<Vec3> points, normals;
  for (int i = 0; i <= 20; ++i) points.push_back(Vec3(0.005 * i, 0.04, 0.013) - rest->origin);
  const Interpolation binding = rest->bind(points, normals);
  std::vector<double> field(rest->phyxelCount()), out(points.size());
  for (std::size_t j = 0; j < field.size(); ++j) field[j] = 3.0 + 20.0 * rest->positions[j][0];
  interpolateScalars(binding, field, out, serialFor());
  for (std::size_t p = 0; p < out.size(); ++p) CHECK_THAT(out[p], WithinAbs(3.0 + 20.0 * points[p][0], 1e-10));
  // Beyond the cells some weights are negative, and a spike there would make a negative value.
  for (Vec3 &x : points) x[1] += 0.02;
  const Interpolation beyond = rest->bind(points, normals);
  const auto least = std::min_element(beyond.weights.begin(), beyond.weights.end());
  REQUIRE(*least < -0.1);
  std::fill(field.begin(), field.end(), 0.0);
  field[beyond.phyxels.indices[static_cast<std::size_t>(least - beyond.weights.begin())]] = 1.0;
  interpolateScalars(beyond, field, out, serialFor());
  for (const double value : out) CHECK((value >= 0.0 && value <= 1.0));
}
