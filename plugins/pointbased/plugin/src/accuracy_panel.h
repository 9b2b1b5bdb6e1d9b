// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/sdk/panel.hpp"
#include "snapshot.h"

namespace pointbased {

/// Three bars: the error that is expected against the one that is wished, the time of a frame now against the one that
/// was promised, and how much the tissue's own stiffness leaves open.
void drawAccuracyBars(sdk::Ui &ui, const BodySnapshot &body);

}  // namespace pointbased
