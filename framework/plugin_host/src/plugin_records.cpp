// SPDX-License-Identifier: Apache-2.0
#include "c3de/plugin_host/plugin_records.h"

#include <fmt/format.h>

#include <charconv>

#include "c3de/core/log.h"
#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"
#include "c3de/registry/settings_store.h"

namespace c3de::plugin_host {
namespace {

// Names of the files.
constexpr const char *kChoices = "plugins", *kFirstUses = "first-uses";
// Prefixes of the keys; the rest is the id.
constexpr std::string_view kOff = "off ", kCrash = "crash ";
constexpr char kSeparator = '\n';

/// Identifies one state of a file.
std::string stateOf(const std::filesystem::path &file) {
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  const auto time = std::filesystem::last_write_time(file, error);
  return error ? std::string() : fmt::format("{} {}", size, time.time_since_epoch().count());
}

/// Changes with the file and with the program that would load it.
std::string stampOf(const std::filesystem::path &file, const std::filesystem::path &program) {
  return stateOf(file) + " " C3DE_VERSION " " + stateOf(program);
}

std::string keyOf(const std::filesystem::path &file, bool hasWindow) {
  return (hasWindow ? "in a window " : "") + pathText(file);
}

/// The parts before each of the first `n` separators, and the rest.
std::vector<std::string> split(const std::string &text, std::size_t n) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  while (parts.size() < n) {
    const std::size_t end = text.find(kSeparator, begin);
    if (end == std::string::npos) return {};
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  parts.push_back(text.substr(begin));
  return parts;
}

}  // namespace

struct PluginRecords::Impl {
  Impl(const std::filesystem::path &choicesFolder, const std::filesystem::path &cacheFolder)
      : choices(choicesFolder), cache(cacheFolder) {}
  registry::SettingsStore choices, cache;

  [[nodiscard]] std::vector<std::string> idsWith(std::string_view beginning) {
    std::vector<std::string> ids;
    for (const std::string &key : choices.keys(kChoices))
      if (key.starts_with(beginning)) ids.push_back(key.substr(beginning.size()));
    return ids;
  }
  [[nodiscard]] Crash crashOf(const std::string &id) {
    Crash crash{id, 0, {}, true};
    const auto parts = split(choices.get(kChoices, std::string(kCrash) + id).value_or(""), 2);
    if (parts.size() != 3) return crash;
    std::from_chars(parts[0].data(), parts[0].data() + parts[0].size(), crash.count);
    crash.isAnswered = parts[1] != "new";
    crash.cause = parts[2];
    return crash;
  }
  void keep(const Crash &crash) {
    const auto kept = choices.set(
        kChoices, std::string(kCrash) + crash.id,
        fmt::format("{}{}{}{}{}", crash.count, kSeparator, crash.isAnswered ? "told" : "new", kSeparator, crash.cause));
    if (!kept) log(LogLevel::warn, kept.error().message);
  }
};

PluginRecords::PluginRecords(const std::filesystem::path &choices, const std::filesystem::path &cache)
    : impl_(std::make_unique<Impl>(choices, cache)) {}

PluginRecords::~PluginRecords() = default;

bool PluginRecords::isOff(const std::string &id) const {
  return impl_->choices.get(kChoices, std::string(kOff) + id).has_value();
}

std::vector<std::string> PluginRecords::allOff() const { return impl_->idsWith(kOff); }

Expected<void> PluginRecords::setOff(const std::string &id, bool isOff) {
  const std::string key = std::string(kOff) + id;
  if (isOff) return impl_->choices.set(kChoices, key, "");
  if (const auto removed = impl_->choices.remove(kChoices, key); !removed) return tl::unexpected(removed.error());
  return {};
}

void PluginRecords::noteCrash(const CrashRecord &record) {
  if (record.owner.empty()) return;
  Crash crash = impl_->crashOf(record.owner);
  ++crash.count;
  crash.isAnswered = false;
  crash.cause = record.cause();
  impl_->keep(crash);
}

void PluginRecords::answerCrash(const std::string &id) {
  Crash crash = impl_->crashOf(id);
  if (crash.isAnswered) return;
  crash.isAnswered = true;
  impl_->keep(crash);
}

std::vector<PluginRecords::Crash> PluginRecords::crashes() const {
  std::vector<Crash> all;
  for (const std::string &id : impl_->idsWith(kCrash)) all.push_back(impl_->crashOf(id));
  return all;
}

std::optional<PluginRecords::FirstUse> PluginRecords::firstUseOf(const std::filesystem::path &file,
                                                                 const std::filesystem::path &program,
                                                                 bool hasWindow) const {
  const auto parts = split(impl_->cache.get(kFirstUses, keyOf(file, hasWindow)).value_or(""), 1);
  if (parts.size() != 2 || parts[0] != stampOf(file, program)) return {};
  return FirstUse{parts[1]};
}

void PluginRecords::keepFirstUse(const std::filesystem::path &file, const std::filesystem::path &program,
                                 bool hasWindow, const FirstUse &use) {
  const auto kept =
      impl_->cache.set(kFirstUses, keyOf(file, hasWindow), stampOf(file, program) + kSeparator + use.reason);
  if (!kept) log(LogLevel::debug, kept.error().message);
}

std::shared_ptr<PluginRecords> recordsOfUser() {
  return std::make_shared<PluginRecords>(userConfigDirectory(), userCacheDirectory());
}

std::filesystem::path crashJournalFolder() { return userCacheDirectory() / "runs"; }

}  // namespace c3de::plugin_host
