// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "app.h"
#include "c3de/core/expected.h"

namespace c3de::app {

/// The file name that denotes standard input or output.
inline constexpr const char *kStandardStream = "-";

/// What names standard input in messages and reports.
inline constexpr const char *kStandardInput = "standard input";

/// The scene (TOML) that standard input has, read to its end; its paths are relative to the present folder.
/// ErrorCode::input: it is empty, too large (64 MiB) or cannot be read.
[[nodiscard]] Expected<std::string> readSceneFromInput();

/// An output named `-`: written to a temporary file, and to standard output at the end. Temporary, because outputs are
/// complete or absent, and replacing the file behind a redirected standard output would lose what is in it.
class StandardOutputFile {
 public:
  StandardOutputFile() = default;
  StandardOutputFile(const StandardOutputFile &) = delete;
  StandardOutputFile &operator=(const StandardOutputFile &) = delete;
  ~StandardOutputFile();  ///< removes the temporary file

  /// Replaces the output that is `-`, if there is one. ErrorCode::usage: more than one. Messages for people are printed
  /// to the error stream from then on.
  [[nodiscard]] Expected<void> take(const std::vector<std::pair<const char *, std::filesystem::path *>> &outputs);
  /// Prints what was written. Nothing was written where the run failed before; its error says so.
  [[nodiscard]] Expected<void> print();

 private:
  std::filesystem::path folder_, file_;  ///< empty: no output is `-`
};

}  // namespace c3de::app
