// SPDX-License-Identifier: Apache-2.0
// What stands in for the inverse of the Hessian inside conjugate gradients, and when it is worth renewing. Private.
#pragma once

#include <memory>
#include <vector>

#include "pointbased/newton.h"

namespace pointbased::detail {

/// An approximate inverse M^-1 of the Hessian with the rows and columns of prescribed phyxels replaced by the identity.
///
/// Blocks are cheap and are made anew for every Newton step. Factorisations are kept, over Newton steps and over calls,
/// until the iterations that they cost beyond what they cost when they were fresh add up to the price of a new one: at
/// most twice the work of somebody who knew in advance. The price is counted in operations, not in time, so a repeated
/// run renews at the same places.
///
/// `automatic` takes a V-cycle over coarser lattices where there are such, until its iterations have paid for a
/// complete factorisation (near incompressibility). Else it factorises completely where that costs no more than some
/// kCheap iterations with an incomplete factorisation, which it takes else, until the iterations have paid for the
/// complete one.
class AdaptivePreconditioner {
 public:
  AdaptivePreconditioner();
  ~AdaptivePreconditioner();
  AdaptivePreconditioner(AdaptivePreconditioner &&) noexcept;
  AdaptivePreconditioner &operator=(AdaptivePreconditioner &&) noexcept;

  /// Makes it ready at the problem's present state; keeps what there is if that still serves.
  /// @param stop  null, or what ends a factorisation half way, with Stopped; forget() then
  void prepare(IncrementalPotential &problem, Preconditioner choice, const StopRequest *stop = nullptr);
  /// out = M^-1 in; zero on prescribed phyxels if `in` is.
  void apply(std::span<const Vec3> in, std::span<Vec3> out);

  /// Iterations of one solve after which something better would have cost less; `most` if there is nothing better.
  [[nodiscard]] int iterationBudget(double tolerance, int most) const;
  /// Books the iterations of a solve, or of the part of it that ran out of its budget.
  /// @param complete  it reached its tolerance
  void book(int iterations, double tolerance, bool complete);
  /// Factorises at the problem's present state, whatever the books say.
  void renew(IncrementalPotential &problem, const StopRequest *stop = nullptr);

  /// Near the inverse, so that few iterations reach any tolerance and the residual tells the error.
  [[nodiscard]] bool isStrong() const;
  [[nodiscard]] int factorisations() const;  ///< since it was made
  void forget();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// One for every part of a large problem that has some (IncrementalPotential::parts()), else one for all of it. Parts
/// of lattices have a V-cycle, unless an assembled factorisation of all is asked for: what couples the parts takes some
/// hundred iterations then, and a factorisation of 7 000 phyxels as long as several of such solutions.
class PreconditionerOfParts {
 public:
  /// As AdaptivePreconditioner.
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
  bool isWhole_ = true;             // one of all, whatever parts there are
};

}  // namespace pointbased::detail
