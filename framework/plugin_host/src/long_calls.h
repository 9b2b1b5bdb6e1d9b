// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/core/plugin_call.h"
#include "c3de/plugin_host/plugin_host.h"

namespace c3de::plugin_host {

/// Reports that a call of a plugin does not return, or has finally returned: in the log, and in the window if it can be
/// drawn. There the user can stop the simulation or cancel the job. Runs on the watchdog's thread.
void reportLongCall(const Services &services, const LongCall &call);

}  // namespace c3de::plugin_host
