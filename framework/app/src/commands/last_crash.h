// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "app.h"
#include "c3de/core/crash_journal.h"
#include "c3de/session/session.h"

namespace c3de::app {

/// Reports how earlier runs crashed, stores this in the records of plugins, and begins the journal of this run. Called
/// before the first plugin is loaded. Empty if no journal is possible, which is logged.
[[nodiscard]] std::optional<CrashJournal> beginJournal(const SessionOptions &options);

}  // namespace c3de::app
