// SPDX-License-Identifier: Apache-2.0
#include "dicom/dicom_files.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>

#include "c3de/core/input_file.h"
#include "c3de/core/text.h"
#include "dicom/dicom_colours.h"
#include "dicom/dicom_mosaic.h"
#include "dicom/dicom_parser.h"
#include "dicom/dicom_segments.h"
#include "formats/image_header.h"

namespace c3de::imaging {
namespace {

constexpr const char *kParametricMap = "1.2.840.10008.5.1.4.1.1.30";

/// Sources of a frame's attributes: its own functional groups, the shared ones, or the file.
struct Places {
  const DicomSet *own, *shared;
  const DicomSet &file;
  [[nodiscard]] std::vector<double> decimals(std::uint32_t group, std::uint32_t tag) const {
    for (const DicomSet *set : {own, shared}) {
      if (!set) continue;
      const auto groups = set->items(group);
      if (!groups.empty())
        if (auto all = groups.front().decimals(tag); !all.empty()) return all;
    }
    return file.decimals(tag);
  }
  /// Adds a notice about an invalid value that is ignored.
  void noteBad(std::uint32_t group, std::uint32_t tag, const char *name, const char *accepted,
               std::vector<std::string> &notices) const {
    std::string written = file.text(tag);
    for (const DicomSet *set : {shared, own})
      if (set)
        if (const auto groups = set->items(group); !groups.empty() && groups.front().has(tag))
          written = groups.front().text(tag);
    if (!written.empty())
      notices.push_back(std::string(name) + " '" + written.substr(0, 60) + "' is not " + accepted +
                        "; it is left out.");
  }
  /// The first item of a sequence.
  [[nodiscard]] std::optional<DicomSet> item(std::uint32_t tag) const {
    for (const DicomSet *set : {own, shared, &file}) {
      if (!set) continue;
      if (auto all = set->items(tag); !all.empty()) return std::move(all.front());
    }
    return std::nullopt;
  }
};

double numberOr(const std::vector<double> &all, double otherwise) {
  return !all.empty() && std::isfinite(all[0]) ? all[0] : otherwise;
}

bool finite(const std::vector<double> &all, std::size_t count) {
  return all.size() >= count && std::all_of(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count),
                                            [](double x) { return std::abs(x) < 1e6; });
}

/// Parametric maps define their values by Real World Value Mapping, PS3.3 C.7.6.16.2.11.
void scaleParameter(const Places &from, DicomFrame &frame, DicomFile &out) {
  const auto mapping = from.item(0x00409096);
  if (!mapping) return;
  const double slope = numberOr(mapping->doubles(0x00409225), 1.0);
  frame.slope = slope == 0.0 ? 1.0 : slope;
  frame.intercept = numberOr(mapping->doubles(0x00409224), 0.0);
  const auto units = mapping->items(0x004008ea);
  if (units.empty() || !out.unit.empty()) return;
  out.unit = units.front().text(0x00080100);  // UCUM
  if (out.unit == "1" || out.unit == "no units") out.unit.clear();
}

DicomFrame readFrame(const Places &from, const DicomSet &file, const std::string &modality, DicomFile &out) {
  DicomFrame frame;
  auto position = from.decimals(0x00209113, 0x00200032);
  auto orientation = from.decimals(0x00209116, 0x00200037);
  if (const auto detectors = file.items(0x00540022); !detectors.empty()) {  // nuclear medicine
    if (position.empty()) position = detectors.front().decimals(0x00200032);
    if (orientation.empty()) orientation = detectors.front().decimals(0x00200037);
  }
  if (finite(position, 3))
    frame.position = Vec3{position[0], position[1], position[2]};
  else
    from.noteBad(0x00209113, 0x00200032, "Image Position", "three numbers", out.notices);
  if (finite(orientation, 6)) {
    const Vec3 row{orientation[0], orientation[1], orientation[2]},
        column{orientation[3], orientation[4], orientation[5]};
    // Standard: perpendicular unit vectors; writers round them.
    if (std::abs(norm(row) - 1.0) < 0.01 && std::abs(norm(column) - 1.0) < 0.01 && std::abs(dot(row, column)) < 0.01) {
      frame.alongRow = (1.0 / norm(row)) * row;
      frame.alongColumn = (1.0 / norm(column)) * column;
      frame.oriented = true;
    } else {
      out.refusal = "its Image Orientation is not two unit vectors at a right angle";
    }
  } else {
    from.noteBad(0x00209116, 0x00200037, "Image Orientation", "six numbers", out.notices);
  }
  auto spacing = from.decimals(0x00289110, 0x00280030);
  if (!finite(spacing, 2)) {
    spacing = from.decimals(0x00289110, 0x00181164);
    if (finite(spacing, 2)) out.notices.push_back("The spacing is that on the detector, not in the patient.");
  }
  if (finite(spacing, 2) && spacing[0] > 0.0 && spacing[1] > 0.0) {
    frame.rowStep = spacing[0];
    frame.columnStep = spacing[1];
    frame.spaced = true;
  } else {
    from.noteBad(0x00289110, 0x00280030, "Pixel Spacing", "two numbers above 0", out.notices);
  }
  frame.sliceStep = std::abs(numberOr(from.decimals(0x00289110, 0x00180088), 0.0));
  if (frame.sliceStep == 0.0) frame.sliceStep = std::abs(numberOr(from.decimals(0x00289110, 0x00180050), 0.0));
  const auto slope = from.decimals(0x00289145, 0x00281053), intercept = from.decimals(0x00289145, 0x00281052);
  frame.slope = numberOr(slope, 1.0);
  frame.intercept = numberOr(intercept, 0.0);
  const auto isNumber = [](const std::vector<double> &all) { return !all.empty() && std::isfinite(all[0]); };
  if (!isNumber(slope) || slope[0] == 0.0)
    from.noteBad(0x00289145, 0x00281053, "Rescale Slope", "a number other than 0", out.notices);
  if (!isNumber(intercept)) from.noteBad(0x00289145, 0x00281052, "Rescale Intercept", "a number", out.notices);
  if (frame.slope == 0.0) frame.slope = 1.0;
  if (modality == "RTDOSE") frame.slope = numberOr(file.decimals(0x3004000e), 1.0), frame.intercept = 0.0;
  if (file.text(0x00080016) == kParametricMap) scaleParameter(from, frame, out);
  if (out.segmentation)
    if (const auto segment = from.item(0x0062000a))
      frame.segment = static_cast<std::uint16_t>(segment->number(0x0062000b));
  return frame;
}

std::string unitOf(const DicomSet &set, const std::string &modality) {
  if (modality == "RTDOSE") return lowerCase(set.text(0x30040002)) == "gy" ? "Gy" : "";
  if (modality == "PT") return set.text(0x00541001);
  const std::string type = set.text(0x00281054);
  if (!type.empty() && type != "US") return type;
  return modality == "CT" ? "HU" : "";
}

/// Frames of these modalities without positions are a time series; those of other modalities may be slices.
bool framesAreTimeSeries(const std::string &modality) {
  for (const char *sliced : {"CT", "MR", "PT", "NM", "RTDOSE", "SEG"})
    if (modality == sliced) return false;
  return true;
}

/// Sets the positions of frames that are given by one position and steps: dose grids and nuclear medicine.
void positionByOffsets(const DicomSet &set, DicomFile &out) {
  const DicomFrame &first = out.frames.front();
  if (out.frames.size() < 2 || !first.position || !first.oriented) return;
  for (std::size_t f = 1; f < out.frames.size(); ++f)
    if (out.frames[f].position && norm(*out.frames[f].position - *first.position) > 1e-6) return;  // each has its own
  auto offsets = set.decimals(0x3004000c);
  const double step = numberOr(set.decimals(0x00180088), 0.0);
  if (offsets.empty() && step != 0.0)
    for (std::size_t f = 0; f < out.frames.size(); ++f) offsets.push_back(step * static_cast<double>(f));
  if (offsets.size() < out.frames.size() && framesAreTimeSeries(out.modality)) {
    out.isTimeSeries = true;
    return;
  }
  if (offsets.size() < out.frames.size()) {
    out.refusal = "its " + std::to_string(out.frames.size()) + " frames have no positions (a cine loop, not a volume)";
    return;
  }
  const Vec3 origin = *first.position, normal = cross(first.alongRow, first.alongColumn);
  for (std::size_t f = 0; f < out.frames.size(); ++f)
    out.frames[f].position = origin + (offsets[f] - offsets[0]) * normal;
}

/// Reads the frames and their positions; the refusal states why they do not form a volume. False: invalid number of
/// frames.
bool readFrames(const DicomSet &set, DicomFile &out) {
  const std::string stated = set.text(0x00280008);
  const double count = stated.empty() ? 1.0 : numberOr(numbersIn(stated), 0.0);
  if (!(count >= 1.0 && count <= 1e5)) {
    out.refusal = "its Number of Frames is '" + stated + "'";
    out.frames.resize(1);
    return false;
  }
  const auto shared = set.items(0x52009229), own = set.items(0x52009230);
  for (std::size_t f = 0; f < static_cast<std::size_t>(count); ++f) {
    out.frames.push_back(readFrame(
        {f < own.size() ? &own[f] : nullptr, shared.empty() ? nullptr : &shared.front(), set}, set, out.modality, out));
    out.frames.back().time = static_cast<double>(f);
  }
  if (!out.segmentation) positionByOffsets(set, out);
  if (out.refusal.empty() && out.frames.size() > 1 && !out.frames.front().position) {
    if (framesAreTimeSeries(out.modality))
      out.isTimeSeries = true;
    else
      out.refusal = "its " + std::to_string(out.frames.size()) +
                    " frames have no position in the patient (a cine loop, not a volume)";
  }
  return true;
}

std::optional<DicomFile> describe(const std::filesystem::path &path, const DicomSet &set) {
  DicomFile out;
  out.path = path;
  out.rows = set.number(0x00280010);
  out.columns = set.number(0x00280011);
  if (out.rows == 0 || out.columns == 0) return std::nullopt;
  out.series = set.text(0x0020000e);
  out.instance = set.text(0x00080018);
  out.number = set.text(0x00200011);
  out.description = set.name(0x0008103e);
  out.modality = set.text(0x00080060);
  out.patientName = set.name(0x00100010);
  out.bits = static_cast<unsigned>(set.number(0x00280100));
  out.isSigned = set.number(0x00280103) == 1;
  out.unit = unitOf(set, out.modality);
  for (const std::uint32_t tag : {0x00200100, 0x00180086, 0x00200012, 0x00200013})
    out.order.push_back(numberOr(set.decimals(tag), 0.0));
  const std::string colours = set.text(0x00280004);
  out.isReal = !set.has(kPixelData) && (set.has(kFloatPixels) || set.has(kDoublePixels));
  if (out.isReal) out.bits = set.has(kFloatPixels) ? 32 : 64;
  if (set.number(0x00280002) > 1 || (!colours.empty() && !colours.starts_with("MONOCHROME"))) {
    out.isColoured = true;
    out.refusal = refusalOfColours(set);
    out.notices.push_back("A colour image: its values are the brightness of its colours, from 0 to 255.");
  }
  if (out.modality == "SEG" || set.has(0x00620002)) {
    out.segmentation = segmentationOf(set);
    out.isColoured = false;  // a segmentation's palette contains the colours of segment numbers
    out.refusal = out.segmentation ? ""
                                   : "is a DICOM segmentation of type '" + set.text(0x00620001) +
                                         "'; BINARY, FRACTIONAL and LABELMAP are read";
    out.notices.clear();
  }
  if (colours == "MONOCHROME1")
    out.notices.push_back("The image is meant to be shown with small values bright (MONOCHROME1).");
  if (set.has(0x00283000))
    out.notices.push_back("The image has a table of values (Modality LUT), which is not applied.");
  if (!readFrames(set, out)) return out;
  std::sort(out.notices.begin(), out.notices.end());
  out.notices.erase(std::unique(out.notices.begin(), out.notices.end()), out.notices.end());
  return out;
}

std::uint64_t bytesOfPixels(const DicomFile &file, const DicomContent &content) {
  const std::uint64_t numbers =
      static_cast<std::uint64_t>(file.rows) * file.columns * file.frames.size() * samplesStored(content.set);
  return (numbers * file.bits + 7) / 8;
}

/// Notice where uncompressed pixel data continue after the pixels stated in the header; padding to even length is
/// normal.
std::string surplusPixels(const DicomFile &file, const DicomContent &content) {
  const DicomSet::Element *pixels = content.pixels();
  if (!pixels || pixels->undefined) return {};
  const std::uint64_t need = bytesOfPixels(file, content);
  if (pixels->length <= need + 1) return {};
  return "The file holds " + std::to_string(pixels->length - need) + " bytes behind the " + std::to_string(need) +
         " of the pixels that its header says; they are left out. Are rows, columns and frames right?";
}

/// Why the pixels cannot be read: the file ends within them, or has none.
std::string missingPixels(const DicomFile &file, const DicomContent &content) {
  const DicomSet::Element *pixels = content.pixels();
  if (!pixels) return content.damage.empty() ? "has no pixels" : "is truncated or damaged: " + content.damage;
  if (pixels->undefined) return fragmentsOf(content) ? "" : "is truncated or damaged within its compressed pixels";
  const std::uint64_t need = bytesOfPixels(file, content);
  const std::uint64_t there = std::min<std::uint64_t>(pixels->length, content.bytes->length() - pixels->at);
  if (there < need)
    return "is truncated: " + std::to_string(there) + " of " + std::to_string(need) + " bytes of pixels";
  return content.damage.empty() ? "" : "is damaged: " + content.damage;
}

}  // namespace

bool isDicom(const std::filesystem::path &path) {
  auto file = openInputFile(path);
  char head[132] = {};
  if (!file || !file->read(head, sizeof head)) return false;
  if (std::memcmp(head + 128, "DICM", 4) == 0) return true;
  // Without the preamble it begins with the signature, the meta header, or the first group of images.
  const bool mayBe = std::memcmp(head, "DICM", 4) == 0 || ((head[0] == 2 || head[0] == 8) && head[1] == 0);
  return mayBe && readDicomHeader(path);
}

std::filesystem::path imageFolderOf(const std::filesystem::path &path) {
  constexpr std::uint32_t kDirectoryRecords = 0x00041220;
  if (!isDicom(path)) return path;
  const auto content = parseDicom(path);
  if (!content || !content->set.has(kDirectoryRecords)) return path;
  return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

std::optional<DicomFile> readDicomHeader(const std::filesystem::path &path) {
  const auto content = parseDicom(path);
  if (!content) return std::nullopt;
  auto out = describe(path, content->set);
  if (!out || !out->refusal.empty()) return out;
  out->refusal = missingPixels(*out, *content);
  if (const std::string more = surplusPixels(*out, *content); !more.empty()) out->notices.push_back(more);
  if (isMosaic(content->set)) splitMosaic(content->set, *out);
  // type after decoding
  if (out->isColoured || (out->segmentation && out->bits < 8)) out->bits = 8, out->isSigned = false;
  if (content->bytes->hasDecimalComma) out->notices.emplace_back(kDecimalCommaNotice);
  return out;
}

}  // namespace c3de::imaging
