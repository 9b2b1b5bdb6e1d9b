// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "c3de/abi/iface/simulator.h"
#include "pointbased/body.h"

namespace pointbased {

/// The fields of iface.simulator: positions, velocities, masses and volumes of phyxels, deformation gradient F, Green
/// strain, second Piola-Kirchhoff stress and von Mises stress (of the Cauchy stress F S Fᵀ / det F; 0 where the point is
/// inverted), and the positions and normals of surfels.
[[nodiscard]] std::span<const c3de_sim_field> bodyFields();

/// Copies a field into room for all its rows. Errors as sdk::Error: no such field (names what there is), no room.
void readBodyField(const Body &body, std::uint32_t on, std::string_view name, const c3de_mview &out);

/// Those of contact, which the simulator knows and a body does not: the contact pressure at phyxels and at surfels.
[[nodiscard]] std::span<const c3de_sim_field> contactFields();
[[nodiscard]] bool isContactField(std::uint32_t on, std::string_view name);
/// Copies pressures, Pa, that are known at phyxels into room for all rows of a contact field. Errors as sdk::Error: no
/// room.
void writeContactPressures(const Body &body, std::uint32_t on, const std::vector<double> &pressures,
                           const ParallelFor &parallelFor, const c3de_mview &out);

}  // namespace pointbased
