// SPDX-License-Identifier: Apache-2.0
#include "dicom/dicom_parser.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "dicom/dicom_text.h"
#include "formats/image_header.h"

namespace c3de::imaging {
namespace {

constexpr std::uint32_t kUndefined = 0xffffffffu, kItem = 0xfffee000u, kItemEnd = 0xfffee00du,
                        kSequenceEnd = 0xfffee0ddu;
constexpr std::uint32_t kCharacterSet = 0x00080005u;
constexpr int kDeepest = 16;
constexpr std::size_t kWindow = 1u << 14;
constexpr std::size_t kLongestText = 1u << 20;

std::uint32_t unsignedOf(const unsigned char *b, std::size_t count, bool bigEndian) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value = value << 8 | b[bigEndian ? i : count - 1 - i];
  return value;
}

bool isRepresentation(const unsigned char *b) { return b[0] >= 'A' && b[0] <= 'Z' && b[1] >= 'A' && b[1] <= 'Z'; }

bool hasLongLength(const std::string &vr) {
  for (const char *known : {"OB", "OW", "OF", "OD", "OL", "OV", "SQ", "UC", "UR", "UT", "UN", "SV", "UV"})
    if (vr == known) return true;
  return false;
}

struct Head {
  std::uint32_t tag = 0, length = 0;
  std::uint64_t value = 0;  ///< where the value begins
  std::string representation;
};

/// Traverses the structure of a file; a position of 0 means that the structure breaks off.
class Walker {
 public:
  Walker(DicomBytes &bytes) : bytes_(bytes) {}

  [[nodiscard]] std::optional<Head> head(std::uint64_t at, DicomSyntax syntax) {
    unsigned char b[12];
    if (!bytes_.read(at, b, 8)) return std::nullopt;
    Head out;
    out.tag = unsignedOf(b, 2, syntax.bigEndian) << 16 | unsignedOf(b + 2, 2, syntax.bigEndian);
    out.value = at + 8;
    if (out.tag >> 16 == 0xfffe || !syntax.isExplicit) {
      out.length = unsignedOf(b + 4, 4, syntax.bigEndian);
      return out;
    }
    if (!isRepresentation(b + 4)) return std::nullopt;
    out.representation.assign(reinterpret_cast<const char *>(b) + 4, 2);
    if (!hasLongLength(out.representation)) {
      out.length = unsignedOf(b + 6, 2, syntax.bigEndian);
      return out;
    }
    if (!bytes_.read(at + 8, b + 8, 4)) return std::nullopt;
    out.length = unsignedOf(b + 8, 4, syntax.bigEndian);
    out.value = at + 12;
    return out;
  }

  /// Position after an element; sequences of undefined length are traversed.
  [[nodiscard]] std::uint64_t behind(const Head &head, DicomSyntax syntax, int depth) {
    if (head.length != kUndefined) {
      const std::uint64_t end = head.value + head.length;
      return end <= bytes_.length() ? end : 0;
    }
    return behindSequence(head.value, inside(head, syntax), depth);
  }

  /// Unknown elements of undefined length are sequences in implicit encoding (PS3.5 6.2.2).
  [[nodiscard]] static DicomSyntax inside(const Head &head, DicomSyntax syntax) {
    return head.representation == "UN" && head.length == kUndefined ? DicomSyntax{false, false} : syntax;
  }

 private:
  std::uint64_t behindSequence(std::uint64_t at, DicomSyntax syntax, int depth) {
    if (depth > kDeepest) return 0;
    for (;;) {
      const auto item = head(at, syntax);
      if (!item) return 0;
      if (item->tag == kSequenceEnd) return item->value;
      if (item->tag != kItem) return 0;
      at = item->length == kUndefined ? behindItem(item->value, syntax, depth) : item->value + item->length;
      if (at == 0 || at > bytes_.length()) return 0;
    }
  }
  std::uint64_t behindItem(std::uint64_t at, DicomSyntax syntax, int depth) {
    for (;;) {
      const auto element = head(at, syntax);
      if (!element) return 0;
      if (element->tag == kItemEnd) return element->value;
      at = behind(*element, syntax, depth + 1);
      if (at == 0) return 0;
    }
  }

  DicomBytes &bytes_;
};

}  // namespace

DicomBytes::DicomBytes(const std::filesystem::path &path) : file_(path, std::ios::binary) {
  std::error_code code;
  const auto size = std::filesystem::file_size(path, code);
  if (file_ && !code) length_ = size;
}
DicomBytes::DicomBytes(std::vector<char> memory) : memory_(std::move(memory)), length_(memory_.size()) {}

bool DicomBytes::read(std::uint64_t at, void *to, std::size_t bytes) {
  if (at > length_ || bytes > length_ - at) return false;
  if (!file_.is_open()) {
    std::memcpy(to, memory_.data() + at, bytes);
    return true;
  }
  const auto load = [&](char *target, std::size_t count) {
    file_.clear();
    file_.seekg(static_cast<std::streamoff>(at));
    file_.read(target, static_cast<std::streamsize>(count));
    return static_cast<std::size_t>(file_.gcount());
  };
  if (bytes > kWindow / 4) return load(static_cast<char *>(to), bytes) == bytes;
  // Headers are read in pieces of a few bytes, back and forth.
  if (at < windowAt_ || at + bytes > windowAt_ + memory_.size()) {
    memory_.resize(kWindow);
    memory_.resize(load(memory_.data(), kWindow));
    windowAt_ = at;
    if (memory_.size() < bytes) return false;
  }
  std::memcpy(to, memory_.data() + (at - windowAt_), bytes);
  return true;
}

/// Fills sets; their only friend.
class DicomParser {
 public:
  /// Elements from a position up to the end, the pixels, or a delimiter. @param damage  set where the structure breaks
  static DicomSet parse(const std::shared_ptr<DicomBytes> &bytes, std::uint64_t at, std::uint64_t end,
                        DicomSyntax syntax, std::string &damage) {
    DicomSet set;
    set.bytes_ = bytes;
    set.syntax_ = syntax;
    Walker walker(*bytes);
    while (at < end && set.elements_.size() < 100000) {
      const auto head = walker.head(at, syntax);
      if (!head) {
        damage = "its structure breaks off at byte " + std::to_string(at);
        break;
      }
      if (head->tag == kItemEnd) break;
      DicomSet::Element element{head->value, head->length, head->length == kUndefined, head->representation == "UN",
                                head->representation};
      // missingPixels() checks whether they are complete
      if (head->tag == kPixelData || head->tag == kFloatPixels || head->tag == kDoublePixels) {
        set.elements_[head->tag] = element;
        break;
      }
      at = walker.behind(*head, syntax, 0);
      if (at == 0) {
        damage = "it ends or is damaged within element " + hex(head->tag);
        break;
      }
      element.length = at - head->value;
      set.elements_[head->tag] = element;
    }
    set.characterSet_ = set.text(kCharacterSet);
    return set;
  }

  static std::string hex(std::uint32_t tag) {
    static constexpr char kDigits[] = "0123456789abcdef";
    std::string text = "(0000,0000)";
    for (std::size_t d = 0; d < 8; ++d) text[1 + d + (d > 3 ? 1 : 0)] = kDigits[tag >> (28 - 4 * d) & 15];
    return text;
  }
};

const DicomSet::Element *DicomSet::find(std::uint32_t tag) const {
  const auto found = elements_.find(tag);
  return found == elements_.end() ? nullptr : &found->second;
}

std::string DicomSet::text(std::uint32_t tag) const {
  const Element *element = find(tag);
  if (!element || element->undefined || element->length == 0 || element->length > kLongestText) return {};
  std::string value(static_cast<std::size_t>(element->length), '\0');
  return bytes_->read(element->at, value.data(), value.size()) ? trimmed(value) : "";
}

std::vector<double> DicomSet::decimals(std::uint32_t tag) const {
  const std::string value = text(tag);
  std::vector<double> all;
  for (std::size_t at = 0; at < value.size();) {
    const std::size_t end = std::min(value.find('\\', at), value.size());
    const std::string one = trimmed(value.substr(at, end - at));
    bytes_->hasDecimalComma = bytes_->hasDecimalComma || hasDecimalComma(one);
    all.push_back(numberFrom(one));
    at = end + 1;
  }
  return all;
}

std::string DicomSet::name(std::uint32_t tag) const { return dicomText(text(tag), characterSet_); }

std::vector<char> DicomSet::bytes(std::uint32_t tag) const {
  const Element *element = find(tag);
  if (!element || element->undefined || element->length > kLongestText) return {};
  std::vector<char> value(static_cast<std::size_t>(element->length));
  if (!bytes_->read(element->at, value.data(), value.size())) value.clear();
  return value;
}

std::vector<std::uint16_t> DicomSet::words(std::uint32_t tag) const {
  const std::vector<char> raw = bytes(tag);
  std::vector<std::uint16_t> all(raw.size() / 2);
  for (std::size_t n = 0; n < all.size(); ++n)
    all[n] = static_cast<std::uint16_t>(
        unsignedOf(reinterpret_cast<const unsigned char *>(raw.data()) + 2 * n, 2, syntax_.bigEndian));
  return all;
}

std::vector<double> DicomSet::doubles(std::uint32_t tag) const {
  std::vector<char> raw = bytes(tag);
  std::vector<double> all(raw.size() / sizeof(double));
  for (std::size_t n = 0; n < all.size(); ++n) {
    char *each = raw.data() + n * sizeof(double);
    if (syntax_.bigEndian == (std::endian::native == std::endian::little)) std::reverse(each, each + sizeof(double));
    std::memcpy(&all[n], each, sizeof(double));
  }
  return all;
}

std::size_t DicomSet::number(std::uint32_t tag) const {
  const Element *element = find(tag);
  unsigned char b[2];
  if (!element || element->undefined || element->length < 2 || !bytes_->read(element->at, b, 2)) return 0;
  return unsignedOf(b, 2, syntax_.bigEndian);
}

std::vector<DicomSet> DicomSet::items(std::uint32_t tag) const {
  std::vector<DicomSet> all;
  const Element *element = find(tag);
  if (!element) return all;
  const DicomSyntax syntax = element->asUnknown ? DicomSyntax{false, false} : syntax_;
  Walker walker(*bytes_);
  const std::uint64_t end = element->at + element->length;
  for (std::uint64_t at = element->at; at < end && all.size() < 200000;) {
    const auto item = walker.head(at, syntax);
    if (!item || item->tag != kItem) break;
    std::string damage;
    const std::uint64_t stop = item->length == kUndefined ? end : item->value + item->length;
    if (stop > end) break;
    all.push_back(DicomParser::parse(bytes_, item->value, stop, syntax, damage));
    if (!all.back().has(kCharacterSet)) all.back().characterSet_ = characterSet_;
    if (!damage.empty()) break;
    if (item->length != kUndefined) {
      at = stop;
      continue;
    }
    at = item->value;  // on to the delimiter of the item
    for (auto next = walker.head(at, syntax); next; next = walker.head(at, syntax)) {
      at = next->tag == kItemEnd ? next->value : walker.behind(*next, syntax, 0);
      if (next->tag == kItemEnd || at == 0) break;
    }
    if (at == 0) break;
  }
  return all;
}

bool DicomContent::isCompressed() const {
  const DicomSet::Element *pixels = set.find(kPixelData);
  return pixels && pixels->undefined;
}

const DicomSet::Element *DicomContent::pixels() const {
  for (const std::uint32_t tag : {kPixelData, kFloatPixels, kDoublePixels})
    if (const DicomSet::Element *found = set.find(tag)) return found;
  return nullptr;
}

namespace {

/// The remainder of a file, inflated; a truncated one as far as possible.
std::vector<char> inflated(DicomBytes &bytes, std::uint64_t from, std::string &damage) {
  std::vector<char> in(static_cast<std::size_t>(bytes.length() - from)), out;
  if (!bytes.read(from, in.data(), in.size())) return out;
  z_stream z{};
  if (inflateInit2(&z, -15) != Z_OK) return out;
  z.next_in = reinterpret_cast<Bytef *>(in.data());
  z.avail_in = static_cast<uInt>(in.size());
  std::vector<char> chunk(1u << 18);
  int answer = Z_OK;
  while (answer == Z_OK && out.size() < (1u << 30)) {
    z.next_out = reinterpret_cast<Bytef *>(chunk.data());
    z.avail_out = static_cast<uInt>(chunk.size());
    answer = inflate(&z, Z_NO_FLUSH);
    out.insert(out.end(), chunk.begin(), chunk.begin() + static_cast<std::ptrdiff_t>(chunk.size() - z.avail_out));
  }
  inflateEnd(&z);
  if (answer != Z_STREAM_END) damage = "its deflated content is truncated or damaged";
  return out;
}

}  // namespace

std::optional<DicomContent> parseDicom(const std::filesystem::path &path) {
  DicomContent out;
  out.bytes = std::make_shared<DicomBytes>(path);
  char magic[4] = {};
  const bool signedAsDicom = out.bytes->read(128, magic, 4) && std::memcmp(magic, "DICM", 4) == 0;
  const bool isSignedAtOnce =
      !signedAsDicom && out.bytes->read(0, magic, 4) && std::memcmp(magic, "DICM", 4) == 0;  // without the preamble
  std::uint64_t at = signedAsDicom ? 132 : isSignedAtOnce ? 4 : 0;
  Walker walker(*out.bytes);
  // The meta group is always explicit and little-endian.
  for (auto head = walker.head(at, {}); head && head->tag >> 16 == 2; head = walker.head(at, {})) {
    const std::uint64_t next = walker.behind(*head, {}, 0);
    if (next == 0) break;
    if (head->tag == 0x00020010) {
      std::string uid(std::min<std::uint32_t>(head->length, 128), '\0');
      if (out.bytes->read(head->value, uid.data(), uid.size())) out.transferSyntax = trimmed(uid);
    }
    at = next;
  }
  if (out.transferSyntax == "1.2.840.10008.1.2.1.99") {
    out.bytes = std::make_shared<DicomBytes>(inflated(*out.bytes, at, out.damage));
    at = 0;
  }
  out.syntax.bigEndian = out.transferSyntax == "1.2.840.10008.1.2.2";
  // Writers often state this incorrectly; the first element shows the actual encoding.
  unsigned char b[8];
  if (!out.bytes->read(at, b, sizeof b)) return signedAsDicom ? std::optional(out) : std::nullopt;
  out.syntax.isExplicit = isRepresentation(b + 4);
  const std::uint32_t group = unsignedOf(b, 2, out.syntax.bigEndian);
  if (!signedAsDicom && group != 8) return std::nullopt;  // must begin with the group of images
  std::string damage;
  out.set = DicomParser::parse(out.bytes, at, out.bytes->length(), out.syntax, damage);
  if (out.damage.empty()) out.damage = damage;
  return out;
}

std::optional<std::vector<DicomSet::Element>> fragmentsOf(const DicomContent &content) {
  const DicomSet::Element *pixels = content.set.find(kPixelData);
  std::vector<DicomSet::Element> all;
  if (!pixels || !pixels->undefined) return std::nullopt;
  Walker walker(*content.bytes);
  for (std::uint64_t at = pixels->at; all.size() < 1000000;) {
    const auto item = walker.head(at, {});
    if (!item) return std::nullopt;
    if (item->tag == kSequenceEnd) return all;
    if (item->tag != kItem || item->length == kUndefined || item->length > content.bytes->length() - item->value)
      return std::nullopt;
    all.push_back({item->value, item->length, false, false, ""});
    at = item->value + item->length;
  }
  return std::nullopt;
}

}  // namespace c3de::imaging
