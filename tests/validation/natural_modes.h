// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "pointbased/body.h"

namespace validation {

struct Mode {
  double frequency = 0.0;  ///< Hz
  double control = 0.0;    ///< fraction of its elastic energy in the control of zero-energy modes, 0 … 1
  /// A motion of single cells against each other, not of the continuum.
  [[nodiscard]] bool rattles() const { return control > 0.5; }
};

/// Lowest natural modes of a body at rest, ascending; rigid motions of a free body are near zero.
///
/// K from stiffnessTriplets() and the held patches, M the phyxels' masses; held phyxels are left out. Subspace
/// iteration on (K + s M)^-1 M with a small shift s > 0, so that a free body can be factorised.
/// @param count  wanted
[[nodiscard]] std::vector<Mode> naturalModes(pointbased::Body &body, int count);

/// Frequency of the mode that is shaped like `shape`, Hz: one step of inverse iteration from it and Rayleigh's
/// quotient. For known shapes, however many rattling modes are below.
/// @param shape  displacement at a material point, frame of the phyxels; free bodies: orthogonal to rigid motions
[[nodiscard]] double frequencyOfShape(pointbased::Body &body,
                                      const std::function<pointbased::Vec3(const pointbased::Vec3 &)> &shape);

}  // namespace validation
