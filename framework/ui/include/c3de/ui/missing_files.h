// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "c3de/core/handle.h"

namespace c3de::ui {

/// The dialog that asks for files of a session which are missing or have changed. The program fills it; the window
/// draws it while it is shown. Main thread.
struct MissingFiles {
  struct Row {
    std::string name, path, size;  ///< as display text
    std::string why;               ///< it is listed
    std::string found;             ///< the file that is used; empty: none
    std::string refusal;           ///< why the last file that was chosen is not used; empty: it is, or none was chosen
    bool canUseAnyway = false;     ///< that file, with its other content
  };
  bool isShown = false;
  std::string session;  ///< name of its file
  std::vector<Row> rows;
  std::string note;  ///< result of the last search
  Handle job;        ///< while a file is checked or a folder is searched; null: none

  std::function<void(std::size_t row, const std::filesystem::path &)> locate;
  std::function<void(std::size_t row)> useAnyway;
  std::function<void(const std::filesystem::path &folder)> search;
  std::function<void()> open, cancel;

  [[nodiscard]] bool isComplete() const {
    for (const Row &row : rows)
      if (row.found.empty()) return false;
    return true;
  }
};

}  // namespace c3de::ui
