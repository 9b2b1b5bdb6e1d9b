// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/written_outputs.h"

#include <cstdint>
#include <system_error>

#include "c3de/core/log.h"

namespace c3de::session {
namespace {

std::string listOf(const std::vector<std::filesystem::path> &files) {
  std::string text;
  for (const auto &file : files) text += (text.empty() ? "" : ", ") + file.string();
  return text;
}

}  // namespace

void WrittenOutputs::add(const std::filesystem::path &file) {
  written_.push_back(file);
  std::error_code code;
  const std::uintmax_t bytes = std::filesystem::file_size(file, code);
  log(LogLevel::debug, "wrote " + file.string() + (code ? std::string() : ", " + std::to_string(bytes) + " bytes"));
}

void WrittenOutputs::addFailure(const std::filesystem::path &file, const Error &error) {
  log(LogLevel::error, error.message);
  if (failed_.empty()) code_ = error.code;
  failed_.push_back(file);
}

std::string WrittenOutputs::written() const { return listOf(written_); }

Error WrittenOutputs::error() const {
  return {code_,
          "not completely written: " + listOf(failed_) + "; written: " + (written_.empty() ? "nothing" : written())};
}

}  // namespace c3de::session
