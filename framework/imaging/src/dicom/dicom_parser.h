// SPDX-License-Identifier: Apache-2.0
// Parser for the structure of DICOM files (PS3.5 chapters 7 and 10). A separate implementation, because Debian's GDCM
// is built with assertions and terminates the program on damaged files. Values are located, not copied: nothing large
// is read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/expected.h"

namespace c3de::imaging {

/// Bytes of a file, or of its inflated content.
class DicomBytes {
 public:
  explicit DicomBytes(const std::filesystem::path &path);
  explicit DicomBytes(std::vector<char> memory);
  [[nodiscard]] std::uint64_t length() const { return length_; }
  /// False: there are fewer bytes.
  [[nodiscard]] bool read(std::uint64_t at, void *to, std::size_t bytes);
  /// A number in the file has a decimal comma, which the standard does not allow.
  bool hasDecimalComma = false;

 private:
  std::ifstream file_;
  std::vector<char> memory_;  ///< all bytes, or those of the file from windowAt_ on
  std::uint64_t length_ = 0, windowAt_ = 0;
};

/// Encoding of elements.
struct DicomSyntax {
  bool isExplicit = true, bigEndian = false;
};

/// Elements by group << 16 | element.
class DicomSet {
 public:
  struct Element {
    std::uint64_t at = 0, length = 0;  ///< of the value; for undefined length including its delimiter
    bool undefined = false, asUnknown = false;
    std::string representation;  ///< "DS", "SQ", …; empty in implicit files
  };

  [[nodiscard]] bool has(std::uint32_t tag) const { return elements_.contains(tag); }
  [[nodiscard]] const Element *find(std::uint32_t tag) const;
  [[nodiscard]] std::string text(std::uint32_t tag) const;                  ///< without padding; "" if absent
  [[nodiscard]] std::string name(std::uint32_t tag) const;                  ///< display text, UTF-8
  [[nodiscard]] std::vector<double> decimals(std::uint32_t tag) const;      ///< of text such as 1\2\3; else NaN
  [[nodiscard]] std::size_t number(std::uint32_t tag) const;                ///< of 16 bits; 0 if absent
  [[nodiscard]] std::vector<std::uint16_t> words(std::uint32_t tag) const;  ///< of 16 bits, US or OW
  [[nodiscard]] std::vector<double> doubles(std::uint32_t tag) const;       ///< of 64 bits (FD)
  [[nodiscard]] std::vector<char> bytes(std::uint32_t tag) const;           ///< as stored, up to a megabyte
  /// Items of a sequence; empty where it is absent or damaged.
  [[nodiscard]] std::vector<DicomSet> items(std::uint32_t tag) const;

 private:
  friend class DicomParser;
  std::shared_ptr<DicomBytes> bytes_;
  DicomSyntax syntax_;
  std::string characterSet_;
  std::map<std::uint32_t, Element> elements_;
};

inline constexpr std::uint32_t kPixelData = 0x7fe00010, kFloatPixels = 0x7fe00008, kDoublePixels = 0x7fe00009;

struct DicomContent {
  DicomSet set;
  std::shared_ptr<DicomBytes> bytes;
  DicomSyntax syntax;
  std::string transferSyntax;  ///< its UID
  std::string damage;          ///< where its structure breaks off; empty: complete, or it ends with its pixels
  [[nodiscard]] bool isCompressed() const;
  [[nodiscard]] const DicomSet::Element *pixels() const;  ///< of any kind; null: none
};

/// None for a file that is not DICOM.
[[nodiscard]] std::optional<DicomContent> parseDicom(const std::filesystem::path &path);

/// The fragments of compressed pixels, the offset table first; none if they do not end correctly.
[[nodiscard]] std::optional<std::vector<DicomSet::Element>> fragmentsOf(const DicomContent &content);

}  // namespace c3de::imaging
