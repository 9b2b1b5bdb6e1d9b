// SPDX-License-Identifier: Apache-2.0
// Large deformations from the linear response of a body. Private to the core.
#pragma once

#include <Eigen/SparseCholesky>

#include "pointbased/body.h"

namespace pointbased::detail {

/// Shape of a body under loads that rotate with it, from its linear response v. At a point q the gradient of v has the
/// rotation ω and the strain ε. The gradients of the shape are close to exp(ω) exp(ε):
///
///     minimise  Σ_q V_q Σ_k |y_k - ȳ - exp(ω_q) exp(ε_q) (x_k - x̄)|²,   k over the phyxels of q
///
/// with the positions x without loads. Held phyxels have the displacement v. The shape exists for any loads, in
/// contrast to an equilibrium under loads of constant direction. The determinant of exp(ω) exp(ε) is positive.
/// @source  Huang, Tong, Zhou, Bao and Desbrun, Interactive shape interpolation through controllable dynamic
///          deformation, IEEE TVCG 17, 2011 (rotation-strain coordinates)
class WarpedResponse {
 public:
  /// The shape without loads is the present one of the body, whose rest state must outlive the object.
  explicit WarpedResponse(const Body &body);
  /// @param v  [phyxels] m, linear response
  /// @param u  [phyxels] m, result: displacements from rest
  void deform(std::span<const Vec3> v, std::span<Vec3> u, const ParallelFor &parallelFor);
  /// Derivative of the displacements with respect to v, along dv, at the last shape: L^-1 b for the b that is added to
  /// three columns of `out`, [phyxels, 3]. Thread-safe.
  void addDerivative(std::span<const Vec3> dv, Eigen::Ref<Eigen::MatrixXf> out) const;
  static constexpr int kTogether = 8;
  using Columns = Eigen::Matrix<double, Eigen::Dynamic, kTogether, Eigen::RowMajor>;
  /// L^-1 b for several b, [phyxels]; they share one pass over the factor. Thread-safe.
  void solve(Columns &b) const;
  /// [phyxels] rotation of the last shape relative to that without loads.
  [[nodiscard]] std::span<const Mat3> rotations() const { return rotations_; }

 private:
  struct Point {
    Mat3 rotation, stretch, turn;  // exp(ω), exp(ε), and J with exp(ω + dω) = exp(ω) exp(J dω)
  };
  // Adds A_q V_q (x_k - x̄) to the rows of the phyxels k of all points.
  template <class Matrix, class Gradient>
  void gather(const Gradient &gradientOf, Matrix &&out) const;

  const RestState &rest_;
  std::vector<Vec3> start_;         // m, displacements without loads
  std::vector<Vec3> arms_;          // per entry of the stencils: V_q (x_k - x̄), m⁴
  std::vector<Mat3> startInverse_;  // [points] inverse of the deformation gradient there
  std::vector<double> holding_;     // [phyxels] weight of v, m³
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> solver_;
  std::vector<Point> points_;
  std::vector<Mat3> rotations_;
};

}  // namespace pointbased::detail
