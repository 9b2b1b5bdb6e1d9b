// SPDX-License-Identifier: Apache-2.0
#include "c3de/registry/settings_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "c3de/core/input_file.h"
#include "c3de/core/log.h"
#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"

namespace c3de::registry {

std::filesystem::path SettingsStore::fileOf(const std::string &plugin) const {
  std::string name = plugin;
  // Ids consist of letters, digits and . _ - / characters; a file name has no slash, and may not begin with a dot.
  std::replace(name.begin(), name.end(), '/', '+');
  if (name.starts_with('.')) name.insert(0, 1, '+');
  return folder_ / (name + ".json");
}

SettingsStore::Values &SettingsStore::valuesOf(const std::string &plugin) {
  const auto [at, isNew] = plugins_.try_emplace(plugin);
  if (!isNew) return at->second;
  Values &values = at->second;
  if (folder_.empty()) return values;
  const std::filesystem::path file = fileOf(plugin);
  std::error_code code;
  if (!std::filesystem::exists(file, code)) return values;
  auto in = openInputFile(file);
  const std::string bytes = in ? std::string(std::istreambuf_iterator<char>(*in), {}) : std::string();
  const nlohmann::json json = nlohmann::json::parse(bytes, nullptr, false);
  const bool isWhole = json.is_object() && json.size() <= kMaxKeys &&
                       std::all_of(json.begin(), json.end(), [](const auto &value) { return value.is_string(); });
  if (!isWhole) {
    values.isDamaged = true;
    log(LogLevel::warn, fmt::format("{}: is damaged and ignored; it is renamed to {}.damaged at the next change",
                                    pathText(file), pathText(file.filename())));
    return values;
  }
  for (const auto &[key, value] : json.items()) values.byKey[key] = value.get<std::string>();
  return values;
}

Expected<void> SettingsStore::write(const std::string &plugin, Values &values) {
  if (folder_.empty()) return {};
  const std::filesystem::path file = fileOf(plugin);
  std::error_code code;
  std::filesystem::create_directories(folder_, code);
  if (code)
    return fail(ErrorCode::output, fmt::format("{}: the folder cannot be made: {}", pathText(folder_), code.message()));
  if (values.isDamaged) {
    std::filesystem::rename(file, file.string() + ".damaged", code);
    if (code)
      return fail(ErrorCode::output,
                  fmt::format("{}: is damaged and cannot be put aside: {}", pathText(file), code.message()));
    values.isDamaged = false;
  }
  const nlohmann::json json(values.byKey);
  return writeWholeFile(file, json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

std::optional<std::string> SettingsStore::get(const std::string &plugin, const std::string &key) {
  const std::lock_guard lock(mutex_);
  const Values &values = valuesOf(plugin);
  const auto found = values.byKey.find(key);
  return found == values.byKey.end() ? std::nullopt : std::optional(found->second);
}

Expected<void> SettingsStore::set(const std::string &plugin, const std::string &key, const std::string &value) {
  const std::lock_guard lock(mutex_);
  Values &values = valuesOf(plugin);
  if (value.size() > kLongestValue)
    return fail(ErrorCode::usage, fmt::format("the value of '{}' has {} bytes, accepted are at most {}", key,
                                              value.size(), kLongestValue));
  if (!values.byKey.contains(key) && values.byKey.size() >= kMaxKeys)
    return fail(ErrorCode::usage,
                fmt::format("'{}' would be key {}, accepted are at most {}", key, values.byKey.size() + 1, kMaxKeys));
  values.byKey[key] = value;
  return write(plugin, values);
}

Expected<bool> SettingsStore::remove(const std::string &plugin, const std::string &key) {
  const std::lock_guard lock(mutex_);
  Values &values = valuesOf(plugin);
  if (values.byKey.erase(key) == 0) return false;
  if (const auto written = write(plugin, values); !written) return tl::unexpected(written.error());
  return true;
}

std::vector<std::string> SettingsStore::keys(const std::string &plugin) {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> all;
  for (const auto &[key, value] : valuesOf(plugin).byKey) all.push_back(key);
  return all;
}

namespace {

// Per process, like the log level: a process is a trial or it is not.
std::atomic<bool> isInMemory{false};

}  // namespace

void keepSettingsInMemory() { isInMemory = true; }

std::filesystem::path defaultSettingsFolder() {
  return isInMemory ? std::filesystem::path() : userConfigDirectory() / "settings";
}

}  // namespace c3de::registry
