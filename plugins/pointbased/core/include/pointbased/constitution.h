// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/material.h"
#include "pointbased/types.h"
#include "pointbased/viscoelasticity.h"

namespace pointbased {

/// Materials of a body.
struct Constitution {
  std::vector<Material> materials{Material{}};  ///< by StencilSet::materials; at least one
  /// Stabilisation of the modes that one evaluation per point does not resolve: kLatticeStabilisation on lattices,
  /// kCloudStabilisation for clouds.
  double stabilisation = 0.0;

  [[nodiscard]] bool viscous() const;   ///< any viscosity > 0
  [[nodiscard]] bool relaxing() const;  ///< any Prony term
  [[nodiscard]] bool plastic() const;   ///< any enabled plasticity
  /// Last error of its external laws, which is cleared; empty: none.
  [[nodiscard]] std::string consumeError() const;
  [[nodiscard]] bool hasHistory() const { return relaxing() || plastic(); }
};

/// History variables of the points of a body. A vector is empty if no material needs it; then its stage is skipped.
struct PointHistory {
  std::vector<Mat3> plasticInverse;  ///< [points] F_p^-1, det 1, since the reference was created
  std::vector<Mat3> plasticBefore;   ///< [points] F_p^-1 of the flow before that; empty: the reference is the first one
  std::vector<PronyPoint> prony;     ///< [points]
  std::vector<HourglassHistory> modes;  ///< [points] of lattices; empty: modes do not relax

  /// Resets it to the initial values and the size for a constitution.
  /// @param hourglass  whether the points have modes (StencilSet::modes)
  void reset(const Constitution &constitution, std::size_t points, bool hourglass = false);

  /// F_p^-1 of the total flow; with plasticity only.
  [[nodiscard]] Mat3 allFlow(std::size_t q) const {
    return plasticBefore.empty() ? plasticInverse[q] : Mat3(plasticBefore[q] * plasticInverse[q]);
  }
};

}  // namespace pointbased
