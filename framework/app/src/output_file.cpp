// SPDX-License-Identifier: Apache-2.0
#include "output_file.h"

#include <fstream>
#include <string>

namespace c3de::app {
namespace fs = std::filesystem;

namespace {

bool isSameFile(const fs::path &a, const fs::path &b) {
  std::error_code code;
  if (fs::equivalent(a, b, code)) return true;
  // Of files that are not there yet the name alone tells.
  const fs::path first = fs::weakly_canonical(a, code), second = fs::weakly_canonical(b, code);
  return !first.empty() && first == second;
}

}  // namespace

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

Expected<void> checkDistinct(std::span<const fs::path> outputs, std::span<const fs::path> inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].empty()) continue;
    for (const fs::path &input : inputs)
      if (!input.empty() && isSameFile(outputs[i], input))
        return fail(ErrorCode::usage, outputs[i].string() + ": is read by this run and would be lost; accepted: another file");
    for (std::size_t j = 0; j < i; ++j)
      if (!outputs[j].empty() && isSameFile(outputs[i], outputs[j]))
        return fail(ErrorCode::usage, outputs[i].string() + ": is named for two outputs; accepted: a file for each");
  }
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
