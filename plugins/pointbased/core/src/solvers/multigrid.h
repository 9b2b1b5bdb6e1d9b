// SPDX-License-Identifier: Apache-2.0
// V-cycle over the lattices of a body, as a preconditioner. Private to the core.
#pragma once

#include <Eigen/Cholesky>
#include <memory>

#include "forces/kernels/aligned_vector.h"
#include "forces/stiffness_factors.h"
#include "solvers/grid_hierarchy.h"
#include "solvers/sweep_kernel.h"

namespace pointbased::detail {

/// k_p w_pi w_pj I between the phyxels i and j of each spring p.
struct SpringRows {
  const Csr &rows;
  std::span<const double> weights, stiffness;  ///< [entries]; [rows] N/m
};

/// M^-1 r by one V-cycle: Gauss-Seidel by 3x3 blocks forwards before the coarser level, backwards after it, a dense
/// factorisation on the coarsest. Coarser matrices are P^T A P. Springs connect corners with almost no material, for
/// which single blocks converge slowly: all nodes of a spring are solved for together, in addition to the coarser
/// level. Coarser matrices are summed cell by cell, in float. Stored are blocks of D^-1/2 A D^-1/2 in sixteen bits.
/// Their rounding errors, 1.5e-5 of the diagonal, are added to the diagonal as well, so that the forces of translations
/// are preserved. Symmetric and positive, hence a preconditioner of conjugate gradients; the same bits for any number
/// of threads.
/// @source  Trottenberg, Oosterlee, Schüller, Multigrid, 2001, ch. 2 and 7.7 (Galerkin coarsening, preconditioners)
class Multigrid {
 public:
  /// Sets the lattices of a body.
  /// @param source  object they were built from; its identity decides whether they have to be rebuilt
  void reset(std::shared_ptr<const GridHierarchy> hierarchy, std::shared_ptr<const void> source);
  [[nodiscard]] bool isOf(const std::shared_ptr<const void> &source, const Csr &springs) const {
    return source_ == source && (!hierarchy_ || (hierarchy_->springs.offsets == springs.offsets &&
                                                 hierarchy_->springs.indices == springs.indices));
  }
  [[nodiscard]] bool exists() const { return hierarchy_ != nullptr; }
  /// The points with trilinear functions, or null: GridHierarchy::trilinear.
  [[nodiscard]] const StencilSet *trilinear() const { return hierarchy_ ? hierarchy_->trilinear.get() : nullptr; }
  /// @param factors  of the points; of the finest matrix
  /// @param coarserFactors  of GridHierarchy::trilinear, for coarser levels; null where there is none
  /// @param held  [phyxels] 1: does not move; or empty
  /// @param blocks  [phyxels] added to the diagonal: inertia, contact, foundation, N/m
  void assemble(const StiffnessFactors &factors, const StiffnessFactors *coarserFactors, std::span<const Mat3> blocks,
                const SpringRows &springs, std::span<const std::uint8_t> held, const ParallelFor &parallelFor,
                const StopRequest *stop);
  /// out = M^-1 in
  void apply(std::span<const Vec3> in, std::span<Vec3> out);

  /// out = A in, with the finest matrix, of which this is the approximate inverse.
  void multiply(std::span<const Vec3> in, std::span<Vec3> out) const;

  /// Number of blocks in the matrices of all levels; an application reads them twice.
  [[nodiscard]] double entries() const;
  /// Blocks in a finest row, in the mean, over the 27 of trilinear functions; at least 1.
  [[nodiscard]] double rowDensity() const;

 private:
  using Floats = kernels::AlignedVector<float>;
  struct Level {
    kernels::AlignedVector<std::int16_t> blocks;  // SweepRows
    Floats inverses;                              // [nodes][12]
    std::vector<float> roots, scales;             // [nodes] square roots of the diagonal, and their inverses
    Floats x, b;                                  // [nodes][4] of the scaled system
    Floats cells;                                 // matrices of the cells of coarser levels: [nodes][9][width]
    std::vector<std::size_t> firstNumber;         // [cells] offset of its matrix, and the total
  };
  struct Sources;  // data that a matrix is assembled from

  void sumRow(const Sources &from, std::size_t l, std::size_t i, Floats &row, Floats &scratch) const;
  void assembleRows(const Sources &from, std::size_t l);
  void keepRow(std::size_t l, std::size_t i, const Floats &row, Floats &scratch);
  void sumCells(const Sources &from, std::size_t l);
  void addFinestCell(const Sources &from, std::size_t q, std::size_t coarse, Floats &scratch);
  void addFinestSpring(const Sources &from, std::size_t q, std::size_t coarse);
  void addCell(std::size_t l, std::size_t q, std::size_t coarse, Floats &scratch);
  void factoriseCoarsest(const Sources &from);
  void invertSprings(const Csr &springs, const StopRequest *stop);
  void solveSprings();
  [[nodiscard]] Mat3 block(std::size_t i, std::size_t j) const;
  [[nodiscard]] kernels::SweepRows rowsOf(std::size_t l);
  template <class Visit>
  void forSlabs(const GridLevel &grid, bool isFirstHalf, const Visit &visit) const;
  void smoothForwards(std::size_t l);
  void smoothBackwards(std::size_t l);
  void restrictResidual(std::size_t fine);
  void prolong(std::size_t fine);
  void cycle(std::size_t l);

  std::shared_ptr<const GridHierarchy> hierarchy_;
  std::shared_ptr<const void> source_;
  std::vector<Level> levels_;
  std::vector<std::uint8_t> held_;  // [nodes of the finest level]
  Eigen::LLT<Eigen::MatrixXd> coarsest_;
  Csr springs_;  // [springs] nodes of the finest level that move
  std::vector<Eigen::MatrixXf> springInverses_;
  Floats own_;  // [nodes of the finest level][9] diagonal blocks of the scaled system
  Floats residual_;
  bool isDense_ = false;
  ParallelFor parallelFor_ = serialFor();
};

}  // namespace pointbased::detail
