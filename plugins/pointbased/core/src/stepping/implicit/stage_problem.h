// SPDX-License-Identifier: Apache-2.0
// Objective function of a stage of an implicit or static step. Private to the core.
#pragma once

#include "forces/stiffness_factors.h"
#include "pointbased/integrators.h"

namespace pointbased::detail {

/// One stage: base position p (m) and velocity q (m/s) of the phyxels, the length h, and the end time for loads and
/// supports.
struct ImplicitStage {
  double h = 0.0;            ///< s; 0: static
  double end = 0.0;          ///< s, or load factor
  double contactSpan = 0.0;  ///< s (or load factor) over which contact planes move
  std::vector<Vec3> p, q;
  double holding = 0.0;  ///< 1/s²: static only, of the inertia that holds bodies without supports
  double elapsed = 0.0;  ///< s since the beginning of the step: duration of relaxation
  /// Error of the scheme itself, relative to the displacement that inertia alone does not predict. 0: the scheme
  /// conserves energy and is solved to more digits than its displacements require.
  double tolerance = 0.0;
};

/// The incremental potential of a stage at the displacements of the body: inertia, elastic energy, supports, contact,
/// surroundings and loads. Forces without a potential (followers, viscous and relaxing ones) enter by the work they do
/// since the last gradient. Leaves the body in the state that was evaluated last.
/// @source  integrators.h, implicitStep()
class StageProblem final : public IncrementalPotential {
 public:
  StageProblem(Body &body, const Environment &env, const ImplicitStage &stage);

  [[nodiscard]] ContactPenalty &penalty() { return penalty_; }
  /// Diagonal blocks of the coupling to other bodies, for the preconditioner of this part. The span must stay valid.
  void setCoupling(std::span<const Mat3> blocks) { coupling_ = blocks; }
  [[nodiscard]] std::span<const Vec3> start() const { return start_; }

  [[nodiscard]] std::size_t phyxels() const override { return n_; }
  [[nodiscard]] std::span<const std::uint8_t> prescribed() const override { return body_.heldMask(); }
  [[nodiscard]] bool setState(std::span<const Vec3> u) override;
  [[nodiscard]] double energy() override;
  // Laws compute the energy from terms of the size of their moduli, however small the strain.
  [[nodiscard]] double roundOff() const override { return roundOff_; }
  void gradient(std::span<Vec3> out) override;
  /// True for a time stage of a body without forces that depend on its position.
  [[nodiscard]] bool movesFreely() const;
  /// m: translation after which the momentum of the body is that of its loads, up to round-off; only if movesFreely().
  [[nodiscard]] Vec3 translationToMomentum();
  // The Hessian is at least that of inertia unless the body is crushed.
  [[nodiscard]] double reach(std::span<const Vec3> gradient) const override;
  void product(std::span<const Vec3> du, std::span<Vec3> out) override;
  void diagonalBlocks(std::span<Mat3> out) override;
  [[nodiscard]] bool assemble(Eigen::SparseMatrix<double> &out) override;
  [[nodiscard]] bool assembleGrids(Multigrid &out, const StopRequest *stop) override;

 private:
  [[nodiscard]] std::span<const Vec3> targets() { return body_.patchTargets(stage_.end); }
  [[nodiscard]] const ElasticFoundation &foundation() const { return body_.foundation(); }
  [[nodiscard]] bool foundationActs() const { return foundation().acts(); }
  // Retardation time over h: the foundation's damping relative to its stiffness, in the Hessian.
  [[nodiscard]] double relativeRetardation() const {
    return stage_.h > 0.0 ? foundation().settings().retardationTime / stage_.h : 0.0;
  }
  [[nodiscard]] std::span<const Vec3> displacementOfStage();
  [[nodiscard]] double dt() const { return dissipative_ ? stage_.elapsed : 0.0; }
  [[nodiscard]] double viscousScale() const { return dissipative_ ? 1.0 / stage_.h : 0.0; }
  // History at the beginning of the step, from which relaxation advances by dt().
  [[nodiscard]] const PointHistory &history() const { return body_.state().history; }

  void addContactAndSurroundings(std::span<Mat3> out);

  // Forces without a potential at the present displacements: followers; viscous and relaxing stresses as the difference
  // to the elastic ones.
  void computeWork();

  // All energies of a solution are relative to its first state. A different origin for one of them alone would be a
  // jump in the merit function as large as the work itself.
  void setReference();
  [[nodiscard]] double workSinceReference() const;

  Body &body_;
  const Environment &env_;
  const ImplicitStage &stage_;
  std::size_t n_;
  double a_ = 0.0, damping_ = 0.0;
  bool followers_ = false, dissipative_ = false, contact_ = false, workCurrent_ = false;
  bool vectorised_ = false, linearised_ = false;
  std::vector<Vec3> deadLoads_, work_, start_, forces_, displacementOfStage_;
  std::vector<Vec3> reference_, referenceWork_;
  double referenceEnergy_ = 0.0, roundOff_ = 0.0;
  ContactPenalty penalty_;
  std::span<const Mat3> coupling_;
  TangentScratch scratch_;
  std::vector<Eigen::Triplet<double>> triplets_;
  StiffnessFactors factors_, trilinearFactors_;
};

}  // namespace pointbased::detail
