// SPDX-License-Identifier: Apache-2.0
// What holds a body, as rows of the panel.
#pragma once

#include "c3de/sdk/panel.hpp"
#include "simulator/snapshot.h"

namespace pointbased {

/// Lists the supports of the scene, the surroundings, attachments and what the body touches. A line states it if there
/// is no support or attachment, those set by hand included.
void drawHolds(sdk::Ui &ui, const Snapshot &snapshot, const BodySnapshot &body);

}  // namespace pointbased
