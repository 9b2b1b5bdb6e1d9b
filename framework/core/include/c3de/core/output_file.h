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

/// What an output file survives besides a killed program.
enum class Durability {
  normal,
  strict  ///< a power failure: flushed to the disk before it replaces the former file, which is never written in place
};

/// A file that appears complete or not at all. It is written in the target folder as an unnamed file, which the system
/// removes if the program is killed, or (if not supported) under a temporary name (FILE.part). It replaces the target
/// when commit() succeeds; an existing file stays until then. Links are followed. Devices and pipes, which cannot be
/// replaced, and files in a folder without write permission (unless Durability::strict) are written directly. All errors
/// are ErrorCode::output and state the reason from the system ("No space left on device").
class OutputFile {
 public:
  [[nodiscard]] static Expected<OutputFile> open(const std::filesystem::path &path,
                                                 Durability durability = Durability::normal);
  OutputFile(OutputFile &&) noexcept = default;
  OutputFile &operator=(OutputFile &&) = delete;
  ~OutputFile();  ///< removes the file unless committed

  /// After a failure nothing more is written; commit() returns the error.
  void write(std::string_view bytes);
  [[nodiscard]] Expected<void> commit();

 private:
  OutputFile() = default;
  void discard();
  int giveName();                    ///< errno, 0: success
  std::filesystem::path path_;       ///< as named by the caller, for messages
  std::filesystem::path target_;     ///< the file that is replaced
  std::filesystem::path temporary_;  ///< empty: written directly, or unnamed
  Durability durability_ = Durability::normal;
  bool unnamed_ = false;  ///< has no name before it is committed
  detail::FilePointer file_;
  int error_ = 0;
};

/// OutputFile for complete text or bytes.
[[nodiscard]] Expected<void> writeWholeFile(const std::filesystem::path &path, std::string_view bytes,
                                            Durability durability = Durability::normal);

/// A table that grows while others may read it. It always ends with a complete row, even if the program terminates or
/// the disk is full.
class OutputRows {
 public:
  /// Replaces an existing file.
  [[nodiscard]] static Expected<OutputRows> open(const std::filesystem::path &path);
  /// @param row  one or more rows, each with its end of line
  [[nodiscard]] Expected<void> add(std::string_view row);
  [[nodiscard]] Expected<void> close();

 private:
  OutputRows() = default;
  std::filesystem::path path_, target_;
  detail::FilePointer file_;
  std::uintmax_t bytes_ = 0;  ///< of complete rows
};

/// Checks that all of these files can be written, before hours of work. Two names must not denote one file (by
/// different spelling, through links, or on a case-insensitive system), and none may denote an input file or be in an
/// input folder. Existing files are unchanged and no new ones remain. Empty paths are ignored. Errors: ErrorCode::usage
/// names the two, ErrorCode::output states why a file cannot be written.
[[nodiscard]] Expected<void> checkOutputs(std::span<const std::filesystem::path> outputs,
                                          std::span<const std::filesystem::path> inputs);

}  // namespace c3de
