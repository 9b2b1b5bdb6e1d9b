// SPDX-License-Identifier: Apache-2.0
// Large deformations from the linear response of a body. Private to the core.
#pragma once

#include <Eigen/SparseCholesky>

#include "matching/factor_kernel.h"
#include "pointbased/body.h"

namespace pointbased::detail {

/// Displacements of the phyxels, one response per pattern of loads. Columns: x of all responses, then y, then z.
using ResponseMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

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
  /// Linear responses, [phyxels, 3 responses], along which differentiate() is called.
  void setResponses(const ResponseMatrix &responses, const ParallelFor &parallelFor);
  [[nodiscard]] std::size_t responseCount() const { return count_; }
  [[nodiscard]] const ResponseMatrix &responses() const { return responses_; }
  /// Derivatives of the displacements along each of the responses, at the last shape.
  void differentiate(ResponseMatrix &out, const ParallelFor &parallelFor) const;
  /// [phyxels] rotation of the last shape relative to that without loads.
  [[nodiscard]] std::span<const Mat3> rotations() const { return rotations_; }

 private:
  struct Point {
    Mat3 rotation, stretch, turn;  // exp(ω), exp(ε), and J with exp(ω + dω) = exp(ω) exp(J dω)
  };
  using Change = Eigen::Matrix<float, 9, 9>;
  static constexpr int kBlock = 16;  // responses
  using Block = Eigen::Matrix<float, Eigen::Dynamic, 3 * kBlock, Eigen::RowMajor>;
  static_assert(3 * kBlock == kernels::kFactorColumns);
  // Of exp(ω) exp(ε), rows in row-major order, by the three components of ω and the six of ε.
  [[nodiscard]] static Change changeAt(const Point &point);
  void solve(Block &b) const;

  const RestState &rest_;
  std::vector<Vec3> start_;         // m, displacements without loads
  std::vector<Vec3> arms_;          // per entry of the stencils: V_q (x_k - x̄), m⁴
  std::vector<Mat3> startInverse_;  // [points] inverse of the deformation gradient there
  std::vector<double> holding_;     // [phyxels] weight of v, m³
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> solver_;
  std::vector<float> factor_;  // values of its L
  ResponseMatrix responses_;   // columns are x of all responses, y, z, each filled up to whole blocks
  std::size_t count_ = 0;      // of the responses
  ResponseMatrix gradients_;   // [9 points, responses]: ω and ε of each
  std::vector<Point> points_;
  std::vector<Mat3> rotations_;
};

}  // namespace pointbased::detail
