// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/material.h"
#include "pointbased/types.h"
#include "pointbased/viscoelasticity.h"

namespace pointbased {

/// What a body is made of.
struct Constitution {
  std::vector<Material> materials{Material{}};  ///< by StencilSet::materials; at least one
  /// Stabilisation of the modes that one evaluation per point cannot see: kLatticeStabilisation on lattices,
  /// kCloudStabilisation for clouds.
  double stabilisation = 0.0;

  [[nodiscard]] bool viscous() const;   ///< any viscosity > 0
  [[nodiscard]] bool relaxing() const;  ///< any Prony term
  [[nodiscard]] bool plastic() const;   ///< any enabled plasticity
  /// What its laws from outside have last failed at, and forgets it; empty: nothing.
  [[nodiscard]] std::string takeComplaint() const;
  [[nodiscard]] bool remembers() const { return relaxing() || plastic(); }
};

/// What the points of a body remember. A vector is empty where no material needs it, and then its stage does not run.
struct PointHistory {
  std::vector<Mat3> plasticInverse;  ///< [points] F_p^-1, det 1, since the reference was made
  std::vector<Mat3> plasticBefore;   ///< [points] F_p^-1 of the flow before that; empty: the reference is the first one
  std::vector<PronyPoint> prony;     ///< [points]
  std::vector<HourglassHistory> modes;  ///< [points] of lattices; empty: modes do not relax

  /// Fresh and of the right size for a constitution.
  /// @param hourglass  whether the points have modes (StencilSet::modes)
  void reset(const Constitution &constitution, std::size_t points, bool hourglass = false);

  /// F_p^-1 of all flow; with plasticity only.
  [[nodiscard]] Mat3 allFlow(std::size_t q) const {
    return plasticBefore.empty() ? plasticInverse[q] : Mat3(plasticBefore[q] * plasticInverse[q]);
  }
};

}  // namespace pointbased
