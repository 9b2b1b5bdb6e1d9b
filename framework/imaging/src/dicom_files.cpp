// SPDX-License-Identifier: Apache-2.0
#include "dicom_files.h"

#include <gdcmImage.h>
#include <gdcmImageReader.h>
#include <gdcmReader.h>
#include <gdcmSequenceOfItems.h>
#include <gdcmTrace.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <sstream>

#include "c3de/core/log.h"
#include "c3de/core/platform.h"
#include "c3de/core/text.h"
#include "image_header.h"

namespace c3de::imaging {
namespace {

using gdcm::DataSet;
using gdcm::Tag;

/// GDCM's own words never reach the console: what is wrong is in our messages.
void quieten() {
  static const bool once = [] {
    gdcm::Trace::DebugOff();
    gdcm::Trace::WarningOff();
    gdcm::Trace::ErrorOff();
    return true;
  }();
  (void)once;
}

std::string textOf(const DataSet *set, const Tag &tag) {
  if (!set || !set->FindDataElement(tag)) return {};
  const gdcm::ByteValue *value = set->GetDataElement(tag).GetByteValue();
  if (!value || !value->GetPointer()) return {};
  return trimmed(std::string(value->GetPointer(), value->GetLength()));
}

std::vector<double> decimalsOf(const DataSet *set, const Tag &tag) {
  std::string text = textOf(set, tag);
  std::replace(text.begin(), text.end(), '\\', ' ');
  return numbersIn(text);
}

std::size_t shortOf(const DataSet &set, const Tag &tag) {  // VR US, in the order of this machine after reading
  if (!set.FindDataElement(tag)) return 0;
  const gdcm::ByteValue *value = set.GetDataElement(tag).GetByteValue();
  std::uint16_t number = 0;
  if (!value || value->GetLength() < sizeof number) return 0;
  std::memcpy(&number, value->GetPointer(), sizeof number);
  return number;
}

/// Item n of a sequence (from 0), held alive; no set where there is none.
struct Item {
  gdcm::SmartPointer<gdcm::SequenceOfItems> sequence;
  const DataSet *set = nullptr;
};
Item item(const DataSet *set, const Tag &tag, std::size_t n) {
  Item out;
  if (!set || !set->FindDataElement(tag)) return out;
  out.sequence = set->GetDataElement(tag).GetValueAsSQ();
  if (out.sequence && n < out.sequence->GetNumberOfItems()) out.set = &out.sequence->GetItem(n + 1).GetNestedDataSet();
  return out;
}

/// Where the attributes of a frame stand: its own functional groups, the shared ones, or the file.
struct Places {
  const DataSet *own, *shared, *file;
  [[nodiscard]] std::vector<double> decimals(const Tag &group, const Tag &tag) const {
    for (const DataSet *set : {own, shared})
      if (auto all = decimalsOf(item(set, group, 0).set, tag); !all.empty()) return all;
    return decimalsOf(file, tag);
  }
};

double numberOr(const std::vector<double> &all, double otherwise) {
  return !all.empty() && std::isfinite(all[0]) ? all[0] : otherwise;
}

bool finite(const std::vector<double> &all, std::size_t count) {
  return all.size() >= count && std::all_of(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count), [](double x) { return std::abs(x) < 1e6; });
}

DicomFrame readFrame(const Places &from, const DataSet &file, const std::string &modality, DicomFile &out) {
  DicomFrame frame;
  auto position = from.decimals(Tag(0x20, 0x9113), Tag(0x20, 0x32));
  auto orientation = from.decimals(Tag(0x20, 0x9116), Tag(0x20, 0x37));
  const Item detector = item(&file, Tag(0x54, 0x22), 0);  // nuclear medicine
  if (position.empty()) position = decimalsOf(detector.set, Tag(0x20, 0x32));
  if (orientation.empty()) orientation = decimalsOf(detector.set, Tag(0x20, 0x37));
  if (finite(position, 3)) frame.position = Vec3{position[0], position[1], position[2]};
  if (finite(orientation, 6)) {
    const Vec3 row{orientation[0], orientation[1], orientation[2]}, column{orientation[3], orientation[4], orientation[5]};
    // Standard: unit vectors at a right angle; writers round them.
    if (std::abs(norm(row) - 1.0) < 0.01 && std::abs(norm(column) - 1.0) < 0.01 && std::abs(dot(row, column)) < 0.01) {
      frame.alongRow = (1.0 / norm(row)) * row;
      frame.alongColumn = (1.0 / norm(column)) * column;
      frame.oriented = true;
    } else {
      out.refusal = "its Image Orientation is not two unit vectors at a right angle";
    }
  }
  auto spacing = from.decimals(Tag(0x28, 0x9110), Tag(0x28, 0x30));
  if (!finite(spacing, 2)) {
    spacing = from.decimals(Tag(0x28, 0x9110), Tag(0x18, 0x1164));
    if (finite(spacing, 2)) out.notices.push_back("The spacing is that on the detector, not in the patient.");
  }
  if (finite(spacing, 2) && spacing[0] > 0.0 && spacing[1] > 0.0) {
    frame.rowStep = spacing[0];
    frame.columnStep = spacing[1];
    frame.spaced = true;
  }
  frame.sliceStep = std::abs(numberOr(from.decimals(Tag(0x28, 0x9110), Tag(0x18, 0x88)), 0.0));
  if (frame.sliceStep == 0.0) frame.sliceStep = std::abs(numberOr(from.decimals(Tag(0x28, 0x9110), Tag(0x18, 0x50)), 0.0));
  frame.slope = numberOr(from.decimals(Tag(0x28, 0x9145), Tag(0x28, 0x1053)), 1.0);
  frame.intercept = numberOr(from.decimals(Tag(0x28, 0x9145), Tag(0x28, 0x1052)), 0.0);
  if (frame.slope == 0.0) frame.slope = 1.0;
  if (modality == "RTDOSE") frame.slope = numberOr(decimalsOf(&file, Tag(0x3004, 0xe)), 1.0), frame.intercept = 0.0;
  return frame;
}

std::string unitOf(const DataSet &set, const std::string &modality) {
  if (modality == "RTDOSE") return lowerCase(textOf(&set, Tag(0x3004, 0x2))) == "gy" ? "Gy" : "";
  if (modality == "PT") return textOf(&set, Tag(0x54, 0x1001));
  const std::string type = textOf(&set, Tag(0x28, 0x1054));
  if (!type.empty() && type != "US") return type;
  return modality == "CT" ? "HU" : "";
}

/// Frames that the file places by one position and steps: dose grids and nuclear medicine.
void placeByOffsets(const DataSet &set, DicomFile &out) {
  const DicomFrame &first = out.frames.front();
  if (out.frames.size() < 2 || !first.position || !first.oriented) return;
  for (std::size_t f = 1; f < out.frames.size(); ++f)
    if (out.frames[f].position && norm(*out.frames[f].position - *first.position) > 1e-6) return;  // each has its own
  auto offsets = decimalsOf(&set, Tag(0x3004, 0xc));
  const double step = numberOr(decimalsOf(&set, Tag(0x18, 0x88)), 0.0);
  if (offsets.empty() && step != 0.0)
    for (std::size_t f = 0; f < out.frames.size(); ++f) offsets.push_back(step * static_cast<double>(f));
  if (offsets.size() < out.frames.size()) {
    out.refusal = "its " + std::to_string(out.frames.size()) + " frames have no places of their own (a film, not a volume)";
    return;
  }
  const Vec3 origin = *first.position, normal = cross(first.alongRow, first.alongColumn);
  for (std::size_t f = 0; f < out.frames.size(); ++f) out.frames[f].position = origin + (offsets[f] - offsets[0]) * normal;
}

std::optional<DicomFile> describe(const std::filesystem::path &path, const DataSet &set) {
  DicomFile out;
  out.path = path;
  out.rows = shortOf(set, Tag(0x28, 0x10));
  out.columns = shortOf(set, Tag(0x28, 0x11));
  if (out.rows == 0 || out.columns == 0) return std::nullopt;
  out.series = textOf(&set, Tag(0x20, 0xe));
  out.instance = textOf(&set, Tag(0x8, 0x18));
  out.description = textOf(&set, Tag(0x8, 0x103e));
  out.modality = textOf(&set, Tag(0x8, 0x60));
  out.patientName = textOf(&set, Tag(0x10, 0x10));
  out.bits = static_cast<unsigned>(shortOf(set, Tag(0x28, 0x100)));
  out.isSigned = shortOf(set, Tag(0x28, 0x103)) == 1;
  out.unit = unitOf(set, out.modality);
  for (const Tag &tag : {Tag(0x20, 0x100), Tag(0x18, 0x86), Tag(0x20, 0x12), Tag(0x20, 0x13)}) out.order.push_back(numberOr(decimalsOf(&set, tag), 0.0));
  const std::string colours = textOf(&set, Tag(0x28, 0x4));
  if (shortOf(set, Tag(0x28, 0x2)) > 1 || (!colours.empty() && !colours.starts_with("MONOCHROME")))
    out.refusal = "holds colours (" + colours + "); images of one number per pixel are read";
  else if (out.modality == "SEG")
    out.refusal = "is a DICOM segmentation, which is not read; convert it to NRRD or NIfTI";
  if (colours == "MONOCHROME1") out.notices.push_back("The image is meant to be shown with small values bright (MONOCHROME1).");
  if (set.FindDataElement(Tag(0x28, 0x3000))) out.notices.push_back("The image has a table of values (Modality LUT), which is not applied.");

  const std::string stated = textOf(&set, Tag(0x28, 0x8));
  const double count = stated.empty() ? 1.0 : numberOr(numbersIn(stated), 0.0);
  if (!(count >= 1.0 && count <= 1e5)) {
    out.refusal = "its Number of Frames is '" + stated + "'";
    out.frames.resize(1);
    return out;
  }
  const Item shared = item(&set, Tag(0x5200, 0x9229), 0);
  for (std::size_t f = 0; f < static_cast<std::size_t>(count); ++f) {
    const Item own = item(&set, Tag(0x5200, 0x9230), f);
    out.frames.push_back(readFrame({own.set, shared.set, &set}, set, out.modality, out));
    out.frames.back().time = static_cast<double>(f);
  }
  placeByOffsets(set, out);
  if (out.refusal.empty() && out.frames.size() > 1 && !out.frames.front().position)
    out.refusal = "its " + std::to_string(out.frames.size()) + " frames have no place in the patient (a film, not a volume)";
  std::sort(out.notices.begin(), out.notices.end());
  out.notices.erase(std::unique(out.notices.begin(), out.notices.end()), out.notices.end());
  return out;
}

std::uint32_t littleEndian(const char *bytes) {
  std::uint32_t value = 0;
  for (int b = 3; b >= 0; --b) value = value << 8 | static_cast<unsigned char>(bytes[b]);
  return value;
}

/// GDCM fills missing pixels with zeros; here a file that ends within its pixels is refused.
/// @param from  where the value of the pixel data begins
std::string missingPixels(const DicomFile &file, const gdcm::TransferSyntax &syntax, std::size_t samples, std::uint64_t from) {
  std::error_code code;
  const std::uint64_t length = std::filesystem::file_size(file.path, code);
  if (code || from == 0 || from >= length) return "has no pixels";
  if (syntax == gdcm::TransferSyntax::DeflatedExplicitVRLittleEndian) return {};
  if (!syntax.IsEncapsulated()) {
    const std::uint64_t need = (static_cast<std::uint64_t>(file.rows) * file.columns * samples * file.frames.size() * file.bits + 7) / 8;
    if (length - from >= need) return {};
    return "is truncated: " + std::to_string(length - from) + " of " + std::to_string(need) + " bytes of pixels";
  }
  std::ifstream in(file.path, std::ios::binary);  // compressed: items up to a delimiter
  for (std::uint64_t at = from; at + 8 <= length;) {
    char head[8] = {};
    in.seekg(static_cast<std::streamoff>(at));
    if (!in.read(head, sizeof head)) break;
    const std::uint32_t tag = littleEndian(head);
    if (tag == 0xe0ddfffeu) return {};
    if (tag != 0xe000fffeu) return "has damaged compressed pixels";
    at += 8 + static_cast<std::uint64_t>(littleEndian(head + 4));
  }
  return "is truncated within its compressed pixels";
}

template <class T>
Voxels copyOf(const std::vector<char> &bytes) {
  std::vector<T> all(bytes.size() / sizeof(T));
  std::memcpy(all.data(), bytes.data(), all.size() * sizeof(T));
  return all;
}

Expected<DicomPixels> decode(const std::filesystem::path &path) {
  gdcm::ImageReader reader;
  reader.SetFileName(path.string().c_str());
  if (!reader.Read()) return refuse(path, "its pixels cannot be read: the file is truncated, damaged or of an unknown encoding");
  const gdcm::Image &image = reader.GetImage();
  const gdcm::PixelFormat &format = image.GetPixelFormat();
  DicomPixels out;
  out.columns = image.GetDimension(0);
  out.rows = image.GetDimension(1);
  out.frames = image.GetNumberOfDimensions() > 2 ? image.GetDimension(2) : 1;
  if (format.GetSamplesPerPixel() != 1) return refuse(path, "holds colours; images of one number per pixel are read");
  const std::size_t pixels = out.columns * out.rows * out.frames;
  const std::size_t each = format.GetPixelSize();
  std::vector<char> bytes(image.GetBufferLength());
  if (each == 0 || bytes.size() != pixels * each)
    return refuse(path, "its pixels are truncated or damaged: " + std::to_string(bytes.size()) + " of " + std::to_string(pixels * each) + " bytes");
  if (!image.GetBuffer(bytes.data())) return refuse(path, "its pixels cannot be decoded (" + std::string(image.GetTransferSyntax().GetString()) + "): truncated or damaged");
  switch (format.GetScalarType()) {
    case gdcm::PixelFormat::INT8: out.voxels = copyOf<std::int8_t>(bytes); break;
    case gdcm::PixelFormat::UINT8: out.voxels = copyOf<std::uint8_t>(bytes); break;
    case gdcm::PixelFormat::INT16: out.voxels = copyOf<std::int16_t>(bytes); break;
    case gdcm::PixelFormat::UINT16: out.voxels = copyOf<std::uint16_t>(bytes); break;
    case gdcm::PixelFormat::INT32: out.voxels = copyOf<std::int32_t>(bytes); break;
    case gdcm::PixelFormat::UINT32: out.voxels = copyOf<std::uint32_t>(bytes); break;
    case gdcm::PixelFormat::FLOAT32: out.voxels = copyOf<float>(bytes); break;
    case gdcm::PixelFormat::FLOAT64: out.voxels = copyOf<double>(bytes); break;
    default: return refuse(path, std::string("its pixels are of type ") + format.GetScalarTypeAsString() + ", which is not read; integers of 8, 16 and 32 bits are");
  }
  return out;
}

/// What decoders print goes to the log, where nobody sees it unless he asks for debugging.
class PrintedText {
 public:
  explicit PrintedText(bool prints) {
    if (prints) capture_.emplace();
  }
  ~PrintedText() {
    if (!capture_) return;
    std::istringstream lines(capture_->text());
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("c3de: ")) std::fprintf(stderr, "%s\n", line.c_str());  // another thread's, meanwhile
      else log(LogLevel::debug, "DICOM decoder: " + line);
    }
  }
  PrintedText(const PrintedText &) = delete;
  PrintedText &operator=(const PrintedText &) = delete;

 private:
  std::optional<ErrorStreamCapture> capture_;
};

}  // namespace

bool isDicom(const std::filesystem::path &path) {
  std::ifstream file(path, std::ios::binary);
  char head[132] = {};
  file.read(head, sizeof head);
  return file.gcount() == sizeof head && std::memcmp(head + 128, "DICM", 4) == 0;
}

std::optional<DicomFile> readDicomHeader(const std::filesystem::path &path) {
  quieten();
  try {
    gdcm::Reader reader;
    reader.SetFileName(path.string().c_str());
    const Tag pixels(0x7fe0, 0x10);
    if (!reader.ReadUpToTag(pixels, {pixels})) return std::nullopt;
    const DataSet &set = reader.GetFile().GetDataSet();
    auto out = describe(path, set);
    const gdcm::TransferSyntax &syntax = reader.GetFile().GetHeader().GetDataSetTransferSyntax();
    if (out) out->decoderPrints = syntax.IsEncapsulated();
    if (out && out->refusal.empty())
      out->refusal = missingPixels(*out, syntax, std::max<std::size_t>(1, shortOf(set, Tag(0x28, 0x2))),
                                   reader.GetStreamCurrentPosition());
    return out;
  } catch (...) {  // GDCM throws several unrelated types at damaged files
    return std::nullopt;
  }
}

Expected<DicomPixels> decodeDicom(const std::filesystem::path &path, bool prints) {
  quieten();
  const PrintedText printed(prints);
  try {
    return decode(path);
  } catch (const std::bad_alloc &) {
    return refuse(path, "its pixels need more memory than the machine gives");
  } catch (...) {
    return refuse(path, "its pixels cannot be decoded: the file is damaged");
  }
}

}  // namespace c3de::imaging
