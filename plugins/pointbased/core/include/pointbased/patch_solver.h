// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCore>
#include <memory>

#include "pointbased/stencil.h"
#include "pointbased/types.h"

namespace pointbased {

/// The held patches of a body (ConstrainedRegion::rows of all its fixes) as springs between their mean displacement and
/// a target:
///
///     U = ½ Σ_p k_p |Σ_j φ_pj u_j - t_p|²
///
/// In implicit and static solutions it is this energy. In explicit steps, springs that are soft enough for the step act
/// as forces. The others correct positions and velocities such that they are integrated implicitly (compliant
/// constraints) and do not reduce the stable step.
class PatchSolver {
 public:
  PatchSolver();
  ~PatchSolver();
  PatchSolver(PatchSolver &&) noexcept;
  PatchSolver &operator=(PatchSolver &&) noexcept;

  /// @param rows, weights    per patch: phyxels with φ
  /// @param stiffness        per patch, N/m, > 0
  /// @param inverseMasses    [phyxels] 1/kg; 0: prescribed
  void set(const Csr &rows, std::span<const double> weights, std::span<const double> stiffness,
           std::span<const double> inverseMasses);
  [[nodiscard]] std::size_t rows() const;
  [[nodiscard]] const Csr &phyxels() const;
  [[nodiscard]] std::span<const double> weights() const;
  [[nodiscard]] std::span<const double> stiffness() const;

  /// Call after the drift of a step. For springs that are too stiff for the step, solves (C M^-1 C^T + 1/(k dt²)) Δλ =
  /// -(C u - t + λ/k)/dt² directly (the factorisation is retained while dt is constant) and applies u += dt² M^-1 C^T
  /// Δλ, v += dt M^-1 C^T Δλ, λ += Δλ. Then λ = -k (C u - t) for the others, which add at most 0.3 to the squared
  /// frequencies of the body times dt².
  /// @source  Macklin et al., XPBD (MIG 2016), solved directly instead of iteratively
  void correct(double dt, std::span<const Vec3> targets, std::span<Vec3> displacements, std::span<Vec3> velocities);

  /// Number of springs that the last correct() has solved for.
  [[nodiscard]] std::size_t solvedRows() const;

  /// Present spring forces λ_p on the body per patch, N; those of the last correct() or updateForces().
  [[nodiscard]] std::span<const Vec3> forces() const;
  [[nodiscard]] std::vector<Vec3> &forces();
  void clearForces();
  /// v += h M^-1 C^T λ.
  void kick(double h, std::span<Vec3> velocities);
  /// Adds C^T λ to the phyxels.
  void addForces(std::span<Vec3> forces) const;

  // The energy and its derivatives at displacements u
  [[nodiscard]] double energy(std::span<const Vec3> targets, std::span<const Vec3> u) const;
  /// λ = -k (C u - t), stored as forces().
  void updateForces(std::span<const Vec3> targets, std::span<const Vec3> u);
  void addProduct(std::span<const Vec3> du, std::span<Vec3> out) const;
  void addDiagonal(std::span<Mat3> blocks) const;
  void addTriplets(std::vector<Eigen::Triplet<double>> &out) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pointbased
