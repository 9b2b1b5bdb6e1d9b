// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "c3de/core/platform.h"

namespace c3de {

/// Appends, and removes the beginning once the text is twice as long as the part to keep.
inline void appendOutput(std::string &text, std::string_view more) {
  text += more;
  if (text.size() > 2 * ProcessResult::kKept) text.erase(0, text.size() - ProcessResult::kKept);
}

}  // namespace c3de
