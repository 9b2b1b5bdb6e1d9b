// SPDX-License-Identifier: Apache-2.0
// Units of length at the ABI boundary.
#pragma once

#include <fmt/format.h>

#include <optional>

#include "c3de/abi/mesh.h"
#include "c3de/geometry/mesh_io.h"
#include "refusal.h"

namespace c3de::plugin_host {

/// None: not specified. Throws Refusal for a number that is no unit.
[[nodiscard]] inline std::optional<geometry::LengthUnit> unitOf(std::uint32_t unit) {
  switch (unit) {
    case C3DE_UNIT_UNKNOWN: return std::nullopt;
    case C3DE_UNIT_M: return geometry::LengthUnit::metre;
    case C3DE_UNIT_MM: return geometry::LengthUnit::millimetre;
    case C3DE_UNIT_CM: return geometry::LengthUnit::centimetre;
    default:
      throw Refusal(C3DE_E_ARG,
                    fmt::format("unit is {}, accepted: 0 (as the file states), 1 (m), 2 (mm), 3 (cm)", unit));
  }
}

}  // namespace c3de::plugin_host
