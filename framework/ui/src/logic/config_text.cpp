// SPDX-License-Identifier: Apache-2.0
#include "logic/config_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace c3de::ui {
namespace {

constexpr std::string_view kBlank = " \t\r";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

bool isNameCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
}

bool isName(std::string_view text) { return !text.empty() && std::all_of(text.begin(), text.end(), isNameCharacter); }

/// The character after the string that begins at `at`. npos: it does not end in its line.
std::size_t endOfString(std::string_view text, std::size_t at) {
  const char quote = text[at];
  for (std::size_t i = at + 1; i < text.size() && text[i] != '\n'; ++i) {
    if (quote == '"' && text[i] == '\\')
      ++i;
    else if (text[i] == quote)
      return i + 1;
  }
  return std::string_view::npos;
}

/// The character after the value that begins at `at`, without the comment and blanks that follow it. A list may have
/// several lines. npos: it does not end.
std::size_t endOfValue(std::string_view text, std::size_t at) {
  int depth = 0;
  std::size_t end = at;
  for (std::size_t i = at; i < text.size();) {
    const char c = text[i];
    if (c == '\n' && depth == 0) return end;
    if (c == '#') {
      i = std::min(text.find('\n', i), text.size());
      continue;
    }
    std::size_t next = i + 1;
    if (c == '"' || c == '\'') next = endOfString(text, i);
    if (next == std::string_view::npos) return next;
    if (c == '[') ++depth;
    if (c == ']') --depth;
    if (c != '\n' && kBlank.find(c) == std::string_view::npos) end = next;
    i = next;
  }
  return depth == 0 ? end : std::string_view::npos;
}

void appendUtf8(std::string &out, unsigned code) {
  if (code < 0x80) {
    out += static_cast<char>(code);
  } else if (code < 0x800) {
    out += static_cast<char>(0xC0u | code >> 6);
    out += static_cast<char>(0x80u | (code & 0x3Fu));
  } else if (code < 0x10000) {
    out += static_cast<char>(0xE0u | code >> 12);
    out += static_cast<char>(0x80u | (code >> 6 & 0x3Fu));
    out += static_cast<char>(0x80u | (code & 0x3Fu));
  } else {
    out += static_cast<char>(0xF0u | code >> 18);
    out += static_cast<char>(0x80u | (code >> 12 & 0x3Fu));
    out += static_cast<char>(0x80u | (code >> 6 & 0x3Fu));
    out += static_cast<char>(0x80u | (code & 0x3Fu));
  }
}

/// What is between double quotes, with its escapes replaced. None: an unknown escape.
std::optional<std::string> unescaped(std::string_view text) {
  constexpr std::string_view kNames = "btnfr\"\\", kMeanings = "\b\t\n\f\r\"\\";
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\') {
      out += text[i];
      continue;
    }
    if (++i == text.size()) return std::nullopt;
    const char name = text[i];
    if (const std::size_t known = kNames.find(name); known != std::string_view::npos) {
      out += kMeanings[known];
      continue;
    }
    const std::size_t digits = name == 'u' ? 4 : name == 'U' ? 8 : 0;
    unsigned code = 0;
    if (digits == 0 || i + digits >= text.size()) return std::nullopt;
    const char *first = text.data() + i + 1;
    const auto parsed = std::from_chars(first, first + digits, code, 16);
    const bool isSurrogate = code >= 0xD800 && code <= 0xDFFF;
    if (parsed.ptr != first + digits || code > 0x10FFFF || isSurrogate) return std::nullopt;
    appendUtf8(out, code);
    i += digits;
  }
  return out;
}

}  // namespace

const ConfigText::Entry *ConfigText::Block::find(std::string_view key) const {
  const auto found = std::find_if(entries.begin(), entries.end(), [&](const Entry &one) { return one.key == key; });
  return found == entries.end() ? nullptr : &*found;
}

ConfigText::ConfigText(std::string text) : text_(std::move(text)) { parse(); }

void ConfigText::parse() {
  blocks_.assign(1, {});
  problems_.clear();
  std::size_t line = 1, counted = 0;
  for (std::size_t begin = 0; begin < text_.size();) {
    line += static_cast<std::size_t>(std::count(text_.begin() + static_cast<std::ptrdiff_t>(counted),
                                                text_.begin() + static_cast<std::ptrdiff_t>(begin), '\n'));
    counted = begin;
    const std::size_t end = std::min(text_.find('\n', begin), text_.size());
    parseLine(begin, end, line);
    // A list may have ended in a later line.
    const std::vector<Entry> &entries = blocks_.back().entries;
    const std::size_t last =
        entries.empty() ? end : std::max(end, std::min(text_.find('\n', entries.back().end), text_.size()));
    begin = last + 1;
    blocks_.back().end = std::min(begin, text_.size());
  }
}

void ConfigText::parseLine(std::size_t begin, std::size_t end, std::size_t line) {
  const std::string_view whole = std::string_view(text_).substr(begin, end - begin), text = trimmed(whole);
  if (text.empty() || text.front() == '#') return;
  const auto refuse = [&](const std::string &why) { problems_.push_back({line, std::string(text) + ": " + why}); };
  if (text.front() == '[') {
    const bool isOfList = text.starts_with("[[");
    const std::string_view closing = isOfList ? "]]" : "]";
    const std::size_t close = text.find(closing);
    const std::string_view after = close == std::string_view::npos ? "" : trimmed(text.substr(close + closing.size()));
    const std::string_view name =
        close == std::string_view::npos ? "" : trimmed(text.substr(closing.size(), close - closing.size()));
    if (!isName(name) || !(after.empty() || after.front() == '#')) return refuse("not a header; accepted: [name]");
    blocks_.push_back({std::string(name), isOfList, line, begin, end, {}});
    return;
  }
  const std::size_t equals = whole.find('=');
  const std::string_view key = trimmed(whole.substr(0, std::min(equals, whole.size())));
  if (equals == std::string_view::npos || !isName(key)) return refuse("not understood; accepted: key = value");
  const std::size_t valueBegin = text_.find_first_not_of(" \t", begin + equals + 1);
  const std::size_t valueEnd = valueBegin < end ? endOfValue(text_, valueBegin) : valueBegin;
  if (valueBegin >= end || valueEnd == valueBegin || text_[valueBegin] == '\r') return refuse("the value is missing");
  if (valueEnd == std::string::npos) return refuse("the value does not end: a quotation mark or bracket is missing");
  blocks_.back().entries.push_back(
      {std::string(key), text_.substr(valueBegin, valueEnd - valueBegin), line, begin, valueEnd, valueBegin});
}

const ConfigText::Entry *ConfigText::find(std::string_view block, std::string_view key) const {
  for (const Block &one : blocks_)
    if (one.name == block && !one.isOfList)
      if (const Entry *entry = one.find(key)) return entry;
  return nullptr;
}

void ConfigText::set(std::string_view block, std::string_view key, std::string_view value) {
  const auto isWanted = [&](const Block &one) { return one.name == block && !one.isOfList; };
  auto found = std::find_if(blocks_.begin(), blocks_.end(),
                            [&](const Block &one) { return isWanted(one) && one.find(key) != nullptr; });
  if (found == blocks_.end()) found = std::find_if(blocks_.begin(), blocks_.end(), isWanted);
  if (found != blocks_.end()) return setIn(static_cast<std::size_t>(found - blocks_.begin()), key, value);
  addAtEnd("[" + std::string(block) + "]\n" + std::string(key) + " = " + std::string(value) + "\n");
}

void ConfigText::setIn(std::size_t block, std::string_view key, std::string_view value) {
  const Block &one = blocks_[block];
  if (const Entry *entry = one.find(key)) {
    text_.replace(entry->valueBegin, entry->end - entry->valueBegin, value);
    return parse();
  }
  // Below the last key of the block, or below its header.
  const std::size_t after =
      one.entries.empty() ? text_.find('\n', one.begin) : text_.find('\n', one.entries.back().end);
  std::string line = std::string(key) + " = " + std::string(value) + "\n";
  if (after == std::string::npos) line.insert(0, 1, '\n');
  text_.insert(after == std::string::npos ? text_.size() : after + 1, line);
  parse();
}

void ConfigText::removeBlock(std::size_t block) {
  // Comments below its last key may belong to the next header.
  const Block &one = blocks_[block];
  const std::size_t last = one.entries.empty() ? one.begin : one.entries.back().end;
  std::size_t end = std::min(text_.find('\n', last), text_.size());
  const std::size_t next = std::min(text_.find_first_not_of(" \t\r\n", end), text_.size());
  if (const std::size_t line = text_.rfind('\n', next); next == text_.size() || line == std::string::npos || line < end)
    end = next;
  else
    end = line + 1;
  text_.erase(one.begin, end - one.begin);
  parse();
}

void ConfigText::addToList(std::string_view name, std::string_view lines) {
  addAtEnd("[[" + std::string(name) + "]]\n" + std::string(lines));
}

void ConfigText::addAtEnd(std::string_view lines) {
  if (!text_.empty() && text_.back() != '\n') text_ += '\n';
  if (!text_.empty()) text_ += '\n';
  text_ += lines;
  parse();
}

std::optional<std::string> stringOf(std::string_view value) {
  if (value.size() < 2 || (value.front() != '"' && value.front() != '\'')) return std::nullopt;
  if (endOfString(value, 0) != value.size()) return std::nullopt;
  const std::string_view inner = value.substr(1, value.size() - 2);
  return value.front() == '"' ? unescaped(inner) : std::optional(std::string(inner));
}

std::optional<double> numberOf(std::string_view value) {
  std::string digits;
  for (const char c : value)
    if (c != '_') digits += c;
  const char *first = digits.data(), *last = first + digits.size();
  if (first != last && *first == '+') ++first;
  double number = 0.0;
  const auto parsed = std::from_chars(first, last, number);
  if (parsed.ec != std::errc() || parsed.ptr != last || !std::isfinite(number)) return std::nullopt;
  return number;
}

std::optional<std::vector<std::string>> stringsOf(std::string_view value) {
  if (value.size() < 2 || value.front() != '[' || value.back() != ']') return std::nullopt;
  std::vector<std::string> texts;
  bool awaitsComma = false;
  for (std::size_t i = 1; i + 1 < value.size();) {
    const char c = value[i];
    if (c == '#') {
      i = std::min(value.find('\n', i), value.size() - 1);
    } else if (c == '\n' || kBlank.find(c) != std::string_view::npos) {
      ++i;
    } else if (c == ',' && awaitsComma) {
      awaitsComma = false;
      ++i;
    } else if ((c == '"' || c == '\'') && !awaitsComma) {
      const std::size_t end = endOfString(value, i);
      const auto text = end == std::string_view::npos ? std::nullopt : stringOf(value.substr(i, end - i));
      if (!text) return std::nullopt;
      texts.push_back(*text);
      awaitsComma = true;
      i = end;
    } else {
      return std::nullopt;
    }
  }
  return texts;
}

std::string quotedValue(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    constexpr std::string_view kHex = "0123456789ABCDEF";
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (code < 0x20 || code == 0x7F) {
      out += "\\u00";
      out += kHex[code >> 4];
      out += kHex[code & 15u];
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string listValue(const std::vector<std::string> &texts) {
  std::string out = "[";
  for (const std::string &text : texts) out += (out.size() > 1 ? ", " : "") + quotedValue(text);
  return out + "]";
}

}  // namespace c3de::ui
