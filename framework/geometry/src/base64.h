// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace c3de::geometry {

[[nodiscard]] std::string toBase64(std::string_view bytes);
/// Decodes base64. Text between two paddings is a separate block, as in VTK's files; none for other characters or a
/// truncated block. White space is skipped.
[[nodiscard]] std::optional<std::string> fromBase64(std::string_view text);

}  // namespace c3de::geometry
