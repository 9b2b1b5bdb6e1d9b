// SPDX-License-Identifier: Apache-2.0
// Preconditioners for conjugate gradients with the Hessian, and the decision when to renew them. Private.
#pragma once

#include <memory>
#include <vector>

#include "pointbased/newton.h"

namespace pointbased::detail {

/// An approximate inverse M^-1 of the Hessian with the rows and columns of prescribed phyxels replaced by the identity.
///
/// Blocks are cheap and are rebuilt for every Newton step. Factorisations are reused over Newton steps and over calls,
/// until their iterations in excess of those of a fresh one add up to the price of a new one. The total work is at most
/// twice the optimum with perfect foresight. The price is counted in operations, not in time, so a repeated run renews
/// at the same points.
///
/// `automatic` uses a V-cycle over coarser lattices if there are any, until its iterations have paid for a complete
/// factorisation (near incompressibility). Otherwise it factorises completely if that costs at most about kCheap
/// iterations with an incomplete factorisation. If not, it uses an incomplete factorisation until its iterations have
/// paid for the complete one.
class AdaptivePreconditioner {
 public:
  AdaptivePreconditioner();
  ~AdaptivePreconditioner();
  AdaptivePreconditioner(AdaptivePreconditioner &&) noexcept;
  AdaptivePreconditioner &operator=(AdaptivePreconditioner &&) noexcept;

  /// Prepares it for the current state of the problem; reuses what is still valid.
  /// @param stop  null, or a request that ends a factorisation with Stopped; call forget() then
  void prepare(IncrementalPotential &problem, Preconditioner choice, const StopRequest *stop = nullptr);
  /// out = M^-1 in; zero on prescribed phyxels if `in` is.
  void apply(std::span<const Vec3> in, std::span<Vec3> out);

  /// Iterations of one solve after which a better preconditioner would have cost less; `most` if there is none.
  [[nodiscard]] int iterationBudget(double tolerance, int most) const;
  /// Records the iterations of a solve, or of the part of it that exceeded its budget.
  /// @param complete  it reached its tolerance
  void book(int iterations, double tolerance, bool complete);
  /// Factorises at the current state of the problem, regardless of the recorded costs.
  void renew(IncrementalPotential &problem, const StopRequest *stop = nullptr);

  /// Close to the inverse, so that few iterations reach any tolerance and the residual indicates the error.
  [[nodiscard]] bool isStrong() const;
  [[nodiscard]] int factorisations() const;  ///< since construction
  void forget();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// One preconditioner for every part of a large problem that has parts (IncrementalPotential::parts()), otherwise one
/// for the whole. Parts of lattices have a V-cycle, unless an assembled factorisation of the whole is requested. The
/// coupling of the parts then takes some hundred iterations, and a factorisation of 7 000 phyxels takes as long as
/// several such solutions.
class PreconditionerOfParts {
 public:
  /// Same as AdaptivePreconditioner.
  void prepare(IncrementalPotential &problem, Preconditioner choice, const StopRequest *stop);
  void apply(std::span<const Vec3> in, std::span<Vec3> out);
  [[nodiscard]] int iterationBudget(double tolerance, int most) const;
  void book(int iterations, double tolerance, bool complete);
  void renew(IncrementalPotential &problem, const StopRequest *stop);
  [[nodiscard]] bool isStrong() const { return keepers_.size() == 1 && keepers_.front().isStrong(); }
  [[nodiscard]] int factorisations() const;
  void forget();

 private:
  std::vector<AdaptivePreconditioner> keepers_{1};
  std::vector<std::size_t> sizes_;  // phyxels of each
  bool isWhole_ = true;             // a single one for all parts
};

}  // namespace pointbased::detail
