// SPDX-License-Identifier: Apache-2.0
// A settings file as text: keys below headers, one value each, in the notation of TOML. Edits change only the value that
// is meant; all other characters stay.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace c3de::ui {

/// Understands headers [name] and [[name]], and keys with strings in one line, numbers, booleans and lists. A line that
/// is none of these is a problem and stays in the text. Value type.
class ConfigText {
 public:
  struct Entry {
    std::string key, value;                          ///< the value as written
    std::size_t line = 0;                            ///< from 1
    std::size_t begin = 0, end = 0, valueBegin = 0;  ///< characters of the text; `end` is after the value
  };
  /// A header with the keys below it. The first one is what is above all headers and has no name.
  struct Block {
    std::string name;
    bool isOfList = false;  ///< [[name]]
    std::size_t line = 0, begin = 0, end = 0;
    std::vector<Entry> entries;
    [[nodiscard]] const Entry *find(std::string_view key) const;
  };
  struct Problem {
    std::size_t line = 0;
    std::string text;
  };

  explicit ConfigText(std::string text);
  [[nodiscard]] const std::string &text() const { return text_; }
  [[nodiscard]] const std::vector<Block> &blocks() const { return blocks_; }
  [[nodiscard]] const std::vector<Problem> &problems() const { return problems_; }
  /// The first entry of a key below [block]. Null: there is none.
  [[nodiscard]] const Entry *find(std::string_view block, std::string_view key) const;

  /// Replaces the value of a key, or adds key and header.
  void set(std::string_view block, std::string_view key, std::string_view value);
  /// The same below one block.
  void setIn(std::size_t block, std::string_view key, std::string_view value);
  void removeBlock(std::size_t block);
  /// Adds a block [[name]] with these lines at the end.
  void addToList(std::string_view name, std::string_view lines);

 private:
  void parse();
  void parseLine(std::size_t begin, std::size_t end, std::size_t line);
  void addAtEnd(std::string_view lines);

  std::string text_;
  std::vector<Block> blocks_;
  std::vector<Problem> problems_;
};

/// A written value as what it is; none: it is something else.
[[nodiscard]] std::optional<std::string> stringOf(std::string_view value);
[[nodiscard]] std::optional<double> numberOf(std::string_view value);
[[nodiscard]] std::optional<std::vector<std::string>> stringsOf(std::string_view value);
/// As a value is written.
[[nodiscard]] std::string quotedValue(std::string_view text);
[[nodiscard]] std::string listValue(const std::vector<std::string> &texts);

}  // namespace c3de::ui
