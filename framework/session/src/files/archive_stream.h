// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <istream>
#include <memory>
#include <streambuf>

#include "c3de/core/expected.h"

namespace c3de::session {

/// A part of a stream: an archive within a recording.
class PartBuffer : public std::streambuf {
 public:
  PartBuffer(std::istream &whole, std::uint64_t begin, std::uint64_t size)
      : whole_(whole), begin_(begin), size_(size) {}

 protected:
  int_type underflow() override;
  pos_type seekoff(off_type distance, std::ios_base::seekdir from, std::ios_base::openmode which) override;
  pos_type seekpos(pos_type to, std::ios_base::openmode which) override;

 private:
  [[nodiscard]] std::uint64_t position() const { return read_ - static_cast<std::uint64_t>(egptr() - gptr()); }

  std::istream &whole_;
  std::uint64_t begin_, size_;
  std::uint64_t read_ = 0;  ///< bytes before the end of the buffer
  std::array<char, std::size_t{1} << 16> buffer_{};
};

/// The same as a stream of its own. The whole must outlive it and must not be used meanwhile.
class StreamPart : public std::istream {
 public:
  StreamPart(std::istream &whole, std::uint64_t first, std::uint64_t size)
      : std::istream(nullptr), part_(whole, first, size) {
    rdbuf(&part_);
  }

 private:
  PartBuffer part_;
};

/// The archive of a session file, or the one that a recording begins with.
struct Archive {
  std::ifstream file;
  std::unique_ptr<std::istream> part;  ///< of a recording
  [[nodiscard]] std::istream &stream() { return part ? *part : file; }
};
/// Errors: input.
[[nodiscard]] Expected<std::unique_ptr<Archive>> openArchive(const std::filesystem::path &path);

}  // namespace c3de::session
