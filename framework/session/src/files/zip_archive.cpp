// SPDX-License-Identifier: Apache-2.0
#include "files/zip_archive.h"

#include <fmt/format.h>
#include <minizip/unzip.h>
#include <minizip/zip.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <new>
#include <set>
#include <vector>

#include "c3de/core/input_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"
#include "c3de/core/text.h"

namespace c3de::session {
namespace {

constexpr int kLevel = 6;
constexpr uLong kDosDate = 0x00210000;  // 1 January 1980, the first that a zip can express
constexpr uLong kUtf8Names = 1u << 11;
constexpr uLong kEncrypted = 1u << 0;
constexpr std::size_t kLongestName = 1024;
constexpr std::size_t kZipChunk = std::size_t{1} << 20;
constexpr std::int64_t kBytesOfEmptyZip = 22;
constexpr std::uint64_t kFirstOfZip64 = 0xffffffffu;
// Deflate cannot pack more tightly; the rest is for members of a few bytes.
constexpr std::uint64_t kLargestRatio = 1032;
constexpr std::uint64_t kRatioSlack = 64;

/// Position after a seek as minizip requests it; below 0: before the first byte.
std::int64_t seekTarget(std::int64_t present, std::int64_t end, ZPOS64_T offset, int origin) {
  const auto distance = static_cast<std::int64_t>(offset);
  return origin == ZLIB_FILEFUNC_SEEK_SET ? distance : distance + (origin == ZLIB_FILEFUNC_SEEK_CUR ? present : end);
}

/// A file in memory that minizip writes.
struct MemoryFile {
  std::string bytes;
  std::size_t at = 0;
};

zlib_filefunc64_def memoryFunctions(MemoryFile &target) {
  zlib_filefunc64_def functions{};
  functions.opaque = &target;
  functions.zopen64_file = [](voidpf opaque, const void *, int) -> voidpf { return opaque; };
  functions.zread_file = [](voidpf, voidpf, void *, uLong) -> uLong { return 0; };
  functions.zwrite_file = [](voidpf, voidpf stream, const void *bytes, uLong size) -> uLong {
    MemoryFile &file = *static_cast<MemoryFile *>(stream);
    try {
      if (file.at + size > file.bytes.size()) file.bytes.resize(file.at + size);
    } catch (const std::exception &) {
      return 0;
    }
    std::copy_n(static_cast<const char *>(bytes), size, file.bytes.begin() + static_cast<std::ptrdiff_t>(file.at));
    file.at += size;
    return size;
  };
  functions.ztell64_file = [](voidpf, voidpf stream) -> ZPOS64_T { return static_cast<MemoryFile *>(stream)->at; };
  functions.zseek64_file = [](voidpf, voidpf stream, ZPOS64_T offset, int origin) -> long {
    MemoryFile &file = *static_cast<MemoryFile *>(stream);
    const std::int64_t to =
        seekTarget(static_cast<std::int64_t>(file.at), static_cast<std::int64_t>(file.bytes.size()), offset, origin);
    if (to < 0) return -1;
    file.at = static_cast<std::size_t>(to);
    return 0;
  };
  functions.zclose_file = [](voidpf, voidpf) -> int { return 0; };
  functions.zerror_file = [](voidpf, voidpf) -> int { return 0; };
  return functions;
}

/// A file, on disk or in memory, that minizip reads.
struct InputStream {
  std::istream &in;
  std::int64_t size = 0;
  bool isShort = false;  ///< fewer bytes than a read requested
};

zlib_filefunc64_def inputFunctions(InputStream &source) {
  zlib_filefunc64_def functions{};
  functions.opaque = &source;
  functions.zopen64_file = [](voidpf opaque, const void *, int) -> voidpf { return opaque; };
  functions.zread_file = [](voidpf, voidpf stream, void *bytes, uLong size) -> uLong {
    InputStream &file = *static_cast<InputStream *>(stream);
    file.in.clear();
    file.in.read(static_cast<char *>(bytes), static_cast<std::streamsize>(size));
    const auto count = static_cast<uLong>(file.in.gcount());
    file.isShort = file.isShort || count < size;
    return count;
  };
  functions.zwrite_file = [](voidpf, voidpf, const void *, uLong) -> uLong { return 0; };
  functions.ztell64_file = [](voidpf, voidpf stream) -> ZPOS64_T {
    std::istream &in = static_cast<InputStream *>(stream)->in;
    in.clear();
    return static_cast<ZPOS64_T>(in.tellg());
  };
  functions.zseek64_file = [](voidpf, voidpf stream, ZPOS64_T offset, int origin) -> long {
    InputStream &file = *static_cast<InputStream *>(stream);
    file.in.clear();
    const std::int64_t to = seekTarget(file.in.tellg(), file.size, offset, origin);
    if (to < 0 || to > file.size) return -1;
    file.in.seekg(to);
    return file.in ? 0 : -1;
  };
  functions.zclose_file = [](voidpf, voidpf) -> int { return 0; };
  functions.zerror_file = [](voidpf, voidpf stream) -> int {
    return static_cast<InputStream *>(stream)->isShort ? 1 : 0;
  };
  return functions;
}

struct Unzipper {
  void operator()(void *zip) const { unzClose(zip); }
};

struct MemberHeader {
  std::string name;
  unz_file_info64 info{};
  unz64_file_pos place{};
};

Expected<MemberHeader> headerOf(unzFile zip, const std::string &file) {
  MemberHeader header;
  std::array<char, kLongestName + 1> name{};
  if (unzGetCurrentFileInfo64(zip, &header.info, name.data(), name.size(), nullptr, 0, nullptr, 0) != UNZ_OK ||
      unzGetFilePos64(zip, &header.place) != UNZ_OK)
    return fail(ErrorCode::input, file + ": is damaged: its list of members cannot be read");
  header.name.assign(name.data(), std::min<std::size_t>(header.info.size_filename, kLongestName + 1));
  const bool isFolder = header.name.ends_with('/');
  const std::string_view member(header.name.data(), header.name.size() - (isFolder ? 1 : 0));
  if (const std::string reason = refusedMemberName(member); !reason.empty())
    return fail(ErrorCode::input, fmt::format("{}: member '{}' {}", file, displayMessage(member), reason));
  return header;
}

Expected<std::vector<MemberHeader>> headersOf(unzFile zip, const std::string &file, std::uint64_t fileSize,
                                              const ZipLimits &limits) {
  std::vector<MemberHeader> headers;
  std::set<std::string> names;
  std::uint64_t packed = 0, unpacked = 0;
  unz_global_info64 global{};
  unzGetGlobalInfo64(zip, &global);
  if (global.number_entry == 0) return headers;
  int status = unzGoToFirstFile(zip);
  for (; status == UNZ_OK; status = unzGoToNextFile(zip)) {
    auto header = headerOf(zip, file);
    if (!header) return tl::unexpected(header.error());
    const unz_file_info64 &info = header->info;
    const std::string shown = fmt::format("{}: member '{}'", file, displayMessage(header->name));
    if (!names.insert(header->name).second) return fail(ErrorCode::input, shown + " occurs twice");
    if ((info.flag & kEncrypted) != 0)
      return fail(ErrorCode::input, shown + " is encrypted; accepted: without a password");
    if (info.compression_method != 0 && info.compression_method != Z_DEFLATED)
      return fail(ErrorCode::input, fmt::format("{} is packed by method {}; accepted: 0 (stored) and {} (deflate)",
                                                shown, info.compression_method, Z_DEFLATED));
    if (info.compressed_size > fileSize - std::min(packed, fileSize))
      return fail(ErrorCode::input,
                  fmt::format("{} is damaged: its {} packed bytes exceed the file", shown, info.compressed_size));
    packed += info.compressed_size;
    const bool isPossible = info.compression_method == 0
                                ? info.uncompressed_size == info.compressed_size
                                : info.uncompressed_size <= kLargestRatio * info.compressed_size + kRatioSlack;
    if (!isPossible)
      return fail(ErrorCode::input, fmt::format("{} is damaged: {} bytes cannot be packed in {}", shown,
                                                info.uncompressed_size, info.compressed_size));
    if (info.uncompressed_size > limits.bytes - unpacked)
      return fail(ErrorCode::input, fmt::format("{}: has more than {} bytes when unpacked, which is the most accepted",
                                                file, limits.bytes));
    unpacked += info.uncompressed_size;
    if (headers.size() == limits.members)
      return fail(ErrorCode::input,
                  fmt::format("{}: has more than {} members, which is the most accepted", file, limits.members));
    headers.push_back(std::move(*header));
  }
  if (status != UNZ_END_OF_LIST_OF_FILE)
    return fail(ErrorCode::input, file + ": is damaged: its list of members cannot be read");
  if (const std::uint64_t free = availableMemory(); free != 0 && unpacked > free)
    return fail(ErrorCode::input,
                fmt::format("{}: has {} bytes when unpacked; the free memory has {}", file, unpacked, free));
  return headers;
}

Expected<std::string> unpack(unzFile zip, const MemberHeader &header, const std::string &file) {
  const auto damaged = [&](const std::string &what) {
    return fail(ErrorCode::input,
                fmt::format("{}: member '{}' is damaged: {}", file, displayMessage(header.name), what));
  };
  if (unzGoToFilePos64(zip, &header.place) != UNZ_OK || unzOpenCurrentFile(zip) != UNZ_OK)
    return damaged("its header differs from the list of members");
  std::string bytes;
  std::vector<char> chunk(
      static_cast<std::size_t>(std::min<std::uint64_t>(kZipChunk, header.info.uncompressed_size + 1)));
  int count = 0;
  while ((count = unzReadCurrentFile(zip, chunk.data(), static_cast<unsigned>(chunk.size()))) > 0)
    bytes.append(chunk.data(), static_cast<std::size_t>(count));
  const int closed = unzCloseCurrentFile(zip);
  if (count < 0) return damaged("it cannot be unpacked");
  if (bytes.size() != header.info.uncompressed_size)
    return damaged(fmt::format("it has {} bytes of {}", bytes.size(), header.info.uncompressed_size));
  if (closed != UNZ_OK) return damaged("its checksum is another");
  return bytes;
}

}  // namespace

std::string refusedMemberName(std::string_view name) {
  if (name.empty()) return "has an empty name";
  if (name.size() > kLongestName) return fmt::format("has a name of more than {} bytes", kLongestName);
  if (!isUtf8(name)) return "has a name that is not UTF-8";
  for (const char c : name)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) return "has a control character in its name";
  if (name.front() == '/' || (name.size() > 1 && name[1] == ':'))
    return "has an absolute name; accepted: relative ones";
  if (name.find('\\') != std::string_view::npos) return "has a backslash in its name; accepted: forward slashes";
  for (std::size_t begin = 0; begin <= name.size();) {
    const std::size_t end = std::min(name.find('/', begin), name.size());
    const std::string_view part = name.substr(begin, end - begin);
    if (part.empty() || part == "." || part == "..")
      return fmt::format("has the part '{}' in its name, which could lead out of the session", part);
    begin = end + 1;
  }
  return {};
}

Expected<std::string> zipBytes(std::span<const ZipMember> members) {
  std::set<std::string_view> names;
  for (const ZipMember &member : members) {
    if (const std::string reason = refusedMemberName(member.name); !reason.empty())
      return fail(ErrorCode::usage, fmt::format("member '{}' {}", displayMessage(member.name), reason));
    if (!names.insert(member.name).second)
      return fail(ErrorCode::usage, fmt::format("member '{}' occurs twice", displayMessage(member.name)));
  }
  MemoryFile file;
  zlib_filefunc64_def functions = memoryFunctions(file);
  const zipFile zip = zipOpen2_64(nullptr, APPEND_STATUS_CREATE, nullptr, &functions);
  bool isGood = zip != nullptr;
  for (const ZipMember &member : members) {
    if (!isGood) break;
    zip_fileinfo info{};
    info.dosDate = kDosDate;
    isGood = zipOpenNewFileInZip4_64(zip, std::string(member.name).c_str(), &info, nullptr, 0, nullptr, 0, nullptr,
                                     Z_DEFLATED, kLevel, 0, -MAX_WBITS, DEF_MEM_LEVEL, Z_DEFAULT_STRATEGY, nullptr, 0,
                                     0, kUtf8Names, member.bytes.size() >= kFirstOfZip64 ? 1 : 0) == ZIP_OK;
    for (std::string_view rest = member.bytes; isGood && !rest.empty();) {
      const std::string_view part = rest.substr(0, kZipChunk);
      isGood = zipWriteInFileInZip(zip, part.data(), static_cast<unsigned>(part.size())) == ZIP_OK;
      rest.remove_prefix(part.size());
    }
    isGood = isGood && zipCloseFileInZip(zip) == ZIP_OK;
  }
  if (zip != nullptr) isGood = zipClose(zip, nullptr) == ZIP_OK && isGood;
  if (!isGood) return fail(ErrorCode::output, "cannot be packed: there is not enough memory");
  return std::move(file.bytes);
}

Expected<std::map<std::string, std::string>> readZip(const std::filesystem::path &path, const ZipLimits &limits) {
  auto in = openInputFile(path);
  if (!in) return tl::unexpected(in.error());
  return readZip(*in, pathText(path), limits);
}

Expected<std::map<std::string, std::string>> readZip(std::istream &in, const std::string &file,
                                                     const ZipLimits &limits) {
  InputStream source{in};
  std::array<char, 4> magic{};
  in.read(magic.data(), magic.size());
  in.clear();
  in.seekg(0, std::ios::end);
  source.size = static_cast<std::int64_t>(in.tellg());
  if (source.size < 0) return fail(ErrorCode::input, file + ": cannot be read");
  zlib_filefunc64_def functions = inputFunctions(source);
  const std::unique_ptr<void, Unzipper> zip(unzOpen2_64(nullptr, &functions));
  if (!zip) {
    // minizip does not find a list of members at the first byte.
    if (std::string_view(magic.data(), magic.size()) == "PK\x05\x06" && source.size == kBytesOfEmptyZip)
      return std::map<std::string, std::string>{};
    if (std::string_view(magic.data(), 2) != "PK") return fail(ErrorCode::input, file + ": is no zip archive");
    return fail(
        ErrorCode::input,
        fmt::format("{}: is truncated or damaged: no list of members at its end, after {} bytes", file, source.size));
  }
  try {
    const auto headers = headersOf(zip.get(), file, static_cast<std::uint64_t>(source.size), limits);
    if (!headers) return tl::unexpected(headers.error());
    std::map<std::string, std::string> members;
    for (const MemberHeader &header : *headers) {
      auto bytes = unpack(zip.get(), header, file);
      if (!bytes) return tl::unexpected(bytes.error());
      if (!header.name.ends_with('/')) members.emplace(header.name, std::move(*bytes));
    }
    return members;
  } catch (const std::bad_alloc &) {
    return fail(ErrorCode::input, file + ": is too large for the free memory");
  }
}

}  // namespace c3de::session
