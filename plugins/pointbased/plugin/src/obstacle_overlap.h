// SPDX-License-Identifier: Apache-2.0
// What of the bodies is where an obstacle is. The mutex of WorldSimulator is held.
#pragma once

#include "body_table.h"

namespace pointbased {

/// m³, of tissue that lay in the reference where an obstacle of the table is now: evaluation points with their
/// volumes, at its surface by the part of a cell that is in it.
[[nodiscard]] double displacedVolume(const Simulator &simulator, const BodyTable &table, std::uint64_t obstacle);

/// Whether skin lies in an obstacle of the table that has just come: contact would lead some of it out to the wrong
/// side.
[[nodiscard]] bool holdsSkin(Simulator &simulator, const BodyTable &table, std::uint64_t obstacle);

}  // namespace pointbased
