// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCore>
#include <limits>
#include <memory>

#include "pointbased/stop_request.h"
#include "pointbased/types.h"

namespace pointbased {

namespace detail {
class Multigrid;
}

/// A smooth energy over the positions of phyxels, of which a minimum is sought: a static equilibrium, or the step of an
/// implicit integrator (incremental potential). Unknowns are displacements, three per phyxel.
class IncrementalPotential {
 public:
  virtual ~IncrementalPotential() = default;
  [[nodiscard]] virtual std::size_t phyxels() const = 0;
  /// 1 for phyxels whose displacement is prescribed (they stay as they are), 0 else; empty: none.
  [[nodiscard]] virtual std::span<const std::uint8_t> prescribed() const = 0;
  /// Moves to u: everything below refers to it. False: u cannot be evaluated (not finite).
  [[nodiscard]] virtual bool setState(std::span<const Vec3> u) = 0;
  [[nodiscard]] virtual double energy() = 0;  ///< J
  /// Round-off of energy() that its size does not show, J: of a sum of parts that cancel.
  [[nodiscard]] virtual double roundOff() const { return 0.0; }
  virtual void gradient(std::span<Vec3> out) = 0;  ///< dE/du, N
  /// How far the minimum may be from here, from a gradient here alone, m; infinite: nobody knows. Of a step in time it
  /// is no farther than what inertia alone would allow.
  [[nodiscard]] virtual double reach(std::span<const Vec3> gradient) const {
    (void)gradient;
    return std::numeric_limits<double>::infinity();
  }
  virtual void product(std::span<const Vec3> du, std::span<Vec3> out) = 0;  ///< Hessian times du, N; matrix-free
  virtual void diagonalBlocks(std::span<Mat3> out) = 0;                     ///< of the Hessian, positive definite
  /// All of the Hessian, or something close to it that is positive definite; false: not available.
  [[nodiscard]] virtual bool assemble(Eigen::SparseMatrix<double> &out) = 0;
  /// What a V-cycle over coarser lattices is made of, at the present state; false: there are none. Private to the core.
  [[nodiscard]] virtual bool assembleGrids(detail::Multigrid &out, const StopRequest *stop) {
    (void)out, (void)stop;
    return false;
  }
  /// Problems over some of the phyxels each, one after the other, that make the Hessian but for what couples them: a
  /// preconditioner of each is one of all. Empty: it is one problem.
  [[nodiscard]] virtual std::span<IncrementalPotential *const> parts() { return {}; }
  /// Most that the present search direction may be scaled by (contact: up to the first touch); 1 is the full step.
  [[nodiscard]] virtual double largestStep(std::span<const Vec3> direction) {
    (void)direction;
    return 1.0;
  }
};

enum class Preconditioner {
  /// Multigrid on lattices; else complete where that is cheap (some 3000 phyxels), else incomplete; both until their
  /// iterations have paid for a complete one (at most 30 000 phyxels); blocks where the Hessian cannot be assembled
  automatic,
  blockJacobi,  ///< 3x3 blocks
  multigrid,    ///< a V-cycle over coarser lattices; blocks for clouds
  incomplete,   ///< incomplete Cholesky of the assembled Hessian
  factorised    ///< complete Cholesky of an assembled Hessian
};

/// Converged is
///  - a residual of at most toleranceForce (exactly zero where that is 0), also at the start; or
///  - a start from which the minimum is within a thousandth of toleranceDisplacement (IncrementalPotential::reach());
///    or
///  - a Newton step that was taken whole (not cut by the line search, by largestStep() or by negative curvature), moved
///    no phyxel by more than toleranceDisplacement, did not raise the residual, and came from a linear solve to
///    confirmingTolerance or better; a solve that finds so small a step at a looser tolerance goes on to that before it
///    is believed. Where the residual is all round-off and does rise, two such steps in a row count; or
///  - no further progress, with a residual below 1e-6 of the first one: round-off is all that is left.
/// A state of exactly zero residual counts as the minimum; that it may be a saddle (a column pressed exactly along its
/// axis) is not looked into: disturb the start.
struct NewtonSettings {
  double toleranceDisplacement = 1e-7;  ///< m, >= 0
  /// Part of the longest way from the start that is tolerated as well: of a step in time that is what inertia alone
  /// has left out, of which the scheme itself errs by a part
  double toleranceOfWay = 0.0;
  bool firstTellsWay = false;  ///< by the first Newton step, if it is taken whole: obstacles cut others short
  double largestTolerance = std::numeric_limits<double>::infinity();  ///< m, that may come of it
  double toleranceForce = 0.0;  ///< N, >= 0: largest residual that is good enough without a further step
  int maxIterations = 50;       ///< Newton steps
  /// Trust region: a step that does not lower the energy is shortened along the path of the linear solve, and bounds
  /// the next ones in the norm of the preconditioner; false: it is scaled. For steps in time without contact: a static
  /// solution of a body that buckles is far away, and found sooner without
  bool trustRegion = false;
  int maxLinearIterations = 2000;  ///< per Newton step; the direction so far is used then
  double linearTolerance = 1e-2;   ///< of the first solves; tightened as the residual falls (Eisenstat and Walker)
  /// Of all solves whose preconditioner is near the inverse: its residual tells the error, and more steps may be
  /// cheaper than exact ones
  double strongTolerance = 1e-2;
  /// At most this, where the Hessian changes so much along a step that the residual hardly falls
  double loosestTolerance = 0.0;
  /// Of a step that ends the solve. With a weak preconditioner at most 1e-3, because its residual tells little
  double confirmingTolerance = 1e-3;
  Preconditioner preconditioner = Preconditioner::automatic;
  /// Raised, also within a factorisation: Stopped is thrown, u is as far as it came
  const StopRequest *stop = nullptr;
};

enum class NewtonOutcome {
  converged,
  iterationLimit,  ///< out of Newton steps
  notFinite,       ///< the start cannot be evaluated, or its gradient is not finite; worst: where
  noDescent,       ///< no step lowers the energy, or six in a row changed neither it nor the residual; worst: where
  cancelled
};

struct NewtonResult {
  NewtonOutcome outcome = NewtonOutcome::converged;
  int iterations = 0;        ///< Newton steps
  int linearIterations = 0;  ///< of conjugate gradients, all together
  int factorisations = 0;    ///< complete or incomplete, in this call; 0: the kept one served
  double lastStep = 0.0;     ///< m, largest displacement of the last Newton correction
  double tolerance = 0.0;    ///< m, below which such a correction was small enough
  double residual = 0.0;     ///< N, largest of a free phyxel; NaN where it cannot be evaluated
  Index worst = 0;           ///< the phyxel that has it
  [[nodiscard]] bool good() const { return outcome == NewtonOutcome::converged; }
};

/// Newton's method with a truncated conjugate-gradient solve (directions of negative curvature are followed, not
/// suppressed), line search on the energy, and the chosen preconditioner. Keeps its scratch and factorisation between
/// calls on problems of the same shape; a factorisation is renewed when the iterations it costs have paid for a new
/// one, counted, not timed. Same bits for any number of threads when the problem's are.
///
/// In steps in time without contact (toleranceOfWay without firstTellsWay) the preconditioned gradient estimates the
/// error that is left, where the preconditioner is near the inverse: twelve times it, scaled as in the step before.
/// Where that is within the tolerance, it is applied as the last correction, without a linear solve.
///
/// The line search halves where the problem cannot be evaluated; it accepts a sufficient decrease of the energy
/// (Armijo) or, where the change drowns in round-off, a falling gradient whose slope along the step says so (Hager and
/// Zhang).
/// @source  Nocedal and Wright, Numerical Optimization, 2nd ed., ch. 7.1; Steihaug 1983; Eisenstat and Walker, SIAM J.
///          Sci. Comput. 17, 1996, choice 2; trust region: Conn, Gould and Toint, Trust-Region Methods, 2000, ch. 7.5;
///          Hager and Zhang, SIAM J. Optim. 16, 2005, approximate Wolfe conditions
class NewtonSolver {
 public:
  NewtonSolver();
  ~NewtonSolver();
  NewtonSolver(NewtonSolver &&) noexcept;
  NewtonSolver &operator=(NewtonSolver &&) noexcept;

  /// @param u  in: the start; out: the minimum, or the lowest state that was found. The problem has been moved
  ///           there (unless the start cannot be evaluated)
  /// @param shouldContinue  asked before every Newton step; false: stop (cancelled)
  [[nodiscard]] NewtonResult solve(IncrementalPotential &problem, std::span<Vec3> u, const NewtonSettings &settings,
                                   const std::function<bool(const NewtonResult &)> &shouldContinue = {});
  /// Forgets the factorisation: the problem has changed its shape or stiffness.
  void forget();
  /// Of the present or last solve: how far it has come.
  [[nodiscard]] const NewtonResult &progress() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pointbased
