// SPDX-License-Identifier: Apache-2.0
#include "vtk_blocks.h"

#include <fmt/format.h>
#include <zlib.h>

#include <cstdint>
#include <vector>

#include "base64.h"

namespace c3de::geometry {
namespace {

constexpr std::uint64_t kBestRatio = 1040, kMinBlock = 1000;  // the best ratio of deflate is 1:1032

std::size_t digitsOf(std::size_t bytes) { return (bytes + 2) / 3 * 4; }

tl::unexpected<Error> cut() { return fail(ErrorCode::input, "it ends too early"); }

/// Decodes the given number of bytes of the source from `at`, and advances `at` past them.
Expected<std::string> take(const PackedArray &array, std::size_t &at, std::uint64_t bytes) {
  if (bytes > array.source.size()) return cut();
  const std::size_t length =
      array.isBase64 ? digitsOf(static_cast<std::size_t>(bytes)) : static_cast<std::size_t>(bytes);
  if (length > array.source.size() - at) return cut();
  const std::string_view part = array.source.substr(at, length);
  at += length;
  if (!array.isBase64) return std::string(part);
  auto decoded = fromBase64(part);
  if (!decoded || decoded->size() < bytes) return fail(ErrorCode::input, "its base64 is damaged");
  decoded->resize(static_cast<std::size_t>(bytes));
  return std::move(*decoded);
}

std::vector<std::uint64_t> wordsOf(const std::string &bytes, const PackedArray &array) {
  std::vector<std::uint64_t> words(bytes.size() / array.headerBytes, 0);
  for (std::size_t w = 0; w < words.size(); ++w)
    for (std::size_t i = 0; i < array.headerBytes; ++i) {
      const std::size_t byte = array.isBigEndian ? array.headerBytes - 1 - i : i;
      words[w] |= std::uint64_t{static_cast<unsigned char>(bytes[w * array.headerBytes + byte])} << (8 * i);
    }
  return words;
}

}  // namespace

Expected<std::string> unpacked(const PackedArray &array) {
  std::size_t at = 0;
  const auto first = take(array, at, array.headerBytes);
  if (!first) return tl::unexpected(first.error());
  const std::uint64_t blocks = wordsOf(*first, array)[0];
  if (blocks == 0) return std::string();
  if (blocks > array.source.size() / array.headerBytes)
    return fail(ErrorCode::input, fmt::format("its header says {} blocks, more than the file holds", blocks));
  at = 0;
  const auto head = take(array, at, (3 + blocks) * array.headerBytes);
  if (!head) return tl::unexpected(head.error());
  const std::vector<std::uint64_t> words = wordsOf(*head, array);
  const std::uint64_t each = words[1], last = words[2] == 0 ? each : words[2];

  std::uint64_t packedBytes = 0;
  for (std::uint64_t b = 0; b < blocks; ++b) {
    const std::uint64_t packed = words[static_cast<std::size_t>(3 + b)], size = b + 1 == blocks ? last : each;
    if (packed > array.source.size() || size > packed * kBestRatio + kMinBlock)
      return fail(
          ErrorCode::input,
          fmt::format("its header says that block {} of {} unpacks from {} to {} bytes, which the file cannot hold", b,
                      blocks, packed, size));
    packedBytes += packed;
  }
  const auto data = take(array, at, packedBytes);
  if (!data) return tl::unexpected(data.error());
  std::string out;
  std::size_t from = 0;
  for (std::uint64_t b = 0; b < blocks; ++b) {
    const auto packed = static_cast<std::size_t>(words[static_cast<std::size_t>(3 + b)]);
    const auto size = static_cast<std::size_t>(b + 1 == blocks ? last : each);
    const std::size_t to = out.size();
    out.resize(to + size);
    uLongf got = static_cast<uLongf>(size);
    Bytef none = 0;
    const int answer = uncompress(size == 0 ? &none : reinterpret_cast<Bytef *>(out.data() + to), &got,
                                  reinterpret_cast<const Bytef *>(data->data() + from), static_cast<uLong>(packed));
    if (answer != Z_OK || got != size)
      return fail(ErrorCode::input, fmt::format("block {} of {} is damaged", b, blocks));
    from += packed;
  }
  return out;
}

}  // namespace c3de::geometry
