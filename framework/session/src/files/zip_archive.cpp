// SPDX-License-Identifier: Apache-2.0
#include "files/zip_archive.h"

#include <fmt/format.h>
#include <minizip/unzip.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <new>
#include <set>
#include <vector>

#include "base/byte_fields.h"
#include "c3de/core/input_file.h"
#include "c3de/core/path_text.h"
#include "c3de/core/platform.h"
#include "c3de/core/text.h"

namespace c3de::session {
namespace {

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
  bool isLarge = false;     ///< 4 GiB or more, or behind so many bytes: unpackLarge() reads it
  std::uint64_t begin = 0;  ///< of a large one: where its own header is
};

std::string bytesAt(InputStream &source, std::uint64_t at, std::size_t size) {
  std::string bytes(size, '\0');
  source.in.clear();
  source.in.seekg(static_cast<std::streamoff>(at));
  source.in.read(bytes.data(), static_cast<std::streamsize>(size));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(source.in.gcount(), 0)));
  source.in.clear();
  return bytes;
}

std::uint64_t fieldAt(std::string_view bytes, std::size_t at, std::size_t size) {
  bytes.remove_prefix(std::min(at, bytes.size()));
  return size == 2 ? takeNumber<std::uint16_t>(bytes).value_or(0) : takeNumber<std::uint32_t>(bytes).value_or(0);
}

/// minizip 1.1 reads no sizes and places of 64 bits where `long` has as many. False: the entry cannot be read.
bool readLargeEntry(InputStream &source, MemberHeader &header) {
  constexpr std::size_t kEntryBytes = 46;
  const std::string entry = bytesAt(source, header.place.pos_in_zip_directory, kEntryBytes);
  if (entry.size() != kEntryBytes || !entry.starts_with("PK\x01\x02")) return false;
  header.begin = fieldAt(entry, 42, 4);
  header.isLarge = header.info.uncompressed_size == kFirstOfZip64 || header.info.compressed_size == kFirstOfZip64 ||
                   header.begin == kFirstOfZip64;
  const std::string extra = bytesAt(source, header.place.pos_in_zip_directory + kEntryBytes + fieldAt(entry, 28, 2),
                                    static_cast<std::size_t>(fieldAt(entry, 30, 2)));
  for (std::string_view rest = extra; rest.size() >= 4;) {
    const auto id = fieldAt(rest, 0, 2), size = fieldAt(rest, 2, 2);
    std::string_view fields = rest.substr(4, static_cast<std::size_t>(size));
    rest.remove_prefix(std::min<std::size_t>(4 + size, rest.size()));
    if (id != 1) continue;
    for (ZPOS64_T *value : {&header.info.uncompressed_size, &header.info.compressed_size})
      if (*value == kFirstOfZip64) *value = takeNumber<std::uint64_t>(fields).value_or(*value);
    if (header.begin == kFirstOfZip64) header.begin = takeNumber<std::uint64_t>(fields).value_or(header.begin);
  }
  return true;
}

Expected<MemberHeader> headerOf(unzFile zip, InputStream &source, const std::string &file) {
  MemberHeader header;
  std::array<char, kLongestName + 1> name{};
  if (unzGetCurrentFileInfo64(zip, &header.info, name.data(), name.size(), nullptr, 0, nullptr, 0) != UNZ_OK ||
      unzGetFilePos64(zip, &header.place) != UNZ_OK)
    return fail(ErrorCode::input, file + ": is damaged: its list of members cannot be read");
  if ((header.info.uncompressed_size == kFirstOfZip64 || header.info.compressed_size == kFirstOfZip64 ||
       static_cast<std::uint64_t>(source.size) >= kFirstOfZip64) &&
      !readLargeEntry(source, header))
    return fail(ErrorCode::input, file + ": is damaged: its list of members cannot be read");
  header.name.assign(name.data(), std::min<std::size_t>(header.info.size_filename, kLongestName + 1));
  const bool isFolder = header.name.ends_with('/');
  const std::string_view member(header.name.data(), header.name.size() - (isFolder ? 1 : 0));
  if (const std::string reason = refusedMemberName(member); !reason.empty())
    return fail(ErrorCode::input, fmt::format("{}: member '{}' {}", file, displayMessage(member), reason));
  return header;
}

Expected<std::vector<MemberHeader>> headersOf(unzFile zip, InputStream &source, const std::string &file,
                                              const ZipLimits &limits) {
  const auto fileSize = static_cast<std::uint64_t>(source.size);
  std::vector<MemberHeader> headers;
  std::set<std::string> names;
  std::uint64_t packed = 0, unpacked = 0;
  unz_global_info64 global{};
  unzGetGlobalInfo64(zip, &global);
  if (global.number_entry == 0) return headers;
  int status = unzGoToFirstFile(zip);
  for (; status == UNZ_OK; status = unzGoToNextFile(zip)) {
    auto header = headerOf(zip, source, file);
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
    const bool isSkipped = limits.skips && limits.skips(header->name);
    if (!isSkipped && info.uncompressed_size > limits.bytes - unpacked)
      return fail(ErrorCode::input, fmt::format("{}: has more than {} bytes when unpacked, which is the most accepted",
                                                file, limits.bytes));
    if (!isSkipped) unpacked += info.uncompressed_size;
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

tl::unexpected<Error> damagedMember(const std::string &file, const MemberHeader &header, const std::string &what) {
  return fail(ErrorCode::input, fmt::format("{}: member '{}' is damaged: {}", file, displayMessage(header.name), what));
}

struct Inflater {
  z_stream stream{};
  bool isGood = inflateInit2(&stream, -MAX_WBITS) == Z_OK;
  ~Inflater() { inflateEnd(&stream); }
};

/// As unpack(), without minizip.
Expected<void> unpackLarge(InputStream &source, const MemberHeader &header, const std::string &file,
                           const TakePiece &take) {
  constexpr std::size_t kLocalBytes = 30;
  const std::string local = bytesAt(source, header.begin, kLocalBytes);
  if (local.size() != kLocalBytes || !local.starts_with("PK\x03\x04"))
    return damagedMember(file, header, "its header differs from the list of members");
  std::uint64_t at = header.begin + kLocalBytes + fieldAt(local, 26, 2) + fieldAt(local, 28, 2);
  std::uint64_t left = header.info.compressed_size, size = 0;
  uLong checksum = 0;
  const auto pass = [&](std::string_view piece) {
    size += piece.size();
    checksum = crc32_z(checksum, reinterpret_cast<const Bytef *>(piece.data()), piece.size());
    return piece.empty() ? Expected<void>() : take(piece);
  };
  Inflater inflater;
  std::string out(kZipChunk, '\0');
  int status = inflater.isGood ? Z_OK : Z_MEM_ERROR;
  while (left > 0 && status == Z_OK) {
    std::string packed = bytesAt(source, at, static_cast<std::size_t>(std::min<std::uint64_t>(left, kZipChunk)));
    if (packed.empty()) return damagedMember(file, header, "it ends too early");
    at += packed.size();
    left -= packed.size();
    if (header.info.compression_method == 0) {
      if (auto passed = pass(packed); !passed) return passed;
      continue;
    }
    inflater.stream.next_in = reinterpret_cast<Bytef *>(packed.data());
    inflater.stream.avail_in = static_cast<uInt>(packed.size());
    do {
      inflater.stream.next_out = reinterpret_cast<Bytef *>(out.data());
      inflater.stream.avail_out = static_cast<uInt>(out.size());
      status = inflate(&inflater.stream, Z_NO_FLUSH);
      if (status == Z_BUF_ERROR) status = Z_OK;  // more input is needed
      if (auto passed = pass(std::string_view(out).substr(0, out.size() - inflater.stream.avail_out)); !passed)
        return passed;
    } while (status == Z_OK && inflater.stream.avail_out == 0);
  }
  if (status != (header.info.compression_method == 0 ? Z_OK : Z_STREAM_END))
    return damagedMember(file, header, "it cannot be unpacked");
  if (size != header.info.uncompressed_size)
    return damagedMember(file, header, fmt::format("it has {} bytes of {}", size, header.info.uncompressed_size));
  if (checksum != header.info.crc) return damagedMember(file, header, "its checksum is another");
  return take({});
}

Expected<void> unpack(unzFile zip, InputStream &source, const MemberHeader &header, const std::string &file,
                      const TakePiece &take) {
  if (header.isLarge) return unpackLarge(source, header, file, take);
  const auto damaged = [&](const std::string &what) { return damagedMember(file, header, what); };
  if (unzGoToFilePos64(zip, &header.place) != UNZ_OK || unzOpenCurrentFile(zip) != UNZ_OK)
    return damaged("its header differs from the list of members");
  std::vector<char> chunk(
      static_cast<std::size_t>(std::min<std::uint64_t>(kZipChunk, header.info.uncompressed_size + 1)));
  int count = 0;
  std::uint64_t size = 0;
  while ((count = unzReadCurrentFile(zip, chunk.data(), static_cast<unsigned>(chunk.size()))) > 0) {
    size += static_cast<std::uint64_t>(count);
    if (auto taken = take(std::string_view(chunk.data(), static_cast<std::size_t>(count))); !taken) {
      unzCloseCurrentFile(zip);
      return taken;
    }
  }
  const int closed = unzCloseCurrentFile(zip);
  if (count < 0) return damaged("it cannot be unpacked");
  if (size != header.info.uncompressed_size)
    return damaged(fmt::format("it has {} bytes of {}", size, header.info.uncompressed_size));
  if (closed != UNZ_OK) return damaged("its checksum is another");
  return take({});
}

/// An archive with its list of members, which has been checked.
struct OpenZip {
  InputStream source;
  zlib_filefunc64_def functions{};
  std::unique_ptr<void, Unzipper> zip;
  std::vector<MemberHeader> headers;

  explicit OpenZip(std::istream &in) : source{in} {}
};

Expected<std::unique_ptr<OpenZip>> openZip(std::istream &in, const std::string &file, const ZipLimits &limits) {
  auto open = std::make_unique<OpenZip>(in);
  InputStream &source = open->source;
  std::array<char, 4> magic{};
  in.clear();
  in.seekg(0);
  in.read(magic.data(), magic.size());
  in.clear();
  in.seekg(0, std::ios::end);
  source.size = static_cast<std::int64_t>(in.tellg());
  if (source.size < 0) return fail(ErrorCode::input, file + ": cannot be read");
  open->functions = inputFunctions(source);
  open->zip.reset(unzOpen2_64(nullptr, &open->functions));
  if (!open->zip) {
    // minizip does not find a list of members at the first byte.
    if (std::string_view(magic.data(), magic.size()) == "PK\x05\x06" && source.size == kBytesOfEmptyZip) return open;
    if (std::string_view(magic.data(), 2) != "PK") return fail(ErrorCode::input, file + ": is no zip archive");
    return fail(
        ErrorCode::input,
        fmt::format("{}: is truncated or damaged: no list of members at its end, after {} bytes", file, source.size));
  }
  auto headers = headersOf(open->zip.get(), source, file, limits);
  if (!headers) return tl::unexpected(headers.error());
  open->headers = std::move(*headers);
  return open;
}

bool isFolder(const MemberHeader &header) { return header.name.ends_with('/'); }

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

Expected<std::map<std::string, std::string>> readZip(const std::filesystem::path &path, const ZipLimits &limits) {
  auto in = openInputFile(path);
  if (!in) return tl::unexpected(in.error());
  return readZip(*in, pathText(path), limits);
}

Expected<std::map<std::string, std::string>> readZip(std::istream &in, const std::string &file,
                                                     const ZipLimits &limits) {
  try {
    const auto open = openZip(in, file, limits);
    if (!open) return tl::unexpected(open.error());
    std::map<std::string, std::string> members;
    for (const MemberHeader &header : (*open)->headers) {
      if (limits.skips && limits.skips(header.name)) continue;
      std::string bytes;
      const auto unpacked = unpack((*open)->zip.get(), (*open)->source, header, file, [&bytes](std::string_view piece) {
        bytes += piece;
        return Expected<void>();
      });
      if (!unpacked) return tl::unexpected(unpacked.error());
      if (!isFolder(header)) members.emplace(header.name, std::move(bytes));
    }
    return members;
  } catch (const std::bad_alloc &) {
    return fail(ErrorCode::input, file + ": is too large for the free memory");
  }
}

Expected<std::map<std::string, std::uint64_t>> listZip(std::istream &in, const std::string &file) {
  ZipLimits limits;
  limits.skips = [](const std::string &) { return true; };
  const auto open = openZip(in, file, limits);
  if (!open) return tl::unexpected(open.error());
  std::map<std::string, std::uint64_t> names;
  for (const MemberHeader &header : (*open)->headers)
    if (!isFolder(header)) names.emplace(header.name, header.info.uncompressed_size);
  return names;
}

Expected<void> streamZip(std::istream &in, const std::string &file,
                         const std::function<Expected<TakePiece>(const std::string &member)> &takerOf) {
  ZipLimits limits;
  limits.skips = [](const std::string &) { return true; };
  const auto open = openZip(in, file, limits);
  if (!open) return tl::unexpected(open.error());
  for (const MemberHeader &header : (*open)->headers) {
    if (isFolder(header)) continue;
    const auto taker = takerOf(header.name);
    if (!taker) return tl::unexpected(taker.error());
    if (!*taker) continue;
    if (auto unpacked = unpack((*open)->zip.get(), (*open)->source, header, file, *taker); !unpacked) return unpacked;
  }
  return {};
}

}  // namespace c3de::session
