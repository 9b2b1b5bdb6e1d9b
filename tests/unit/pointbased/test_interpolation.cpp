// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "pointbased/interpolation.h"
#include "shapes.h"
#include "support/catch.h"

using namespace pointbased;

namespace {

constexpr double kSize = 0.1;  // m, half the extent of the clouds

std::vector<Vec3> randomCloud(std::size_t n, std::uint64_t seed) {
  shapes::Random random(seed);
  std::vector<Vec3> points(n);
  for (Vec3 &x : points) x = Vec3(0.3, -0.2, 0.1) + kSize * random.vector();
  return points;
}

// Random points of a plane, a line, or one point through (0.3, -0.2, 0.1); `rank` directions of a rotated frame.
std::vector<Vec3> flatCloud(std::size_t n, int rank, std::uint64_t seed) {
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  std::vector<Vec3> points = randomCloud(n, seed);
  for (Vec3 &x : points) {
    Vec3 d = turn.transpose() * (x - Vec3(0.3, -0.2, 0.1));
    for (int a = rank; a < 3; ++a) d[a] = 0.0;
    x = Vec3(0.3, -0.2, 0.1) + turn * d;
  }
  return points;
}

// Inside, at a phyxel, on the hull, outside every support, far away.
std::vector<Vec3> probes(const std::vector<Vec3> &cloud) {
  std::vector<Vec3> points = randomCloud(40, 77);
  points.push_back(cloud.front());
  for (const Vec3 &direction : {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(0.3, 0.5, -0.8), Vec3(-1, -1, -1)})
    for (const double reach : {1.0, 2.0, 10.0}) points.push_back(Vec3(0.3, -0.2, 0.1) + reach * kSize * direction);
  return points;
}

std::vector<Vec3> moved(const std::vector<Vec3> &X, const Mat3 &F, const Vec3 &shift) {
  std::vector<Vec3> u(X.size());
  for (std::size_t i = 0; i < X.size(); ++i) u[i] = F * X[i] + shift - X[i];
  return u;
}

Mat3 matrix(shapes::Random &random) {
  Mat3 F;
  for (int c = 0; c < 3; ++c) F.col(c) = random.vector();
  return F;
}

// Amplification of rounding by a point's φ: their absolute sum.
double gain(const Interpolation &binding, std::size_t p) {
  double sum = 0.0;
  for (Index e = binding.phyxels.offsets[p]; e < binding.phyxels.offsets[p + 1]; ++e)
    sum += std::abs(binding.weights[e]);
  return sum;
}

// Rounding of about ten operations on lengths of a metre, times the amplification.
constexpr double kRounding = 1e-14;

}  // namespace

TEST_CASE("Every affine motion of a cloud is followed exactly, inside, outside and far away", "[interpolation]") {
  for (const std::size_t n : {20u, 100u, 1000u}) {
    const std::vector<Vec3> X = randomCloud(n, n);
    const std::vector<Vec3> points = probes(X);
    const Interpolation binding = bindToCloud(points, X, serialFor());
    REQUIRE(binding.count() == points.size());
    CHECK(binding.rank.empty());
    shapes::Random random(5);
    for (int k = 0; k < 4; ++k) {
      const Mat3 F = matrix(random);
      const Vec3 shift = random.vector();
      const std::vector<Vec3> u = moved(X, F, shift);
      std::vector<Vec3> displacements(points.size());
      std::vector<Mat3> gradients(points.size());
      interpolateDisplacements(binding, X, u, displacements, serialFor());
      interpolateGradients(binding, u, gradients, serialFor());
      for (std::size_t p = 0; p < points.size(); ++p) {
        CAPTURE(n, p, gain(binding, p));
        CHECK((displacements[p] - (F * points[p] + shift - points[p])).norm() < kRounding * gain(binding, p));
        CHECK((gradients[p] - F).norm() < 1e-11);  // rounding over the distance of phyxels, a hundredth of a metre
      }
    }
  }
}

TEST_CASE(
    "The functions of a point sum to one and have the point as their mean, gradients sum to zero and to the identity",
    "[interpolation]") {
  const std::vector<Vec3> X = randomCloud(300, 4);
  const std::vector<Vec3> points = probes(X);
  const Interpolation binding = bindToCloud(points, X, serialFor());
  for (std::size_t p = 0; p < points.size(); ++p) {
    double sum = 0.0;
    Vec3 mean = Vec3::Zero(), gradientSum = Vec3::Zero();
    Mat3 identity = Mat3::Zero();
    double largest = 0.0;
    for (Index e = binding.phyxels.offsets[p]; e < binding.phyxels.offsets[p + 1]; ++e) {
      const Vec3 &x = X[binding.phyxels.indices[e]];
      sum += binding.weights[e];
      mean += binding.weights[e] * x;
      gradientSum += binding.gradients[e];
      identity += x * binding.gradients[e].transpose();
      largest = std::max(largest, binding.gradients[e].norm());
    }
    CHECK(sum == Approx(1.0).margin(kRounding * gain(binding, p)));
    CHECK((mean - points[p]).norm() < kRounding * gain(binding, p));
    CHECK(gradientSum.norm() < 1e-13 * largest);
    CHECK((identity - Mat3::Identity()).norm() < 1e-12);
  }
}

TEST_CASE("A point is bound to its sixteen nearest phyxels, and to more where those are the skin of one side",
          "[interpolation]") {
  std::vector<Vec3> X;
  for (int x = 0; x < 5; ++x)
    for (int y = 0; y < 5; ++y)
      for (int z = 0; z < 5; ++z) X.emplace_back(0.01 * x, 0.01 * y, 0.01 * z);
  const std::vector<Vec3> points{Vec3(0.02, 0.02, 0.02), Vec3(0.02, 0.02, 0.045), Vec3(0.02, 0.02, 0.3)};
  const Interpolation binding = bindToCloud(points, X, serialFor());
  CHECK(binding.phyxels.offsets[1] == kPhyxelsPerPoint);
  CHECK(binding.phyxels.offsets[2] == 2 * kPhyxelsPerPoint);
  CHECK(binding.phyxels.offsets[3] - binding.phyxels.offsets[2] > kPhyxelsPerPoint);
  CHECK(binding.rank.empty());  // the distant point provides the stretch along z
}

TEST_CASE("A rigid motion is followed exactly by points of clouds that span less than space", "[interpolation]") {
  // Half a turn about an axis across the line or the plane, and an arbitrary one.
  for (const int rank : {3, 2, 1, 0})
    for (const std::size_t n : {std::size_t{40}, std::size_t{5}, std::size_t{2}, std::size_t{1}}) {
      const int spanned = std::min(rank, static_cast<int>(n) - 1);
      std::vector<Vec3> X = flatCloud(n, rank, 12);
      std::vector<Vec3> points = probes(X);
      const Interpolation binding = bindToCloud(points, X, serialFor());
      for (const double angle : {0.4, std::numbers::pi}) {
        const Mat3 R = Eigen::AngleAxisd(angle, Vec3(2, -1, 0.4).normalized()).toRotationMatrix();
        const Vec3 shift(0.5, 0.1, -0.7);
        const std::vector<Vec3> u = moved(X, R, shift);
        std::vector<Vec3> displacements(points.size());
        std::vector<Mat3> gradients(points.size());
        interpolateDisplacements(binding, X, u, displacements, serialFor());
        interpolateGradients(binding, u, gradients, serialFor());
        for (std::size_t p = 0; p < points.size(); ++p) {
          const int found = binding.rank.empty() ? 3 : binding.rank[p];
          CAPTURE(rank, n, angle, p, found);
          REQUIRE(found <= spanned);
          const Vec3 now = points[p] + displacements[p];
          const double tolerance = 10 * kRounding * gain(binding, p);
          const Mat3 &G = gradients[p];
          CHECK((G.transpose() * G - Mat3::Identity()).norm() < 1e-10);
          CHECK(G.determinant() == Approx(1.0).epsilon(1e-10));
          if (found >= 2) {
            CHECK((now - (R * points[p] + shift)).norm() < tolerance);
            CHECK((G - R).norm() < 1e-10);
          } else {
            // A line may spin about itself and a point about every axis, but distances to the points are preserved.
            for (const Vec3 &x : X) {
              const Vec3 there = R * x + shift;
              if (spanned == found) CHECK((now - there).norm() == Approx((points[p] - x).norm()).margin(tolerance));
            }
          }
        }
      }
    }
}

TEST_CASE("Points on a line of phyxels follow its motion, stretch included", "[interpolation]") {
  const std::vector<Vec3> X = flatCloud(30, 1, 3);
  std::vector<Vec3> points;
  for (double t = -1.0; t < 2.0; t += 0.17) points.push_back(X[0] + t * (X[1] - X[0]));
  const Interpolation binding = bindToCloud(points, X, serialFor());
  shapes::Random random(9);
  const Mat3 F = matrix(random);
  const std::vector<Vec3> u = moved(X, F, Vec3(0.1, 0, 0));
  std::vector<Vec3> displacements(points.size());
  interpolateDisplacements(binding, X, u, displacements, serialFor());
  for (std::size_t p = 0; p < points.size(); ++p) {
    REQUIRE(binding.rank[p] == 1);
    CHECK((displacements[p] - (F * points[p] + Vec3(0.1, 0, 0) - points[p])).norm() <
          10 * kRounding * gain(binding, p));
  }
}

TEST_CASE("A point over a sheet of phyxels keeps its distance while the sheet is stretched and turned",
          "[interpolation]") {
  std::vector<Vec3> X;
  for (int x = 0; x < 6; ++x)
    for (int y = 0; y < 6; ++y) X.emplace_back(0.01 * x, 0.01 * y, 0.0);
  const std::vector<Vec3> points{Vec3(0.021, 0.033, 0.005)};
  const Interpolation binding = bindToCloud(points, X, serialFor());
  REQUIRE(binding.rank[0] == 2);
  const Mat3 R = Eigen::AngleAxisd(2.1, Vec3(1, 1, 0.2).normalized()).toRotationMatrix();
  const Mat3 F = R * Vec3(1.5, 0.7, 1.0).asDiagonal();
  std::vector<Vec3> displacements(1);
  interpolateDisplacements(binding, X, moved(X, F, Vec3::Zero()), displacements, serialFor());
  CHECK((points[0] + displacements[0] - F * points[0]).norm() < 1e-14);
}

TEST_CASE("A uniform motion moves every point by the same bits", "[interpolation]") {
  const std::vector<Vec3> X = randomCloud(200, 6);
  const Interpolation binding = bindToCloud(probes(X), X, serialFor());
  const Vec3 shift(0.1, 1e7, -3.3);
  const std::vector<Vec3> u(X.size(), shift);
  std::vector<Vec3> out(binding.count());
  interpolateDisplacements(binding, X, u, out, serialFor());
  for (const Vec3 &d : out) CHECK(d == shift);
  interpolateField(binding, u, out, serialFor());
  for (const Vec3 &d : out) CHECK(d == shift);
}

TEST_CASE("Spread forces do the same work, and have the same sum and torque", "[interpolation]") {
  for (const int rank : {3, 2, 1, 0}) {
    const std::vector<Vec3> X = flatCloud(rank == 0 ? 1 : 60, rank, 21);
    const std::vector<Vec3> points = probes(X);
    const Interpolation binding = bindToCloud(points, X, serialFor());
    shapes::Random random(31);
    std::vector<Vec3> force(points.size()), velocity(X.size()), pointVelocity(points.size());
    for (Vec3 &f : force) f = random.vector();
    for (Vec3 &v : velocity) v = random.vector();
    std::vector<Vec3> spread(X.size(), Vec3::Zero());
    spreadForces(binding, force, spread);
    interpolateField(binding, velocity, pointVelocity, serialFor());

    double power = 0.0, pointPower = 0.0, scale = 0.0;
    Vec3 sum = Vec3::Zero(), pointSum = Vec3::Zero(), torque = Vec3::Zero(), pointTorque = Vec3::Zero();
    for (std::size_t j = 0; j < X.size(); ++j) {
      power += spread[j].dot(velocity[j]);
      sum += spread[j];
      torque += X[j].cross(spread[j]);
      scale += spread[j].norm();
    }
    for (std::size_t p = 0; p < points.size(); ++p) {
      pointPower += force[p].dot(pointVelocity[p]);
      pointSum += force[p];
      // Outside a plane or a line a force acts at its foot point.
      const bool turns = !binding.rank.empty() && binding.rank[p] < 3;
      const Vec3 at = turns ? Vec3(points[p] - binding.offsets[binding.frameOf[p]]) : points[p];
      pointTorque += at.cross(force[p]);
    }
    CAPTURE(rank, scale);
    CHECK(power == Approx(pointPower).margin(1e-13 * scale));
    CHECK((sum - pointSum).norm() < 1e-13 * scale);
    CHECK((torque - pointTorque).norm() < 1e-13 * scale);
  }
}

TEST_CASE("Surfels and their normals follow affine motions, mirrored ones too", "[interpolation]") {
  const std::vector<Vec3> X = randomCloud(400, 8);
  const std::vector<Vec3> points = probes(X);
  const Interpolation binding = bindToCloud(points, X, serialFor());
  shapes::Random random(14);
  std::vector<Vec3> rest(points.size());
  for (Vec3 &n : rest) n = random.vector().normalized();
  for (int k = 0; k < 6; ++k) {
    const Mat3 F = matrix(random);
    const std::vector<Vec3> u = moved(X, F, Vec3(0, 0.2, 0));
    std::vector<Vec3> positions(points.size()), normals(points.size()), bare(points.size());
    updateSurfels(binding, rest, X, u, positions, normals, serialFor());
    updateSurfels(binding, {}, X, u, bare, {}, serialFor());
    for (std::size_t p = 0; p < points.size(); ++p) {
      const Vec3 expected = (F.determinant() * (F.inverse().transpose() * rest[p])).normalized();
      CHECK((positions[p] - F * points[p] - Vec3(0, 0.2, 0)).norm() < kRounding * gain(binding, p));
      CHECK((bare[p] - positions[p]).norm() == 0.0);
      CHECK((normals[p] - expected).norm() < 1e-9);  // F of these seeds has a condition number below a hundred
    }
  }
}

TEST_CASE("Interpolation gives the same bits however the points are divided", "[interpolation]") {
  const ParallelFor pieces = [](std::size_t n, std::size_t, const std::function<void(std::size_t, std::size_t)> &body) {
    for (std::size_t begin = 0; begin < n; begin += 7) body(begin, std::min(n, begin + 7));
  };
  const std::vector<Vec3> X = flatCloud(50, 2, 2);
  const std::vector<Vec3> points = probes(X);
  const Interpolation a = bindToCloud(points, X, serialFor()), b = bindToCloud(points, X, pieces);
  CHECK(a.phyxels.indices == b.phyxels.indices);
  CHECK(a.weights == b.weights);
  const std::vector<Vec3> u = randomCloud(50, 3);
  std::vector<Vec3> out1(points.size()), out2(points.size());
  interpolateDisplacements(a, X, u, out1, serialFor());
  interpolateDisplacements(b, X, u, out2, pieces);
  CHECK(out1 == out2);
}

TEST_CASE("Points without phyxels, and no points at all, stay where they are", "[interpolation]") {
  const std::vector<Vec3> points{Vec3(1, 2, 3)};
  const Interpolation alone = bindToCloud(points, {}, serialFor());
  std::vector<Vec3> out(1, Vec3(9, 9, 9));
  interpolateDisplacements(alone, {}, {}, out, serialFor());
  CHECK(out[0] == Vec3::Zero());
  const std::vector<Vec3> X = randomCloud(20, 1);
  CHECK(bindToCloud({}, X, serialFor()).count() == 0);
}
