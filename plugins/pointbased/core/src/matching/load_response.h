// SPDX-License-Identifier: Apache-2.0
// Response of a body to loads that may have deformed it. Private to the core.
#pragma once

#include <memory>

#include "base/rigid_fit.h"
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
  [[nodiscard]] std::size_t count() const { return warped_.responseCount(); }
  /// @param u  [phyxels] m, result
  void deform(const Eigen::VectorXd &amplitudes, std::span<Vec3> u, const ParallelFor &parallelFor);
  /// m, root mean square over the phyxels of the linear response.
  [[nodiscard]] double size(const Eigen::VectorXd &amplitudes, const ParallelFor &parallelFor) const;
  /// Derivatives of all measurements with respect to the amplitudes at the last shape, [rows, patterns], m/Pa.
  /// @param tolerance  m, root mean square: derivatives are reused, rotated, while the shape differs by less than this
  ///                   after the best rigid motion, which rotates by at most 0.05 rad
  [[nodiscard]] Eigen::MatrixXd sensitivities(const MatchTerms &terms, double tolerance,
                                              const ParallelFor &parallelFor);
  /// The next sensitivities() are those of the last shape.
  void forgetDerivatives() { differentiatedAt_.clear(); }
  /// m/Pa, response of a phyxel to a pattern, rotated with it.
  [[nodiscard]] Vec3 of(std::size_t pattern, std::size_t phyxel) const {
    return warped_.rotations()[phyxel] * linear(pattern, phyxel);
  }

 private:
  explicit LoadResponse(const Body &body) : rest_(body.rest()), warped_(body) {}
  [[nodiscard]] std::vector<Vec3> sum(const Eigen::VectorXd &amplitudes, const ParallelFor &parallelFor) const;
  [[nodiscard]] Vec3 linear(std::size_t pattern, std::size_t phyxel) const {
    const ResponseMatrix &all = warped_.responses();
    const auto p = static_cast<Eigen::Index>(pattern), i = static_cast<Eigen::Index>(phyxel);
    const Eigen::Index third = all.cols() / 3;
    return Eigen::Vector3f(all(i, p), all(i, third + p), all(i, 2 * third + p)).cast<double>();
  }
  // m, root mean square distance of the last shape from that of the derivatives after the motion.
  [[nodiscard]] double distanceAfter(const RigidFit &motion) const;

  const RestState &rest_;
  WarpedResponse warped_;
  std::vector<Vec3> shape_, differentiatedAt_;  // m, positions of the last shape, and of that of the derivatives
  ResponseMatrix derivatives_;                  // of the displacements, m/Pa
};

}  // namespace pointbased::detail
