// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/sdk/panel.hpp"
#include "grasp_tool.h"
#include "move_tool.h"
#include "touch_tool.h"

namespace pointbased {

/// What touches and is attached, and by how much: a line for each pair.
void drawContacts(sdk::Ui &ui, const Snapshot &snapshot);

/// The instrument: its size, where it is, and what it feels.
void drawTouch(sdk::Ui &ui, TouchTool &touch, const Snapshot *snapshot);

/// The jaws: their size, how far they close, and what they do.
void drawGrasp(sdk::Ui &ui, GraspTool &grasp, const Snapshot *snapshot);

/// Obstacles and implants: which one, where it is, how it is turned, what touches it.
void drawPlacement(sdk::Ui &ui, MoveTool &move, const Snapshot *snapshot);

}  // namespace pointbased
