// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

#include "c3de/core/expected.h"

namespace c3de {

namespace detail {
struct FileCloser {
  void operator()(std::FILE *file) const { std::fclose(file); }
};
using FilePointer = std::unique_ptr<std::FILE, FileCloser>;
}  // namespace detail

/// A file that appears complete or not at all: it is written beside its place without a name, which the system takes
/// back when the program is killed, or (where it knows no such files) under a name of its own (FILE.part), and takes
/// its place when commit() succeeds. What was there stays until then. A link is followed; a device or pipe, which
/// nothing can take the place of, and a file in a folder that may not be written to, are written directly. All errors
/// are ErrorCode::output and say the reason of the system ("No space left on device").
class OutputFile {
 public:
  [[nodiscard]] static Expected<OutputFile> open(const std::filesystem::path &path);
  OutputFile(OutputFile &&) noexcept = default;
  OutputFile &operator=(OutputFile &&) = delete;
  ~OutputFile();  ///< removes what was not committed

  /// After a failure nothing more is written; commit() tells it.
  void write(std::string_view bytes);
  [[nodiscard]] Expected<void> commit();

 private:
  OutputFile() = default;
  void discard();
  int giveName();                    ///< errno, 0: done
  std::filesystem::path path_;       ///< as it was named, for messages
  std::filesystem::path target_;     ///< what is replaced
  std::filesystem::path temporary_;  ///< empty: written directly, or unnamed
  bool unnamed_ = false;             ///< has no name before it is committed
  detail::FilePointer file_;
  int error_ = 0;
};

/// OutputFile for text or bytes that are there already.
[[nodiscard]] Expected<void> writeWholeFile(const std::filesystem::path &path, std::string_view bytes);

/// A table that grows while others may read it, and ends with a whole row whenever the program ends or the disk is
/// full.
class OutputRows {
 public:
  /// Replaces what is there.
  [[nodiscard]] static Expected<OutputRows> open(const std::filesystem::path &path);
  /// @param row  one row or several, each with its end of line
  [[nodiscard]] Expected<void> add(std::string_view row);
  [[nodiscard]] Expected<void> close();

 private:
  OutputRows() = default;
  std::filesystem::path path_, target_;
  detail::FilePointer file_;
  std::uintmax_t bytes_ = 0;  ///< of whole rows
};

/// Whether all of these files can be written, asked before hours of work go into what is to be written: that no two
/// names lead to one file (however they are spelt, through links, or because the system tells no capitals), and none to
/// a file that is read, or that lies in a folder that is read. Leaves existing files as they are and no new ones
/// behind. Empty paths are left out. Errors: ErrorCode::usage names the two, ErrorCode::output says why a file cannot
/// be written.
[[nodiscard]] Expected<void> checkOutputs(std::span<const std::filesystem::path> outputs,
                                          std::span<const std::filesystem::path> inputs);

}  // namespace c3de
