// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace c3de::imaging {

/// DICOM text as UTF-8: PS3.3 C.12.1.1.2 (Specific Character Set) and PS3.5 6.1 with annexes H, I, J and K (escape
/// sequences of ISO 2022). Bytes that cannot be decoded become U+FFFD, control characters become blanks, so the result
/// is always valid UTF-8. Without a character set, text that is valid UTF-8 is treated as such, because some writers
/// omit the character set.
/// @param characterSet  value of (0008,0005), "ISO 2022 IR 6\ISO 2022 IR 87" for example; empty: ASCII
[[nodiscard]] std::string dicomText(std::string_view bytes, const std::string &characterSet);

}  // namespace c3de::imaging
