// SPDX-License-Identifier: Apache-2.0
// Overlap of bodies with an obstacle. The mutex of SimulatedWorld is held.
#pragma once

#include "simulator/body_table.h"

namespace pointbased {

/// m³ of tissue whose reference position is inside the present obstacle of the table. Sums the volumes of evaluation
/// points; at the surface, the fraction of the cell that is inside.
[[nodiscard]] double displacedVolume(const Simulator &simulator, const BodyTable &table, std::uint64_t obstacle);

/// Whether skin is inside an obstacle of the table that has just been added. Contact would push part of it out on the
/// wrong side.
[[nodiscard]] bool containsSkin(Simulator &simulator, const BodyTable &table, std::uint64_t obstacle);

}  // namespace pointbased
