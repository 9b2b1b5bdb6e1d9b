// SPDX-License-Identifier: Apache-2.0
#include "output_file.h"

#include <fstream>
#include <string>

namespace c3de::app {
namespace fs = std::filesystem;

Expected<void> checkWritable(const fs::path &file) {
  std::error_code code;
  if (fs::is_directory(file, code)) return fail(ErrorCode::output, file.string() + ": is a folder; accepted: a file name");
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, code))
    return fail(ErrorCode::output, file.string() + ": cannot be written: there is no folder " + folder.string());
  const bool existed = fs::exists(file, code);
  const bool good = std::ofstream(file, std::ios::app).good();
  if (!existed) fs::remove(file, code);
  if (!good) return fail(ErrorCode::output, file.string() + ": cannot be written; accepted: a file in a folder that may be written");
  return {};
}

Expected<void> writeTextFile(const fs::path &file, std::string_view text) {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  out.close();
  if (!out) return fail(ErrorCode::output, file.string() + ": writing failed; is there space left?");
  return {};
}

}  // namespace c3de::app
