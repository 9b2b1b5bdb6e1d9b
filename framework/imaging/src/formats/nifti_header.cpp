// SPDX-License-Identifier: Apache-2.0
// NIfTI-1.1 and NIfTI-2 (nifti.nimh.nih.gov): header of 348 or 540 bytes, world is RAS.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "c3de/core/text.h"
#include "formats/byte_stream.h"
#include "formats/image_header.h"

namespace c3de::imaging {
namespace {

/// Reads numbers of either byte order at offsets of the header.
class Fields {
 public:
  Fields(std::vector<unsigned char> bytes, bool swapped) : bytes_(std::move(bytes)), swapped_(swapped) {}
  template <class T>
  [[nodiscard]] double at(std::size_t offset) const {
    std::array<unsigned char, sizeof(T)> raw;
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(offset), sizeof(T), raw.begin());
    if (swapped_) std::reverse(raw.begin(), raw.end());
    return static_cast<double>(std::bit_cast<T>(raw));
  }

 private:
  std::vector<unsigned char> bytes_;
  bool swapped_;
};

/// The fields of both versions that are used here.
struct Nifti {
  bool second = false, swapped = false, pair = false;
  std::array<double, 8> dim{}, pixdim{};
  int type = 0, qform = 0, sform = 0, units = 0;
  double offset = 0.0, slope = 0.0, intercept = 0.0;
  std::array<double, 6> quaternion{};  // b, c, d, x, y, z
  std::array<double, 12> rows{};
};

Expected<Nifti> parse(const std::filesystem::path &path) {
  auto bytes = firstBytes(path, 540);
  if (!bytes) return tl::unexpected(bytes.error());
  if (bytes->size() < 348)
    return refuse(path, "too short for a NIfTI header: " + std::to_string(bytes->size()) + " of 348 bytes");
  const Fields plain(*bytes, std::endian::native == std::endian::big);
  const Fields turned(*bytes, std::endian::native != std::endian::big);
  const double length = plain.at<std::int32_t>(0), turnedLength = turned.at<std::int32_t>(0);
  Nifti n;
  n.swapped = turnedLength == 348 || turnedLength == 540;
  const double known = n.swapped ? turnedLength : length;
  if (known != 348 && known != 540)
    return refuse(path, "no NIfTI header: it begins with " + formatNumber(length) + ", not with 348 or 540");
  n.second = known == 540;
  if (n.second && bytes->size() < 540)
    return refuse(path, "too short for a NIfTI-2 header: " + std::to_string(bytes->size()) + " of 540 bytes");
  const char *magic = reinterpret_cast<const char *>(bytes->data()) + (n.second ? 4 : 344);
  const char version = n.second ? '2' : '1';
  if (magic[0] != 'n' || (magic[1] != '+' && magic[1] != 'i') || magic[2] != version)
    return refuse(path, "the header is not signed as NIfTI (an Analyze file has no orientation and is not read)");
  n.pair = magic[1] == 'i';
  const Fields &f = n.swapped ? turned : plain;
  for (std::size_t i = 0; i < 8; ++i) {
    n.dim[i] = n.second ? f.at<std::int64_t>(16 + 8 * i) : f.at<std::int16_t>(40 + 2 * i);
    n.pixdim[i] = n.second ? f.at<double>(104 + 8 * i) : f.at<float>(76 + 4 * i);
  }
  n.type = static_cast<int>(n.second ? f.at<std::int16_t>(12) : f.at<std::int16_t>(70));
  n.offset = n.second ? f.at<std::int64_t>(168) : f.at<float>(108);
  n.slope = n.second ? f.at<double>(176) : f.at<float>(112);
  n.intercept = n.second ? f.at<double>(184) : f.at<float>(116);
  n.units = n.second ? static_cast<int>(f.at<std::int32_t>(500)) : static_cast<int>((*bytes)[123]);
  n.qform = static_cast<int>(n.second ? f.at<std::int32_t>(344) : f.at<std::int16_t>(252));
  n.sform = static_cast<int>(n.second ? f.at<std::int32_t>(348) : f.at<std::int16_t>(254));
  for (std::size_t i = 0; i < 6; ++i) n.quaternion[i] = n.second ? f.at<double>(352 + 8 * i) : f.at<float>(256 + 4 * i);
  for (std::size_t i = 0; i < 12; ++i) n.rows[i] = n.second ? f.at<double>(400 + 8 * i) : f.at<float>(280 + 4 * i);
  return n;
}

Expected<Scalar> scalarOf(const std::filesystem::path &path, int type) {
  switch (type) {
    case 2: return Scalar::u8;
    case 4: return Scalar::i16;
    case 8: return Scalar::i32;
    case 16: return Scalar::f32;
    case 64: return Scalar::f64;
    case 256: return Scalar::i8;
    case 512: return Scalar::u16;
    case 768: return Scalar::u32;
    case 1024: return Scalar::i64;
    case 1280: return Scalar::u64;
    case 32:
    case 1792:
    case 2048: return refuse(path, "holds complex numbers; images of one number per voxel and colours are read");
    case 128:
    case 2304: return Scalar::u8;  // RGB24, RGBA32
    default:
      return refuse(path, "its datatype " + std::to_string(type) +
                              " is not read; integers of 8 to 64 bits and floating point of 32 and 64 bits are");
  }
}

using Columns = std::array<Vec3, 4>;  // i, j, k, origin

Columns fromSform(const Nifti &n) {
  Columns c{};
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 4; ++column) c[column][row] = n.rows[4 * row + column];
  return c;
}

Columns fromQform(const Nifti &n, const Vec3 &spacing) {
  double b = n.quaternion[0], c = n.quaternion[1], d = n.quaternion[2];
  double a = 1.0 - (b * b + c * c + d * d);
  if (a < 1e-7) {  // a half turn, as in the reference implementation
    const double length = std::sqrt(b * b + c * c + d * d);
    b /= length, c /= length, d /= length;
    a = 0.0;
  } else {
    a = std::sqrt(a);
  }
  const double turn = n.pixdim[0] < 0.0 ? -1.0 : 1.0;
  return {spacing[0] * Vec3{a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)},
          spacing[1] * Vec3{2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b)},
          turn * spacing[2] * Vec3{2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - c * c - b * b},
          Vec3{n.quaternion[3], n.quaternion[4], n.quaternion[5]}};
}

bool spans(const Columns &c) {
  for (const Vec3 &v : c)
    for (const double x : v)
      if (!std::isfinite(x)) return false;
  const double lengths = norm(c[0]) * norm(c[1]) * norm(c[2]);
  return lengths > 0.0 && std::abs(dot(c[0], cross(c[1], c[2]))) > 1e-6 * lengths;
}

/// Whether the voxel size is typical of scanners, from micro-CT to overviews. Files without a unit are in mm by
/// convention, and only sizes outside this range contradict it.
bool isUsualInMillimetres(const Columns &c) {
  constexpr double kShortest = 0.02, kLongest = 20.0;  // mm
  return std::all_of(c.begin(), c.begin() + 3, [](const Vec3 &axis) {
    const double length = norm(axis);
    return length >= kShortest && length <= kLongest;
  });
}

/// sform if its code is positive, else qform, else the spacing alone.
Columns place(const Nifti &n, ImageHeader &header) {
  Vec3 spacing{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double given = std::abs(n.pixdim[a + 1]);
    spacing[a] = std::isfinite(given) && given > 0.0 ? given : 1.0;
    if (spacing[a] != given && header.geometry.size[a] > 1)
      header.notices.push_back("The header gives no spacing along axis " + std::to_string(a + 1) + ": 1 is taken.");
  }
  const Columns sform = fromSform(n), qform = fromQform(n, spacing);
  if (n.sform > 0 && spans(sform)) {
    if (n.qform > 0 && spans(qform)) {
      double most = 0.0;
      for (unsigned corner = 0; corner < 8; ++corner) {
        Vec3 difference = sform[3] - qform[3];
        for (std::size_t a = 0; a < 3; ++a)
          if ((corner >> a & 1u) != 0)
            difference = difference + static_cast<double>(header.geometry.size[a] - 1) * (sform[a] - qform[a]);
        most = std::max(most, norm(difference));
      }
      if (most > 1.0)
        header.notices.push_back("The two placements of the header (sform, qform) differ by up to " +
                                 formatNumber(std::round(most)) + " mm: sform is taken.");
    }
    return sform;
  }
  if (n.sform > 0) header.notices.push_back("The sform of the header spans no volume and is ignored.");
  if (n.qform > 0 && spans(qform)) return qform;
  header.notices.push_back(
      "The header does not state the orientation of the image in the patient: the index axes are assumed to be right, "
      "anterior and superior; left and right may be exchanged.");
  return {Vec3{spacing[0], 0, 0}, Vec3{0, spacing[1], 0}, Vec3{0, 0, spacing[2]}, Vec3{}};
}

/// name.hdr and name.img of a pair; either may be compressed.
std::filesystem::path partner(const std::filesystem::path &path, const char *kind) {
  std::filesystem::path stem = path;
  if (lowerCase(stem.extension().string()) == ".gz") stem.replace_extension();
  stem.replace_extension(kind);
  std::error_code code;
  if (std::filesystem::exists(stem, code)) return stem;
  std::filesystem::path zipped = stem;
  zipped += ".gz";
  return std::filesystem::exists(zipped, code) ? zipped : stem;
}

constexpr double kLongestExtensions = 1 << 20;

/// The label table between header and voxels, if any. Damaged extensions are ignored.
std::string labelXmlOf(const std::filesystem::path &path, const Nifti &n) {
  const std::size_t header = n.second ? 540 : 348;
  if (n.pair || n.offset > kLongestExtensions || n.offset < static_cast<double>(header) + 12.0) return {};
  const auto end = static_cast<std::size_t>(n.offset);
  auto bytes = firstBytes(path, end);
  if (!bytes || bytes->size() < end || (*bytes)[header] == 0) return {};
  const std::string text(bytes->begin(), bytes->end());
  const Fields fields(std::move(*bytes), n.swapped != (std::endian::native == std::endian::big));
  for (std::size_t at = header + 4; at + 8 <= end;) {
    const double size = fields.at<std::int32_t>(at);
    if (!(size >= 8.0 && size <= static_cast<double>(end - at))) return {};
    const auto whole = static_cast<std::size_t>(size);
    // Its code is 30 from Connectome Workbench, 0 (unknown) from TotalSegmentator.
    if (std::string xml = text.substr(at + 8, whole - 8); xml.find("<LabelTable") != std::string::npos) return xml;
    at += whole;
  }
  return {};
}

}  // namespace

Expected<ImageHeader> readNiftiHeader(const std::filesystem::path &path) {
  const std::string extension = imageExtension(path);
  const bool image = extension == ".img" || extension == ".img.gz";
  const auto parsed = parse(image ? partner(path, ".hdr") : path);
  if (!parsed) return tl::unexpected(parsed.error());
  const Nifti &n = *parsed;
  ImageHeader header;
  header.path = path;
  const int dimensions = static_cast<int>(n.dim[0]);
  if (dimensions < 1 || dimensions > 7)
    return refuse(path, "the header says " + formatNumber(n.dim[0]) + " dimensions; accepted is 1 to 7");
  std::vector<double> sizes(n.dim.begin() + 1, n.dim.begin() + 1 + dimensions);
  if (const auto set = setSize(header, sizes); !set) return tl::unexpected(set.error());
  for (std::size_t a = 3; a < sizes.size(); ++a)
    if (!(sizes[a] >= 1.0 && sizes[a] < 1e6))
      return refuse(path, "the header says " + formatNumber(sizes[a]) + " along axis " + std::to_string(a + 1));
  for (std::size_t a = 4; a < sizes.size(); ++a)
    if (sizes[a] > 1.0)
      return refuse(path, "holds " + formatNumber(sizes[a]) +
                              " numbers per voxel (a vector image); images of one number per voxel and colours (RGB24, "
                              "RGBA32) are read");
  header.volumes = sizes.size() > 3 ? static_cast<std::size_t>(sizes[3]) : 1;
  const auto scalar = scalarOf(path, n.type);
  if (!scalar) return tl::unexpected(scalar.error());
  header.scalar = *scalar;
  header.channels = n.type == 128 ? 3 : n.type == 2304 ? 4 : 1;
  header.bigEndian = n.swapped != (std::endian::native == std::endian::big);
  if (std::isfinite(n.slope) && std::isfinite(n.intercept)) {
    if (n.slope != 0.0 && header.channels == 1) header.slope = n.slope, header.intercept = n.intercept;
  } else {
    header.notices.push_back("The scaling of the header is not a number: values are taken as stored.");
  }

  Columns c = place(n, header);
  const int space = n.units & 7;
  const double mm = space == 1 ? 1000.0 : space == 3 ? 1e-3 : 1.0;
  if (space > 3)
    header.notices.push_back("The header's unit of length, number " + std::to_string(space) +
                             ", is not known (1 m, 2 mm, 3 micrometres): mm is taken.");
  else if (space == 0 && !isUsualInMillimetres(c))
    header.notices.push_back(
        "The header does not name its unit of length, and its voxels are unusual in mm: mm is taken.");
  for (Vec3 &v : c) v = mm * Vec3{-v[0], -v[1], v[2]};  // RAS to LPS
  if (const auto set = setAffine(header, c[0], c[1], c[2], c[3]); !set) return tl::unexpected(set.error());

  const std::filesystem::path data = n.pair ? (image ? path : partner(path, ".img")) : path;
  const double least = n.pair ? 0.0 : n.second ? 540.0 : 348.0;
  double offset = n.offset;
  if (!n.pair && offset == 0.0) offset = n.second ? 544.0 : 352.0;
  if (!(offset >= least && offset < 1e9))
    return refuse(path, "the header says that voxels begin at byte " + formatNumber(n.offset));
  const bool zipped = isGzip(data);
  header.encoding = zipped ? ImageHeader::Encoding::deflated : ImageHeader::Encoding::raw;
  header.parts = {{data, zipped ? 0 : static_cast<std::uint64_t>(offset)}};
  header.skip = zipped ? static_cast<std::uint64_t>(offset) : 0;
  header.labelXml = labelXmlOf(path, n);
  header.segmented = !header.labelXml.empty();
  return header;
}

}  // namespace c3de::imaging
