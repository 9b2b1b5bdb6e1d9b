// SPDX-License-Identifier: Apache-2.0
#include "logic/label_list.h"

#include <cctype>

namespace c3de::ui {
namespace {

std::string plain(std::string text) {
  for (char &c : text) c = c == '_' ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace

bool isListed(const std::string &name, const std::string &filter) {
  const std::string in = plain(name), words = plain(filter);
  for (std::size_t at = 0; at < words.size();) {
    const std::size_t begin = words.find_first_not_of(' ', at);
    if (begin == std::string::npos) break;
    at = std::min(words.find(' ', begin), words.size());
    if (in.find(words.substr(begin, at - begin)) == std::string::npos) return false;
  }
  return true;
}

}  // namespace c3de::ui
