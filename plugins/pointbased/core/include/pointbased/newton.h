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

/// A smooth energy of the positions of phyxels, to be minimised: for a static equilibrium, or for a step of an implicit
/// integrator (incremental potential). Unknowns are displacements, three per phyxel.
class IncrementalPotential {
 public:
  virtual ~IncrementalPotential() = default;
  [[nodiscard]] virtual std::size_t phyxels() const = 0;
  /// 1 for phyxels whose displacement is prescribed (it does not change), else 0; empty: none.
  [[nodiscard]] virtual std::span<const std::uint8_t> prescribed() const = 0;
  /// Sets the state u, to which all functions below refer. False: u cannot be evaluated (not finite).
  [[nodiscard]] virtual bool setState(std::span<const Vec3> u) = 0;
  [[nodiscard]] virtual double energy() = 0;  ///< J
  /// Additional round-off of energy(), J, not visible from its magnitude: of a sum of parts that cancel.
  [[nodiscard]] virtual double roundOff() const { return 0.0; }
  virtual void gradient(std::span<Vec3> out) = 0;  ///< dE/du, N
  /// Upper bound of the distance to the minimum, m, from a gradient here only; infinite: unknown. For a time step it is
  /// at most the distance that inertia alone would allow.
  [[nodiscard]] virtual double reach(std::span<const Vec3> gradient) const {
    (void)gradient;
    return std::numeric_limits<double>::infinity();
  }
  virtual void product(std::span<const Vec3> du, std::span<Vec3> out) = 0;  ///< Hessian times du, N; matrix-free
  virtual void diagonalBlocks(std::span<Mat3> out) = 0;                     ///< of the Hessian, positive definite
  /// The whole Hessian, or a positive definite approximation of it; false: not available.
  [[nodiscard]] virtual bool assemble(Eigen::SparseMatrix<double> &out) = 0;
  /// Components of a V-cycle over coarser lattices, at the present state; false: not available. Private to the core.
  [[nodiscard]] virtual bool assembleGrids(detail::Multigrid &out, const StopRequest *stop) {
    (void)out, (void)stop;
    return false;
  }
  /// Subproblems over disjoint consecutive phyxels that make up the Hessian, except for their coupling. Preconditioners
  /// of the parts form one of the whole. Empty: a single problem.
  [[nodiscard]] virtual std::span<IncrementalPotential *const> parts() { return {}; }
  /// Upper limit of the scaling of a search direction (contact: up to the first touch); 1 is the full step.
  [[nodiscard]] virtual double largestStep(std::span<const Vec3> direction) {
    (void)direction;
    return 1.0;
  }
};

enum class Preconditioner {
  /// Multigrid on lattices. Otherwise complete Cholesky where that is cheap (about 3000 phyxels), else incomplete; both
  /// until their iterations have paid for a complete one (at most 30 000 phyxels). Blocks if the Hessian cannot be
  /// assembled
  automatic,
  blockJacobi,  ///< 3x3 blocks
  multigrid,    ///< a V-cycle over coarser lattices; blocks for clouds
  incomplete,   ///< incomplete Cholesky of the assembled Hessian
  factorised    ///< complete Cholesky of an assembled Hessian
};

/// Convergence criteria:
///  - a residual of at most toleranceForce (exactly zero if that is 0), also at the start; or
///  - a start that is within a thousandth of toleranceDisplacement of the minimum (IncrementalPotential::reach()); or
///  - a full Newton step (not cut by the line search, by largestStep() or by negative curvature) that moved no phyxel
///    by more than toleranceDisplacement, did not increase the residual, and came from a linear solve to
///    confirmingTolerance or better. A solve that finds such a small step at a looser tolerance continues to that
///    tolerance first. Where the residual is all round-off and increases, two such steps in a row count; or
///  - no further progress, with a residual below 1e-6 of the first one: only round-off remains.
///
/// A state with exactly zero residual counts as the minimum. Whether it is a saddle point (a column compressed exactly
/// along its axis) is not checked: perturb the start.
struct NewtonSettings {
  double toleranceDisplacement = 1e-7;  ///< m, >= 0
  /// Fraction of the largest displacement from the start that is tolerated as well. For a time step that is the part
  /// that inertia alone does not predict, and the scheme itself has an error of a fraction of it
  double relativeStepTolerance = 0.0;
  bool calibrateFromFirstStep = false;  ///< by the first Newton step, if it is a full step: obstacles shorten others
  double largestTolerance = std::numeric_limits<double>::infinity();  ///< m, upper limit of the calibrated tolerance
  double toleranceForce = 0.0;  ///< N, >= 0: largest residual that is accepted without a further step
  int maxIterations = 50;       ///< Newton steps
  /// Trust region: a step that does not lower the energy is shortened along the path of the linear solve, and limits
  /// the next ones in the norm of the preconditioner. False: the step is scaled. Intended for time steps without
  /// contact: the static solution of a buckling body is far away and is reached sooner without it
  bool trustRegion = false;
  int maxLinearIterations = 2000;  ///< per Newton step; then the present direction is used
  double linearTolerance = 1e-2;   ///< of the first solves; decreases with the residual (Eisenstat and Walker)
  /// Of all solves with a preconditioner close to the inverse: its residual indicates the error, and more steps may be
  /// cheaper than exact ones
  double strongTolerance = 1e-2;
  /// Upper limit where the Hessian changes so much along a step that the residual hardly decreases
  double loosestTolerance = 0.0;
  /// Of the step that ends the solve. At most 1e-3 with a weak preconditioner, whose residual is a poor indicator
  double confirmingTolerance = 1e-3;
  Preconditioner preconditioner = Preconditioner::automatic;
  /// When raised, also within a factorisation, Stopped is thrown; u keeps the value reached so far
  const StopRequest *stop = nullptr;
};

enum class NewtonOutcome {
  converged,
  iterationLimit,  ///< the limit of Newton steps was reached
  notFinite,       ///< the start cannot be evaluated, or its gradient is not finite; worst: location
  noDescent,       ///< no step lowers the energy, or six in a row changed neither it nor the residual; worst: location
  cancelled
};

struct NewtonResult {
  NewtonOutcome outcome = NewtonOutcome::converged;
  int iterations = 0;        ///< Newton steps
  int linearIterations = 0;  ///< of conjugate gradients, total
  int factorisations = 0;    ///< complete or incomplete, in this call; 0: the stored one was reused
  double lastStep = 0.0;     ///< m, largest displacement of the last Newton correction
  double tolerance = 0.0;    ///< m, below which such a correction was accepted
  double residual = 0.0;     ///< N, largest of a free phyxel; NaN if it cannot be evaluated
  Index worst = 0;           ///< phyxel with that residual
  [[nodiscard]] bool good() const { return outcome == NewtonOutcome::converged; }
};

/// Newton's method with a truncated conjugate-gradient solve (directions of negative curvature are followed, not
/// suppressed), a line search on the energy, and the chosen preconditioner. Scratch storage and factorisation are
/// retained between calls on problems of the same shape. A factorisation is renewed when the iterations it costs have
/// paid for a new one, by count, not by time. Bitwise identical for any number of threads if the problem is.
///
/// In time steps without contact (relativeStepTolerance without calibrateFromFirstStep) the preconditioned gradient
/// estimates the remaining error if the preconditioner is close to the inverse. The estimate is twelve times the
/// gradient, scaled as in the step before. If it is within the tolerance, it is applied as the last correction, without
/// a linear solve.
///
/// The line search halves the step where the problem cannot be evaluated. It accepts a sufficient decrease of the
/// energy (Armijo) or, where the change is lost in round-off, a decreasing gradient with a suitable slope along the
/// step (Hager and Zhang).
/// @source  Nocedal and Wright, Numerical Optimization, 2nd ed., ch. 7.1; Steihaug 1983; Eisenstat and Walker, SIAM J.
///          Sci. Comput. 17, 1996, choice 2; trust region: Conn, Gould and Toint, Trust-Region Methods, 2000, ch. 7.5;
///          Hager and Zhang, SIAM J. Optim. 16, 2005, approximate Wolfe conditions
class NewtonSolver {
 public:
  NewtonSolver();
  ~NewtonSolver();
  NewtonSolver(NewtonSolver &&) noexcept;
  NewtonSolver &operator=(NewtonSolver &&) noexcept;

  /// @param u  in: the start; out: the minimum, or the lowest state that was found. The problem has been moved there
  ///           (unless the start cannot be evaluated)
  /// @param shouldContinue  called before every Newton step; false: stop (cancelled)
  [[nodiscard]] NewtonResult solve(IncrementalPotential &problem, std::span<Vec3> u, const NewtonSettings &settings,
                                   const std::function<bool(const NewtonResult &)> &shouldContinue = {});
  /// Discards the factorisation: the problem has changed its shape or stiffness.
  void forget();
  /// Progress of the present or last solve.
  [[nodiscard]] const NewtonResult &progress() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pointbased
