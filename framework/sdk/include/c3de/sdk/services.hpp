// SPDX-License-Identifier: Apache-2.0
// Typed wrappers of the host's services. Each is a value over a table that may be absent: test it with `if (service)`.
// Calls on an absent service answer C3DE_E_UNSUPPORTED. Threads are those of the table's functions.
#pragma once

#include "c3de/sdk/services/geometry.hpp"
#include "c3de/sdk/services/history.hpp"
#include "c3de/sdk/services/imaging.hpp"
#include "c3de/sdk/services/jobs.hpp"
#include "c3de/sdk/services/log.hpp"
#include "c3de/sdk/services/registry.hpp"
#include "c3de/sdk/services/scene.hpp"
#include "c3de/sdk/services/simulation.hpp"
#include "c3de/sdk/services/time.hpp"
