// SPDX-License-Identifier: Apache-2.0
#include "files/zip_writer.h"

#include <fmt/format.h>
#include <zlib.h>

#include <array>
#include <utility>

#include "base/byte_fields.h"
#include "c3de/core/text.h"
#include "files/zip_archive.h"

namespace c3de::session {
namespace {

constexpr std::uint32_t kLocalHeader = 0x04034b50, kDescriptor = 0x08074b50, kListEntry = 0x02014b50,
                        kListEnd = 0x06054b50, kLargeListEnd = 0x06064b50, kLargeListPlace = 0x07064b50;
constexpr std::uint16_t kVersion = 20, kLargeVersion = 45, kLargeField = 1;
constexpr std::uint16_t kDescriptorAndUtf8 = 1u << 3 | 1u << 11;
constexpr std::uint32_t kFirstDate = 0x00210000;  // 1 January 1980
constexpr std::uint32_t kIsLarge = 0xffffffffu;
constexpr std::uint16_t kAreMany = 0xffffu;
/// Content that cannot be packed grows a little.
constexpr std::uint64_t kLargeFrom = 0xf0000000u;
constexpr int kPackLevel = 6;

template <class... Fields>
std::string fieldsOf(Fields... fields) {
  std::string out;
  (putNumber(out, fields), ...);
  return out;
}

}  // namespace

struct ZipWriter::Deflater {
  z_stream stream{};
  bool isGood = false;
  std::array<char, std::size_t{1} << 16> out{};
  Deflater() { isGood = deflateInit2(&stream, kPackLevel, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY) == Z_OK; }
  ~Deflater() { deflateEnd(&stream); }
};

ZipWriter::ZipWriter(Sink sink) : deflater_(std::make_unique<Deflater>()) {
  sink_ = [this, to = std::move(sink)](std::string_view bytes) {
    written_ += bytes.size();
    to(bytes);
  };
}

ZipWriter::~ZipWriter() = default;

Expected<void> ZipWriter::begin(std::string_view name, std::uint64_t expectedBytes) {
  if (const std::string reason = refusedMemberName(name); !reason.empty())
    return fail(ErrorCode::usage, fmt::format("member '{}' {}", displayMessage(name), reason));
  if (names_.size() == kMostZipMembers)
    return fail(ErrorCode::usage, fmt::format("member '{}' is one too many; accepted: up to {}, as many as are read",
                                              displayMessage(name), kMostZipMembers));
  if (!names_.emplace(name).second)
    return fail(ErrorCode::usage, fmt::format("member '{}' occurs twice", displayMessage(name)));
  name_ = name;
  begin_ = written_;
  isLarge_ = expectedBytes >= kLargeFrom;
  unpacked_ = packed_ = 0;
  checksum_ = 0;
  const std::string extra =
      isLarge_ ? fieldsOf(kLargeField, std::uint16_t{16}, std::uint64_t{0}, std::uint64_t{0}) : std::string();
  const std::uint32_t size = isLarge_ ? kIsLarge : 0;
  sink_(fieldsOf(kLocalHeader, isLarge_ ? kLargeVersion : kVersion, kDescriptorAndUtf8, std::uint16_t{Z_DEFLATED},
                 kFirstDate, std::uint32_t{0}, size, size, static_cast<std::uint16_t>(name_.size()),
                 static_cast<std::uint16_t>(extra.size())) +
        name_ + extra);
  deflateReset(&deflater_->stream);
  return {};
}

Expected<void> ZipWriter::add(std::string_view bytes) {
  constexpr std::size_t kPiece = std::size_t{1} << 30;  // zlib counts with 32 bits
  while (!bytes.empty()) {
    const std::string_view piece = bytes.substr(0, kPiece);
    bytes.remove_prefix(piece.size());
    checksum_ =
        static_cast<std::uint32_t>(crc32_z(checksum_, reinterpret_cast<const Bytef *>(piece.data()), piece.size()));
    unpacked_ += piece.size();
    // zlib does not change its input; its type is without const unless ZLIB_CONST is defined.
    deflater_->stream.next_in = reinterpret_cast<Bytef *>(const_cast<char *>(piece.data()));
    deflater_->stream.avail_in = static_cast<uInt>(piece.size());
    if (auto packed = deflate(false); !packed) return packed;
  }
  return {};
}

Expected<void> ZipWriter::deflate(bool isLast) {
  z_stream &stream = deflater_->stream;
  int status = Z_OK;
  do {
    stream.next_out = reinterpret_cast<Bytef *>(deflater_->out.data());
    stream.avail_out = static_cast<uInt>(deflater_->out.size());
    status = deflater_->isGood ? ::deflate(&stream, isLast ? Z_FINISH : Z_NO_FLUSH) : Z_MEM_ERROR;
    if (status == Z_STREAM_ERROR || status == Z_MEM_ERROR)
      return fail(ErrorCode::output, "cannot be packed: there is not enough memory");
    const std::size_t count = deflater_->out.size() - stream.avail_out;
    packed_ += count;
    sink_(std::string_view(deflater_->out.data(), count));
  } while (isLast ? status != Z_STREAM_END : stream.avail_out == 0);
  return {};
}

Expected<void> ZipWriter::end() {
  deflater_->stream.next_in = nullptr;
  deflater_->stream.avail_in = 0;
  if (auto packed = deflate(true); !packed) return packed;
  if (!isLarge_ && (unpacked_ >= kIsLarge || packed_ >= kIsLarge))
    return fail(ErrorCode::usage,
                fmt::format("member '{}' has become larger while it was saved", displayMessage(name_)));
  const auto packed32 = static_cast<std::uint32_t>(packed_), unpacked32 = static_cast<std::uint32_t>(unpacked_);
  sink_(isLarge_ ? fieldsOf(kDescriptor, checksum_, packed_, unpacked_)
                 : fieldsOf(kDescriptor, checksum_, packed32, unpacked32));
  std::string large;
  if (isLarge_) large += fieldsOf(unpacked_, packed_);
  const bool isFar = begin_ >= kIsLarge;
  if (isFar) large += fieldsOf(begin_);
  if (!large.empty()) large = fieldsOf(kLargeField, static_cast<std::uint16_t>(large.size())) + large;
  const std::uint16_t version = large.empty() ? kVersion : kLargeVersion;
  list_ += fieldsOf(kListEntry, version, version, kDescriptorAndUtf8, std::uint16_t{Z_DEFLATED}, kFirstDate, checksum_,
                    isLarge_ ? kIsLarge : packed32, isLarge_ ? kIsLarge : unpacked32,
                    static_cast<std::uint16_t>(name_.size()), static_cast<std::uint16_t>(large.size()),
                    std::uint16_t{0}, std::uint16_t{0}, std::uint16_t{0}, std::uint32_t{0},
                    isFar ? kIsLarge : static_cast<std::uint32_t>(begin_)) +
           name_ + large;
  return {};
}

void ZipWriter::finish() {
  const std::uint64_t place = written_, count = names_.size(), size = list_.size();
  sink_(list_);
  const bool isLarge = place >= kIsLarge || size >= kIsLarge || count >= kAreMany;
  if (isLarge) {
    const std::uint64_t end = written_;
    sink_(fieldsOf(kLargeListEnd, std::uint64_t{44}, kLargeVersion, kLargeVersion, std::uint32_t{0}, std::uint32_t{0},
                   count, count, size, place));
    sink_(fieldsOf(kLargeListPlace, std::uint32_t{0}, end, std::uint32_t{1}));
  }
  const auto shortCount = isLarge ? kAreMany : static_cast<std::uint16_t>(count);
  sink_(fieldsOf(kListEnd, std::uint16_t{0}, std::uint16_t{0}, shortCount, shortCount,
                 isLarge ? kIsLarge : static_cast<std::uint32_t>(size),
                 isLarge ? kIsLarge : static_cast<std::uint32_t>(place), std::uint16_t{0}));
}

Expected<std::string> zipBytes(std::span<const ZipMember> members) {
  std::string bytes;
  ZipWriter zip([&bytes](std::string_view piece) { bytes += piece; });
  for (const auto &[name, content] : members) {
    if (auto begun = zip.begin(name, content.size()); !begun) return tl::unexpected(begun.error());
    if (auto added = zip.add(content); !added) return tl::unexpected(added.error());
    if (auto ended = zip.end(); !ended) return tl::unexpected(ended.error());
  }
  zip.finish();
  return bytes;
}

}  // namespace c3de::session
