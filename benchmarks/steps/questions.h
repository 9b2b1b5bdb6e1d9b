// SPDX-License-Identifier: Apache-2.0
// The cost of contact between skins, one thread.
#pragma once

#include "bench/report.h"

namespace bench {

/// Four balls, first apart, then falling on each other and resting: contact and forces per step.
void measureBalls(const Options &options, Report &report);

/// A slab bent over itself, of 2 000 to 100 000 vertices in self-contact: a step while the list of near pairs is valid,
/// and building the list.
void measureSheet(const Options &options, Report &report);

/// Two blocks: a sixtieth of a second in explicit and in implicit steps, pressed together and apart. For explicit steps
/// also per pressing vertex and substep, next to the value that the cost model assumes (MachineSpeed::touch_ns).
void measurePressed(const Options &options, Report &report);

}  // namespace bench
