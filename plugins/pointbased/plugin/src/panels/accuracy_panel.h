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
/// The accuracy target, if it is not one in mm: the simple mode has no row for it.
void drawOtherTarget(sdk::Ui &ui, const ParameterValues &world);
/// Why the accuracy target is not met, if it is not.
void drawUnmetTarget(sdk::Ui &ui, const BodySnapshot &body);

}  // namespace pointbased
