// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/crash_journal.h"
#include "c3de/core/expected.h"

namespace c3de::plugin_host {

/// What earlier runs have left about plugins: which are switched off, which have ended a run, and how the first use of
/// each file went. Two small files; of two programs that write at the same time the later one wins. Any thread.
class PluginRecords {
 public:
  /// @param choices  folder of what people have chosen; @param cache  of what can be found out again
  PluginRecords(const std::filesystem::path &choices, const std::filesystem::path &cache);
  ~PluginRecords();

  [[nodiscard]] bool isOff(const std::string &id) const;
  [[nodiscard]] std::vector<std::string> allOff() const;
  /// ErrorCode::output: it holds for this run only.
  [[nodiscard]] Expected<void> setOff(const std::string &id, bool isOff);

  struct Crash {
    std::string id;
    unsigned count = 0;      ///< runs that it has ended
    std::string cause;       ///< of the last one, as of CrashRecord
    bool isAnswered = true;  ///< somebody has chosen what to do about the last one
  };
  /// A record that names nobody is not kept.
  void noteCrash(const CrashRecord &record);
  void answerCrash(const std::string &id);
  [[nodiscard]] std::vector<Crash> crashes() const;

  struct FirstUse {
    std::string reason;  ///< why it cannot be used; empty: it can
  };
  /// How the first use of a file went, in a process of `program`; empty: not known, or one of them has changed since.
  [[nodiscard]] std::optional<FirstUse> firstUseOf(const std::filesystem::path &file,
                                                   const std::filesystem::path &program, bool hasWindow) const;
  void keepFirstUse(const std::filesystem::path &file, const std::filesystem::path &program, bool hasWindow,
                    const FirstUse &use);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Where the program keeps them for the present user.
[[nodiscard]] std::shared_ptr<PluginRecords> recordsOfUser();
/// Of the user's runs that have died.
[[nodiscard]] std::filesystem::path crashJournalFolder();

}  // namespace c3de::plugin_host
