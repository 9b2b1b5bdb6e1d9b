// SPDX-License-Identifier: Apache-2.0
// External elastic laws: the interface of such a law, and the checks before it is used.
#pragma once

#include <memory>
#include <mutex>

#include "pointbased/types.h"

namespace pointbased {

/// Stiffness of a tangent dP/dF, Pa.
struct TangentBound {
  double wave = 0.0;  ///< largest a⊗n : dP/dF : a⊗n over unit a, n: the modulus of the fastest wave
  double all = 0.0;   ///< largest eigenvalue of dP/dF
};

/// An elastic law with its parameters, evaluated in batches. Pure functions of F: the result for a point depends only
/// on its F, to the last bit.
///
/// @threads any, concurrently; no allocation unless an evaluation fails
class ElasticLaw {
 public:
  virtual ~ElasticLaw() = default;
  /// For messages: name of the law and of its provider.
  [[nodiscard]] virtual std::string name() const = 0;
  /// W(F), J/m³, 0 at F = I.
  [[nodiscard]] virtual Result<void> energies(std::span<const Mat3> F, std::span<double> W) const = 0;
  /// P = dW/dF, Pa, 0 at F = I.
  [[nodiscard]] virtual Result<void> stresses(std::span<const Mat3> F, std::span<Mat3> P) const = 0;
  /// dP = d/ds P(F + s dF) at s = 0, Pa.
  [[nodiscard]] virtual Result<void> differentials(std::span<const Mat3> F, std::span<const Mat3> dF,
                                                   std::span<Mat3> dP) const = 0;
  /// Whether bounds() is implemented; else bounds are derived from nine differentials per point.
  [[nodiscard]] virtual bool hasBounds() const { return false; }
  /// Upper bounds of the tangent's stiffness.
  [[nodiscard]] virtual Result<void> bounds(std::span<const Mat3> F, std::span<TangentBound> out) const;
};

/// A law that has passed the checks of checked(), with its properties at rest. Failures of the law and non-finite
/// values become NaN, for which the guard stops the body, and an error text.
class CheckedLaw {
 public:
  /// Lamé parameters of the closest isotropic law at rest, Pa: used by stabilisation, contact and the error estimate.
  [[nodiscard]] double lambda() const { return lambda_; }
  [[nodiscard]] double mu() const { return mu_; }
  [[nodiscard]] const TangentBound &atRest() const { return atRest_; }
  [[nodiscard]] const ElasticLaw &law() const { return *law_; }

  void energies(std::span<const Mat3> F, std::span<double> W) const;
  void stresses(std::span<const Mat3> F, std::span<Mat3> P) const;
  void differentials(std::span<const Mat3> F, std::span<const Mat3> dF, std::span<Mat3> dP) const;
  void bounds(std::span<const Mat3> F, std::span<TangentBound> out) const;

  /// Last error of the law, which is cleared; empty: none. Any thread.
  [[nodiscard]] std::string consumeError() const;

 private:
  friend Result<std::shared_ptr<const CheckedLaw>> checked(std::shared_ptr<const ElasticLaw> law);
  explicit CheckedLaw(std::shared_ptr<const ElasticLaw> law) : law_(std::move(law)) {}
  void recordError(std::string text) const;
  template <class T>
  void checkResult(const Result<void> &answered, const char *what, std::span<const Mat3> F, std::span<T> values) const;

  std::shared_ptr<const ElasticLaw> law_;
  double lambda_ = 0.0, mu_ = 0.0;
  TangentBound atRest_;
  mutable std::mutex mutex_;
  mutable std::string lastError_;
};

/// Tests the law with a fixed set of deformations with stretches of 0.8 … 1.25, rotated in all directions.
/// Requirements: energy and stress are zero at rest; the rest state is stiff against every strain; W(QF) = W(F)
/// (objective) and W(FQ) = W(F) (isotropic: coplanar stencils are completed for such laws only); P = dW/dF and dP agree
/// with differences; the differential is linear and symmetric; bounds() are upper bounds; a single point gives the same
/// as in a batch. Errors: text names the failed requirement with its numbers.
///
/// Tolerances, all relative to the stiffness of the law at the same F: 1e-9 for exact requirements (a million times the
/// round-off of a formula, far below any mistake in one), 1e-5 for comparisons with central differences (their
/// truncation for exponents of up to about ten, at a step of 1e-5).
[[nodiscard]] Result<std::shared_ptr<const CheckedLaw>> checked(std::shared_ptr<const ElasticLaw> law);

}  // namespace pointbased
