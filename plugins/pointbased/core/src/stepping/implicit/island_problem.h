// SPDX-License-Identifier: Apache-2.0
// Objective function of a stage of several coupled bodies. Private to the core.
#pragma once

#include "stepping/implicit/stage_coupling.h"
#include "stepping/implicit/stage_problem.h"

namespace pointbased::detail {

/// The sum of the stages of several bodies and of their coupling, over the displacements of all, body by body.
class IslandProblem final : public IncrementalPotential {
 public:
  /// @param parts     at least one; in the order of the bodies of `coupling` that move
  /// @param coupling  StageCoupling::begin() has been called
  IslandProblem(std::vector<StageProblem *> parts, StageCoupling &coupling);

  [[nodiscard]] std::size_t phyxels() const override { return mask_.size(); }
  [[nodiscard]] std::span<const std::uint8_t> prescribed() const override { return mask_; }
  [[nodiscard]] bool setState(std::span<const Vec3> u) override;
  [[nodiscard]] double energy() override;
  [[nodiscard]] double roundOff() const override;
  void gradient(std::span<Vec3> out) override;
  // The coupling has no negative curvature: the Hessian is at least that of inertia.
  [[nodiscard]] double reach(std::span<const Vec3> gradient) const override;
  void product(std::span<const Vec3> du, std::span<Vec3> out) override;
  void diagonalBlocks(std::span<Mat3> out) override;
  [[nodiscard]] bool assemble(Eigen::SparseMatrix<double> &out) override;
  [[nodiscard]] std::span<IncrementalPotential *const> parts() override;

 private:
  // visit(part, its first phyxel, number of phyxels)
  template <class Visit>
  void forParts(const Visit &visit) const {
    std::size_t first = 0;
    for (StageProblem *part : parts_) {
      visit(*part, first, part->phyxels());
      first += part->phyxels();
    }
  }

  std::vector<StageProblem *> parts_;
  std::vector<IncrementalPotential *> potentials_;  // the same parts
  std::vector<Mat3> blocks_;
  StageCoupling &coupling_;
  std::vector<std::uint8_t> mask_;
  std::vector<Vec3> displacements_, forces_;
  Eigen::SparseMatrix<double> part_;
  std::vector<Eigen::Triplet<double>> triplets_;
};

}  // namespace pointbased::detail
