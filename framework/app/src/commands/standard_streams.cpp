// SPDX-License-Identifier: Apache-2.0
#include "commands/standard_streams.h"

#include <array>
#include <chrono>
#include <cstdio>
#include <fstream>

#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"
#include "commands/standard_output.h"

namespace c3de::app {
namespace {

constexpr std::size_t kMostBytes = std::size_t{64} << 20;

/// An empty folder of this process alone.
Expected<std::filesystem::path> ownFolder() {
  std::error_code code;
  const std::filesystem::path parent = std::filesystem::temp_directory_path(code);
  if (code)
    return fail(ErrorCode::output, "standard output: there is no folder for temporary files: " + code.message());
  const auto now = std::chrono::steady_clock::now().time_since_epoch().count();
  const std::filesystem::path folder =
      parent / ("c3de-output-" + std::to_string(processId()) + "-" + std::to_string(now));
  if (!std::filesystem::create_directory(folder, code))
    return fail(ErrorCode::output, "standard output: " + pathText(folder) + " cannot be made: " + code.message());
  return folder;
}

}  // namespace

Expected<std::string> readSceneFromInput() {
  std::string text;
  std::array<char, 65536> block{};
  while (const std::size_t count = std::fread(block.data(), 1, block.size(), stdin)) {
    text.append(block.data(), count);
    if (text.size() > kMostBytes)
      return fail(ErrorCode::input, "standard input: more than 64 MiB; accepted: a scene as TOML");
  }
  if (std::ferror(stdin) != 0) return fail(ErrorCode::input, "standard input: cannot be read");
  if (text.empty()) return fail(ErrorCode::input, "standard input: is empty; accepted: a scene as TOML");
  return text;
}

StandardOutputFile::~StandardOutputFile() {
  std::error_code ignored;
  if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

Expected<void> StandardOutputFile::take(const std::vector<std::pair<const char *, std::filesystem::path *>> &outputs) {
  const char *taken = nullptr;
  for (const auto &[option, file] : outputs) {
    if (*file != kStandardStream) continue;
    if (taken != nullptr)
      return fail(ErrorCode::usage, std::string(taken) + " and " + option +
                                        " both write to standard output; accepted: `-` for one output");
    taken = option;
    auto folder = ownFolder();
    if (!folder) return tl::unexpected(folder.error());
    folder_ = std::move(*folder);
    file_ = folder_ / "standard-output";
    *file = file_;
  }
  if (taken != nullptr) reserveStandardOutput();
  return {};
}

Expected<void> StandardOutputFile::print() {
  std::error_code code;
  if (file_.empty() || !std::filesystem::exists(file_, code)) return {};
  std::ifstream in(file_, std::ios::binary);
  std::array<char, 65536> block{};
  while (in.read(block.data(), block.size()) || in.gcount() > 0)
    printResult({block.data(), static_cast<std::size_t>(in.gcount())});
  if (in.bad()) return fail(ErrorCode::output, "standard output: " + pathText(file_) + " cannot be read again");
  return {};
}

}  // namespace c3de::app
