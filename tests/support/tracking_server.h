// SPDX-License-Identifier: Apache-2.0
// An OpenIGTLink server for tests. It packs and reads messages by itself, so that the library is checked as well.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

struct WireMessage {
  std::string type, device, body;
};

/// A message with its header and checksum, protocol version 1.
/// @param seconds  time stamp; 0: none
std::string packedWire(const WireMessage &message, std::uint32_t seconds = 0);
/// The same with an extended header and metadata, protocol version 3, whose headers have the number 2.
std::string packedExtendedWire(const WireMessage &message);
/// Body of a TRANSFORM message without rotation, RAS mm.
std::string transformBody(const std::array<float, 3> &at);
/// Body of a POINT message. @param points  name and position, RAS mm
std::string pointBody(const std::vector<std::pair<std::string, std::array<float, 3>>> &points);

/// Big-endian numbers of a body.
float floatAt(const std::string &body, std::size_t offset);
unsigned shortAt(const std::string &body, std::size_t offset);

/// Listens on a free port of the local machine. Functions wait at most a few seconds.
class TrackingServer {
 public:
  TrackingServer();
  ~TrackingServer();
  TrackingServer(const TrackingServer &) = delete;
  TrackingServer &operator=(const TrackingServer &) = delete;

  [[nodiscard]] std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  /// False: nobody has connected in time.
  bool accept(double longest_s = 20.0);
  /// Closes the connection, not the port.
  void disconnect();
  bool send(const std::string &bytes);
  /// The next message of a type; other messages are skipped. None: none has arrived in time.
  std::optional<WireMessage> receive(const std::string &type, double longest_s = 20.0);

 private:
  bool read(char *bytes, std::size_t count, double longest_s);
  int listener_ = -1, connection_ = -1;
  unsigned port_ = 0;
};
