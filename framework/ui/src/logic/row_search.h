// SPDX-License-Identifier: Apache-2.0
// The search of a panel: which of its rows are drawn while words are typed into its search field.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace c3de::ui {

/// From this number of rows on, a panel always shows its search field.
inline constexpr std::size_t kManyRows = 30;

/// Every word of the search occurs in the text. Case is ignored, also of Latin letters with accents; "_" and "." count
/// as spaces.
[[nodiscard]] bool containsWords(std::string_view text, std::string_view words);

/// A panel is drawn row by row, and the tooltip of a row follows it. A row therefore matches by its tooltip from the
/// frame after the one in which it was drawn first. Main thread.
class RowSearch {
 public:
  enum class Kind {
    widget,    ///< before the first heading it is always drawn: the head of a panel, with its warnings
    parameter  ///< filtered also there
  };

  /// @param words  empty or spaces: every row is drawn
  void setWords(std::string_view words);
  [[nodiscard]] const std::string &words() const { return words_; }
  [[nodiscard]] bool isActive() const { return isActive_; }

  /// Before the first row of a frame.
  void begin();
  /// The rows that follow belong to a section. Its heading is drawn before the first of them that is.
  void heading(const std::string &text);
  /// Whether the row is drawn: the words are in the texts of its section, its own and its tooltip.
  /// @param key  the same in all frames
  [[nodiscard]] bool row(const std::string &key, const std::string &texts, Kind kind = Kind::widget);
  /// Whether a row without a text, such as a bar, is drawn: if it matches itself or the row before is drawn.
  [[nodiscard]] bool follower(const std::string &texts);
  /// Of the last row.
  void tooltip(const std::string &text);
  /// The heading to be drawn before the row that row() has just accepted; each is returned once.
  [[nodiscard]] std::optional<std::string> takeHeading();
  /// After the last row of a frame.
  void end();

  /// Whether the last row was drawn.
  [[nodiscard]] bool isShown() const { return isShown_; }
  /// Rows of the last complete frame, and how many of them match. Rows of the head are not counted as matches.
  [[nodiscard]] std::size_t rowCount() const { return rowCount_; }
  [[nodiscard]] std::size_t matchCount() const { return matchCount_; }

 private:
  std::string words_;
  bool isActive_ = false;
  std::map<std::string, std::string> tooltips_;  // by key
  std::string section_, key_;
  bool isHeadingDue_ = false, isShown_ = true;
  bool hasHeading_ = false, hadHeading_ = false;  // in this frame, in the last one
  std::size_t rows_ = 0, matches_ = 0, rowCount_ = 0, matchCount_ = 0;
};

}  // namespace c3de::ui
