// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/path_text.h"

namespace c3de::ui {

/// Contents of a file dialog: one folder, its folders first, then its matching files. No drawing. Main thread.
class FileBrowser {
 public:
  /// @param extensions  for example "obj;stl"; empty: every file
  void setExtensions(const std::string &extensions);
  [[nodiscard]] const std::vector<std::string> &extensions() const { return extensions_; }
  /// Shows a folder. On error, which states the reason, the contents remain unchanged.
  [[nodiscard]] Expected<void> open(const std::filesystem::path &folder);
  [[nodiscard]] Expected<void> refresh() { return open(std::filesystem::path(folder_)); }
  [[nodiscard]] Expected<void> openParent() { return open(folder_.parent_path()); }

  struct Entry {
    std::string name;  ///< UTF-8
    bool isFolder = false;
    std::uintmax_t bytes = 0;
  };
  [[nodiscard]] const std::filesystem::path &folder() const { return folder_; }
  [[nodiscard]] const std::vector<Entry> &entries() const { return entries_; }

  struct Choice {
    bool isFolder = false;
    std::filesystem::path path;
  };
  /// Resolves a typed text: absolute, or relative to the folder; "~" is the home folder. Errors: it does not exist, or
  /// it is a file whose extension is not accepted.
  [[nodiscard]] Expected<Choice> resolve(const std::string &typed) const;
  /// Same for a file to be written, which need not exist. Without an extension, the first accepted one is added.
  /// Errors: no such folder, or an extension that is not accepted.
  [[nodiscard]] Expected<Choice> resolveNew(const std::string &typed) const;
  [[nodiscard]] bool accepts(const std::filesystem::path &file) const;

 private:
  [[nodiscard]] std::filesystem::path pathOf(const std::string &typed) const;
  [[nodiscard]] Error notAccepted(const std::string &typed) const;

  std::filesystem::path folder_;
  std::vector<std::string> extensions_;  ///< lower case, without dot
  std::vector<Entry> entries_;
};

/// The name or, if the folder contains a file of that name, the name with a number before its extension
/// ("heart-2.nii.gz").
[[nodiscard]] std::string freeName(const std::filesystem::path &folder, const std::string &name);
/// Converts a text to a part of a file name: keeps its letters, digits, '.' and '_', with '-' for anything in between.
[[nodiscard]] std::string fileNamePart(const std::string &text);

/// For example "1.4 MB".
[[nodiscard]] std::string sizeText(std::uintmax_t bytes);

}  // namespace c3de::ui
