// SPDX-License-Identifier: Apache-2.0
#include "c3de/core/input_file.h"
#include "c3de/core/file_path.h"

#include <algorithm>

#include "c3de/core/path_text.h"

namespace c3de {
namespace {

const char *kindOf(std::filesystem::file_type type) {
  switch (type) {
    case std::filesystem::file_type::directory: return "a folder";
    case std::filesystem::file_type::fifo: return "a pipe (FIFO)";
    case std::filesystem::file_type::socket: return "a socket";
    case std::filesystem::file_type::block:
    case std::filesystem::file_type::character: return "a device";
    default: return "something else";
  }
}

}  // namespace

std::string describeNonFile(const std::filesystem::path &path) {
  std::error_code code;
  const std::filesystem::file_status status = std::filesystem::status(path, code);
  switch (status.type()) {
    case std::filesystem::file_type::regular: return {};
    case std::filesystem::file_type::not_found: return "no such file";
    case std::filesystem::file_type::none: return "cannot be reached: " + code.message();
    default: return std::string("is ") + kindOf(status.type()) + ", not a file";
  }
}

Expected<void> checkInputFile(const std::filesystem::path &path) {
  const std::string instead = describeNonFile(path);
  if (instead.empty()) return {};
  return fail(ErrorCode::input, pathText(path) + ": " + instead);
}

Expected<std::ifstream> openInputFile(const std::filesystem::path &path) {
  if (const auto good = checkInputFile(path); !good) return tl::unexpected(good.error());
  std::ifstream file(path, std::ios::binary);
  if (!file) return fail(ErrorCode::input, pathText(path) + ": cannot be opened (no permission to read it?)");
  return file;
}

std::filesystem::path namedFile(const std::filesystem::path &folder, const std::string &name) {
  std::filesystem::path asWritten = joinedPath(folder, pathFromText(name));
  std::error_code code;
  if (name.find('\\') == std::string::npos || std::filesystem::exists(asWritten, code)) return asWritten;
  std::string slashed = name;
  std::replace(slashed.begin(), slashed.end(), '\\', '/');
  std::filesystem::path other = joinedPath(folder, pathFromText(slashed));
  return std::filesystem::exists(other, code) ? other : asWritten;
}

}  // namespace c3de
