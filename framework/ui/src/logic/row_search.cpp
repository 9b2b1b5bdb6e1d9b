// SPDX-License-Identifier: Apache-2.0
#include "logic/row_search.h"

#include <algorithm>
#include <utility>

namespace c3de::ui {
namespace {

/// Lower case of ASCII and of À … Þ; separators of ids become spaces.
std::string folded(std::string_view text) {
  std::string out(text);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto c = static_cast<unsigned char>(out[i]);
    if (c >= 'A' && c <= 'Z') out[i] = static_cast<char>(c + 0x20);
    if (c == '_' || c == '.') out[i] = ' ';
    if (c != 0xC3 || i + 1 == out.size()) continue;
    const auto next = static_cast<unsigned char>(out[i + 1]);
    constexpr unsigned char kTimesSign = 0x97;
    if (next >= 0x80 && next <= 0x9E && next != kTimesSign) out[i + 1] = static_cast<char>(next + 0x20);
  }
  return out;
}

}  // namespace

bool containsWords(std::string_view text, std::string_view words) {
  const std::string in = folded(text), wanted = folded(words);
  for (std::size_t at = wanted.find_first_not_of(' '); at != std::string::npos;) {
    const std::size_t end = std::min(wanted.find(' ', at), wanted.size());
    if (in.find(wanted.substr(at, end - at)) == std::string::npos) return false;
    at = wanted.find_first_not_of(' ', end);
  }
  return true;
}

void RowSearch::setWords(std::string_view words) {
  words_ = words;
  isActive_ = folded(words).find_first_not_of(' ') != std::string::npos;
}

void RowSearch::begin() {
  section_.clear();
  key_.clear();
  isHeadingDue_ = hasHeading_ = false;
  isShown_ = true;
  rows_ = matches_ = 0;
}

void RowSearch::heading(const std::string &text) {
  section_ = text;
  hasHeading_ = isHeadingDue_ = true;
  isShown_ = !isActive_;
}

bool RowSearch::row(const std::string &key, const std::string &texts, Kind kind) {
  ++rows_;
  key_ = key;
  if (!isActive_) return isShown_ = true;
  // In a panel without headings no row is its head.
  const bool isHead = kind == Kind::widget && !hasHeading_ && hadHeading_;
  const auto known = tooltips_.find(key);
  const bool isMatch = containsWords(
      section_ + '\n' + texts + '\n' + (known == tooltips_.end() ? std::string() : known->second), words_);
  if (isMatch && !isHead) ++matches_;
  return isShown_ = isMatch || isHead;
}

bool RowSearch::follower(const std::string &texts) {
  if (isShown_) return true;
  return row({}, texts);
}

void RowSearch::tooltip(const std::string &text) {
  if (key_.empty()) return;
  std::string &known = tooltips_[key_];
  if (known != text) known = text;
}

std::optional<std::string> RowSearch::takeHeading() {
  return std::exchange(isHeadingDue_, false) ? std::optional(section_) : std::nullopt;
}

void RowSearch::end() {
  hadHeading_ = hasHeading_;
  rowCount_ = rows_;
  matchCount_ = matches_;
}

}  // namespace c3de::ui
