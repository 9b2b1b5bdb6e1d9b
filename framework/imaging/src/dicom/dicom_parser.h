// SPDX-License-Identifier: Apache-2.0
// The structure of DICOM files (PS3.5 chapters 7 and 10), of our own because Debian's GDCM has its assertions on and
// ends the program at damaged files. Values are found, not copied: nothing large is read.
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
  /// False: there are not so many.
  [[nodiscard]] bool read(std::uint64_t at, void *to, std::size_t bytes);
  /// That a number of the file has a decimal comma, which the standard does not know.
  bool hasDecimalComma = false;

 private:
  std::ifstream file_;
  std::vector<char> memory_;  ///< all bytes, or those of the file from windowAt_ on
  std::uint64_t length_ = 0, windowAt_ = 0;
};

/// How elements are written.
struct DicomSyntax {
  bool isExplicit = true, bigEndian = false;
};

/// Elements by group << 16 | element.
class DicomSet {
 public:
  struct Element {
    std::uint64_t at = 0, length = 0;  ///< of the value; with undefined length up to and with its delimiter
    bool undefined = false, asUnknown = false;
    std::string representation;  ///< "DS", "SQ", …; empty in implicit files
  };

  [[nodiscard]] bool has(std::uint32_t tag) const { return elements_.contains(tag); }
  [[nodiscard]] const Element *find(std::uint32_t tag) const;
  [[nodiscard]] std::string text(std::uint32_t tag) const;                  ///< without padding; "" if absent
  [[nodiscard]] std::string name(std::uint32_t tag) const;                  ///< text for a person, UTF-8
  [[nodiscard]] std::vector<double> decimals(std::uint32_t tag) const;      ///< of text such as 1\2\3; NaN for none
  [[nodiscard]] std::size_t number(std::uint32_t tag) const;                ///< of 16 bits; 0 if absent
  [[nodiscard]] std::vector<std::uint16_t> words(std::uint32_t tag) const;  ///< of 16 bits, US or OW
  [[nodiscard]] std::vector<double> doubles(std::uint32_t tag) const;       ///< of 64 bits (FD)
  [[nodiscard]] std::vector<char> bytes(std::uint32_t tag) const;           ///< as stored, up to a megabyte
  /// Items of a sequence; empty where there is none or it is damaged.
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
  std::string damage;          ///< where its structure breaks off; empty: it is whole, or ends with its pixels
  [[nodiscard]] bool isCompressed() const;
  [[nodiscard]] const DicomSet::Element *pixels() const;  ///< of whichever kind; null: none
};

/// Nothing for what is no DICOM file.
[[nodiscard]] std::optional<DicomContent> parseDicom(const std::filesystem::path &path);

/// The pieces of compressed pixels, the table of offsets first; nothing if they do not end as they should.
[[nodiscard]] std::optional<std::vector<DicomSet::Element>> fragmentsOf(const DicomContent &content);

}  // namespace c3de::imaging
