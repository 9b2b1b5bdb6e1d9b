// SPDX-License-Identifier: Apache-2.0
#include "toml_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "c3de/core/text.h"

namespace c3de::scene {
namespace {

constexpr std::size_t kColumns = 120;

bool isTable(const TomlValue &value) { return value.kind == TomlValue::Kind::table; }

bool isFilledListOfTables(const TomlValue &value) {
  return value.kind == TomlValue::Kind::array && !value.items.empty() &&
         std::all_of(value.items.begin(), value.items.end(), isTable);
}

std::string quoted(const std::string &text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      out += std::string("\\") + c;
    else if (c == '\n')
      out += "\\n";
    else if (c == '\t')
      out += "\\t";
    else if (byte < 0x20 || byte == 0x7f)
      out += fmt::format("\\u{:04X}", byte);
    else
      out += c;
  }
  return out + '"';
}

std::string keyText(const std::string &key) {
  const bool isBare = !key.empty() && std::all_of(key.begin(), key.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
  return isBare ? key : quoted(key);
}

std::string numberText(double value) {
  if (std::isnan(value)) return "nan";
  std::string text = formatNumber(value);
  if (std::isfinite(value) && text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string integerText(double value) {
  // 2^63 is not an integer of TOML; the largest one is read as the same double.
  return value >= 9223372036854775808.0 ? "9223372036854775807" : fmt::format("{:.0f}", value);
}

std::string inlineText(const TomlValue &value, const std::string &indent);

/// @param isLong  one item per line
std::string arrayText(const TomlValue &value, const std::string &indent, bool isLong) {
  const std::string deeper = indent + "  ";
  std::string out = "[";
  for (std::size_t i = 0; i < value.items.size(); ++i)
    out += isLong ? "\n" + deeper + inlineText(value.items[i], deeper) + ","
                  : (i == 0 ? "" : ", ") + inlineText(value.items[i], indent);
  return out + (isLong ? "\n" + indent : "") + "]";
}

std::string inlineText(const TomlValue &value, const std::string &indent) {
  switch (value.kind) {
    case TomlValue::Kind::boolean: return value.num != 0.0 ? "true" : "false";
    case TomlValue::Kind::integer: return integerText(value.num);
    case TomlValue::Kind::number: return numberText(value.num);
    case TomlValue::Kind::text: return quoted(value.text);
    case TomlValue::Kind::array: {
      std::string text = arrayText(value, indent, false);
      return text.size() <= kColumns ? text : arrayText(value, indent, true);
    }
    default: break;
  }
  if (value.entries.empty()) return "{}";
  std::string out = "{";
  for (const auto &[key, member] : value.entries)
    out += (out == "{" ? " " : ", ") + keyText(key) + " = " + inlineText(member, indent);
  return out + " }";
}

void addLine(std::string &out, const std::string &key, const TomlValue &value) {
  const std::string line = key + " = " + inlineText(value, "");
  if (line.size() <= kColumns || (!isTable(value) && value.kind != TomlValue::Kind::array)) {
    out += line + "\n";
  } else if (isTable(value)) {
    for (const auto &[name, member] : value.entries) addLine(out, key + "." + keyText(name), member);
  } else {
    out += key + " = " + arrayText(value, "", true) + "\n";
  }
}

void addSections(std::string &out, const std::string &key, const TomlValue &list) {
  for (const TomlValue &table : list.items) {
    out += "\n[[" + key + "]]\n";
    for (const auto &[name, value] : table.entries) addLine(out, keyText(name), value);
  }
}

}  // namespace

std::string tomlText(const TomlValue &root) {
  std::string out;
  for (const auto &[key, value] : root.entries)
    if (!isTable(value) && !isFilledListOfTables(value)) addLine(out, keyText(key), value);
  for (const auto &[key, value] : root.entries) {
    if (isFilledListOfTables(value)) addSections(out, keyText(key), value);
    if (!isTable(value)) continue;
    const bool hasLines = std::any_of(value.entries.begin(), value.entries.end(),
                                      [](const TomlValue::Entry &entry) { return !isFilledListOfTables(entry.value); });
    if (hasLines || value.entries.empty()) out += "\n[" + keyText(key) + "]\n";
    for (const auto &[name, member] : value.entries)
      if (!isFilledListOfTables(member)) addLine(out, keyText(name), member);
    for (const auto &[name, member] : value.entries)
      if (isFilledListOfTables(member)) addSections(out, keyText(key) + "." + keyText(name), member);
  }
  return out;
}

bool areEqual(const TomlValue &a, const TomlValue &b) {
  if (a.kind != b.kind || a.text != b.text || a.items.size() != b.items.size() || a.entries.size() != b.entries.size())
    return false;
  const bool isSameNumber = a.num == b.num && std::signbit(a.num) == std::signbit(b.num);
  if (!isSameNumber && !(std::isnan(a.num) && std::isnan(b.num))) return false;
  return std::equal(a.items.begin(), a.items.end(), b.items.begin(), areEqual) &&
         std::all_of(a.entries.begin(), a.entries.end(), [&](const TomlValue::Entry &entry) {
           const TomlValue *other = b.find(entry.key);
           return other != nullptr && areEqual(entry.value, *other);
         });
}

TomlValue tomlString(std::string text) {
  TomlValue out;
  out.kind = TomlValue::Kind::text;
  out.text = std::move(text);
  return out;
}

TomlValue tomlList(std::vector<TomlValue> items) {
  TomlValue out;
  out.kind = TomlValue::Kind::array;
  out.items = std::move(items);
  return out;
}

}  // namespace c3de::scene
