// SPDX-License-Identifier: Apache-2.0
#include "commands/last_crash.h"

#include <fmt/format.h>

#include "c3de/core/log.h"
#include "c3de/plugin_host/plugin_records.h"

namespace c3de::app {

std::optional<CrashJournal> beginJournal(const SessionOptions &options) {
  const std::filesystem::path folder = plugin_host::crashJournalFolder();
  for (const CrashRecord &record : CrashJournal::popCrashRecords(folder)) {
    std::string line = "the last run " + record.cause();
    if (!record.owner.empty())
      line += fmt::format("; to go on without it: --without {}; with the program's own plugins alone: --safe-mode",
                          record.owner);
    log(LogLevel::warn, line);
    if (options.loadRules.records) options.loadRules.records->noteCrash(record);
  }
  auto journal = CrashJournal::begin(folder);
  if (journal) return std::move(*journal);
  log(LogLevel::warn, journal.error().message);
  return {};
}

}  // namespace c3de::app
