// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "element.h"

#include <functional>
#include <vector>

namespace truth {

/// Sparse direct solver for the sum of symmetric element matrices: L D L^T by dense fronts along a nested dissection.
/// Without pivoting, as is right near a stable equilibrium; a pivot that vanishes is reported.
/// @source  Duff, Reid, The multifrontal solution of indefinite sparse symmetric linear equations, 1983
class Multifrontal {
 public:
  using ElementMatrix = Eigen::Matrix<double, kElementDofs, kElementDofs>;

  /// @param numbers  [3 node + axis] number of the unknown, from zero, or negative where there is none
  Multifrontal(const Model &model, const std::vector<int> &numbers);

  /// @param matrixOf  the matrix of element e, called once for each
  /// @return false if a pivot vanishes or is not finite
  bool factorize(const std::function<const ElementMatrix &(int e)> &matrixOf);

  /// Negative pivots of the last factorisation: a positive number means that the state is not stable.
  int negativePivots() const { return negativePivots_; }

  Eigen::VectorXd solve(const Eigen::VectorXd &right) const;

 private:
  struct Front {
    int first = -1, second = -1, element = -1;
    std::vector<int> unknowns;   ///< those eliminated here, then the border
    int pivots = 0;              ///< how many are eliminated here
    Eigen::MatrixXd factor;      ///< [unknowns x pivots] unit lower L; D is on its diagonal
    Eigen::MatrixXd complement;  ///< [border x border] lower half, for the parent part; freed there
  };

  void extend(Front &child, Eigen::MatrixXd &matrix);

  std::vector<Front> fronts_;
  std::vector<std::array<int, kElementDofs>> elementUnknowns_;
  std::vector<int> place_;  ///< scratch: [unknown] row in the current front
  int negativePivots_ = 0;
};

}  // namespace truth
