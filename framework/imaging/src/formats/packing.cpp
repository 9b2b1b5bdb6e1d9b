// SPDX-License-Identifier: Apache-2.0
#include "formats/packing.h"

#include <zlib.h>

#include <algorithm>

namespace c3de::imaging {

std::string packed(std::string_view bytes, Packing packing) {
  std::string out;
  if (packing == Packing::none) return std::string(bytes);
  z_stream z{};
  // Level 1: higher levels compress voxels hardly better and take several times as long.
  if (deflateInit2(&z, 1, Z_DEFLATED, packing == Packing::gzip ? 15 + 16 : 15, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    return out;
  const char *next = bytes.data();
  std::size_t left = bytes.size();
  int answer = Z_OK;
  char chunk[1u << 16];
  while (answer == Z_OK) {
    if (z.avail_in == 0 && left > 0) {
      z.next_in = reinterpret_cast<Bytef *>(const_cast<char *>(next));
      z.avail_in = static_cast<uInt>(std::min<std::size_t>(left, 1u << 30));
      next += z.avail_in;
      left -= z.avail_in;
    }
    z.next_out = reinterpret_cast<Bytef *>(chunk);
    z.avail_out = sizeof chunk;
    answer = deflate(&z, left == 0 ? Z_FINISH : Z_NO_FLUSH);
    out.append(chunk, sizeof chunk - z.avail_out);
  }
  deflateEnd(&z);
  return out;
}

}  // namespace c3de::imaging
