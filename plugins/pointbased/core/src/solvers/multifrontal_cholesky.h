// SPDX-License-Identifier: Apache-2.0
// Complete Cholesky factorisation of a sparse matrix of 3x3 blocks, as a preconditioner. Private.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "pointbased/stop_request.h"

namespace pointbased::detail {

/// A = L L^T for symmetric positive definite A with one block row per phyxel.
///
/// Columns with (nearly) the same rows below are eliminated together as one dense front, whose update is added to the
/// front of its parent in the elimination tree (multifrontal method). The work consists of dense products, several
/// times as fast as column by column, and the factor needs no indices. It is computed in double and stored in float:
/// this halves the memory traffic of a solve, and the preconditioner remains exactly symmetric and positive.
/// @source  Duff and Reid, ACM TOMS 9, 1983 (multifrontal); Liu, SIAM J. Matrix Anal. Appl. 11, 1990 (elimination
/// trees)
class MultifrontalCholesky {
 public:
  /// Order (minimum degree on the graph of the blocks), elimination tree and fronts of a pattern.
  void analyse(const Eigen::SparseMatrix<double> &matrix);
  /// Factorises a matrix with the analysed pattern; both triangles must be stored. Returns false if it is not positive
  /// definite.
  /// @param diagonalShift  the diagonal is multiplied by 1 + diagonalShift, and diagonalShift times its mean is added
  /// @param stop  null, or a request that ends it with Stopped; the factorisation is then invalid
  [[nodiscard]] bool factorise(const Eigen::SparseMatrix<double> &matrix, double diagonalShift,
                               const StopRequest *stop = nullptr);
  /// x = (L L^T)^-1 b to float precision.
  void solve(std::span<const Vec3> b, std::span<Vec3> x);

  [[nodiscard]] double entries() const { return entries_; }  ///< numbers in the factor, including zeros of the fronts
  [[nodiscard]] double work() const { return work_; }        ///< multiply-adds of a factorisation

 private:
  // Block columns [first, last) in elimination order, and the block rows below them, ascending.
  struct Front {
    int first = 0, last = 0, parent = -1;
    std::vector<int> rows;
    std::size_t panel = 0;  // offset of its columns in panels_
    [[nodiscard]] int columns() const { return last - first; }
    [[nodiscard]] int size() const { return columns() + static_cast<int>(rows.size()); }
  };

  void orderColumns(const std::vector<std::vector<int>> &neighbours);
  void findFronts(const std::vector<std::vector<int>> &neighbours);
  void mergeFronts(std::vector<Front> &fronts, const std::vector<int> &parent);

  std::vector<int> order_;     // elimination position -> block
  std::vector<int> position_;  // inverse of order_
  std::vector<Front> fronts_;
  double entries_ = 0.0, work_ = 0.0;
  Eigen::VectorXf panels_, permuted_, gathered_;
};

}  // namespace pointbased::detail
