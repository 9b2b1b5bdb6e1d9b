// SPDX-License-Identifier: Apache-2.0
// STL, binary and text. Some writers store a wrong or zero count in binary files, or write text in capitals.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstdint>
#include <limits>

#include "file_text.h"
#include "little_endian.h"
#include "raw_mesh.h"
#include "wording.h"

namespace c3de::geometry {
namespace {

constexpr std::size_t kHeaderBytes = 84, kTriangleBytes = 50;
constexpr std::string_view kSpace = " \t\r\n\v\f";

bool equalInAnyCase(std::string_view a, std::string_view lower) {
  return a.size() == lower.size() && std::equal(a.begin(), a.end(), lower.begin(), [](char x, char y) {
           return std::tolower(static_cast<unsigned char>(x)) == y;
         });
}

std::uint32_t countIn(std::string_view bytes) {
  std::uint32_t count = 0;
  for (std::size_t b = 4; b-- > 0;) count = count << 8 | static_cast<unsigned char>(bytes[kHeaderBytes - 4 + b]);
  return count;
}

/// A binary file may begin with "solid" too, but a text file contains no zero byte.
bool isText(std::string_view bytes) {
  if (bytes.size() >= kHeaderBytes && bytes.size() - kHeaderBytes == kTriangleBytes * std::size_t{countIn(bytes)})
    return false;
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  bytes = bytes.substr(0, 4096);
  if (bytes.find('\0') != std::string_view::npos) return false;
  bytes.remove_prefix(std::min(bytes.find_first_not_of(kSpace), bytes.size()));
  return equalInAnyCase(bytes.substr(0, 5), "solid") || equalInAnyCase(bytes.substr(0, 5), "facet");
}

void addTriangle(RawMesh &raw) {
  const auto n = static_cast<unsigned>(raw.vertices.size());
  raw.triangles.push_back({n - 3, n - 2, n - 1});
}

Expected<RawMesh> readBinary(const std::string &name, std::string_view bytes) {
  const auto refuse = [&](const std::string &what) { return fail(ErrorCode::input, name + ": " + what); };
  if (bytes.size() < kHeaderBytes + kTriangleBytes)
    return refuse(fmt::format("{} bytes that are neither an STL text nor a header of {} bytes with triangles",
                              bytes.size(), kHeaderBytes));
  const std::size_t stated = countIn(bytes), there = (bytes.size() - kHeaderBytes) / kTriangleBytes,
                    rest = (bytes.size() - kHeaderBytes) % kTriangleBytes;
  RawMesh raw;
  std::size_t count = there;
  if (rest == 0 && stated != there) {
    raw.notes.push_back(fmt::format("the header says {}, the size of the file {}: all {} were read{}",
                                    counted(stated, "triangle", "triangles"), there, there,
                                    stated > there ? "; the file may be truncated" : ""));
  } else if (rest != 0 && (stated == 0 || stated <= there)) {
    count = stated == 0 ? there : stated;
    const std::size_t behind = bytes.size() - kHeaderBytes - count * kTriangleBytes;
    raw.notes.push_back(fmt::format("{} after the last of {} {} left out", counted(behind, "byte", "bytes"),
                                    counted(count, "triangle", "triangles"), wasOrWere(behind)));
  } else if (rest != 0) {
    return refuse(
        fmt::format("is no STL text, and as a binary file it is cut or damaged: the header says {} triangles "
                    "({} bytes), the file has {} bytes",
                    stated, kHeaderBytes + kTriangleBytes * stated, bytes.size()));
  }
  if (3 * count > std::numeric_limits<unsigned>::max() - 1) return refuse("more than 4294967294 vertices");
  raw.vertices.reserve(3 * count);
  raw.triangles.reserve(count);
  for (std::size_t t = 0; t < count; ++t) {
    const char *corner = bytes.data() + kHeaderBytes + t * kTriangleBytes + 12;  // after the normal
    for (int c = 0; c < 3; ++c) {
      Vec3 p{};
      for (double &x : p) {
        std::uint32_t bits = 0;
        for (std::size_t b = 4; b-- > 0;) bits = bits << 8 | static_cast<unsigned char>(corner[b]);
        x = static_cast<double>(std::bit_cast<float>(bits));
        corner += 4;
      }
      raw.vertices.push_back(p);
    }
    addTriangle(raw);
  }
  return raw;
}

class TextParser {
 public:
  TextParser(std::string name, std::string_view text) : name_(std::move(name)), text_(text) {}

  Expected<RawMesh> run() {
    std::vector<unsigned> corners;
    bool isInside = false, isEnded = false;
    for (std::string_view word = token(); !word.empty(); word = token()) {
      isEnded = equalInAnyCase(word, "endsolid");
      if (isEnded || equalInAnyCase(word, "solid")) {
        at_ = std::min(text_.find_first_of("\r\n", at_), text_.size());  // its name
      } else if (equalInAnyCase(word, "facet")) {
        isInside = true;
      } else if (equalInAnyCase(word, "endfacet")) {
        isInside = false;
      } else if (equalInAnyCase(word, "vertex")) {
        if (auto read = vertex(); !read) return tl::unexpected(read.error());
        corners.push_back(static_cast<unsigned>(raw_.vertices.size() - 1));
      } else if (equalInAnyCase(word, "endloop")) {
        if (!addFace(raw_, corners))
          return refuse(fmt::format("a concave facet with {} corners; up to 4096 are accepted", corners.size()));
        corners.clear();
      }
    }
    if (isInside) return refuse("the file ends within a facet");
    if (raw_.triangles.empty()) return fail(ErrorCode::input, name_ + ": no facets; a surface is expected");
    if (!isEnded) raw_.notes.push_back("the file ends without 'endsolid': it may be truncated");
    return std::move(raw_);
  }

 private:
  std::string_view token() {
    at_ = std::min(text_.find_first_not_of(kSpace, at_), text_.size());
    begin_ = at_;
    at_ = std::min(text_.find_first_of(kSpace, at_), text_.size());
    return text_.substr(begin_, at_ - begin_);
  }
  [[nodiscard]] tl::unexpected<Error> refuse(const std::string &what) const {
    const auto line = std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(begin_), '\n') + 1;
    return fail(ErrorCode::input, fmt::format("{}:{}: {}", name_, line, what));
  }
  Expected<void> vertex() {
    Vec3 p{};
    for (double &x : p) {
      const std::string_view word = token();
      const NumberState state = parseNumber(word, x);
      if (state == NumberState::notANumber)
        return refuse("coordinate " + quotedText(word) + " is not a number (a decimal point is expected)");
      if (state == NumberState::notFinite) return refuse("coordinate " + quotedText(word) + " is not finite");
    }
    raw_.vertices.push_back(p);
    return {};
  }

  std::string name_;
  std::string_view text_;
  std::size_t at_ = 0, begin_ = 0;
  RawMesh raw_;
};

}  // namespace

Expected<RawMesh> readStl(const std::filesystem::path &path) {
  const auto bytes = readWholeFile(path);
  if (!bytes) return tl::unexpected(bytes.error());
  const std::string name = displayPath(path);
  return isText(*bytes) ? TextParser(name, *bytes).run() : readBinary(name, *bytes);
}

}  // namespace c3de::geometry
