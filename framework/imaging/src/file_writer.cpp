// SPDX-License-Identifier: Apache-2.0
#include "file_writer.h"

#include <zlib.h>

#include <algorithm>

namespace c3de::imaging {

FileWriter::FileWriter(std::filesystem::path path, std::filesystem::path temporary)
    : path_(std::move(path)), temporary_(std::move(temporary)), file_(temporary_, std::ios::binary | std::ios::trunc) {}

FileWriter::~FileWriter() {
  if (!file_.is_open()) return;
  file_.close();
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

Expected<FileWriter> FileWriter::open(const std::filesystem::path &path) {
  std::filesystem::path temporary = path;
  temporary += ".part";
  FileWriter writer(path, temporary);
  if (!writer.file_) return fail(ErrorCode::output, path.string() + ": cannot be written (is there such a folder, and may you write to it?)");
  return writer;
}

void FileWriter::write(std::string_view bytes) { file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size())); }

std::string FileWriter::packed(std::string_view bytes, Packing packing) {
  std::string out;
  if (packing == Packing::none) return std::string(bytes);
  z_stream z{};
  // Level 1: voxels gain little from more, and it is several times as fast.
  if (deflateInit2(&z, 1, Z_DEFLATED, packing == Packing::gzip ? 15 + 16 : 15, 8, Z_DEFAULT_STRATEGY) != Z_OK) return out;
  const char *next = bytes.data();
  std::size_t left = bytes.size();
  int answer = Z_OK;
  char chunk[1u << 16];
  while (answer == Z_OK) {
    if (z.avail_in == 0 && left > 0) {
      z.next_in = reinterpret_cast<Bytef *>(const_cast<char *>(next));
      z.avail_in = static_cast<uInt>(std::min<std::size_t>(left, 1u << 30));
      next += z.avail_in;
      left -= z.avail_in;
    }
    z.next_out = reinterpret_cast<Bytef *>(chunk);
    z.avail_out = sizeof chunk;
    answer = deflate(&z, left == 0 ? Z_FINISH : Z_NO_FLUSH);
    out.append(chunk, sizeof chunk - z.avail_out);
  }
  deflateEnd(&z);
  return out;
}

Expected<void> FileWriter::commit() {
  file_.flush();
  const bool good = file_.good();
  file_.close();
  std::error_code code;
  if (good && !file_.fail()) std::filesystem::rename(temporary_, path_, code);
  if (!good || file_.fail() || code) {
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
    return fail(ErrorCode::output, path_.string() + ": could not be written completely (is the disk full?)");
  }
  return {};
}

}  // namespace c3de::imaging
