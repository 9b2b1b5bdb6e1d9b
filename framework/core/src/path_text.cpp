// SPDX-License-Identifier: Apache-2.0
#include "c3de/core/path_text.h"

namespace c3de {

std::string pathText(const std::filesystem::path &path) {
  const std::u8string text = path.u8string();
  return {text.begin(), text.end()};
}

std::filesystem::path pathFromText(const std::string &text) {
  return std::filesystem::path(std::u8string(text.begin(), text.end()));
}

}  // namespace c3de
