// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/sdk/panel.hpp"
#include "simulator/snapshot.h"

namespace pointbased {

/// The three lines of AccuracyStatement.
void drawAccuracyStatement(sdk::Ui &ui, const BodySnapshot &body);
/// Bars: the used part of the error target, the present time of a frame against the promised one, and the uncertainty
/// that remains from the tissue's own stiffness.
void drawAccuracyBars(sdk::Ui &ui, const BodySnapshot &body);

}  // namespace pointbased
