// SPDX-License-Identifier: Apache-2.0
#include "discretisation/lattice/lattice_direction.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <optional>

namespace pointbased::lattice {
namespace {

// m of a ball, for which all directions are equivalent, and the factor by which m of a body with faces must be smaller.
constexpr double kOfBall = 0.4, kWorthTurning = 0.75;
// Least gain in m, or a quarter of m, for which a lattice is rotated: a nearly aligned body keeps the world axes.
constexpr double kGain = 0.002;
constexpr int kSweeps = 40;
constexpr double kTurned = 1e-13;  // rad: smaller rotations are 0

// Mean of n ⊗ n ⊗ n ⊗ n over the area of a surface.
class NormalMoments {
 public:
  explicit NormalMoments(const Surface &surface) {
    double total = 0.0;
    for (const auto &[a, b, c] : surface.triangles) {
      const Vec3 &x = surface.positions[a];
      const Vec3 cross = (surface.positions[b] - x).cross(surface.positions[c] - x);
      const double area = cross.norm();
      if (!(area > 0.0) || !std::isfinite(area)) continue;
      total += area;
      const Vec3 n = cross / area;
      const Mat3 nn = n * n.transpose();
      second_ += area * nn;
      for (int k = 0; k < 9; ++k) fourth_[static_cast<std::size_t>(k)] += area * nn(k / 3, k % 3) * nn;
    }
    if (!(total > 0.0)) return;
    known_ = true;
    second_ /= total;
    for (Mat3 &slice : fourth_) slice /= total;
  }

  [[nodiscard]] bool known() const { return known_; }
  [[nodiscard]] const Mat3 &second() const { return second_; }
  /// Mean of (n·a)(n·b)(n·c)(n·d).
  [[nodiscard]] double of(const Vec3 &a, const Vec3 &b, const Vec3 &c, const Vec3 &d) const {
    double sum = 0.0;
    for (int k = 0; k < 9; ++k) sum += a[k / 3] * b[k % 3] * c.dot(fourth_[static_cast<std::size_t>(k)] * d);
    return sum;
  }
  [[nodiscard]] double misalignment(const Mat3 &axes) const {
    double aligned = 0.0;
    for (int a = 0; a < 3; ++a) aligned += of(axes.col(a), axes.col(a), axes.col(a), axes.col(a));
    return std::max(0.0, 1.0 - aligned);
  }

 private:
  Mat3 second_ = Mat3::Zero();
  std::array<Mat3, 9> fourth_{Mat3::Zero(), Mat3::Zero(), Mat3::Zero(), Mat3::Zero(), Mat3::Zero(),
                              Mat3::Zero(), Mat3::Zero(), Mat3::Zero(), Mat3::Zero()};
  bool known_ = false;
};

// Angle of the rotation of two axes in their plane that aligns them best: m depends on the cosine of four times the
// difference from it.
double bestTurn(const NormalMoments &m, const Vec3 &a, const Vec3 &b) {
  const double sine = m.of(a, a, a, b) - m.of(a, b, b, b);
  const double cosine = 0.25 * (m.of(a, a, a, a) + m.of(b, b, b, b)) - 1.5 * m.of(a, a, b, b);
  return std::hypot(sine, cosine) > 1e-12 ? 0.25 * std::atan2(sine, cosine) : 0.0;
}

Mat3 ascend(const NormalMoments &moments, Mat3 axes) {
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double most = 0.0;
    for (int a = 0; a < 3; ++a) {
      const int b = (a + 1) % 3;
      const double angle = bestTurn(moments, axes.col(a), axes.col(b));
      most = std::max(most, std::abs(angle));
      const Vec3 first = std::cos(angle) * axes.col(a) + std::sin(angle) * axes.col(b);
      axes.col(b) = std::cos(angle) * axes.col(b) - std::sin(angle) * axes.col(a);
      axes.col(a) = first;
    }
    if (most < kTurned) break;
  }
  // Removes rounding of many rotations.
  axes.col(0).normalize();
  axes.col(1) = (axes.col(1) - axes.col(0).dot(axes.col(1)) * axes.col(0)).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

std::array<Mat3, 6> starts(const NormalMoments &moments) {
  const auto turned = [](double degrees, const Vec3 &about) -> Mat3 {
    return Eigen::AngleAxisd(degrees * EIGEN_PI / 180.0, about.normalized()).toRotationMatrix();
  };
  Mat3 principal = Eigen::SelfAdjointEigenSolver<Mat3>(moments.second()).eigenvectors();
  if (principal.determinant() < 0.0) principal.col(2) = -principal.col(2);
  return {Mat3::Identity(),
          principal,
          Mat3(principal * turned(45.0, Vec3::UnitX())),
          Mat3(principal * turned(45.0, Vec3::UnitZ())),
          turned(60.0, Vec3(1, 1, 1)),
          turned(35.0, Vec3(1, -2, 3))};
}

// Permutes and flips the axes to be as close to those of the world as possible, as a rotation.
Mat3 named(const Mat3 &axes) {
  Mat3 best = axes;
  for (int first = 0; first < 3; ++first)
    for (int second = 0; second < 3; ++second)
      for (const double sx : {1.0, -1.0})
        for (const double sy : {1.0, -1.0}) {
          if (first == second) continue;
          Mat3 renamed;
          renamed.col(0) = sx * axes.col(first);
          renamed.col(1) = sy * axes.col(second);
          renamed.col(2) = renamed.col(0).cross(renamed.col(1));
          if (renamed.trace() > best.trace() + 1e-9) best = renamed;
        }
  return best;
}

// Axes along the faces of the body; empty if it has no preferred direction.
std::optional<Mat3> alongFaces(const Surface &surface) {
  const Mat3 world = Mat3::Identity();
  const NormalMoments moments(surface);
  if (!moments.known()) return {};
  Mat3 best = world;
  double least = moments.misalignment(world);
  const double enough = std::max(kWorthTurning * least - 1e-9, least - kGain);
  for (const Mat3 &start : starts(moments)) {
    const Mat3 axes = ascend(moments, start);
    const double found = moments.misalignment(axes);
    if (found < least - 1e-9) {
      least = found;
      best = axes;
    }
  }
  if (least > kWorthTurning * kOfBall) return {};
  return least < enough ? named(best) : world;
}

// Smallest rotation of an axis of the world onto the normal of the first half-space.
Mat3 alongBorder(std::span<const Region> held) {
  for (const Region &region : held) {
    const auto *half = std::get_if<HalfSpaceRegion>(&region);
    if (half == nullptr) continue;
    const Vec3 normal = half->normal.normalized();
    int axis = 0;
    const double along = normal.cwiseAbs().maxCoeff(&axis);
    if (along > 1.0 - 1e-12) break;
    const Vec3 from = normal[axis] > 0.0 ? Vec3::Unit(axis) : Vec3(-Vec3::Unit(axis));
    return Eigen::Quaterniond::FromTwoVectors(from, normal).toRotationMatrix();
  }
  return Mat3::Identity();
}

}  // namespace

Mat3 latticeDirection(const BodyShape &shape, std::span<const Region> held) {
  if (shape.shares) return Mat3::Identity();
  const std::optional<Mat3> faces = alongFaces(shape.surface);
  return faces ? *faces : alongBorder(held);
}

double misalignment(const Surface &surface, const Mat3 &axes) {
  const NormalMoments moments(surface);
  return moments.known() ? moments.misalignment(axes) : 0.0;
}

}  // namespace pointbased::lattice
