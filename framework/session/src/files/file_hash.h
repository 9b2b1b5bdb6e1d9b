// SPDX-License-Identifier: Apache-2.0
// SHA-256 of files and folders, read in pieces.
#pragma once

#include <openssl/evp.h>

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"

namespace c3de::session {

class Sha256 {
 public:
  Sha256();
  void add(std::string_view bytes);
  /// 64 lower-case hexadecimal digits. Errors: internal.
  [[nodiscard]] Expected<std::string> digits();

 private:
  struct Free {
    void operator()(EVP_MD_CTX *context) const { EVP_MD_CTX_free(context); }
  };
  std::unique_ptr<EVP_MD_CTX, Free> context_;
  bool isGood_ = false;
};

/// A line of the list whose hash is that of a folder.
[[nodiscard]] std::string lineOfFolder(const std::string &sha256, const std::string &name);

/// Reports a part of work that is measured in bytes.
class ByteProgress {
 public:
  /// @param verb  "Checking"
  ByteProgress(const ProgressFn &report, std::uint64_t total, std::string verb = "Checking")
      : report_(report), total_(total), verb_(std::move(verb)) {}
  /// Errors: cancelled.
  [[nodiscard]] Expected<void> add(std::uint64_t bytes, const std::string &name);

 private:
  const ProgressFn &report_;
  std::uint64_t total_ = 0, done_ = 0;
  std::string verb_;
};

/// A file, or the files of a folder.
struct Content {
  std::filesystem::path path;
  std::vector<std::filesystem::path> files;  ///< of a folder: relative to it, in order; of a file: empty
  bool isFolder = false;
  std::uint64_t bytes = 0;
};

/// Files below a folder, links to files included. Errors: input.
/// @param enoughBytes  of a folder that has more, the rest is not listed
[[nodiscard]] Expected<Content> contentOf(const std::filesystem::path &path,
                                          std::uint64_t enoughBytes = std::numeric_limits<std::uint64_t>::max());
/// Errors: input, cancelled.
[[nodiscard]] Expected<std::string> hashOfFile(const std::filesystem::path &file, ByteProgress &progress);
[[nodiscard]] Expected<std::string> hashOf(const Content &content, ByteProgress &progress);

}  // namespace c3de::session
