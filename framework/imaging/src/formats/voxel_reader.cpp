// SPDX-License-Identifier: Apache-2.0
#include "formats/voxel_reader.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <new>
#include <optional>
#include <string_view>

#include "c3de/core/platform.h"
#include "formats/voxel_bytes.h"

namespace c3de::imaging {
namespace {

std::string megabytes(double bytes) { return std::to_string(static_cast<long long>(std::ceil(bytes / 1e6))) + " MB"; }

template <class T>
void swapBytes(std::vector<T> &all) {
  if constexpr (sizeof(T) > 1)
    for (T &x : all) {
      auto raw = std::bit_cast<std::array<unsigned char, sizeof(T)>>(x);
      std::reverse(raw.begin(), raw.end());
      x = std::bit_cast<T>(raw);
    }
}

/// Reads and discards until the end of all volumes or of the data. @return number of complete volumes
Expected<std::size_t> countVolumes(const ImageHeader &header, const ReadOptions &options, VoxelBytes &bytes) {
  std::vector<char> away(1u << 20);
  const double all = bytesOfAll(header);
  while (bytes.at() < all) {
    if (!shouldContinue(options.progress, bytes.at() / all, "Checking whether the file is complete"))
      return cancelled(header.path);
    if (!bytes.read(away.data(),
                    static_cast<std::size_t>(std::min(static_cast<double>(away.size()), all - bytes.at()))))
      break;
  }
  return static_cast<std::size_t>(bytes.at() / bytesOfVolume(header));
}

/// The values of one volume. @param whole  complete volumes of the file; set if it was unknown
template <class T>
Expected<void> readBinary(const ImageHeader &header, const ReadOptions &options, std::vector<T> &all,
                          std::optional<std::size_t> &whole, std::vector<std::string> &notices) {
  const double share = bytesOfAll(header) / static_cast<double>(header.parts.size());
  if (share != std::floor(share))
    return refuse(header.path,
                  "its voxels do not divide evenly into " + std::to_string(header.parts.size()) + " files");
  VoxelBytes bytes(header);
  // values per voxel, of which `kept` are used
  const std::size_t together = header.interleaved ? header.volumes * header.channels : 1;
  const std::size_t kept = header.interleaved ? header.channels : 1;
  if (!header.interleaved) bytes.skip(static_cast<double>(options.time) * bytesOfVolume(header));
  const std::size_t chunk = std::max<std::size_t>(1, (4u << 20) / (sizeof(T) * together));
  std::vector<T> mixed(together > kept ? chunk * together : 0);
  for (std::size_t at = 0; at < all.size(); at += chunk * kept) {
    if (!shouldContinue(options.progress, static_cast<double>(at) / static_cast<double>(all.size()), "Reading voxels"))
      return cancelled(header.path);
    const std::size_t groups = std::min(chunk, (all.size() - at) / kept);
    T *to = mixed.empty() ? all.data() + at : mixed.data();
    if (auto read = bytes.read(to, groups * together * sizeof(T)); !read) return read;
    if (mixed.empty()) continue;
    for (std::size_t g = 0; g < groups; ++g)
      std::copy_n(mixed.begin() + static_cast<std::ptrdiff_t>(g * together + options.time * kept), kept,
                  all.begin() + static_cast<std::ptrdiff_t>(at + g * kept));
  }
  if (bytes.at() >= bytesOfAll(header)) {
    whole = header.volumes;
    if (const std::string fault = bytes.faultAtEnd(); !fault.empty()) {
      if (fault.find("damaged") != std::string::npos) return refuse(header.path, fault + " (checksum)");
      notices.push_back("The file ends before its checksum, so the voxels cannot be verified.");
    }
  } else if (!whole) {
    const auto counted = countVolumes(header, options, bytes);
    if (!counted) return tl::unexpected(counted.error());
    whole = *counted;
  }
  if (const double behind = bytes.leftOver(); behind > 0.0)
    notices.push_back("The file holds " + std::to_string(static_cast<long long>(behind)) + " bytes behind the " +
                      std::to_string(static_cast<long long>(bytesOfAll(header))) +
                      " of the voxels that its header says; they are left out. Is the size in the header right?");
  if (header.bigEndian != (std::endian::native == std::endian::big)) swapBytes(all);
  return {};
}

int hexDigit(int c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// Index of the n-th number of a text in a volume; none: it belongs to another volume.
std::optional<std::size_t> placeIn(const ImageHeader &header, std::size_t time, std::size_t n) {
  const std::size_t each = header.channels, all = header.geometry.voxelCount() * each;
  if (!header.interleaved) return n / all == time ? std::optional(n % all) : std::nullopt;
  return n / each % header.volumes == time ? std::optional(n / (each * header.volumes) * each + n % each)
                                           : std::nullopt;
}

/// Numbers as text (or bytes as pairs of hexadecimal digits), all in one file.
template <class T>
Expected<void> readText(const ImageHeader &header, const ReadOptions &options, std::vector<T> &all,
                        std::optional<std::size_t> &whole, std::vector<std::string> &notices) {
  if (header.parts.size() != 1) return refuse(header.path, "voxels as text in several files are not read");
  auto opened = openBytes(header.parts[0].path, header.parts[0].offset, false);
  if (!opened) return tl::unexpected(opened.error());
  std::vector<char> chunk(1u << 16);
  std::string word;
  const std::size_t total = all.size() * header.volumes;
  const std::size_t needed = header.interleaved ? total : all.size() * (options.time + 1);
  std::size_t count = 0, held = 0;
  std::array<unsigned char, sizeof(T)> raw{};
  const bool hex = header.encoding == ImageHeader::Encoding::hex;
  const auto put = [&](T value) {
    if (const auto at = placeIn(header, options.time, count)) all[*at] = value;
    ++count;
  };
  const auto take = [&](int c) -> bool {  // false: not a number
    const bool blank = c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ',' || c == EOF;
    if (hex) {
      if (blank) return true;
      if (hexDigit(c) < 0) return false;
      raw[held / 2] = static_cast<unsigned char>(raw[held / 2] << 4 | hexDigit(c));
      if (++held == 2 * sizeof(T)) put(std::bit_cast<T>(raw)), held = 0;
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
      if (!(value >= static_cast<double>(std::numeric_limits<T>::lowest()) &&
            value <= static_cast<double>(std::numeric_limits<T>::max())))
        return false;
    put(static_cast<T>(value));
    word.clear();
    return true;
  };
  bool isGood = true, isEnd = false;
  while (count < total && isGood && !isEnd) {
    std::size_t i = 0;
    const std::size_t got = (*opened)->read(chunk.data(), chunk.size());
    if (!shouldContinue(options.progress, static_cast<double>(count) / static_cast<double>(total), "Reading voxels"))
      return cancelled(header.path);
    for (; i < got && count < total && isGood; ++i) isGood = take(static_cast<unsigned char>(chunk[i]));
    isEnd = got == 0;
    if (isEnd) isGood = take(EOF);
    if (count == total && std::string_view(chunk.data(), got).find_first_not_of(" \t\r\n,", i) != std::string::npos)
      notices.push_back("The file holds more numbers than the " + std::to_string(total) +
                        " voxels that its header says; they are left out. Is the size in the header right?");
  }
  if (count < needed && !isGood)
    return refuse(header.parts[0].path, "voxel " + std::to_string(count) + " is no number of the stored type");
  if (count < needed)
    return refuse(header.parts[0].path,
                  "is truncated: " + std::to_string(count) + " of " + std::to_string(total) + " voxels");
  whole = count / all.size();
  if (hex && header.bigEndian != (std::endian::native == std::endian::big)) swapBytes(all);
  return {};
}

template <class T>
Expected<std::vector<T>> readAll(const ImageHeader &header, const ReadOptions &options,
                                 std::optional<std::size_t> &whole, std::vector<std::string> &notices) {
  std::vector<T> all(header.geometry.voxelCount() * header.channels);
  const bool binary =
      header.encoding == ImageHeader::Encoding::raw || header.encoding == ImageHeader::Encoding::deflated;
  const auto read =
      binary ? readBinary(header, options, all, whole, notices) : readText(header, options, all, whole, notices);
  if (!read) return tl::unexpected(read.error());
  return all;
}

template <class T>
Expected<Voxels> readOf(const ImageHeader &header, const ReadOptions &options, std::optional<std::size_t> &whole,
                        std::vector<std::string> &notices) {
  auto all = readAll<T>(header, options, whole, notices);
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

Expected<Voxels> readStored(const ImageHeader &header, const ReadOptions &options, std::optional<std::size_t> &whole,
                            std::vector<std::string> &notices) {
  try {
    switch (header.scalar) {
      case Scalar::i8: return readOf<std::int8_t>(header, options, whole, notices);
      case Scalar::u8: return readOf<std::uint8_t>(header, options, whole, notices);
      case Scalar::i16: return readOf<std::int16_t>(header, options, whole, notices);
      case Scalar::u16: return readOf<std::uint16_t>(header, options, whole, notices);
      case Scalar::i32: return readOf<std::int32_t>(header, options, whole, notices);
      case Scalar::u32: return readOf<std::uint32_t>(header, options, whole, notices);
      case Scalar::i64: return readOf<std::int64_t>(header, options, whole, notices);
      case Scalar::u64: return readOf<std::uint64_t>(header, options, whole, notices);
      case Scalar::f32: return readOf<float>(header, options, whole, notices);
      case Scalar::f64: break;
    }
    return readOf<double>(header, options, whole, notices);
  } catch (const std::bad_alloc &) {
    return refuse(header.path,
                  "reading needs " + megabytes(bytesOfVolume(header)) + " of memory, which is not available");
  }
}

const char *volumesOf(const ImageHeader &header) { return header.layered ? "layers" : "time points"; }

/// "3 time points (0 … 2)"
std::string listOf(const ImageHeader &header, std::size_t count) {
  return std::to_string(count) + " " + volumesOf(header) +
         (count > 0 ? " (0 … " + std::to_string(count - 1) + ")" : "");
}

}  // namespace

bool shouldContinue(const ProgressFn &progress, double fraction, const std::string &what) {
  return !progress || progress(fraction, what);
}

tl::unexpected<Error> cancelled(const std::filesystem::path &path) {
  return fail(ErrorCode::cancelled, path.string() + ": reading was cancelled");
}

Expected<void> checkMemory(const std::filesystem::path &path, double bytes, std::size_t limit) {
  const double most = limit != 0 ? static_cast<double>(limit) : static_cast<double>(availableMemory());
  if (most == 0.0 || bytes <= most) return {};
  return refuse(path, "reading needs " + megabytes(bytes) + " of memory; " +
                          (limit != 0 ? "allowed are " : "free are ") + megabytes(most));
}

Expected<Voxels> readVoxels(const ImageHeader &header, const ReadOptions &options, std::vector<std::string> &notices) {
  if (options.time >= header.volumes)
    return refuse(header.path, "time " + std::to_string(options.time) + " is asked for; the file has " +
                                   (header.volumes == 1 ? "one time point (0)" : listOf(header, header.volumes)));
  const double bytes = bytesOfVolume(header);
  std::optional<std::size_t> whole = wholeVolumesBySize(header);
  if (whole && header.volumes > 1 && *whole <= options.time)
    return refuse(header.path, "is cut: of " + listOf(header, header.volumes) + " that its header promises " +
                                   std::to_string(*whole) + " are whole; " + std::to_string(options.time) +
                                   " is not among them");
  const double needed = header.interleaved ? bytesOfAll(header) : bytes * static_cast<double>(options.time + 1);
  if (const auto fits = checkFileSize(header, needed); !fits) return tl::unexpected(fits.error());
  const bool narrowed = header.scalar == Scalar::i64 || header.scalar == Scalar::u64;
  if (const auto fits = checkMemory(header.path, (narrowed ? 2.0 : 1.0) * bytes, options.memoryLimit); !fits)
    return tl::unexpected(fits.error());
  auto voxels = readStored(header, options, whole, notices);
  if (!voxels) return voxels;
  if (header.volumes > 1 && !header.layered)
    notices.push_back("The file holds " + listOf(header, header.volumes) + ": " + std::to_string(options.time) +
                      " is read.");
  if (whole && *whole < header.volumes)
    notices.push_back("The file is cut or damaged: of " + std::to_string(header.volumes) + " " + volumesOf(header) +
                      " that its header promises " +
                      (*whole == 1 ? "only the first is" : "the first " + std::to_string(*whole) + " are") + " whole.");
  return voxels;
}

}  // namespace c3de::imaging
