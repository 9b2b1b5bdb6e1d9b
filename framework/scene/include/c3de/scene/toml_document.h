// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/parameter.h"

namespace c3de::scene {

/// A TOML value with its line; a separate type, so that only one source file includes the parser's header.
struct TomlValue {
  enum class Kind { boolean, integer, number, text, array, table, date };
  struct Entry;

  Kind kind = Kind::table;
  int line = 0;
  double num = 0.0;  ///< boolean (0/1), integer, number
  std::string text;
  std::vector<TomlValue> items;
  std::vector<Entry> entries;  ///< of a table, in the order of the file

  [[nodiscard]] bool isNumber() const { return kind == Kind::integer || kind == Kind::number; }
  [[nodiscard]] bool isNumbers(std::size_t count) const;  ///< an array of that many numbers
  [[nodiscard]] const TomlValue *find(std::string_view key) const;
  /// For messages: "a number", "the text \"abc\"", "[0, \"abc\", 0]", …
  [[nodiscard]] std::string kindName() const;
  [[nodiscard]] std::string shown() const;  ///< in TOML syntax, long lists truncated
};

struct TomlValue::Entry {
  std::string key;
  TomlValue value;
};

/// The root table. The error reads "SOURCE:LINE: what is wrong".
[[nodiscard]] Expected<TomlValue> parseToml(std::string_view text, const std::string &source);

/// The whole file, unless it is unreasonably large.
[[nodiscard]] Expected<std::string> readTextFile(const std::filesystem::path &path);

/// Converts a number, text, boolean or [x, y, z] to a parameter. False: any other value.
[[nodiscard]] bool toParameter(const TomlValue &toml, const std::string &id, ParameterValue &out);

}  // namespace c3de::scene
