// SPDX-License-Identifier: Apache-2.0
#include "last_error.h"

#include <array>
#include <utility>

namespace c3de::plugin_host {
namespace {

// Per thread and not per host: a failing call and the question why come from the same thread, one after the other.
thread_local std::string lastError;

}  // namespace

void setLastError(std::string_view text) noexcept {
  try {
    lastError.assign(text);
  } catch (...) {
    lastError.clear();
  }
}

std::string takeLastError() noexcept { return std::exchange(lastError, std::string()); }

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
