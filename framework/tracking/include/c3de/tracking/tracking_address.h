// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "c3de/core/expected.h"

namespace c3de::tracking {

/// Where an OpenIGTLink server listens.
struct TrackingAddress {
  std::string host;            ///< name or IPv4 address
  std::uint16_t port = 18944;  ///< the port registered for OpenIGTLink
};

/// From "HOST" or "HOST:PORT". Errors (ErrorCode::usage) state the text and what is accepted.
[[nodiscard]] Expected<TrackingAddress> parseTrackingAddress(const std::string &text);
/// "HOST:PORT".
[[nodiscard]] std::string textOf(const TrackingAddress &address);

}  // namespace c3de::tracking
