// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace c3de::imaging {

/// Text of DICOM as UTF-8: PS3.3 C.12.1.1.2 (Specific Character Set) and PS3.5 6.1 with annexes H, I, J and K (escape
/// sequences of ISO 2022). What cannot be decoded becomes U+FFFD, control characters become blanks, so the answer is
/// always good UTF-8. Without a character set, text that is good UTF-8 is taken as such, because some writers forget to
/// say so.
/// @param characterSet  value of (0008,0005), "ISO 2022 IR 6\ISO 2022 IR 87" for example; empty: ASCII
[[nodiscard]] std::string dicomText(std::string_view bytes, const std::string &characterSet);

}  // namespace c3de::imaging
