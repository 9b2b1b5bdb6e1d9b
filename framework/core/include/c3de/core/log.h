// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace c3de {

enum class LogLevel { debug, info, warn, error };

/// Writes one line to stderr as `c3de: LEVEL: message` if the level is at or above the threshold. Any thread.
void log(LogLevel level, std::string_view message);
void setLogThreshold(LogLevel level);

/// Additionally receives every line, whatever the threshold; called on the logging thread. Empty: none.
void setLogListener(std::function<void(LogLevel, const std::string &)> listener);

}  // namespace c3de
