// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "app.h"
#include "c3de/core/crash_journal.h"
#include "c3de/session/session.h"

namespace c3de::app {

/// Says what earlier runs died of, keeps it in the records of plugins, and begins the journal of this run: before the
/// first plugin is loaded. Empty: there can be none, which the log says.
[[nodiscard]] std::optional<CrashJournal> beginJournal(const SessionOptions &options);

}  // namespace c3de::app
