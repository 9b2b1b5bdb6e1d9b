// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/core/foreign_call.h"
#include "c3de/plugin_host/plugin_host.h"

namespace c3de::plugin_host {

/// Says that a call of a plugin does not return, or has at last: in the log; and in the window where it can be drawn,
/// with the choice to stop the simulation or cancel the job. The watchdog's thread.
void tellLongCall(const Services &services, const LongCall &call);

}  // namespace c3de::plugin_host
