// SPDX-License-Identifier: Apache-2.0
// What the user prefers, and the file that keeps it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/ui/display_units.h"
#include "c3de/ui/image_presets.h"

namespace c3de::ui {

enum class ThemeKind { dark, light };

/// Window and level for images whose name contains these words.
struct WindowLevelRule {
  std::string words;  ///< all of them occur in modality, series description or file name; case is ignored
  double centre = 0.0, width = 1.0;  ///< in the unit of the image, HU for computed tomography; width > 0
  friend bool operator==(const WindowLevelRule &, const WindowLevelRule &) = default;
};

/// The window level of the first rule that applies. None: no rule does.
/// @param name  modality, series description and file name of the image
[[nodiscard]] std::optional<WindowLevel> windowLevelFor(const std::vector<WindowLevelRule> &rules,
                                                        const std::string &name);

struct Preferences {
  static constexpr double kSmallestFont = 10.0, kLargestFont = 28.0, kUsualFont = 14.0;
  static constexpr double kShortestAutosave_s = 2.0, kLongestAutosave_s = 3600.0;
  static constexpr std::size_t kMostFolders = 12;

  ThemeKind theme = ThemeKind::dark;
  double fontSize_px = kUsualFont;  ///< logical pixels; everything else scales with it
  DisplayUnits units;
  std::string folder;  ///< in which file dialogs begin; empty: the working folder, or the folder of the last file
  std::vector<std::string> bookmarks, recentFolders;  ///< absolute; the latest first
  double autosave_s = 8.0;                            ///< between two copies of unsaved work
  std::vector<WindowLevelRule> windowLevels;
  friend bool operator==(const Preferences &, const Preferences &) = default;

  /// The folder becomes the first recent one. Of more than kMostFolders the oldest are dropped.
  void addRecentFolder(const std::string &folder);
};

/// The usual values, with the bookmarks and recent folders of `present`.
[[nodiscard]] Preferences usualPreferences(const Preferences &present);

/// Default location of the file: "config.toml" in the user's settings folder.
[[nodiscard]] std::filesystem::path preferencesFile();

struct ReadPreferences {
  Preferences values;                 ///< what was not understood has its usual value
  std::vector<std::string> problems;  ///< "FILE:LINE: KEY = VALUE: why; accepted: …"
};
/// A missing file is no problem, an unreadable one is.
[[nodiscard]] ReadPreferences readPreferences(const std::filesystem::path &file);

/// Writes what differs between `before` and `after` into the file. Every other line stays as it is, also what is not
/// understood, and comments. Changes by other programs since `before` was read are kept where they concern other keys.
/// @param replacesInvalid  known keys whose value is not accepted get that of `after`, too
/// Errors: ErrorCode::output, the file or its folder cannot be read or written. The file is unchanged then.
[[nodiscard]] Expected<void> writePreferences(const std::filesystem::path &file, const Preferences &before,
                                              const Preferences &after, bool replacesInvalid = false);

}  // namespace c3de::ui
