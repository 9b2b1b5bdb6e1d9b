// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace pointbased {

/// Names of a file in UTF-8, from the path that the host passes in UTF-8. A plain std::string would have the code page of the
/// system on Windows.
inline std::string fileName(const std::string &path) {
  const std::u8string text = std::filesystem::path(std::u8string(path.begin(), path.end())).filename().u8string();
  return {text.begin(), text.end()};
}

/// The same without its extension.
inline std::string fileStem(const std::string &path) {
  const std::u8string text = std::filesystem::path(std::u8string(path.begin(), path.end())).stem().u8string();
  return {text.begin(), text.end()};
}

}  // namespace pointbased
