// SPDX-License-Identifier: Apache-2.0
// Elastic laws from outside of the core: what such a law has to answer, and what is asked of it before it is used.
#pragma once

#include <memory>
#include <mutex>

#include "pointbased/types.h"

namespace pointbased {

/// How stiff a tangent dP/dF is, Pa.
struct TangentBound {
  double wave = 0.0;  ///< largest a⊗n : dP/dF : a⊗n over unit a, n: the modulus of the fastest wave
  double all = 0.0;   ///< largest eigenvalue of dP/dF
};

/// An elastic law with its parameters, evaluated in batches. Pure functions of F: the answer for a point depends on
/// nothing but its F, to the last bit.
///
/// @threads any, concurrently; no allocation where nothing fails
class ElasticLaw {
 public:
  virtual ~ElasticLaw() = default;
  /// For messages: law and who offers it.
  [[nodiscard]] virtual std::string name() const = 0;
  /// W(F), J/m³, 0 at F = I.
  [[nodiscard]] virtual Result<void> energies(std::span<const Mat3> F, std::span<double> W) const = 0;
  /// P = dW/dF, Pa, 0 at F = I.
  [[nodiscard]] virtual Result<void> stresses(std::span<const Mat3> F, std::span<Mat3> P) const = 0;
  /// dP = d/ds P(F + s dF) at s = 0, Pa.
  [[nodiscard]] virtual Result<void> differentials(std::span<const Mat3> F, std::span<const Mat3> dF,
                                                   std::span<Mat3> dP) const = 0;
  /// Whether bounds() is answered; else they are derived from nine differentials per point.
  [[nodiscard]] virtual bool hasBounds() const { return false; }
  /// Upper bounds of the tangent's stiffness.
  [[nodiscard]] virtual Result<void> bounds(std::span<const Mat3> F, std::span<TangentBound> out) const;
};

/// A law that has passed the checks of checked(), and what it is like at rest. Failures of the law and values that are
/// no numbers become NaN, by which the guard stops the body, and a complaint.
class CheckedLaw {
 public:
  /// Of the isotropic law next to it at rest, Pa: what stabilisation, contact and error estimate go by.
  [[nodiscard]] double lambda() const { return lambda_; }
  [[nodiscard]] double mu() const { return mu_; }
  [[nodiscard]] const TangentBound &atRest() const { return atRest_; }
  [[nodiscard]] const ElasticLaw &law() const { return *law_; }

  void energies(std::span<const Mat3> F, std::span<double> W) const;
  void stresses(std::span<const Mat3> F, std::span<Mat3> P) const;
  void differentials(std::span<const Mat3> F, std::span<const Mat3> dF, std::span<Mat3> dP) const;
  void bounds(std::span<const Mat3> F, std::span<TangentBound> out) const;

  /// What the law has last failed at, and forgets it; empty: nothing. Any thread.
  [[nodiscard]] std::string takeComplaint() const;

 private:
  friend Result<std::shared_ptr<const CheckedLaw>> checked(std::shared_ptr<const ElasticLaw> law);
  explicit CheckedLaw(std::shared_ptr<const ElasticLaw> law) : law_(std::move(law)) {}
  void complain(std::string text) const;
  template <class T>
  void judge(const Result<void> &answered, const char *what, std::span<const Mat3> F, std::span<T> values) const;

  std::shared_ptr<const ElasticLaw> law_;
  double lambda_ = 0.0, mu_ = 0.0;
  TangentBound atRest_;
  mutable std::mutex mutex_;
  mutable std::string complaint_;
};

/// Asks the law about a fixed set of deformations with stretches of 0.8 … 1.25, turned in all directions: energy and
/// stress zero at rest, a rest that is stiff against every strain, W(QF) = W(F) (objective) and W(FQ) = W(F) (isotropic:
/// stencils that lie in a plane are completed for such laws only), P = dW/dF and dP by differences, the
/// differential linear and symmetric, bounds that bound, one point alone as in a batch. What fails is said with its
/// numbers.
///
/// Tolerances, all of the law's stiffness at the same F: 1e-9 for what holds exactly (a million times the round-off of a
/// formula, far below any mistake in one), 1e-5 for what is compared with central differences (their truncation for
/// exponents of up to some ten, at a step of 1e-5).
[[nodiscard]] Result<std::shared_ptr<const CheckedLaw>> checked(std::shared_ptr<const ElasticLaw> law);

}  // namespace pointbased
