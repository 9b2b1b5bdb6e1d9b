// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/sdk/panel.hpp"
#include "snapshot.h"

namespace pointbased {

/// The three lines of AccuracyStatement.
void drawAccuracyStatement(sdk::Ui &ui, const BodySnapshot &body);
/// Bars: how much of a wished error is used, the time of a frame now against the one that was promised, and how much
/// the tissue's own stiffness leaves open.
void drawAccuracyBars(sdk::Ui &ui, const BodySnapshot &body);

}  // namespace pointbased
