// SPDX-License-Identifier: Apache-2.0
#include "whole_file.h"

#include <fstream>

#include "file_text.h"

namespace c3de::geometry {

Expected<void> writeWholeFile(const std::filesystem::path &path, std::string_view bytes) {
  std::filesystem::path temporary = path;
  temporary += ".part";
  const std::string name = displayPath(path);
  std::error_code code;
  if (std::filesystem::is_directory(path, code)) return fail(ErrorCode::output, name + ": is a folder; accepted: a file name");
  std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
  if (!out) return fail(ErrorCode::output, name + ": cannot be written (is there such a folder, and may you write to it?)");
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  const bool isComplete = !out.fail();
  if (isComplete) std::filesystem::rename(temporary, path, code);
  if (!isComplete || code) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    return fail(ErrorCode::output, name + ": could not be written completely" + (code ? ": " + code.message() : " (is the disk full?)"));
  }
  return {};
}

}  // namespace c3de::geometry
