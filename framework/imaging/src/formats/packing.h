// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace c3de::imaging {

enum class Packing { none, gzip, zlib };
/// The bytes as a stream of that packing; empty if there is no memory for it.
[[nodiscard]] std::string packed(std::string_view bytes, Packing packing);

}  // namespace c3de::imaging
