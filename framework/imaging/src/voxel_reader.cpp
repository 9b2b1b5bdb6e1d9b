// SPDX-License-Identifier: Apache-2.0
#include "voxel_reader.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <new>

#include "byte_stream.h"
#include "c3de/core/platform.h"

namespace c3de::imaging {
namespace {

std::string megabytes(double bytes) { return std::to_string(static_cast<long long>(std::ceil(bytes / 1e6))) + " MB"; }

/// The parts of a file one after the other; each holds an equal share of all bytes, so a short one leaves no shift.
class Joined {
 public:
  Joined(const ImageHeader &header, double shareBytes) : header_(header), share_(shareBytes) {}

  [[nodiscard]] Expected<void> read(void *to, std::size_t bytes) {
    auto *next = static_cast<char *>(to);
    while (bytes > 0) {
      if (!stream_) {
        if (part_ >= header_.parts.size()) return refuse(header_.path, "its files hold fewer voxels than the header says");
        const ImageHeader::Part &part = header_.parts[part_];
        auto opened = openBytes(part.path, part.offset, header_.encoding == ImageHeader::Encoding::deflated);
        if (!opened) return tl::unexpected(opened.error());
        stream_ = std::move(*opened);
        left_ = share_;
        if (!skipBytes(*stream_, header_.skip)) return refuse(part.path, "ends before its voxels begin" + because());
      }
      const auto part = static_cast<std::size_t>(std::min(left_, static_cast<double>(bytes)));
      const std::size_t got = stream_->read(next, part);
      done_ += static_cast<double>(got);
      if (got < part)
        return refuse(header_.parts[part_].path, "is truncated or damaged: the voxels end after " + std::to_string(static_cast<long long>(done_)) +
                                                     " of " + std::to_string(static_cast<long long>(share_ * static_cast<double>(header_.parts.size()))) +
                                                     " bytes" + because());
      next += got;
      bytes -= got;
      left_ -= static_cast<double>(got);
      if (left_ <= 0.0 && bytes > 0) stream_.reset(), ++part_;
    }
    return {};
  }
  /// Looks at the check sum behind the last voxel.
  [[nodiscard]] std::string faultAtEnd() {
    if (!stream_) return {};
    stream_->finish();
    return stream_->fault();
  }

 private:
  [[nodiscard]] std::string because() const { return stream_->fault().empty() ? "" : " (" + stream_->fault() + ")"; }

  const ImageHeader &header_;
  double share_, left_ = 0.0, done_ = 0.0;
  std::size_t part_ = 0;
  std::unique_ptr<ByteStream> stream_;
};

template <class T>
void swapBytes(std::vector<T> &all) {
  if constexpr (sizeof(T) > 1)
    for (T &x : all) {
      auto raw = std::bit_cast<std::array<unsigned char, sizeof(T)>>(x);
      std::reverse(raw.begin(), raw.end());
      x = std::bit_cast<T>(raw);
    }
}

template <class T>
Expected<void> readBinary(const ImageHeader &header, const ReadOptions &options, std::vector<T> &all, std::vector<std::string> &notices) {
  const double total = static_cast<double>(all.size()) * static_cast<double>(header.volumes) * sizeof(T);
  const double share = total / static_cast<double>(header.parts.size());
  if (share != std::floor(share)) return refuse(header.path, "its voxels do not divide evenly into " + std::to_string(header.parts.size()) + " files");
  Joined bytes(header, share);
  const std::size_t chunk = (4u << 20) / sizeof(T);
  for (std::size_t at = 0; at < all.size(); at += chunk) {
    if (!goOn(options.progress, static_cast<double>(at) / static_cast<double>(all.size()), "Reading voxels")) return cancelled(header.path);
    if (auto read = bytes.read(all.data() + at, std::min(chunk, all.size() - at) * sizeof(T)); !read) return read;
  }
  if (header.volumes == 1)
    if (const std::string fault = bytes.faultAtEnd(); !fault.empty()) {
      if (fault.find("damaged") != std::string::npos) return refuse(header.path, fault + " (check sum)");
      notices.push_back("The file ends before its check sum: whether the voxels are undamaged is not known.");
    }
  if (header.bigEndian != (std::endian::native == std::endian::big)) swapBytes(all);
  return {};
}

int hexDigit(int c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// Numbers as text (or bytes as pairs of hexadecimal digits), of which one file holds all.
template <class T>
Expected<void> readText(const ImageHeader &header, const ReadOptions &options, std::vector<T> &all) {
  if (header.parts.size() != 1) return refuse(header.path, "voxels as text in several files are not read");
  auto opened = openBytes(header.parts[0].path, header.parts[0].offset, false);
  if (!opened) return tl::unexpected(opened.error());
  std::vector<char> chunk(1u << 16);
  std::string word;
  std::size_t count = 0, held = 0;
  std::array<unsigned char, sizeof(T)> raw{};
  const bool hex = header.encoding == ImageHeader::Encoding::hex;
  const auto take = [&](int c) -> bool {  // false: no number
    const bool blank = c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ',' || c == EOF;
    if (hex) {
      if (blank) return true;
      if (hexDigit(c) < 0) return false;
      raw[held / 2] = static_cast<unsigned char>(raw[held / 2] << 4 | hexDigit(c));
      if (++held == 2 * sizeof(T)) all[count++] = std::bit_cast<T>(raw), held = 0;
      return true;
    }
    if (!blank) {
      word += static_cast<char>(c);
      return word.size() < 64;
    }
    if (word.empty()) return true;
    double value = 0.0;
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || stop != word.data() + word.size()) return false;
    if constexpr (std::is_integral_v<T>)
      if (!(value >= static_cast<double>(std::numeric_limits<T>::lowest()) && value <= static_cast<double>(std::numeric_limits<T>::max()))) return false;
    all[count++] = static_cast<T>(value);
    word.clear();
    return true;
  };
  while (count < all.size()) {
    const std::size_t got = (*opened)->read(chunk.data(), chunk.size());
    if (!goOn(options.progress, static_cast<double>(count) / static_cast<double>(all.size()), "Reading voxels")) return cancelled(header.path);
    for (std::size_t i = 0; i < got && count < all.size(); ++i)
      if (!take(static_cast<unsigned char>(chunk[i])))
        return refuse(header.parts[0].path, "voxel " + std::to_string(count) + " is no number of the stored type");
    if (got == 0) {
      const bool good = take(EOF);
      if (!good || count < all.size())
        return refuse(header.parts[0].path, "is truncated: " + std::to_string(count) + " of " + std::to_string(all.size()) + " voxels");
    }
  }
  if (hex && header.bigEndian != (std::endian::native == std::endian::big)) swapBytes(all);
  return {};
}

template <class T>
Expected<std::vector<T>> readAll(const ImageHeader &header, const ReadOptions &options, std::vector<std::string> &notices) {
  std::vector<T> all(header.geometry.voxelCount());
  const bool binary = header.encoding == ImageHeader::Encoding::raw || header.encoding == ImageHeader::Encoding::deflated;
  const auto read = binary ? readBinary(header, options, all, notices) : readText(header, options, all);
  if (!read) return tl::unexpected(read.error());
  return all;
}

template <class T>
Expected<Voxels> readOf(const ImageHeader &header, const ReadOptions &options, std::vector<std::string> &notices) {
  auto all = readAll<T>(header, options, notices);
  if (!all) return tl::unexpected(all.error());
  if constexpr (sizeof(T) == 8 && std::is_integral_v<T>) {
    using Narrow = std::conditional_t<std::is_signed_v<T>, std::int32_t, std::uint32_t>;
    const auto [least, most] = std::minmax_element(all->begin(), all->end());
    if (*least >= std::numeric_limits<Narrow>::lowest() && *most <= std::numeric_limits<Narrow>::max())
      return Voxels(std::vector<Narrow>(all->begin(), all->end()));
    notices.push_back("64-bit integers beyond the range of 32 bits are kept as floating point.");
    return Voxels(std::vector<double>(all->begin(), all->end()));
  } else {
    return Voxels(std::move(*all));
  }
}

/// A header can say anything; what cannot be in files of this size is refused before memory is taken for it.
Expected<void> checkFileSize(const ImageHeader &header, double bytes) {
  double there = 0.0;
  for (const ImageHeader::Part &part : header.parts) {
    std::error_code code;
    const auto size = std::filesystem::file_size(part.path, code);
    if (code) return refuse(part.path, "no such file (named by " + header.path.filename().string() + ")");
    there += static_cast<double>(size) - static_cast<double>(part.offset);
  }
  const double least = header.encoding == ImageHeader::Encoding::raw        ? bytes
                       : header.encoding == ImageHeader::Encoding::deflated ? bytes / 1040.0 - 1000.0  // deflate's best is 1:1032
                                                                            : bytes / 8.0;
  if (there >= least) return {};
  return refuse(header.path, "is truncated or damaged: the header says " + std::to_string(static_cast<long long>(bytes)) +
                                 " bytes of voxels, the file has " + std::to_string(static_cast<long long>(std::max(there, 0.0))) +
                                 (header.encoding == ImageHeader::Encoding::deflated ? " compressed ones" : ""));
}

}  // namespace

bool goOn(const ProgressFn &progress, double fraction, const std::string &what) { return !progress || progress(fraction, what); }

tl::unexpected<Error> cancelled(const std::filesystem::path &path) { return fail(ErrorCode::cancelled, path.string() + ": reading was cancelled"); }

Expected<void> checkMemory(const std::filesystem::path &path, double bytes, std::size_t limit) {
  const double most = limit != 0 ? static_cast<double>(limit) : static_cast<double>(availableMemory());
  if (most == 0.0 || bytes <= most) return {};
  return refuse(path, "reading needs " + megabytes(bytes) + " of memory; " + (limit != 0 ? "allowed are " : "free are ") + megabytes(most));
}

Expected<Voxels> readVoxels(const ImageHeader &header, const ReadOptions &options, std::vector<std::string> &notices) {
  const double bytes = static_cast<double>(header.geometry.voxelCount()) * static_cast<double>(bytesOf(header.scalar));
  if (const auto fits = checkFileSize(header, bytes); !fits) return tl::unexpected(fits.error());
  const bool narrowed = header.scalar == Scalar::i64 || header.scalar == Scalar::u64;
  if (const auto fits = checkMemory(header.path, (narrowed ? 2.0 : 1.0) * bytes, options.memoryLimit); !fits) return tl::unexpected(fits.error());
  if (header.volumes > 1)
    notices.push_back("The file holds " + std::to_string(header.volumes) + " volumes: the first is read.");
  try {
    switch (header.scalar) {
      case Scalar::i8: return readOf<std::int8_t>(header, options, notices);
      case Scalar::u8: return readOf<std::uint8_t>(header, options, notices);
      case Scalar::i16: return readOf<std::int16_t>(header, options, notices);
      case Scalar::u16: return readOf<std::uint16_t>(header, options, notices);
      case Scalar::i32: return readOf<std::int32_t>(header, options, notices);
      case Scalar::u32: return readOf<std::uint32_t>(header, options, notices);
      case Scalar::i64: return readOf<std::int64_t>(header, options, notices);
      case Scalar::u64: return readOf<std::uint64_t>(header, options, notices);
      case Scalar::f32: return readOf<float>(header, options, notices);
      case Scalar::f64: break;
    }
    return readOf<double>(header, options, notices);
  } catch (const std::bad_alloc &) {
    return refuse(header.path, "reading needs " + megabytes(bytes) + " of memory, which the machine does not give");
  }
}

}  // namespace c3de::imaging
