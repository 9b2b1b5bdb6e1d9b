// SPDX-License-Identifier: Apache-2.0
#include "formats/voxel_bytes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "c3de/core/input_file.h"

namespace c3de::imaging {
namespace {

std::string whole(double x) { return std::to_string(static_cast<long long>(x)); }

/// Whether the trailer of a gzip file states this inflated size (modulo 2³²); a truncated file has a different end.
bool endsAsGzipOf(const ImageHeader::Part &part, double bytes) {
  auto opened = openInputFile(part.path);
  if (!opened) return false;
  std::ifstream &file = *opened;
  file.seekg(static_cast<std::streamoff>(part.offset));
  if (file.get() != 0x1f || file.get() != 0x8b) return false;
  std::array<unsigned char, 4> last{};
  file.seekg(-4, std::ios::end);
  if (!file.read(reinterpret_cast<char *>(last.data()), 4)) return false;
  const double stated = last[0] + 256.0 * (last[1] + 256.0 * (last[2] + 256.0 * last[3]));
  return stated == std::fmod(bytes, 4294967296.0);
}

}  // namespace

VoxelBytes::VoxelBytes(const ImageHeader &header)
    : header_(header), share_(bytesOfAll(header) / static_cast<double>(header.parts.size())) {}

void VoxelBytes::skip(double bytes) {
  const double to = at_ + bytes;
  const bool staysHere = stream_ && to < static_cast<double>(part_ + 1) * share_;
  if (bytes > 0.0 && !(staysHere && skipBytes(*stream_, static_cast<std::uint64_t>(bytes)))) stream_.reset();
  at_ = to;
}

Expected<void> VoxelBytes::open() {
  part_ = static_cast<std::size_t>(at_ / share_);
  if (part_ >= header_.parts.size()) return refuse(header_.path, "its files hold fewer voxels than the header says");
  const ImageHeader::Part &part = header_.parts[part_];
  const auto within = static_cast<std::uint64_t>(at_ - static_cast<double>(part_) * share_);
  const bool isDeflated = header_.encoding == ImageHeader::Encoding::deflated;
  auto opened = openBytes(part.path, part.offset + (isDeflated ? 0 : within), isDeflated);
  if (!opened) return tl::unexpected(opened.error());
  stream_ = std::move(*opened);
  if (isDeflated && !skipBytes(*stream_, header_.skip + within))
    return refuse(part.path, "is truncated or damaged: it ends before its voxels begin" + because());
  return {};
}

Expected<void> VoxelBytes::read(void *to, std::size_t bytes) {
  auto *next = static_cast<char *>(to);
  while (bytes > 0) {
    if (stream_ && at_ >= static_cast<double>(part_ + 1) * share_) stream_.reset();
    if (!stream_)
      if (auto opened = open(); !opened) return opened;
    const double left = static_cast<double>(part_ + 1) * share_ - at_;
    const auto part = static_cast<std::size_t>(std::min(left, static_cast<double>(bytes)));
    const std::size_t got = stream_->read(next, part);
    at_ += static_cast<double>(got);
    if (got < part)
      return refuse(header_.parts[part_].path, "is truncated or damaged: the voxels end after " + whole(at_) + " of " +
                                                   whole(bytesOfAll(header_)) + " bytes" + because());
    next += got;
    bytes -= got;
  }
  return {};
}

std::string VoxelBytes::faultAtEnd() {
  if (!stream_) return {};
  behind_ = static_cast<double>(stream_->finish());
  return stream_->fault();
}

double VoxelBytes::leftOver() const {
  if (header_.encoding != ImageHeader::Encoding::raw) return behind_;
  double behind = 0.0;
  for (const ImageHeader::Part &part : header_.parts) {
    std::error_code code;
    const auto size = std::filesystem::file_size(part.path, code);
    if (!code) behind += std::max(0.0, static_cast<double>(size) - static_cast<double>(part.offset) - share_);
  }
  return behind;
}

Expected<void> checkFileSize(const ImageHeader &header, double bytes) {
  double there = 0.0;
  for (const ImageHeader::Part &part : header.parts) {
    if (const auto good = checkInputFile(part.path); !good)
      return fail(ErrorCode::input, good.error().message + " (named by " + header.path.filename().string() + ")");
    std::error_code code;
    const auto size = std::filesystem::file_size(part.path, code);
    there += static_cast<double>(size) - static_cast<double>(part.offset);
  }
  const double least = header.encoding == ImageHeader::Encoding::raw ? bytes
                       // the best ratio of deflate is 1:1032
                       : header.encoding == ImageHeader::Encoding::deflated ? bytes / 1040.0 - 1000.0
                                                                            : bytes / 8.0;
  if (there >= least) return {};
  return refuse(header.path, "is truncated or damaged: the header says " + whole(bytes) + " bytes of voxels" +
                                 (header.volumes > 1 ? " up to the end of what is asked for" : "") + ", the file has " +
                                 whole(std::max(there, 0.0)) +
                                 (header.encoding == ImageHeader::Encoding::deflated ? " compressed ones" : ""));
}

std::optional<std::size_t> wholeVolumesBySize(const ImageHeader &header) {
  const double share = bytesOfAll(header) / static_cast<double>(header.parts.size());
  if (header.encoding == ImageHeader::Encoding::deflated) {
    const bool areWhole = std::all_of(header.parts.begin(), header.parts.end(), [&](const ImageHeader::Part &part) {
      return endsAsGzipOf(part, static_cast<double>(header.skip) + share);
    });
    return areWhole ? std::optional(header.volumes) : std::nullopt;
  }
  if (header.encoding != ImageHeader::Encoding::raw) return std::nullopt;
  double there = 0.0;
  for (const ImageHeader::Part &part : header.parts) {
    std::error_code code;
    const auto size = std::filesystem::file_size(part.path, code);
    const double here = code ? 0.0 : std::max(0.0, static_cast<double>(size) - static_cast<double>(part.offset));
    there += std::min(here, share);
    if (here < share) break;
  }
  if (header.interleaved) return there >= bytesOfAll(header) ? header.volumes : 0;
  return static_cast<std::size_t>(there / bytesOfVolume(header));
}

}  // namespace c3de::imaging
