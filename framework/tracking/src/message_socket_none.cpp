// SPDX-License-Identifier: Apache-2.0
// A build without the library OpenIGTLink: nothing can be connected, so nothing is ever packed.
#include "message_socket.h"

namespace c3de::tracking {

bool MessageSocket::isAvailable() { return false; }
std::unique_ptr<MessageSocket> MessageSocket::connectTo(const TrackingAddress &) { return nullptr; }
Bytes packedTransform(const std::string &, const Mat4 &) { return {}; }
Bytes packedPoints(const std::string &, const std::vector<TrackedPoint> &) { return {}; }
Bytes packedImage(const std::string &, const imaging::Volume &) { return {}; }

}  // namespace c3de::tracking
