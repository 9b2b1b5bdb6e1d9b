// SPDX-License-Identifier: Apache-2.0
#include "support/tracking_server.h"

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <bit>
#include <chrono>
#include <cstring>

namespace {

/// CRC-64 of ECMA-182, from 0, highest bit first.
std::uint64_t checksum(const std::string &bytes) {
  std::uint64_t crc = 0;
  for (const char c : bytes) {
    crc ^= static_cast<std::uint64_t>(static_cast<unsigned char>(c)) << 56;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 63) != 0 ? crc << 1 ^ 0x42F0E1EBA9EA3693u : crc << 1;
  }
  return crc;
}

std::string bigEndian(std::uint64_t value, int bytes) {
  std::string out;
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) out += static_cast<char>(value >> shift & 0xff);
  return out;
}

std::string field(std::string text, std::size_t size) {
  text.resize(size, '\0');
  return text;
}

std::uint64_t numberAt(const std::string &bytes, std::size_t offset, std::size_t count) {
  std::uint64_t out = 0;
  for (std::size_t i = 0; i < count; ++i) out = out << 8 | static_cast<unsigned char>(bytes.at(offset + i));
  return out;
}

std::string textAt(const std::string &bytes, std::size_t offset, std::size_t count) {
  const std::string text = bytes.substr(offset, count);
  return text.substr(0, text.find('\0'));
}

std::string packedHeader(unsigned version, const WireMessage &message, std::uint32_t seconds) {
  return bigEndian(version, 2) + field(message.type, 12) + field(message.device, 20) + bigEndian(seconds, 4) +
         bigEndian(0, 4) + bigEndian(message.body.size(), 8) + bigEndian(checksum(message.body), 8);
}

}  // namespace

std::string packedWire(const WireMessage &message, std::uint32_t seconds) {
  return packedHeader(1, message, seconds) + message.body;
}

std::string packedExtendedWire(const WireMessage &message) {
  // One pair of metadata: its header with the sizes of key and value, then both.
  const std::string key = "Status", value = "OK";
  const std::string header = bigEndian(1, 2) + bigEndian(key.size(), 2) + bigEndian(3, 2) + bigEndian(value.size(), 4);
  const std::string metadata = key + value;
  WireMessage out = message;
  out.body = bigEndian(12, 2) + bigEndian(header.size(), 2) + bigEndian(metadata.size(), 4) + bigEndian(7, 4) +
             message.body + header + metadata;
  return packedHeader(2, out, 0) + out.body;
}

std::string transformBody(const std::array<float, 3> &at) {
  std::string out;
  for (const float x : {1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, at[0], at[1], at[2]})
    out += bigEndian(std::bit_cast<std::uint32_t>(x), 4);
  return out;
}

std::string pointBody(const std::vector<std::pair<std::string, std::array<float, 3>>> &points) {
  std::string out;
  for (const auto &[name, at] : points) {
    out += field(name, 64) + field("Fiducial", 32) + std::string(4, '\xff');
    for (const float x : at) out += bigEndian(std::bit_cast<std::uint32_t>(x), 4);
    out += bigEndian(0, 4) + field("", 20);
  }
  return out;
}

float floatAt(const std::string &body, std::size_t offset) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(numberAt(body, offset, 4)));
}

unsigned shortAt(const std::string &body, std::size_t offset) {
  return static_cast<unsigned>(numberAt(body, offset, 2));
}

TrackingServer::TrackingServer() : listener_(::socket(AF_INET, SOCK_STREAM, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ::bind(listener_, reinterpret_cast<const sockaddr *>(&address), sizeof address);
  ::listen(listener_, 1);
  socklen_t size = sizeof address;
  ::getsockname(listener_, reinterpret_cast<sockaddr *>(&address), &size);
  port_ = ntohs(address.sin_port);
}

TrackingServer::~TrackingServer() {
  disconnect();
  ::close(listener_);
}

bool TrackingServer::accept(double longest_s) {
  pollfd ready{listener_, POLLIN, 0};
  if (::poll(&ready, 1, static_cast<int>(1e3 * longest_s)) != 1) return false;
  connection_ = ::accept(listener_, nullptr, nullptr);
  return connection_ >= 0;
}

void TrackingServer::disconnect() {
  if (connection_ >= 0) ::close(connection_);
  connection_ = -1;
}

bool TrackingServer::send(const std::string &bytes) {
  std::size_t sent = 0;
  while (sent < bytes.size()) {
    const ssize_t count = ::send(connection_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (count <= 0) return false;
    sent += static_cast<std::size_t>(count);
  }
  return true;
}

bool TrackingServer::read(char *bytes, std::size_t count, double longest_s) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(longest_s);
  while (count > 0) {
    const double left_s = std::chrono::duration<double>(end - std::chrono::steady_clock::now()).count();
    pollfd ready{connection_, POLLIN, 0};
    if (left_s <= 0.0 || ::poll(&ready, 1, static_cast<int>(1e3 * left_s) + 1) != 1) return false;
    const ssize_t got = ::recv(connection_, bytes, count, 0);
    if (got <= 0) return false;
    bytes += got;
    count -= static_cast<std::size_t>(got);
  }
  return true;
}

std::optional<WireMessage> TrackingServer::receive(const std::string &type, double longest_s) {
  std::string header(58, '\0');
  while (read(header.data(), header.size(), longest_s)) {
    WireMessage out{textAt(header, 2, 12), textAt(header, 14, 20), std::string(numberAt(header, 42, 8), '\0')};
    if (!read(out.body.data(), out.body.size(), longest_s) || numberAt(header, 50, 8) != checksum(out.body))
      return std::nullopt;
    if (out.type == type) return out;
  }
  return std::nullopt;
}
