// SPDX-License-Identifier: Apache-2.0
#include "last_error.h"

#include <array>
#include <utility>

#include "c3de/core/per_thread.h"

namespace c3de::plugin_host {
namespace {

// Per thread and not per host: a failed call and the query for its error come from the same thread, one after the
// other.
PluginError &lastError() { return perThread<PluginError>(); }
thread_local bool callbackFailed = false;

}  // namespace

bool exchangeCallbackFailed(bool value) noexcept { return std::exchange(callbackFailed, value); }

void setLastError(std::string_view text) noexcept {
  try {
    lastError() = {std::string(text), {}, 0, {}};
  } catch (...) {
    lastError() = {};
  }
}

void setLastError(PluginError error) noexcept { lastError() = std::move(error); }

PluginError takeLastErrorAt() noexcept { return std::exchange(lastError(), PluginError()); }

std::string takeLastError() noexcept {
  try {
    return describe(takeLastErrorAt());
  } catch (...) {
    return {};
  }
}

std::string describe(const PluginError &error) {
  const std::string table = error.table.empty() ? "" : error.table + " " + std::to_string(error.index) + ": ";
  return table + (error.key.empty() ? "" : error.key + ": ") + error.text;
}

std::string statusName(c3de_status status) {
  static constexpr std::array kNames{"C3DE_OK",          "C3DE_E_ARG",       "C3DE_E_VERSION",  "C3DE_E_UNSUPPORTED",
                                     "C3DE_E_EXISTS",    "C3DE_E_NOT_FOUND", "C3DE_E_STALE",    "C3DE_E_STATE",
                                     "C3DE_E_THREAD",    "C3DE_E_NOMEM",     "C3DE_E_IO",       "C3DE_E_FORMAT",
                                     "C3DE_E_CANCELLED", "C3DE_E_TIMEOUT",   "C3DE_E_DIVERGED", "C3DE_E_GPU",
                                     "C3DE_E_EXCEPTION", "C3DE_E_INTERNAL"};
  const auto index = static_cast<std::int64_t>(status) * -1;
  if (index >= 0 && index < static_cast<std::int64_t>(kNames.size())) return kNames[static_cast<std::size_t>(index)];
  return "status " + std::to_string(status);
}

}  // namespace c3de::plugin_host
