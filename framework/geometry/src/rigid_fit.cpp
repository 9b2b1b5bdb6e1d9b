// SPDX-License-Identifier: Apache-2.0
#include "c3de/geometry/rigid_fit.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace c3de::geometry {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Vec3 meanOf(std::span<const Vec3> points) {
  Vec3 sum{};
  for (const Vec3 &p : points) sum = sum + p;
  return (1.0 / static_cast<double>(points.size())) * sum;
}

bool isFinitePoint(const Vec3 &p) { return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]); }

/// Why points do not define a rotation; empty: they do.
std::string problemOf(std::span<const Vec3> points, const char *name) {
  const Vec3 middle = meanOf(points);
  const auto farthest = std::max_element(
      points.begin(), points.end(), [&](const Vec3 &a, const Vec3 &b) { return norm(a - middle) < norm(b - middle); });
  const double extent = norm(*farthest - middle);
  // Coordinates of scans have some 0.01 mm; points closer than round-off are one.
  const double largest = std::max({1.0, std::abs(middle[0]), std::abs(middle[1]), std::abs(middle[2])});
  if (extent <= 1e-9 * largest)
    return fmt::format("the {} points coincide; accepted: at least three points that are in no straight line", name);
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vec3 &p : points) {
    const Vec3 d = p - middle;
    const Eigen::Vector3d v(d[0], d[1], d[2]);
    spread += v * v.transpose();
  }
  const Eigen::Vector3d along =
      Eigen::JacobiSVD<Eigen::Matrix3d>(spread, Eigen::ComputeFullU).matrixU().col(0).normalized();
  double farthestFromLine = 0.0;
  for (const Vec3 &p : points) {
    const Vec3 d = p - middle;
    const Eigen::Vector3d v(d[0], d[1], d[2]);
    farthestFromLine = std::max(farthestFromLine, (v - v.dot(along) * along).norm());
  }
  if (farthestFromLine > kCollinear * extent) return {};
  return fmt::format(
      "the {} {} points are in a straight line: none is farther than {:.3g} mm from it; accepted: more "
      "than {:.3g} mm, {:g} of their extent",
      points.size(), name, farthestFromLine, kCollinear * extent, kCollinear);
}

}  // namespace

bool isFinite(const RigidPose &pose) {
  return isFinitePoint(pose.translation_mm) && isFinitePoint(pose.rotation_deg) && isFinitePoint(pose.centre_mm);
}

Mat4 matrixOf(const RigidPose &pose) {
  const auto turn = [](std::size_t axis, double angle_deg) {
    // Multiples of 90 degrees are exact.
    const double quarters = angle_deg / 90.0;
    double c = std::cos(kDegree * angle_deg), s = std::sin(kDegree * angle_deg);
    if (quarters == std::round(quarters)) c = std::round(c), s = std::round(s);
    Mat4 m = kIdentity4;
    const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
    m[4 * a + a] = m[4 * b + b] = c;
    m[4 * a + b] = s;
    m[4 * b + a] = -s;
    return m;
  };
  Mat4 m =
      multiply(turn(2, pose.rotation_deg[2]), multiply(turn(1, pose.rotation_deg[1]), turn(0, pose.rotation_deg[0])));
  const Vec3 moved = transformPoint(m, pose.centre_mm);
  for (std::size_t r = 0; r < 3; ++r) m[12 + r] = pose.centre_mm[r] - moved[r] + pose.translation_mm[r];
  return m;
}

RigidPose poseOf(const Mat4 &rigid, const Vec3 &centre_mm) {
  RigidPose pose;
  pose.centre_mm = centre_mm;
  pose.translation_mm = transformPoint(rigid, centre_mm) - centre_mm;
  const auto entry = [&](std::size_t row, std::size_t column) { return rigid[4 * column + row]; };
  const double cosY = std::hypot(entry(0, 0), entry(1, 0));
  pose.rotation_deg[1] = std::atan2(-entry(2, 0), cosY) / kDegree;
  constexpr double kGimbal = 1e-9;
  if (cosY > kGimbal) {
    pose.rotation_deg[0] = std::atan2(entry(2, 1), entry(2, 2)) / kDegree;
    pose.rotation_deg[2] = std::atan2(entry(1, 0), entry(0, 0)) / kDegree;
  } else {
    pose.rotation_deg[0] = std::atan2(-entry(1, 2), entry(1, 1)) / kDegree;
  }
  return pose;
}

Mat4 rigidInverse(const Mat4 &rigid) {
  Mat4 inverse = kIdentity4;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) inverse[4 * c + r] = rigid[4 * r + c];
  const Vec3 back = transformPoint(inverse, {rigid[12], rigid[13], rigid[14]});
  for (std::size_t r = 0; r < 3; ++r) inverse[12 + r] = -back[r];
  return inverse;
}

Expected<RigidFit> fitRigid(std::span<const Vec3> moving, std::span<const Vec3> fixed) {
  const std::size_t count = moving.size();
  if (fixed.size() != count)
    return fail(ErrorCode::usage,
                fmt::format("{} moving and {} fixed points; accepted: as many of both", count, fixed.size()));
  if (count < kFewestRigidPairs)
    return fail(ErrorCode::usage, fmt::format("{} pair{} of points; accepted: at least {} that are in no straight line",
                                              count, count == 1 ? "" : "s", kFewestRigidPairs));
  for (std::size_t i = 0; i < count; ++i)
    if (!isFinitePoint(moving[i]) || !isFinitePoint(fixed[i]))
      return fail(ErrorCode::usage, fmt::format("pair {} has a coordinate that is not finite", i + 1));
  for (const auto &[points, name] : {std::pair{moving, "moving"}, std::pair{fixed, "fixed"}})
    if (const std::string problem = problemOf(points, name); !problem.empty()) return fail(ErrorCode::usage, problem);

  const Vec3 from = meanOf(moving), to = meanOf(fixed);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 a = moving[i] - from, b = fixed[i] - to;
    covariance += Eigen::Vector3d(b[0], b[1], b[2]) * Eigen::Vector3d(a[0], a[1], a[2]).transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  // Where the best orthogonal matrix is a reflection, the direction of the least spread is reversed.
  if ((u * svd.matrixV().transpose()).determinant() < 0.0) u.col(2) = -u.col(2);
  const Eigen::Matrix3d rotation = u * svd.matrixV().transpose();

  RigidFit fit;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c)
      fit.fixedFromMoving[4 * c + r] = rotation(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c));
  const Vec3 turned = transformPoint(fit.fixedFromMoving, from);
  for (std::size_t r = 0; r < 3; ++r) fit.fixedFromMoving[12 + r] = to[r] - turned[r];
  double squares = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double distance = norm(transformPoint(fit.fixedFromMoving, moving[i]) - fixed[i]);
    fit.residual_mm.push_back(distance);
    fit.mean_mm += distance / static_cast<double>(count);
    squares += distance * distance / static_cast<double>(count);
    fit.max_mm = std::max(fit.max_mm, distance);
  }
  fit.rms_mm = std::sqrt(squares);
  return fit;
}

}  // namespace c3de::geometry
