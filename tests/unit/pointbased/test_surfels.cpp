// SPDX-License-Identifier: Apache-2.0
#include "pointbased/surfels.h"
#include "shapes.h"
#include "support/catch.h"

using namespace pointbased;

TEST_CASE("surfels follow an affine motion exactly, normals too") {
  const auto rest = shapes::restState(shapes::ball(Vec3(0, 0, 0), 0.05), 0.012);
  std::vector<Vec3> points, normals;
  shapes::Random random(4);
  for (int i = 0; i < 50; ++i) {
    normals.push_back(random.vector().normalized());
    points.push_back(0.05 * normals.back());
  }
  points.push_back(Vec3(1.0, 0.0, 0.0));  // far outside every support
  normals.push_back(Vec3(1, 0, 0));
  const SurfelBinding binding = bindSurfels(points, normals, rest->positions, serialFor());
  Mat3 A;
  A << 1.3, 0.2, 0.0, -0.1, 0.8, 0.1, 0.0, 0.3, 1.1;
  std::vector<Vec3> u;
  for (const Vec3 &X : rest->positions) u.push_back(A * X - X + Vec3(0.1, 0.2, 0.3));
  const std::vector<Mat3> F(rest->phyxelCount(), A);
  std::vector<Vec3> x(points.size()), n(points.size());
  updateSurfels(binding, rest->positions, u, F, x, n, serialFor());
  for (std::size_t s = 0; s < points.size(); ++s) {
    CHECK((x[s] - (A * points[s] + Vec3(0.1, 0.2, 0.3))).norm() < 1e-12);
    const Vec3 expected = (A.inverse().transpose() * normals[s]).normalized();
    CHECK((n[s] - expected).norm() < 1e-12);
  }
}

TEST_CASE("the weights of a surfel are positive and sum to one") {
  const auto rest = shapes::restState(shapes::box(Vec3(0, 0, 0), Vec3(0.05, 0.02, 0.01)), 0.01);
  const std::vector<Vec3> points{Vec3(0, 0, 0), Vec3(0.025, 0.01, 0.005), Vec3(-3, 0, 0)};
  const SurfelBinding binding = bindSurfels(points, {}, rest->positions, serialFor());
  for (std::size_t s = 0; s < points.size(); ++s) {
    double sum = 0.0;
    for (Index e = binding.phyxels.offsets[s]; e < binding.phyxels.offsets[s + 1]; ++e) {
      CHECK(binding.weights[e] >= 0.0);
      sum += binding.weights[e];
    }
    CHECK_THAT(sum, WithinRel(1.0, 1e-14));
  }
}

TEST_CASE("surfels of a single phyxel move with it") {
  const auto rest = shapes::restState(std::vector<Vec3>{Vec3(0, 0, 0)}, 0.01);
  const std::vector<Vec3> points{Vec3(0.004, 0, 0)};
  const SurfelBinding binding = bindSurfels(points, {}, rest->positions, serialFor());
  const std::vector<Vec3> u{Vec3(1, 2, 3)};
  const std::vector<Mat3> F{Mat3::Identity()};
  std::vector<Vec3> x(1);
  updateSurfels(binding, rest->positions, u, F, x, {}, serialFor());
  CHECK((x[0] - Vec3(1.004, 2, 3)).norm() < 1e-14);
}
