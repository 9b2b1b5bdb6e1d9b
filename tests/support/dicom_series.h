// SPDX-License-Identifier: Apache-2.0
// A volume as a CT series: one file per slice, explicit VR little endian, with the minimum that a reader needs.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "c3de/core/vec.h"

namespace c3de::test {

/// The elements of a DICOM data set, to be added in ascending order.
class DicomElements {
 public:
  /// Values of odd length are padded, as the standard requires.
  void add(std::uint16_t group, std::uint16_t element, const char (&vr)[3], std::string value) {
    if (value.size() % 2 != 0) value += std::string(vr) == "UI" ? '\0' : ' ';
    number(group, 2);
    number(element, 2);
    bytes_ += vr;
    bool isLong = false;
    for (const char *known : {"OB", "OW", "OF", "OD", "SQ", "UN"}) isLong = isLong || std::string(vr) == known;
    if (isLong) number(0, 2);
    number(static_cast<std::uint32_t>(value.size()), isLong ? 4 : 2);
    bytes_ += value;
  }
  void add(std::uint16_t group, std::uint16_t element, std::uint16_t value) {
    add(group, element, "US", {static_cast<char>(value & 0xff), static_cast<char>(value >> 8)});
  }
  /// Decimal strings: at most 16 characters each.
  void add(std::uint16_t group, std::uint16_t element, std::initializer_list<double> values) {
    std::string text;
    for (const double value : values) {
      char number[32];
      std::snprintf(number, sizeof number, "%.9g", value);
      text += (text.empty() ? "" : "\\") + std::string(number);
    }
    add(group, element, "DS", text);
  }
  /// A sequence of items, each the bytes of its elements.
  void add(std::uint16_t group, std::uint16_t element, const std::vector<std::string> &items) {
    DicomElements all;
    for (const std::string &item : items) {
      all.number(0xfffe, 2);
      all.number(0xe000, 2);
      all.number(static_cast<std::uint32_t>(item.size()), 4);
      all.bytes_ += item;
    }
    add(group, element, "SQ", all.bytes_);
  }
  [[nodiscard]] const std::string &bytes() const { return bytes_; }

 private:
  void number(std::uint32_t value, int width) {
    for (int b = 0; b < width; ++b) bytes_ += static_cast<char>(value >> (8 * b) & 0xff);
  }
  std::string bytes_;
};

/// A file: the preamble and meta information, then the data set.
inline std::string dicomFile(const std::string &elements, const std::string &transferSyntax = "1.2.840.10008.1.2.1") {
  DicomElements meta;
  meta.add(0x0002, 0x0001, "OB", std::string("\0\1", 2));
  meta.add(0x0002, 0x0002, "UI", "1.2.840.10008.5.1.4.1.1.4");
  meta.add(0x0002, 0x0003, "UI", "2.25.3104.9");
  meta.add(0x0002, 0x0010, "UI", transferSyntax);
  meta.add(0x0002, 0x0012, "UI", "2.25.3104");
  DicomElements length;
  const auto bytes = static_cast<std::uint32_t>(meta.bytes().size());
  length.add(0x0002, 0x0000, "UL", {static_cast<char>(bytes & 0xff), static_cast<char>(bytes >> 8), '\0', '\0'});
  return std::string(128, '\0') + "DICM" + length.bytes() + meta.bytes() + elements;
}

/// Files 0001.dcm, … in an existing folder; stored numbers are values + 1024. Rows and columns are at right angles.
/// Slices may be shifted against each other, as with a tilted gantry, and may be in any order along their normal.
inline void writeDicomSeries(const std::filesystem::path &folder, const std::array<std::size_t, 3> &size,
                             const Mat4 &worldFromIndex, std::span<const std::int16_t> values) {
  const Mat4 &m = worldFromIndex;
  const Vec3 row{m[0], m[1], m[2]}, column{m[4], m[5], m[6]};
  const Vec3 x = (1.0 / norm(row)) * row, y = (1.0 / norm(column)) * column;
  const std::string ct = "1.2.840.10008.5.1.4.1.1.2", root = "2.25.3104";
  for (std::size_t k = 0; k < size[2]; ++k) {
    const std::string instance = root + ".1.1." + std::to_string(k + 1);
    const Vec3 at = transformPoint(m, {0.0, 0.0, static_cast<double>(k)});
    DicomElements slice;
    slice.add(0x0008, 0x0016, "UI", ct);
    slice.add(0x0008, 0x0018, "UI", instance);
    slice.add(0x0008, 0x0060, "CS", "CT");
    slice.add(0x0010, 0x0010, "PN", "");
    slice.add(0x0020, 0x000d, "UI", root + ".1");
    slice.add(0x0020, 0x000e, "UI", root + ".1.1");
    slice.add(0x0020, 0x0013, "IS", std::to_string(k + 1));
    slice.add(0x0020, 0x0032, {at[0], at[1], at[2]});
    slice.add(0x0020, 0x0037, {x[0], x[1], x[2], y[0], y[1], y[2]});
    slice.add(0x0020, 0x0052, "UI", root + ".2");
    slice.add(0x0028, 0x0002, std::uint16_t{1});
    slice.add(0x0028, 0x0004, "CS", "MONOCHROME2");
    slice.add(0x0028, 0x0010, static_cast<std::uint16_t>(size[1]));
    slice.add(0x0028, 0x0011, static_cast<std::uint16_t>(size[0]));
    slice.add(0x0028, 0x0030, {norm(column), norm(row)});  // between rows, then between columns
    slice.add(0x0028, 0x0100, std::uint16_t{16});
    slice.add(0x0028, 0x0101, std::uint16_t{16});
    slice.add(0x0028, 0x0102, std::uint16_t{15});
    slice.add(0x0028, 0x0103, std::uint16_t{0});
    slice.add(0x0028, 0x1052, {-1024.0});
    slice.add(0x0028, 0x1053, {1.0});
    std::string pixels;
    for (const std::int16_t value : values.subspan(k * size[0] * size[1], size[0] * size[1])) {
      const auto stored = static_cast<std::uint16_t>(value + 1024);
      pixels += static_cast<char>(stored & 0xff);
      pixels += static_cast<char>(stored >> 8);
    }
    slice.add(0x7fe0, 0x0010, "OW", pixels);

    char name[32];
    std::snprintf(name, sizeof name, "%04zu.dcm", k + 1);
    std::ofstream file(folder / name, std::ios::binary);
    file << dicomFile(slice.bytes());
  }
}

}  // namespace c3de::test
