// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "c3de/core/expected.h"

namespace c3de::imaging {

/// Writes beside the file and takes its place when all is written, so that what was there stays until then.
class FileWriter {
 public:
  enum class Packing { none, gzip, zlib };
  [[nodiscard]] static Expected<FileWriter> open(const std::filesystem::path &path);
  FileWriter(FileWriter &&) = default;
  FileWriter &operator=(FileWriter &&) = delete;
  ~FileWriter();  ///< removes what was not committed

  void write(std::string_view bytes);
  /// The bytes as a stream of that packing; empty if there is no memory for it.
  [[nodiscard]] static std::string packed(std::string_view bytes, Packing packing);
  [[nodiscard]] Expected<void> commit();

 private:
  FileWriter(std::filesystem::path path, std::filesystem::path temporary);
  std::filesystem::path path_, temporary_;
  std::ofstream file_;
};

}  // namespace c3de::imaging
