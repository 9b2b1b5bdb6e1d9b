// SPDX-License-Identifier: Apache-2.0
// Converts bytes to pixels. Uncompressed pixels and RLE are decoded here; JPEG, JPEG-LS and JPEG 2000 by GDCM's codecs,
// which receive only the compressed bytes. The only source file that includes GDCM.
#include <gdcmDataElement.h>
#include <gdcmImage.h>
#include <gdcmJPEGLSCodec.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>

#include <algorithm>
#include <bit>
#include <cstdio>
#include <cstring>
#include <new>
#include <optional>
#include <sstream>

#include "c3de/core/log.h"
#include "c3de/core/platform.h"
#include "dicom/dicom_colours.h"
#include "dicom/dicom_files.h"
#include "dicom/dicom_parser.h"
#include "formats/image_header.h"

namespace c3de::imaging {
namespace {

constexpr const char *kRle = "1.2.840.10008.1.2.5";

/// Attributes that describe pixels, PS3.3 C.7.6.3.
struct Layout {
  std::size_t rows = 0, columns = 0, frames = 1;
  unsigned allocated = 0, stored = 0, high = 0;
  std::size_t samples = 1;  ///< values per pixel
  bool isSigned = false, isReal = false;
  std::string colours;  ///< Photometric Interpretation where there are three samples
  [[nodiscard]] std::size_t pixels() const { return rows * columns * frames; }
  [[nodiscard]] std::size_t bytes() const {
    return allocated == 1 ? (pixels() + 7) / 8 : pixels() * samples * (allocated / 8);
  }
};

/// Redirects the output of decoders to the log, where it is visible only at debug level.
class PrintedText {
 public:
  PrintedText() {
    gdcm::Trace::DebugOff();
    gdcm::Trace::WarningOff();
    gdcm::Trace::ErrorOff();
  }
  ~PrintedText() {
    std::istringstream lines(capture_.text());
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("c3de: "))
        std::fprintf(stderr, "%s\n", line.c_str());  // from another thread in the meantime
      else
        log(LogLevel::debug, "DICOM decoder: " + line);
    }
  }
  PrintedText(const PrintedText &) = delete;
  PrintedText &operator=(const PrintedText &) = delete;

 private:
  ErrorStreamCapture capture_;
};

/// Converts bytes in native order to voxels; clears overlay bits, extends signs.
template <class T>
Voxels voxelsOf(const std::vector<char> &bytes, const Layout &layout) {
  std::vector<T> all(bytes.size() / sizeof(T));
  std::memcpy(all.data(), bytes.data(), all.size() * sizeof(T));
  const unsigned bits = 8 * sizeof(T);
  if (layout.stored == 0 || layout.stored >= bits || layout.high + 1 < layout.stored || layout.high >= bits) return all;
  const unsigned left = bits - 1 - layout.high, right = bits - layout.stored;
  using U = std::make_unsigned_t<T>;
  for (T &value : all) value = static_cast<T>(static_cast<T>(static_cast<U>(static_cast<U>(value) << left)) >> right);
  return all;
}

template <class T>
Voxels realsOf(const std::vector<char> &bytes) {
  std::vector<T> all(bytes.size() / sizeof(T));
  std::memcpy(all.data(), bytes.data(), all.size() * sizeof(T));
  return all;
}

/// One byte per bit; the lowest bit of a byte comes first, and frames follow without a gap (PS3.5 8.1.1).
Voxels bitsOf(const std::vector<char> &bytes, const Layout &layout) {
  std::vector<std::uint8_t> all(layout.pixels());
  for (std::size_t p = 0; p < all.size(); ++p) all[p] = static_cast<unsigned char>(bytes[p / 8]) >> (p % 8) & 1u;
  return all;
}

Expected<Voxels> toVoxels(const std::filesystem::path &path, const std::vector<char> &bytes, const Layout &layout) {
  if (layout.isReal) return layout.allocated == 32 ? realsOf<float>(bytes) : realsOf<double>(bytes);
  if (layout.allocated == 1) return bitsOf(bytes, layout);
  if (layout.allocated == 8)
    return layout.isSigned ? voxelsOf<std::int8_t>(bytes, layout) : voxelsOf<std::uint8_t>(bytes, layout);
  if (layout.allocated == 16)
    return layout.isSigned ? voxelsOf<std::int16_t>(bytes, layout) : voxelsOf<std::uint16_t>(bytes, layout);
  if (layout.allocated == 32)
    return layout.isSigned ? voxelsOf<std::int32_t>(bytes, layout) : voxelsOf<std::uint32_t>(bytes, layout);
  return refuse(path, "its pixels have " + std::to_string(layout.allocated) + " bits; 8, 16 and 32 are read");
}

Expected<std::vector<char>> native(const std::filesystem::path &path, DicomContent &content, const Layout &layout) {
  const DicomSet::Element &pixels = *content.pixels();
  const bool isPaired = layout.colours == "YBR_FULL_422";
  std::vector<char> bytes(isPaired ? layout.pixels() * 2 : layout.bytes());
  if (bytes.size() > pixels.length || !content.bytes->read(pixels.at, bytes.data(), bytes.size()))
    return refuse(path, "is truncated within its pixels");
  // Swaps the bytes of words; also of 8-bit values that were written as words.
  const std::size_t word = layout.allocated > 8 ? layout.allocated / 8 : pixels.representation == "OW" ? 2 : 1;
  if (content.syntax.bigEndian == (std::endian::native == std::endian::little))
    for (std::size_t at = 0; at + word <= bytes.size(); at += word)
      std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                   bytes.begin() + static_cast<std::ptrdiff_t>(at + word));
  if (isPaired) return unpaired(bytes);
  if (layout.samples == 3 && content.set.number(0x00280006) == 1)
    return interleaved(bytes, layout.rows * layout.columns, layout.allocated / 8);
  return bytes;
}

/// PS3.5 annex G: a PackBits segment for each byte of a pixel, the most significant byte of each value first.
/// @param each  bytes of a pixel; @param bytes  of one of its values
bool unpackRle(const std::vector<char> &packed, char *to, std::size_t pixels, std::size_t each, std::size_t bytes) {
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t b = 4; b-- > 0;) value = value << 8 | static_cast<unsigned char>(packed[at + b]);
    return static_cast<std::size_t>(value);
  };
  if (packed.size() < 64 || number(0) != each) return false;
  for (std::size_t segment = 0; segment < each; ++segment) {
    std::size_t at = number(4 + 4 * segment), done = 0;
    const std::size_t end = segment + 1 < each ? std::min(number(8 + 4 * segment), packed.size()) : packed.size();
    const std::size_t sample = segment / bytes * bytes, place = segment % bytes;
    char *next = to + sample + (std::endian::native == std::endian::little ? bytes - 1 - place : place);
    while (done < pixels && at < end) {
      const int count = static_cast<signed char>(packed[at++]);
      if (count == -128) continue;
      const std::size_t run = static_cast<std::size_t>(count < 0 ? 1 - count : 1 + count);
      if (run > pixels - done || at + (count < 0 ? 1 : run) > end) return false;
      for (std::size_t r = 0; r < run; ++r) next[each * (done + r)] = packed[count < 0 ? at : at + r];
      at += count < 0 ? 1 : run;
      done += run;
    }
    if (done < pixels) return false;
  }
  return true;
}

Expected<std::vector<char>> rle(const std::filesystem::path &path, const std::vector<std::vector<char>> &pieces,
                                const Layout &layout) {
  std::vector<char> bytes(layout.bytes());
  if (pieces.size() != layout.frames)
    return refuse(
        path, "has " + std::to_string(pieces.size()) + " packed frames instead of " + std::to_string(layout.frames));
  const std::size_t pixels = layout.rows * layout.columns, each = layout.samples * (layout.allocated / 8);
  for (std::size_t f = 0; f < pieces.size(); ++f)
    if (!unpackRle(pieces[f], bytes.data() + f * pixels * each, pixels, each, layout.allocated / 8))
      return refuse(path, "its packed pixels (RLE) are damaged");
  return bytes;
}

struct StatedSize {
  std::size_t columns = 0, rows = 0, components = 0;
};

std::size_t bigEndianAt(const std::vector<char> &bytes, std::size_t at, std::size_t count) {
  std::size_t value = 0;
  for (std::size_t b = 0; b < count; ++b) value = value << 8 | static_cast<unsigned char>(bytes[at + b]);
  return value;
}

/// The size stated in a JPEG 2000 stream: the marker SIZ (T.800 A.5.1).
std::optional<StatedSize> sizeInJpeg2000(const std::vector<char> &s) {
  std::size_t at = 0;  // the stream may be in a file format with some boxes before it
  while (at + 46 < s.size() && at < 4096 && bigEndianAt(s, at, 4) != 0xff4fff51u) ++at;
  if (at + 46 >= s.size() || bigEndianAt(s, at, 4) != 0xff4fff51u) return std::nullopt;
  // Xsiz Ysiz XOsiz YOsiz XTsiz YTsiz XTOsiz YTOsiz
  const auto field = [&](std::size_t n) { return bigEndianAt(s, at + 8 + 4 * n, 4); };
  const StatedSize size{field(0) - field(2), field(1) - field(3), bigEndianAt(s, at + 40, 2)};
  if (field(4) == 0 || field(5) == 0) return std::nullopt;
  const double tiles = (static_cast<double>(field(0)) / static_cast<double>(field(4)) + 1.0) *
                       (static_cast<double>(field(1)) / static_cast<double>(field(5)) + 1.0);
  return tiles < 10000.0 ? std::optional(size) : std::nullopt;  // each tile needs kilobytes
}

/// The size stated in the start of frame of a JPEG or JPEG-LS stream (T.81 B.2.2). None where its segments do not
/// follow each other without a gap up to the scan: GDCM terminates the program where libjpeg only warns of a header.
std::optional<StatedSize> sizeInJpeg(const std::vector<char> &s) {
  if (s.size() < 4 || bigEndianAt(s, 0, 2) != 0xffd8u) return std::nullopt;
  std::optional<StatedSize> size;
  for (std::size_t at = 2; at + 10 <= s.size();) {
    const std::size_t marker = bigEndianAt(s, at, 2);
    if (marker == 0xffff) {  // fill byte
      ++at;
      continue;
    }
    if (marker == 0xffda) return size;
    const std::size_t length = bigEndianAt(s, at + 2, 2);
    if (marker < 0xffc0 || (marker >= 0xffd0 && marker <= 0xffd9) || length < 2) return std::nullopt;
    const bool frame =
        (marker <= 0xffcf && marker != 0xffc4 && marker != 0xffc8 && marker != 0xffcc) || marker == 0xfff7;
    if (frame) {
      const std::size_t bits = bigEndianAt(s, at + 4, 1);
      if (bits < 2 || bits > 16) return std::nullopt;  // GDCM has no codec for it, but calls one
      size = StatedSize{bigEndianAt(s, at + 7, 2), bigEndianAt(s, at + 5, 2), bigEndianAt(s, at + 9, 1)};
    }
    const bool isJfif = marker == 0xffe0 && length >= 16 && bigEndianAt(s, at + 4, 4) == 0x4a464946u;
    if (isJfif && s[at + 9] != 1) return std::nullopt;  // versions that libjpeg warns about
    at += 2 + length;
  }
  return std::nullopt;
}

/// A damaged stream may state any size, and its decoder would allocate memory for it.
bool isOfSize(const std::vector<std::vector<char>> &pieces, const std::string &syntax, const Layout &layout) {
  const bool waves = syntax.starts_with("1.2.840.10008.1.2.4.9");
  return std::all_of(pieces.begin(), pieces.end(), [&](const std::vector<char> &piece) {
    const auto size = waves ? sizeInJpeg2000(piece) : sizeInJpeg(piece);
    return size && size->columns == layout.columns && size->rows == layout.rows && size->components == layout.samples;
  });
}

/// GDCM's JPEG-LS codec through its interface for image regions: the other interface leaks, or terminates the program,
/// on damaged streams.
class JpegLs : public gdcm::JPEGLSCodec {
 public:
  bool decode(const std::vector<char> &frame, const Layout &layout, char *to) {
    const unsigned size[2] = {static_cast<unsigned>(layout.columns), static_cast<unsigned>(layout.rows)};
    SetNumberOfDimensions(2);
    SetDimensions(size);
    SetPixelFormat(formatOf(layout));
    std::string items("\xfe\xff\x00\xe0\0\0\0\0\xfe\xff\x00\xe0", 12);  // an empty offset table, then the frame
    for (unsigned b = 0; b < 4; ++b) items += static_cast<char>(frame.size() >> 8 * b & 255);
    items.append(frame.begin(), frame.end());
    items.append("\xfe\xff\xdd\xe0\0\0\0\0", 8);
    std::istringstream stream(items);
    return DecodeExtent(to, 0, size[0] - 1, 0, size[1] - 1, 0, 0, stream);
  }
  [[nodiscard]] static gdcm::PixelFormat formatOf(const Layout &layout) {
    return gdcm::PixelFormat(static_cast<std::uint16_t>(layout.samples), static_cast<std::uint16_t>(layout.allocated),
                             static_cast<std::uint16_t>(layout.stored), static_cast<std::uint16_t>(layout.high),
                             static_cast<std::uint16_t>(layout.isSigned ? 1 : 0));
  }
};

/// GDCM returns the components of JPEG as stored in the stream, but converts those of JPEG 2000 to red, green and blue.
gdcm::PhotometricInterpretation::PIType photometricOf(const Layout &layout) {
  if (layout.samples == 1) return gdcm::PhotometricInterpretation::MONOCHROME2;
  if (layout.colours == "YBR_RCT") return gdcm::PhotometricInterpretation::YBR_RCT;
  if (layout.colours == "YBR_ICT") return gdcm::PhotometricInterpretation::YBR_ICT;
  return layout.colours == "RGB" ? gdcm::PhotometricInterpretation::RGB : gdcm::PhotometricInterpretation::YBR_FULL;
}

/// One frame of JPEG or JPEG 2000.
bool decodeFrame(const std::vector<char> &frame, gdcm::TransferSyntax::TSType type, const Layout &layout, char *to) {
  gdcm::SmartPointer<gdcm::SequenceOfFragments> fragments = new gdcm::SequenceOfFragments;
  gdcm::Fragment fragment;
  fragment.SetByteValue(frame.data(), static_cast<std::uint32_t>(frame.size()));
  fragments->AddFragment(fragment);
  gdcm::DataElement pixels(gdcm::Tag(0x7fe0, 0x10));
  pixels.SetVR(gdcm::VR::OB);
  pixels.SetValue(*fragments);  // this makes its length undefined
  gdcm::Image image;
  image.SetNumberOfDimensions(2);
  image.SetDimension(0, static_cast<unsigned>(layout.columns));
  image.SetDimension(1, static_cast<unsigned>(layout.rows));
  image.SetPixelFormat(JpegLs::formatOf(layout));
  image.SetPhotometricInterpretation(photometricOf(layout));
  image.SetPlanarConfiguration(0);
  image.SetTransferSyntax(type);
  image.SetDataElement(pixels);
  const std::size_t bytes = layout.rows * layout.columns * layout.samples * (layout.allocated / 8);
  if (image.GetBufferLength() != bytes) return false;
  std::vector<char> buffer(bytes);  // GDCM sometimes changes the bit depth, and with it the buffer size
  if (!image.GetBuffer(buffer.data()) || image.GetBufferLength() != bytes ||
      image.GetPixelFormat().GetPixelSize() * 8 != layout.allocated * layout.samples)
    return false;
  if (layout.samples == 3 && image.GetPlanarConfiguration() == 1)
    buffer = interleaved(buffer, layout.rows * layout.columns, layout.allocated / 8);
  std::copy(buffer.begin(), buffer.end(), to);
  return true;
}

Expected<std::vector<char>> byCodec(const std::filesystem::path &path, std::vector<std::vector<char>> pieces,
                                    const std::string &syntax, const Layout &layout) {
  const gdcm::TransferSyntax::TSType type = gdcm::TransferSyntax::GetTSType(syntax.c_str());
  if (type == gdcm::TransferSyntax::TS_END) return refuse(path, "its encoding " + syntax + " is not read");
  if (layout.samples == 1 && !layout.colours.empty() &&
      (syntax == "1.2.840.10008.1.2.4.50" || syntax == "1.2.840.10008.1.2.4.51"))
    return refuse(path, "its palette colours are compressed by lossy JPEG, which alters palette indices");
  if (layout.frames == 1)  // one frame may be split into fragments
    for (; pieces.size() > 1; pieces.erase(pieces.begin() + 1))
      pieces[0].insert(pieces[0].end(), pieces[1].begin(), pieces[1].end());
  if (pieces.size() != layout.frames)
    return refuse(path, "has " + std::to_string(pieces.size()) + " compressed pieces for " +
                            std::to_string(layout.frames) + " frames");
  if (!isOfSize(pieces, syntax, layout))
    return refuse(path, "its compressed pixels are damaged or not of the stated size");
  const PrintedText printed;
  std::vector<char> bytes(layout.bytes());
  const std::size_t each = bytes.size() / layout.frames;
  const bool isJpegLs =
      type == gdcm::TransferSyntax::JPEGLSLossless || type == gdcm::TransferSyntax::JPEGLSNearLossless;
  if (isJpegLs && layout.samples > 1)
    return refuse(path, "its colours are packed as JPEG-LS, which is read for grey images only");
  for (std::size_t f = 0; f < layout.frames; ++f) {
    char *to = bytes.data() + f * each;
    if (!(isJpegLs ? JpegLs().decode(pieces[f], layout, to) : decodeFrame(pieces[f], type, layout, to)))
      return refuse(path,
                    "its compressed pixels (" + std::string(gdcm::TransferSyntax(type).GetString()) + ") are damaged");
  }
  return bytes;
}

Expected<Layout> layoutOf(const std::filesystem::path &path, const DicomSet &set) {
  Layout layout;
  layout.rows = set.number(0x00280010);
  layout.columns = set.number(0x00280011);
  const auto frames = set.decimals(0x00280008);
  if (!frames.empty() && frames[0] >= 1.0 && frames[0] < 1e6) layout.frames = static_cast<std::size_t>(frames[0]);
  layout.isReal = !set.has(kPixelData);
  layout.allocated = layout.isReal ? (set.has(kFloatPixels) ? 32 : 64) : static_cast<unsigned>(set.number(0x00280100));
  if (layout.isReal) return layout;
  layout.stored = static_cast<unsigned>(set.number(0x00280101));
  layout.high = static_cast<unsigned>(set.number(0x00280102));
  layout.isSigned = set.number(0x00280103) == 1;
  const std::string colours = set.text(0x00280004);
  const bool isSegmentation = set.has(0x00620002);
  if (!isSegmentation && (set.number(0x00280002) > 1 || (!colours.empty() && !colours.starts_with("MONOCHROME")))) {
    if (const std::string refusal = refusalOfColours(set); !refusal.empty()) return refuse(path, refusal);
    layout.colours = colours;
    layout.samples = std::max<std::size_t>(1, set.number(0x00280002));
  }
  if (layout.allocated == 1 && isSegmentation) return layout;
  if (layout.allocated != 8 && layout.allocated != 16 && layout.allocated != 32)
    return refuse(path, "its pixels have " + std::to_string(layout.allocated) + " bits; 8, 16 and 32 are read");
  if (layout.stored > layout.allocated || layout.stored == 0 || layout.high >= layout.allocated ||
      layout.high + 1 < layout.stored)
    return refuse(path, "its pixels have " + std::to_string(layout.stored) + " bits, the highest the " +
                            std::to_string(layout.high) + "th, in " + std::to_string(layout.allocated));
  return layout;
}

Expected<DicomPixels> decode(const std::filesystem::path &path) {
  auto content = parseDicom(path);
  if (!content || !content->pixels()) return refuse(path, "has no pixels");
  const DicomSet &set = content->set;
  const auto layout = layoutOf(path, set);
  if (!layout) return tl::unexpected(layout.error());

  Expected<std::vector<char>> bytes;
  if (!content->isCompressed()) {
    bytes = native(path, *content, *layout);
  } else {
    const auto fragments = fragmentsOf(*content);
    if (!fragments || fragments->size() < 2) return refuse(path, "is truncated within its compressed pixels");
    std::vector<std::vector<char>> pieces;
    for (std::size_t f = 1; f < fragments->size(); ++f) {  // the first is the offset table
      pieces.emplace_back(static_cast<std::size_t>((*fragments)[f].length));
      if (!content->bytes->read((*fragments)[f].at, pieces.back().data(), pieces.back().size()))
        return refuse(path, "cannot be read");
    }
    if (layout->allocated == 1)
      return refuse(path, "its bits are compressed (" + content->transferSyntax + "), which is not read");
    bytes = content->transferSyntax == kRle ? rle(path, pieces, *layout)
                                            : byCodec(path, pieces, content->transferSyntax, *layout);
  }
  if (!bytes) return tl::unexpected(bytes.error());
  DicomPixels out{layout->rows, layout->columns, layout->frames, {}, {}};
  if (layout->samples == 3) {
    const bool isDifference = layout->colours == "YBR_FULL" || layout->colours == "YBR_FULL_422";
    out.colours = coloursOf({std::move(*bytes), layout->allocated, layout->stored, isDifference});
  } else {
    auto voxels = toVoxels(path, *bytes, *layout);
    if (!voxels) return tl::unexpected(voxels.error());
    out.voxels = std::move(*voxels);
    if (!layout->colours.empty()) out.colours = paletteColours(set, out.voxels);
    if (out.colours.empty() && !layout->colours.empty())
      return refuse(path, "the tables of its palette are damaged or missing");
  }
  if (!out.colours.empty()) out.voxels = lumaOf(out.colours);
  return out;
}

}  // namespace

Expected<DicomPixels> decodeDicom(const std::filesystem::path &path) {
  try {
    return decode(path);
  } catch (const std::bad_alloc &) {
    return refuse(path, "its pixels need more memory than the machine gives");
  } catch (...) {  // GDCM throws several unrelated types on damaged pixels
    return refuse(path, "its pixels cannot be decoded: they are damaged");
  }
}

}  // namespace c3de::imaging
