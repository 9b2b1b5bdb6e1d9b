// SPDX-License-Identifier: Apache-2.0
// Messages for the log.
#pragma once

#include <string_view>

#include "c3de/sdk/services/service.hpp"

namespace c3de::sdk {

class Log : public Service<c3de_log_v1> {
 public:
  using Service::Service;
  void debug(std::string_view message) const noexcept { write(C3DE_LOG_DEBUG, message); }
  void info(std::string_view message) const noexcept { write(C3DE_LOG_INFO, message); }
  void warn(std::string_view message) const noexcept { write(C3DE_LOG_WARN, message); }
  void error(std::string_view message) const noexcept { write(C3DE_LOG_ERROR, message); }
  void write(std::uint32_t severity, std::string_view message) const noexcept {
    if (table_) table_->write(table_->ctx, severity, str(message));
  }
};

}  // namespace c3de::sdk
