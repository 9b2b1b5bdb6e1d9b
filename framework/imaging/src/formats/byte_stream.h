// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "c3de/core/expected.h"

namespace c3de::imaging {

/// A sequential stream of the bytes of a file.
class ByteStream {
 public:
  virtual ~ByteStream() = default;
  /// Fewer than requested: the data end here, or are damaged.
  virtual std::size_t read(void *to, std::size_t bytes) = 0;
  /// The fault so far; empty: none.
  [[nodiscard]] virtual std::string fault() const = 0;
  /// Skips the remainder of a compressed stream, so that its checksum is verified. @return bytes, at most 256 KiB
  virtual std::size_t finish() = 0;
};

/// @param deflated  the bytes from offset on are gzip or zlib; they are returned inflated
[[nodiscard]] Expected<std::unique_ptr<ByteStream>> openBytes(const std::filesystem::path &path, std::uint64_t offset,
                                                              bool deflated);

/// Skips this many bytes; false: there are fewer.
[[nodiscard]] bool skipBytes(ByteStream &stream, std::uint64_t bytes);

/// Whether the file has a gzip signature.
[[nodiscard]] bool isGzip(const std::filesystem::path &path);

/// The first bytes, inflated if the file is gzip; fewer if it is shorter.
[[nodiscard]] Expected<std::vector<unsigned char>> firstBytes(const std::filesystem::path &path, std::size_t bytes);

}  // namespace c3de::imaging
