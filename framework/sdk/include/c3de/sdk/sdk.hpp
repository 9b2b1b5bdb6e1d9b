// SPDX-License-Identifier: Apache-2.0
// The whole SDK. C++20 over the C tables, compiled into the plugin; nothing of it crosses the boundary.
#pragma once

#include "c3de/sdk/commands.hpp"
#include "c3de/sdk/files.hpp"
#include "c3de/sdk/object.hpp"
#include "c3de/sdk/panel.hpp"
#include "c3de/sdk/params.hpp"
#include "c3de/sdk/plugin.hpp"
#include "c3de/sdk/running_simulator.hpp"
#include "c3de/sdk/scene_record.hpp"
#include "c3de/sdk/services.hpp"
#include "c3de/sdk/simulator.hpp"
#include "c3de/sdk/structs.hpp"
#include "c3de/sdk/tool.hpp"
