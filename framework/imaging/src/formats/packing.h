// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace c3de::imaging {

enum class Packing { none, gzip, zlib };
/// The bytes compressed in that format; empty if memory is insufficient.
[[nodiscard]] std::string packed(std::string_view bytes, Packing packing);

}  // namespace c3de::imaging
