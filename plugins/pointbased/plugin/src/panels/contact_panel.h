// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/sdk/panel.hpp"
#include "tools/grasp_tool.h"
#include "tools/move_tool.h"
#include "tools/touch_tool.h"

namespace pointbased {

/// Contacts and attachments with their magnitudes: one line for each pair.
void drawContacts(sdk::Ui &ui, const Snapshot &snapshot);

/// The instrument: its size, its position and the forces on it.
void drawTouch(sdk::Ui &ui, TouchTool &touch, const Snapshot *snapshot);

/// The jaws: their size, how far they close, and the forces they exert.
void drawGrasp(sdk::Ui &ui, GraspTool &grasp, const Snapshot *snapshot);

/// Obstacles and implants: which one, its position, its orientation, what touches it.
void drawPlacement(sdk::Ui &ui, MoveTool &move, const Snapshot *snapshot);

}  // namespace pointbased
