// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/body.h"

namespace pointbased {

struct PinchSettings {
  double frequency_hz = 25.0;  ///< of the spring on the mass it holds
  double dampingRatio = 1.0;
  double radius_mm = 18.0;  ///< of the patch around the surfel; at least two spacings are taken
};

/// A hold on a surfel: the phyxels within the radius of it, all measured at rest, weighted towards the middle (the
/// surfel's own ones when none is so near), and a spring that strains them by several hundred per cent at most. The
/// target is for the caller to set.
[[nodiscard]] Grab grabAround(const RestState &rest, std::size_t surfel, const PinchSettings &settings,
                              double youngsModulus);

}  // namespace pointbased
