// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "c3de/core/expected.h"

namespace c3de::study {

/// The limit of three refined runs.
struct Extrapolation {
  std::vector<double> value;
  double order = 0.0;        ///< as observed; infinite if the last two runs agree to the last digit
  double uncertainty = 0.0;  ///< of the whole, in the requested norm
};

/// Extrapolates f(h) = f* + C h^p from three runs: p from the norms of the two differences, f* componentwise with that
/// p (at most 4: a larger one is due to chance). The uncertainty is 1.25 times the size of the last correction, |f* -
/// f3|.
/// @param h  steps or spacings, decreasing, above 0; any ratios
/// @param f  the same quantities of each run
/// @param weights  of the norm sqrt(sum w f^2); empty: the largest component
/// The error (ErrorCode::state) states why the runs do not converge: the order is not above 0.1, or a single number
/// oscillates from run to run.
/// @source  L. F. Richardson, Phil. Trans. R. Soc. A 210 (1911); P. J. Roache, J. Fluids Eng. 116 (1994), grid
///          convergence index with factor 1.25; unequal ratios as in I. B. Celik et al., J. Fluids Eng. 130 (2008)
[[nodiscard]] Expected<Extrapolation> extrapolate(const std::array<double, 3> &h,
                                                  const std::array<std::vector<double>, 3> &f,
                                                  const std::vector<double> &weights);

}  // namespace c3de::study
