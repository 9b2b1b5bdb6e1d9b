// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "c3de/core/expected.h"

namespace c3de::imaging {

/// Bytes of a file, one after the other.
class ByteStream {
 public:
  virtual ~ByteStream() = default;
  /// Fewer than asked: the data end here, or are damaged.
  virtual std::size_t read(void *to, std::size_t bytes) = 0;
  /// What is wrong so far; empty: nothing.
  [[nodiscard]] virtual std::string fault() const = 0;
  /// Reads away what is left of a compressed stream, so that its check sum is looked at. @return bytes, at most 256 KiB
  virtual std::size_t finish() = 0;
};

/// @param deflated  the bytes from offset on are gzip or zlib; they are delivered inflated
[[nodiscard]] Expected<std::unique_ptr<ByteStream>> openBytes(const std::filesystem::path &path, std::uint64_t offset,
                                                              bool deflated);

/// Reads away so many bytes; false: there are not so many.
[[nodiscard]] bool skipBytes(ByteStream &stream, std::uint64_t bytes);

/// Whether the file begins as gzip does.
[[nodiscard]] bool isGzip(const std::filesystem::path &path);

/// The first bytes, inflated where the file is gzip; fewer where it has no more.
[[nodiscard]] Expected<std::vector<unsigned char>> firstBytes(const std::filesystem::path &path, std::size_t bytes);

}  // namespace c3de::imaging
