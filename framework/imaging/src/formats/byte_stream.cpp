// SPDX-License-Identifier: Apache-2.0
#include "formats/byte_stream.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>

#include "c3de/core/input_file.h"

namespace c3de::imaging {
namespace {

class FileBytes : public ByteStream {
 public:
  explicit FileBytes(std::ifstream file) : file_(std::move(file)) {}
  std::size_t read(void *to, std::size_t bytes) override {
    file_.read(static_cast<char *>(to), static_cast<std::streamsize>(bytes));
    return static_cast<std::size_t>(file_.gcount());
  }
  [[nodiscard]] std::string fault() const override { return file_.bad() ? "it cannot be read" : ""; }
  std::size_t finish() override { return 0; }

 private:
  std::ifstream file_;
};

class InflatedBytes : public ByteStream {
 public:
  explicit InflatedBytes(std::ifstream file) : file_(std::move(file)), input_(1u << 16) {
    ready_ = inflateInit2(&z_, 15 + 32) == Z_OK;  // 32: detects gzip or zlib
    if (!ready_) fault_ = "the decompressor does not start";
  }
  ~InflatedBytes() override {
    if (ready_) inflateEnd(&z_);
  }
  InflatedBytes(const InflatedBytes &) = delete;
  InflatedBytes &operator=(const InflatedBytes &) = delete;

  std::size_t read(void *to, std::size_t bytes) override {
    auto *next = static_cast<Bytef *>(to);
    std::size_t left = bytes;
    while (left > 0 && fault_.empty() && !ended_) {
      if (z_.avail_in == 0) refill();
      z_.next_out = next;
      z_.avail_out = static_cast<uInt>(std::min<std::size_t>(left, 1u << 30));
      const uInt asked = z_.avail_out;
      const bool atEnd = z_.avail_in == 0;
      const int answer = inflate(&z_, Z_NO_FLUSH);
      const std::size_t got = asked - z_.avail_out;
      next += got;
      left -= got;
      if (answer == Z_STREAM_END) {
        nextMember();
      } else if (answer == Z_BUF_ERROR || (answer == Z_OK && atEnd && got == 0)) {
        fault_ = "the compressed data end too early";
      } else if (answer != Z_OK) {
        fault_ = "the compressed data are damaged";
      }
    }
    return bytes - left;
  }
  [[nodiscard]] std::string fault() const override { return fault_; }
  std::size_t finish() override {
    std::array<char, 4096> rest;
    std::size_t behind = 0;
    // Long data after the voxels are another volume: not worth the time.
    for (int i = 0; i < 64 && !ended_ && fault_.empty(); ++i)
      if (const std::size_t got = read(rest.data(), rest.size()); got == 0)
        break;
      else
        behind += got;
    return behind;
  }

 private:
  void refill() {
    file_.read(reinterpret_cast<char *>(input_.data()), static_cast<std::streamsize>(input_.size()));
    z_.next_in = input_.data();
    z_.avail_in = static_cast<uInt>(file_.gcount());
  }
  /// gzip files may be concatenated; any other trailing data are ignored.
  void nextMember() {
    if (z_.avail_in == 0) refill();
    if (z_.avail_in >= 1 && z_.next_in[0] == 0x1f && inflateReset(&z_) == Z_OK) return;
    ended_ = true;
  }

  std::ifstream file_;
  std::vector<Bytef> input_;
  z_stream z_{};
  bool ready_ = false, ended_ = false;
  std::string fault_;
};

}  // namespace

Expected<std::unique_ptr<ByteStream>> openBytes(const std::filesystem::path &path, std::uint64_t offset,
                                                bool deflated) {
  auto file = openInputFile(path);
  if (!file) return tl::unexpected(file.error());
  file->seekg(static_cast<std::streamoff>(offset));
  if (!*file)
    return fail(ErrorCode::input,
                path.string() + ": has no byte " + std::to_string(offset) + ", where the voxels should begin");
  if (deflated) return std::make_unique<InflatedBytes>(std::move(*file));
  return std::make_unique<FileBytes>(std::move(*file));
}

bool skipBytes(ByteStream &stream, std::uint64_t bytes) {
  std::vector<char> away(static_cast<std::size_t>(std::min<std::uint64_t>(bytes, 1u << 16)));
  while (bytes > 0) {
    const auto part = static_cast<std::size_t>(std::min<std::uint64_t>(bytes, away.size()));
    if (stream.read(away.data(), part) != part) return false;
    bytes -= part;
  }
  return true;
}

bool isGzip(const std::filesystem::path &path) {
  auto file = openInputFile(path);
  return file && file->get() == 0x1f && file->get() == 0x8b;
}

Expected<std::vector<unsigned char>> firstBytes(const std::filesystem::path &path, std::size_t bytes) {
  auto stream = openBytes(path, 0, isGzip(path));
  if (!stream) return tl::unexpected(stream.error());
  std::vector<unsigned char> all(bytes);
  all.resize((*stream)->read(all.data(), bytes));
  return all;
}

}  // namespace c3de::imaging
