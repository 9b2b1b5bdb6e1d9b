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

/// Records of earlier runs about plugins: which are switched off, which have crashed a run, and the result of the first
/// use of each file. Two small files; if two programs write at the same time, the later one wins. Any thread.
class PluginRecords {
 public:
  /// @param choices  folder of the user's choices; @param cache  folder of what can be determined again
  PluginRecords(const std::filesystem::path &choices, const std::filesystem::path &cache);
  ~PluginRecords();

  [[nodiscard]] bool isOff(const std::string &id) const;
  [[nodiscard]] std::vector<std::string> allOff() const;
  /// ErrorCode::output: the setting applies to this run only.
  [[nodiscard]] Expected<void> setOff(const std::string &id, bool isOff);

  struct Crash {
    std::string id;
    unsigned count = 0;      ///< number of runs it has crashed
    std::string cause;       ///< of the last crash, as of CrashRecord
    bool isAnswered = true;  ///< the user has decided about the last crash
  };
  /// A record without a plugin is not stored.
  void noteCrash(const CrashRecord &record);
  void answerCrash(const std::string &id);
  [[nodiscard]] std::vector<Crash> crashes() const;

  struct FirstUse {
    std::string reason;  ///< why it cannot be used; empty: it can
  };
  /// Result of the first use of a file, in a process of `program`; empty: unknown, or one of them has changed since.
  [[nodiscard]] std::optional<FirstUse> firstUseOf(const std::filesystem::path &file,
                                                   const std::filesystem::path &program, bool hasWindow) const;
  void keepFirstUse(const std::filesystem::path &file, const std::filesystem::path &program, bool hasWindow,
                    const FirstUse &use);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The records of the present user.
[[nodiscard]] std::shared_ptr<PluginRecords> recordsOfUser();
/// Journal folder of the user's crashed runs.
[[nodiscard]] std::filesystem::path crashJournalFolder();

}  // namespace c3de::plugin_host
