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
/// strain, second Piola-Kirchhoff stress and von Mises stress, and the positions and normals of surfels. The von Mises
/// stress is that of the Cauchy stress F S Fᵀ / det F; it is 0 where the point is inverted.
[[nodiscard]] std::span<const c3de_sim_field> bodyFields();

/// Copies a field into a buffer that holds all its rows. Throws sdk::Error if there is no such field (lists the
/// existing ones) or if the buffer is too small.
void readBodyField(const Body &body, std::uint32_t on, std::string_view name, const c3de_mview &out);

/// Contact fields, which only the simulator can provide: the contact pressure at phyxels and at surfels.
[[nodiscard]] std::span<const c3de_sim_field> contactFields();
[[nodiscard]] bool isContactField(std::uint32_t on, std::string_view name);
/// Copies pressures, Pa, that are defined at phyxels into a buffer for all rows of a contact field. Throws sdk::Error
/// if the buffer is too small.
void writeContactPressures(const Body &body, std::uint32_t on, const std::vector<double> &pressures,
                           const ParallelFor &parallelFor, const c3de_mview &out);

}  // namespace pointbased
