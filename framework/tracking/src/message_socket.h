// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/imaging/volume.h"
#include "c3de/tracking/tracking_link.h"

namespace c3de::tracking {

using Bytes = std::vector<std::byte>;

inline constexpr std::size_t kNameLength = 20;  ///< bytes of a device in a message

enum class Received {
  nothing,
  frame,  ///< the points of a POINT message
  tip,    ///< the position of a tool's tip, of a TRANSFORM or POSITION message, as the only point
  skipped,
  refused
};

/// A connected socket with OpenIGTLink messages. One thread at a time. Without the library OpenIGTLink there is none.
class MessageSocket {
 public:
  static bool isAvailable();
  /// Waits for the operating system, which may take minutes where no machine answers. Null: it is not connected.
  static std::unique_ptr<MessageSocket> connectTo(const TrackingAddress &address);
  virtual ~MessageSocket() = default;
  /// Waits up to kWait_ms for a message. Errors (input): why the connection has ended.
  [[nodiscard]] virtual Expected<Received> receive(TrackedFrame &frame) = 0;
  /// False: the connection has ended, or the peer does not read.
  [[nodiscard]] virtual bool send(const Bytes &message) = 0;
  static constexpr int kWait_ms = 20;
};

[[nodiscard]] Bytes packedTransform(const std::string &device, const Mat4 &motion);
[[nodiscard]] Bytes packedPoints(const std::string &device, const std::vector<TrackedPoint> &points);
[[nodiscard]] Bytes packedImage(const std::string &device, const imaging::Volume &image);

}  // namespace c3de::tracking
