// SPDX-License-Identifier: Apache-2.0
#include "c3de/tracking/tracking_address.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "c3de/core/text.h"

namespace c3de::tracking {

Expected<TrackingAddress> parseTrackingAddress(const std::string &text) {
  const auto refuse = [&](const std::string &what) {
    return fail(ErrorCode::usage, fmt::format("'{}': {}; accepted: HOST or HOST:PORT, for example localhost:18944",
                                              displayText(text), what));
  };
  TrackingAddress out;
  const std::size_t colon = text.find(':');
  out.host = text.substr(0, colon);
  const auto isPart = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' || c == '-' ||
           c == '_';
  };
  if (out.host.empty() || out.host.size() > 253) return refuse("there is no host");
  if (!std::all_of(out.host.begin(), out.host.end(), isPart))
    return refuse("a host consists of letters, digits, '.', '-' and '_'");
  if (colon == std::string::npos) return out;
  const std::string port = text.substr(colon + 1);
  unsigned number = 0;
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), number);
  if (error != std::errc() || end != port.data() + port.size() || number < 1 || number > 65535)
    return refuse(fmt::format("the port is '{}'; a port is a number from 1 to 65535", displayText(port)));
  out.port = static_cast<std::uint16_t>(number);
  return out;
}

std::string textOf(const TrackingAddress &address) { return fmt::format("{}:{}", address.host, address.port); }

}  // namespace c3de::tracking
