// SPDX-License-Identifier: Apache-2.0
// A body that springs pull to measurements, as an energy to minimise. Private to the core.
#pragma once

#include "stepping/implicit/stage_problem.h"

namespace pointbased::detail {

/// Springs between measurements and material points of a body. With the displacement v since they were made, and a
/// small change m of the motion of the body,
///
///     U = ½ Σ_i (r_i - S_i v - C_i m) · A_i (r_i - S_i v - C_i m)
class MatchSprings {
 public:
  using Motion = Eigen::Matrix<double, 6, 1>;
  using Columns = Eigen::Matrix<double, 3, 6>;

  void clear();
  /// A phyxel that moves the point of the next finish(), with its weight.
  void add(Index phyxel, double weight);
  /// @param A  N/m;  r  m, measurement minus body;  C  derivative of the point with respect to the motion
  void finish(const Mat3 &A, const Vec3 &r, const Columns &C);
  [[nodiscard]] std::size_t count() const { return stiffness_.size(); }

  [[nodiscard]] double energy(std::span<const Vec3> v) const;
  void addForces(std::span<const Vec3> v, std::span<Vec3> out) const;  ///< N, on the phyxels: -dU/dv
  void addProduct(std::span<const Vec3> dv, std::span<Vec3> out) const;
  void addBlocks(std::span<Mat3> blocks) const;
  void addTriplets(std::vector<Eigen::Triplet<double>> &out) const;
  /// dU/dm and d²U/dm² at v = 0, m = 0.
  void ofMotion(Motion &gradient, Eigen::Matrix<double, 6, 6> &hessian) const;

 private:
  [[nodiscard]] Vec3 residual(std::size_t i, std::span<const Vec3> v) const;

  Csr rows_;
  std::vector<double> weights_;
  std::vector<Mat3> stiffness_;
  std::vector<Vec3> residuals_;
  std::vector<Columns> columns_;
};

/// Energy of a static stage of a body plus that of springs. Unknown is the displacement of the body.
class MatchPotential final : public IncrementalPotential {
 public:
  /// @param from  [phyxels] m, displacements at which the springs were made; must stay valid
  MatchPotential(Body &body, const Environment &env, const ImplicitStage &stage, const MatchSprings &springs,
                 std::span<const Vec3> from);

  [[nodiscard]] std::size_t phyxels() const override { return stage_.phyxels(); }
  [[nodiscard]] std::span<const std::uint8_t> prescribed() const override { return stage_.prescribed(); }
  [[nodiscard]] bool setState(std::span<const Vec3> u) override;
  [[nodiscard]] double energy() override { return stage_.energy() + springs_.energy(since_); }
  [[nodiscard]] double roundOff() const override { return stage_.roundOff(); }
  void gradient(std::span<Vec3> out) override;
  void product(std::span<const Vec3> du, std::span<Vec3> out) override;
  void diagonalBlocks(std::span<Mat3> out) override { stage_.diagonalBlocks(out); }
  [[nodiscard]] bool assemble(Eigen::SparseMatrix<double> &out) override;
  [[nodiscard]] bool assembleGrids(Multigrid &out, const StopRequest *stop) override {
    return stage_.assembleGrids(out, stop);
  }
  [[nodiscard]] std::span<const Vec3> since() const { return since_; }  ///< m, displacement since the springs were made

 private:
  StageProblem stage_;
  const MatchSprings &springs_;
  std::span<const Vec3> from_;
  std::vector<Vec3> since_, scratch_;
  std::vector<Mat3> blocks_;
};

}  // namespace pointbased::detail
