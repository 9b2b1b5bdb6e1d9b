// SPDX-License-Identifier: Apache-2.0
#include "dicom/dicom_mosaic.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "c3de/core/text.h"
#include "formats/image_header.h"

namespace c3de::imaging {
namespace {

/// (gggg,xxee) of the block reserved by a private creator; 0: none.
std::uint32_t privateTag(const DicomSet &set, std::uint32_t group, const std::string &creator, std::uint32_t element) {
  for (std::uint32_t block = 0x10; block <= 0xff; ++block)
    if (set.text(group << 16 | block) == creator) return group << 16 | block << 8 | element;
  return 0;
}

/// Fields of a CSA header by name. Versions 1 and 2 ("SV10") differ in their beginning and in how they count lengths.
std::map<std::string, std::vector<double>> csaFields(const std::vector<char> &csa) {
  std::map<std::string, std::vector<double>> fields;
  std::size_t at = 0;
  const auto number = [&](std::size_t from) {
    std::uint32_t value = 0;
    for (std::size_t b = 4; b-- > 0;) value = value << 8 | static_cast<unsigned char>(csa[from + b]);
    return value;
  };
  const bool isSecond = csa.size() > 16 && std::memcmp(csa.data(), "SV10", 4) == 0;
  if (isSecond) at = 8;
  if (csa.size() < at + 8) return fields;
  const std::uint32_t count = number(at);
  at += 8;
  constexpr std::size_t kTag = 84, kItem = 16;
  std::uint32_t first = 0;
  for (std::uint32_t n = 0; n < count && n < 1000 && at + kTag <= csa.size(); ++n) {
    const char *name = csa.data() + at;
    const std::string key(name, std::find(name, name + 64, '\0'));
    const std::uint32_t items = number(at + 76);
    if (n == 0) first = items;
    at += kTag;
    for (std::uint32_t i = 0; i < items && i < 1000; ++i) {
      if (at + kItem > csa.size()) return fields;
      const std::uint32_t length = isSecond ? number(at + 4) : number(at) - first;
      at += kItem;
      if (length > csa.size() - at) return fields;
      const auto value =
          numbersIn(trimmed(std::string(csa.data() + at, std::find(csa.data() + at, csa.data() + at + length, '\0'))));
      if (value.size() == 1) fields[key].push_back(value[0]);
      at = std::min(csa.size(), at + (length + 3) / 4 * 4);
    }
  }
  return fields;
}

template <class T>
std::vector<T> apart(const std::vector<T> &picture, const DicomFile &file, std::size_t columns) {
  const std::size_t each = file.rows * file.columns;
  std::vector<T> out(each * file.frames.size());
  for (std::size_t f = 0; f < file.frames.size(); ++f)
    for (std::size_t row = 0; row < file.rows; ++row) {
      const T *from = picture.data() + (f / file.tiles * file.rows + row) * columns + f % file.tiles * file.columns;
      std::copy_n(from, file.columns, out.data() + f * each + row * file.columns);
    }
  return out;
}

}  // namespace

bool isMosaic(const DicomSet &set) {
  const std::string type = "\\" + set.text(0x00080008) + "\\";
  return type.find("\\MOSAIC\\") != std::string::npos;
}

void splitMosaic(const DicomSet &set, DicomFile &file) {
  if (!file.refusal.empty()) return;
  const auto csa = csaFields(set.bytes(privateTag(set, 0x0029, "SIEMENS CSA HEADER", 0x10)));
  const auto field = [&](const char *name) {
    const auto found = csa.find(name);
    return found == csa.end() ? std::vector<double>() : found->second;
  };
  const auto refuseTiles = [&](const std::string &what) {
    file.refusal = "is a mosaic of Siemens (many slices in one picture) " + what;
  };
  double count = 0.0;
  if (const auto stated = field("NumberOfImagesInMosaic"); !stated.empty())
    count = stated[0];
  else
    count = static_cast<double>(set.number(privateTag(set, 0x0019, "SIEMENS MR HEADER", 0x0a)));
  if (count == 0.0)
    return refuseTiles(
        "whose header does not say how many there are: NumberOfImagesInMosaic is missing (was the CSA header "
        "removed?)");
  if (!(count >= 1.0 && count <= 4096.0) || count != std::floor(count) || file.frames.size() != 1)
    return refuseTiles("whose header says " + formatNumber(count) + " tiles in " + std::to_string(file.frames.size()) +
                       " frames; accepted are 1 to 4096 in one");
  const auto tiles = static_cast<std::size_t>(std::ceil(std::sqrt(count)));
  if (file.rows % tiles != 0 || file.columns % tiles != 0)
    return refuseTiles("of " + std::to_string(file.columns) + " x " + std::to_string(file.rows) +
                       " pixels, which are not " + std::to_string(tiles) + " x " + std::to_string(tiles) +
                       " equal tiles");
  const DicomFrame whole = file.frames.front();
  if (!whole.position || !whole.oriented || !whole.spaced)
    return refuseTiles("without position, orientation or pixel spacing");
  const auto apart = set.decimals(0x00180088);
  const double step = !apart.empty() ? std::abs(apart[0]) : 0.0;
  if (!(step > 0.0 && step < 1e4))
    return refuseTiles("whose Spacing Between Slices is missing: the slice distance is unknown");
  const auto stated = field("SliceNormalVector");
  const Vec3 normal = cross(whole.alongRow, whole.alongColumn);
  const double along = stated.size() == 3 ? dot({stated[0], stated[1], stated[2]}, normal) : 0.0;
  if (!(std::abs(along) > 0.99 && std::abs(along) < 1.01))
    return refuseTiles(stated.size() == 3 ? "whose SliceNormalVector is not perpendicular to its slices"
                                          : "whose SliceNormalVector is missing: the stacking direction is unknown");

  file.tiles = tiles;
  const double adjacentColumns = static_cast<double>(file.columns - file.columns / tiles),
               rowsBelow = static_cast<double>(file.rows - file.rows / tiles);
  file.columns /= tiles;
  file.rows /= tiles;
  const Vec3 corner = *whole.position + (0.5 * adjacentColumns * whole.columnStep) * whole.alongRow +
                      (0.5 * rowsBelow * whole.rowStep) * whole.alongColumn;
  file.frames.assign(static_cast<std::size_t>(count), whole);
  for (std::size_t f = 0; f < file.frames.size(); ++f) {
    file.frames[f].position = corner + ((along > 0.0 ? step : -step) * static_cast<double>(f)) * normal;
    file.frames[f].sliceStep = step;
    file.frames[f].time = 0.0;
  }
  file.notices.push_back("The picture is a mosaic of " + std::to_string(file.frames.size()) +
                         " slices (Siemens): it is split into them.");
}

bool splitTiles(const DicomFile &file, DicomPixels &pixels) {
  if (pixels.frames != 1 || pixels.columns != file.columns * file.tiles || pixels.rows != file.rows * file.tiles ||
      file.frames.size() > file.tiles * file.tiles)
    return false;
  std::visit([&](auto &all) { all = apart(all, file, pixels.columns); }, pixels.voxels);
  if (!pixels.colours.empty()) pixels.colours = apart(pixels.colours, file, pixels.columns);
  pixels.columns = file.columns;
  pixels.rows = file.rows;
  pixels.frames = file.frames.size();
  return true;
}

}  // namespace c3de::imaging
