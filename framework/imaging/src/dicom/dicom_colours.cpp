// SPDX-License-Identifier: Apache-2.0
#include "dicom/dicom_colours.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace c3de::imaging {
namespace {

constexpr const char *kPalette = "PALETTE COLOR";

std::uint8_t byteOf(double x) { return static_cast<std::uint8_t>(std::clamp(std::lround(x), 0L, 255L)); }

/// One of the three tables of a palette.
struct PaletteTable {
  std::vector<std::uint8_t> entries;
  double first = 0.0;  ///< number mapped to the first entry
  [[nodiscard]] std::uint8_t at(double number) const {
    const double last = static_cast<double>(entries.size() - 1);
    return entries[static_cast<std::size_t>(std::clamp(number - first, 0.0, last))];
  }
};

PaletteTable tableOf(const DicomSet &set, std::uint32_t descriptor, std::uint32_t data) {
  PaletteTable out;
  const auto said = set.words(descriptor);
  if (said.size() < 3) return out;
  const std::size_t count = said[0] == 0 ? 65536u : said[0];
  out.first = set.number(0x00280103) == 1 ? static_cast<double>(static_cast<std::int16_t>(said[1])) : said[1];
  const auto raw = set.bytes(data);
  const auto words = set.words(data);
  if (words.size() >= count && count > 0)
    for (std::size_t n = 0; n < count; ++n)
      out.entries.push_back(static_cast<std::uint8_t>(said[2] > 8 ? words[n] >> 8 : std::min<unsigned>(words[n], 255)));
  else if (raw.size() >= count)
    for (std::size_t n = 0; n < count; ++n) out.entries.push_back(static_cast<std::uint8_t>(raw[n]));
  return out;
}

}  // namespace

std::string refusalOfColours(const DicomSet &set) {
  const std::string colours = set.text(0x00280004);
  const std::size_t samples = set.number(0x00280002), bits = set.number(0x00280100);
  const std::string found = "holds colours (" + colours + ", " + std::to_string(samples) + " numbers of " +
                            std::to_string(bits) + " bits per pixel)";
  if (bits != 8 && bits != 16) return found + "; supported: 8 and 16 bits";
  if (colours == kPalette)
    return samples == 1 && !set.has(0x00281221) ? ""
                                                : found + "; palettes are read where their tables are not in segments";
  if (samples == 3 && (colours == "RGB" || colours == "YBR_FULL" || colours == "YBR_ICT" || colours == "YBR_RCT"))
    return "";
  if (samples == 3 && bits == 8 && colours == "YBR_FULL_422") return "";
  return found + "; RGB, YBR_FULL, YBR_FULL_422, YBR_ICT, YBR_RCT and PALETTE COLOR are read";
}

std::size_t samplesStored(const DicomSet &set) {
  if (set.text(0x00280004) == "YBR_FULL_422") return 2;
  return std::max<std::size_t>(1, set.number(0x00280002));
}

std::vector<Rgba> coloursOf(const ColourSamples &samples) {
  const std::size_t each = samples.allocated / 8;
  const unsigned down = samples.stored > 8 ? samples.stored - 8 : 0;
  std::vector<Rgba> out(samples.bytes.size() / (3 * each), Rgba{0, 0, 0, 255});
  for (std::size_t p = 0; p < out.size(); ++p) {
    std::array<unsigned, 3> c{};
    for (std::size_t s = 0; s < 3; ++s) {
      std::uint16_t value = static_cast<unsigned char>(samples.bytes[each * (3 * p + s)]);
      if (each == 2) std::memcpy(&value, samples.bytes.data() + 2 * (3 * p + s), 2);
      c[s] = std::min(255u, static_cast<unsigned>(value) >> down);
    }
    if (!samples.isDifference) {
      for (std::size_t s = 0; s < 3; ++s) out[p][s] = static_cast<std::uint8_t>(c[s]);
      continue;
    }
    const double y = c[0], cb = c[1] - 128.0, cr = c[2] - 128.0;  // PS3.3 C.7.6.3.1.2
    out[p] = {byteOf(y + 1.402 * cr), byteOf(y - 0.344136 * cb - 0.714136 * cr), byteOf(y + 1.772 * cb), 255};
  }
  return out;
}

std::vector<char> unpaired(const std::vector<char> &bytes) {
  std::vector<char> out;
  out.reserve(bytes.size() / 2 * 3);
  for (std::size_t at = 0; at + 4 <= bytes.size(); at += 4)
    for (std::size_t pixel = 0; pixel < 2; ++pixel)
      out.insert(out.end(), {bytes[at + pixel], bytes[at + 2], bytes[at + 3]});
  return out;
}

std::vector<char> interleaved(const std::vector<char> &planes, std::size_t pixelsOfFrame, std::size_t bytesEach) {
  std::vector<char> out(planes.size());
  const std::size_t frame = 3 * pixelsOfFrame * bytesEach;
  for (std::size_t from = 0; from + frame <= planes.size(); from += frame)
    for (std::size_t s = 0; s < 3; ++s)
      for (std::size_t p = 0; p < pixelsOfFrame; ++p)
        std::copy_n(planes.data() + from + (s * pixelsOfFrame + p) * bytesEach, bytesEach,
                    out.data() + from + (3 * p + s) * bytesEach);
  return out;
}

std::vector<Rgba> paletteColours(const DicomSet &set, const Voxels &numbers) {
  std::array<PaletteTable, 3> tables;
  for (std::uint32_t s = 0; s < 3; ++s) tables[s] = tableOf(set, 0x00281101 + s, 0x00281201 + s);
  std::vector<Rgba> out;
  if (std::any_of(tables.begin(), tables.end(), [](const PaletteTable &table) { return table.entries.empty(); }))
    return out;
  std::visit(
      [&](const auto &all) {
        out.reserve(all.size());
        for (const auto number : all) {
          const auto at = static_cast<double>(number);
          out.push_back({tables[0].at(at), tables[1].at(at), tables[2].at(at), 255});
        }
      },
      numbers);
  return out;
}

std::vector<std::uint8_t> lumaOf(const std::vector<Rgba> &colours) {
  std::vector<std::uint8_t> out;
  out.reserve(colours.size());
  for (const Rgba &c : colours) out.push_back(byteOf(0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]));
  return out;
}

}  // namespace c3de::imaging
