// SPDX-License-Identifier: Apache-2.0
// Response of a body to loads that may have deformed it. Private to the core.
#pragma once

#include <map>
#include <memory>

#include "matching/load_patterns.h"
#include "matching/match_terms.h"
#include "matching/warped_response.h"
#include "pointbased/integrators.h"

namespace pointbased::detail {

/// Displacements u(q) for amplitudes q of the patterns of loads: K G_p = B_p once, without loads; then
/// WarpedResponse of Σ q_p G_p.
class LoadResponse {
 public:
  /// Solves for the responses at the present equilibrium of a body, which must outlive the object.
  /// Errors: the equilibrium is not stable.
  [[nodiscard]] static Result<std::unique_ptr<LoadResponse>> create(Body &body, const LoadPatterns &patterns,
                                                                    const Environment &environment);
  [[nodiscard]] std::size_t count() const { return linear_.size(); }
  /// @param u  [phyxels] m, result
  void deform(const Eigen::VectorXd &amplitudes, std::span<Vec3> u, const ParallelFor &parallelFor);
  /// m, root mean square over the phyxels of the linear response.
  [[nodiscard]] double size(const Eigen::VectorXd &amplitudes) const;
  /// Derivatives of all measurements with respect to the amplitudes at the last shape, [rows, patterns], m/Pa.
  /// @param tolerance  m, root mean square: derivatives at a shape that is so near are taken as those of this one
  [[nodiscard]] Eigen::MatrixXd sensitivities(const MatchTerms &terms, double tolerance,
                                              const ParallelFor &parallelFor);
  /// The next sensitivities() are those of the last shape.
  void forgetDerivatives() { differentiatedAt_.clear(); }
  /// m/Pa, response of a phyxel to a pattern, rotated with it.
  [[nodiscard]] Vec3 of(std::size_t pattern, std::size_t phyxel) const {
    return warped_.rotations()[phyxel] * linear_[pattern][phyxel];
  }

 private:
  explicit LoadResponse(const Body &body) : warped_(body) {}
  [[nodiscard]] std::vector<Vec3> sum(const Eigen::VectorXd &amplitudes) const;
  // Derivatives at the last shape, unless it is that of `derivatives_` within the tolerance.
  void differentiate(double tolerance, const ParallelFor &parallelFor);
  // L^-1 of the weights of the phyxels of points of a binding.
  void findColumns(const Interpolation &binding, std::span<const Index> points, std::span<Eigen::VectorXf *> out,
                   const ParallelFor &parallelFor) const;
  // Derivatives of the displacements of vertices of the skin that are not in `moved_`.
  void moveVertices(const Interpolation &skin, std::span<const Index> vertices, const ParallelFor &parallelFor);

  std::vector<std::vector<Vec3>> linear_;  // [patterns][phyxels] m/Pa
  WarpedResponse warped_;
  std::vector<Vec3> shape_, differentiatedAt_;  // m, last displacements, and those of the derivatives
  Eigen::MatrixXf derivatives_;                 // [phyxels, 3 patterns]: right sides of L
  std::map<Index, Eigen::VectorXf> columns_;    // findColumns() of vertices of the skin
  std::map<Index, Eigen::RowVectorXf> moved_;   // [3 patterns] of vertices of the skin
};

}  // namespace pointbased::detail
