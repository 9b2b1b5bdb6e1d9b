// SPDX-License-Identifier: Apache-2.0
#include "c3de/geometry/rigid_fit.h"

#include <limits>
#include <random>

#include "support/catch.h"

using namespace c3de;
using geometry::fitRigid;
using geometry::matrixOf;
using geometry::poseOf;
using geometry::RigidPose;

namespace {

const std::vector<Vec3> kPoints{{10, 20, 30}, {-40, 12, 7}, {25, -60, 3}, {4, 5, -70}, {33, 41, 52}};

std::vector<Vec3> moved(const Mat4 &m, const std::vector<Vec3> &points) {
  std::vector<Vec3> out;
  for (const Vec3 &p : points) out.push_back(transformPoint(m, p));
  return out;
}

double largestDifference(const Mat4 &a, const Mat4 &b) {
  double most = 0.0;
  for (std::size_t i = 0; i < 16; ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

double determinant(const Mat4 &m) { return dot({m[0], m[1], m[2]}, cross({m[4], m[5], m[6]}, {m[8], m[9], m[10]})); }

std::string refusal(const std::vector<Vec3> &moving, const std::vector<Vec3> &fixed) {
  const auto fit = fitRigid(moving, fixed);
  if (fit) return "";
  CHECK(fit.error().code == ErrorCode::usage);
  return fit.error().message;
}

}  // namespace

TEST_CASE("A known rotation and translation are found to 1e-9", "[rigid_fit]") {
  const RigidPose pose =
      GENERATE(RigidPose{{0, 0, 0}, {0, 0, 0}, {}}, RigidPose{{12, -34, 56}, {10, -20, 30}, {5, 6, 7}},
               RigidPose{{-1000, 2000, 3}, {170, 80, -120}, {}}, RigidPose{{1, 2, 3}, {180, 0, 0}, {}});
  const Mat4 wanted = matrixOf(pose);
  const auto fit = fitRigid(kPoints, moved(wanted, kPoints));
  REQUIRE(fit);
  CHECK(largestDifference(fit->fixedFromMoving, wanted) < 1e-9);
  CHECK(fit->max_mm < 1e-9);
  CHECK(fit->mean_mm <= fit->rms_mm);
  CHECK(fit->residual_mm.size() == kPoints.size());
  // Three of them, which are in a plane, suffice.
  const std::vector<Vec3> three(kPoints.begin(), kPoints.begin() + 3);
  const auto ofThree = fitRigid(three, moved(wanted, three));
  REQUIRE(ofThree);
  CHECK(largestDifference(ofThree->fixedFromMoving, wanted) < 1e-9);
}

TEST_CASE("With noise no other rigid motion nearby has a smaller sum of squares", "[rigid_fit]") {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 0.5);
  const RigidPose pose{{3, -8, 15}, {12, 25, -40}, {}};
  std::vector<Vec3> moving, fixed;
  std::uniform_real_distribution<double> place(-80.0, 80.0);
  for (int i = 0; i < 40; ++i) {
    moving.push_back({place(random), place(random), place(random)});
    fixed.push_back(transformPoint(matrixOf(pose), moving.back()) + Vec3{noise(random), noise(random), noise(random)});
  }
  const auto fit = fitRigid(moving, fixed);
  REQUIRE(fit);
  CHECK_THAT(determinant(fit->fixedFromMoving), WithinAbs(1.0, 1e-12));
  // The noise has 0.5 mm in each of three directions.
  CHECK_THAT(fit->rms_mm, WithinAbs(0.5 * std::sqrt(3.0), 0.15));
  const RigidPose found = poseOf(fit->fixedFromMoving, {});
  CHECK(norm(found.rotation_deg - pose.rotation_deg) < 0.5);
  CHECK(norm(found.translation_mm - pose.translation_mm) < 0.5);
  const auto sumOf = [&](const Mat4 &m) {
    double sum = 0.0;
    for (std::size_t i = 0; i < moving.size(); ++i) {
      const Vec3 d = transformPoint(m, moving[i]) - fixed[i];
      sum += dot(d, d);
    }
    return sum;
  };
  const double least = sumOf(fit->fixedFromMoving);
  for (std::size_t a = 0; a < 3; ++a)
    for (const double step : {-0.01, 0.01}) {
      RigidPose turned = found, shifted = found;
      turned.rotation_deg[a] += step;
      shifted.translation_mm[a] += step;
      CHECK(sumOf(matrixOf(turned)) > least);
      CHECK(sumOf(matrixOf(shifted)) > least);
    }
}

TEST_CASE("Mirrored points give a rotation, not a reflection", "[rigid_fit]") {
  std::vector<Vec3> mirrored = kPoints;
  for (Vec3 &p : mirrored) p[0] = -p[0];
  const auto fit = fitRigid(kPoints, mirrored);
  REQUIRE(fit);
  CHECK_THAT(determinant(fit->fixedFromMoving), WithinAbs(1.0, 1e-12));
  CHECK(fit->max_mm > 1.0);
}

TEST_CASE("Points that define no rotation are refused, with the reason", "[rigid_fit]") {
  const std::vector<Vec3> two(kPoints.begin(), kPoints.begin() + 2);
  CHECK_THAT(refusal(two, two), Contains("2 pairs of points; accepted: at least 3"));
  CHECK_THAT(refusal({}, {}), Contains("0 pairs"));
  CHECK_THAT(refusal(kPoints, two), Contains("5 moving and 2 fixed points"));
  const std::vector<Vec3> line{{1, 1, 1}, {2, 3, 4}, {3, 5, 7}, {5, 9, 13}};
  CHECK_THAT(refusal(line, moved(matrixOf({{5, 5, 5}, {10, 20, 30}, {}}), line)), Contains("in a straight line"));
  const std::vector<Vec3> four(kPoints.begin(), kPoints.begin() + 4);
  CHECK_THAT(refusal(four, line), Contains("the 4 fixed points are in a straight line"));
  CHECK_THAT(refusal({{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}, {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}),
             Contains("the moving points coincide"));
  std::vector<Vec3> broken = kPoints;
  broken[2][1] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THAT(refusal(kPoints, broken), Contains("pair 3") && Contains("not finite"));
}

TEST_CASE("A pose and its matrix are the same motion", "[rigid_fit]") {
  const Vec3 centre{11, -7, 5};
  for (const Vec3 &angles :
       {Vec3{0, 0, 0}, Vec3{10, 20, 30}, Vec3{-170, 89, 175}, Vec3{90, 0, -90}, Vec3{33, 90, 0}, Vec3{33, -90, 0}}) {
    const RigidPose pose{{1, 2, 3}, angles, centre};
    const RigidPose back = poseOf(matrixOf(pose), centre);
    CAPTURE(angles[0], angles[1], angles[2]);
    CHECK(norm(back.rotation_deg - angles) < 1e-6);
    CHECK(norm(back.translation_mm - pose.translation_mm) < 1e-12);
    CHECK(largestDifference(matrixOf(back), matrixOf(pose)) < 1e-7);
    CHECK(largestDifference(multiply(geometry::rigidInverse(matrixOf(pose)), matrixOf(pose)), kIdentity4) < 1e-12);
    // The centre only moves by the translation.
    CHECK(norm(transformPoint(matrixOf(pose), centre) - centre - pose.translation_mm) < 1e-12);
  }
  // x is turned first: 90 degrees about x, then about z, move y to z and leave it there.
  CHECK(norm(transformPoint(matrixOf({{}, {90, 0, 90}, {}}), {0, 1, 0}) - Vec3{0, 0, 1}) < 1e-12);
  CHECK_FALSE(geometry::isFinite({{0, 0, 0}, {0, std::numeric_limits<double>::infinity(), 0}, {}}));
}
