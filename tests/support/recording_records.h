// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace c3de::test {

// A record of a recording: type (4), size (8), checksum of these (4), content, checksum of type, size and content (4).
inline constexpr std::size_t kRecordType = 4, kRecordHeader = 16, kRecordChecksum = 4;

/// CRC-32 of zip archives.
inline std::uint32_t crc32Of(const std::string &bytes, std::uint32_t before = 0) {
  std::uint32_t sum = ~before;
  for (const char c : bytes) {
    sum ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) sum = sum >> 1 ^ ((sum & 1u) != 0 ? 0xedb88320u : 0u);
  }
  return ~sum;
}

/// The record with checksums that are right, whatever its type, size and content.
inline std::string withChecksums(std::string record) {
  const auto put = [&](std::size_t at, std::uint32_t number) {
    for (std::size_t i = 0; i < 4; ++i) record[at + i] = static_cast<char>(number >> (8 * i) & 0xffu);
  };
  const std::uint32_t ofHeader = crc32Of(record.substr(0, kRecordHeader - kRecordChecksum));
  const std::size_t end = record.size() - kRecordChecksum;
  put(kRecordHeader - kRecordChecksum, ofHeader);
  put(end, crc32Of(record.substr(kRecordHeader, end - kRecordHeader), ofHeader));
  return record;
}

}  // namespace c3de::test
