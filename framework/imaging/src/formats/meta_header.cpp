// SPDX-License-Identifier: Apache-2.0
// MetaImage (itk.org/Wiki/MetaIO): lines `Key = Value`, the last of which states where the voxels are; world is LPS.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>

#include "c3de/core/input_file.h"
#include "c3de/core/text.h"
#include "formats/image_header.h"

namespace c3de::imaging {
namespace {

using Keys = std::map<std::string, std::string>;

std::string valueOf(const Keys &keys, std::initializer_list<const char *> names) {
  for (const char *name : names)
    if (const auto found = keys.find(name); found != keys.end()) return found->second;
  return {};
}
bool isTrue(const std::string &text) { return lowerCase(text).starts_with("t") || text == "1"; }

Expected<Scalar> scalarOf(const std::filesystem::path &path, const std::string &type) {
  static const std::map<std::string, Scalar> kTypes{
      {"MET_CHAR", Scalar::i8},       {"MET_UCHAR", Scalar::u8},       {"MET_SHORT", Scalar::i16},
      {"MET_USHORT", Scalar::u16},    {"MET_INT", Scalar::i32},        {"MET_UINT", Scalar::u32},
      {"MET_LONG", Scalar::i32},      {"MET_ULONG", Scalar::u32},      {"MET_FLOAT", Scalar::f32},
      {"MET_LONG_LONG", Scalar::i64}, {"MET_ULONG_LONG", Scalar::u64}, {"MET_DOUBLE", Scalar::f64}};
  if (const auto found = kTypes.find(type); found != kTypes.end()) return found->second;
  return refuse(path,
                "its ElementType '" + type + "' is not read; MET_CHAR … MET_ULONG_LONG, MET_FLOAT and MET_DOUBLE are");
}

struct Parsed {
  Keys keys;
  std::vector<std::string> list;  ///< file names after ElementDataFile = LIST
  std::uint64_t dataOffset = 0;   ///< after the last line of the header
};

Expected<Parsed> parse(const std::filesystem::path &path) {
  auto opened = openInputFile(path);
  if (!opened) return tl::unexpected(opened.error());
  std::ifstream &file = *opened;
  Parsed out;
  std::string line;
  for (int lines = 0; lines < 4096; ++lines) {
    line.clear();
    for (int c; line.size() < 65536 && (c = file.get()) != EOF && c != '\n';) line += static_cast<char>(c);
    if (line.size() >= 65536) break;
    const std::size_t equals = line.find('=');
    if (equals != std::string::npos) {
      const std::string key = trimmed(line.substr(0, equals)), value = trimmed(line.substr(equals + 1));
      out.keys[key] = value;
      if (key == "ElementDataFile") {
        if (file.eof() && value == "LOCAL") return refuse(path, "ends with its header: there are no voxels");
        out.dataOffset = file.eof() ? 0 : static_cast<std::uint64_t>(file.tellg());
        if (value.starts_with("LIST"))
          while (std::getline(file, line) && out.list.size() < 100000)
            if (const std::string name = trimmed(line); !name.empty()) out.list.push_back(name);
        return out;
      }
    } else if (!trimmed(line).empty()) {
      break;
    }
    if (!file) break;
  }
  return refuse(path, "no MetaImage header: there is no line ElementDataFile = …");
}

/// Keys that MetaIO writes into images. Programs may add their own.
// clang-format off
const std::vector<std::string> kKeys{
    "ObjectType", "ObjectSubType", "TransformType", "NDims", "Name", "ID", "ParentID", "Comment", "AcquisitionDate",
    "CompressedData", "CompressedDataSize", "CompressionLevel", "BinaryData",
    "BinaryDataByteOrderMSB", "ElementByteOrderMSB",
    "Color", "Position", "Origin", "Offset", "TransformMatrix", "Rotation", "Orientation", "CenterOfRotation",
    "AnatomicalOrientation", "DistanceUnits", "ElementSpacing", "DimSize", "HeaderSize", "HeaderSizePerSlice", "Modality",
    "ImagePosition", "SequenceID", "ElementMin", "ElementMax", "ElementNumberOfChannels", "ElementSize", "ElementType",
    "ElementNBits", "ElementToIntensityFunctionSlope", "ElementToIntensityFunctionOffset", "ElementDataFile"};
// clang-format on

/// The format requires readers to ignore unknown keys; a key that looks like a typing error gets a notice.
std::string unknownKeys(const Keys &keys) {
  std::string slips, others;
  for (const auto &[key, value] : keys) {
    if (std::find(kKeys.begin(), kKeys.end(), key) != kKeys.end()) continue;
    const std::string nearest = nearestName(key, kKeys);
    if (!nearest.empty())
      slips += (slips.empty() ? "" : ", ") + ("'" + key.substr(0, 40) + "' (did you mean '" + nearest + "'?)");
    else if (others.size() < 200)
      others += (others.empty() ? "" : ", ") + key.substr(0, 40);
  }
  if (slips.empty() && others.empty()) return {};
  return "The header has keys unknown in MetaImage, which are ignored: " + slips +
         (slips.empty() || others.empty() ? "" : ", ") + others + ".";
}

/// The files that ElementDataFile names: one, a list, or a numbered pattern `name%03d.raw first last step`.
Expected<std::vector<std::string>> dataFiles(const std::filesystem::path &path, const Parsed &parsed) {
  const std::string named = parsed.keys.at("ElementDataFile");
  if (named.starts_with("LIST")) return parsed.list;
  const std::size_t percent = named.find('%');
  if (percent == std::string::npos) return std::vector<std::string>{named};
  const std::size_t blank = named.find(' ', percent);
  const auto range = blank == std::string::npos ? std::vector<double>{} : numbersIn(named.substr(blank));
  auto names = numberedNames(named.substr(0, blank), range);
  if (names.empty()) return refuse(path, "ElementDataFile = " + named + " is no pattern with first, last and step");
  return names;
}

/// The first number of a key; none if the key is missing.
std::optional<double> numberOf(const Keys &keys, const char *name) {
  const auto all = numbersIn(valueOf(keys, {name}));
  return all.empty() ? std::nullopt : std::optional(all.front());
}

/// Returns the number of dimensions, of which the fourth is time.
Expected<std::size_t> readSize(ImageHeader &header, const Keys &keys) {
  const auto sizes = numbersIn(valueOf(keys, {"DimSize"}));
  const double stated =
      keys.contains("NDims") ? numbersIn(keys.at("NDims") + " 0").front() : static_cast<double>(sizes.size());
  if (!(stated >= 2 && stated <= 4) || sizes.size() < static_cast<std::size_t>(stated))
    return refuse(header.path, "the header says NDims = " + formatNumber(stated) + " with " +
                                   std::to_string(sizes.size()) + " sizes; 2 to 4 dimensions are read");
  const auto n = static_cast<std::size_t>(stated);
  if (const auto set =
          setSize(header, {sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(n, 3))});
      !set)
    return tl::unexpected(set.error());
  if (n == 4) {
    if (!(sizes[3] >= 1.0 && sizes[3] < 1e6))
      return refuse(header.path, "the header says " + formatNumber(sizes[3]) + " along axis 4");
    header.volumes = static_cast<std::size_t>(sizes[3]);
  }
  return n;
}

Expected<void> readVoxelType(ImageHeader &header, const Keys &keys) {
  const std::string type = valueOf(keys, {"ElementType"});
  const auto scalar = scalarOf(header.path, type);
  if (!scalar) return tl::unexpected(scalar.error());
  header.scalar = *scalar;
  if (const auto channels = numberOf(keys, "ElementNumberOfChannels"); channels && *channels != 1.0) {
    if ((*channels != 3.0 && *channels != 4.0) || (header.scalar != Scalar::u8 && header.scalar != Scalar::u16))
      return refuse(header.path,
                    "holds " + formatNumber(*channels) + " numbers per voxel of type " + type +
                        " (a vector image); images of one number per voxel, and of 3 or 4 colours as MET_UCHAR "
                        "or MET_USHORT, are read");
    header.channels = static_cast<std::size_t>(*channels);
  }
  header.bigEndian = isTrue(valueOf(keys, {"ElementByteOrderMSB", "BinaryDataByteOrderMSB"}));
  return {};
}

/// The numbers of the first of these keys that exists, at least `n`; empty: none exists. A decimal comma gets a notice;
/// where commas give more numbers than there are axes, the intended ones are unknown.
Expected<std::vector<double>> lengthsOf(ImageHeader &header, const Keys &keys,
                                        std::initializer_list<const char *> names, std::size_t n) {
  const std::string text = valueOf(keys, names);
  auto numbers = numbersIn(text);
  if (hasDecimalComma(text) &&
      std::find(header.notices.begin(), header.notices.end(), kDecimalCommaNotice) == header.notices.end())
    header.notices.emplace_back(kDecimalCommaNotice);
  const bool isFull = numbers.size() == n || (numbers.size() > n && text.find(',') == std::string::npos);
  if (numbers.empty() ||
      (isFull && std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); })))
    return numbers;
  return refuse(header.path, std::string(*names.begin()) + " = " + text.substr(0, 80) + " is not the " +
                                 std::to_string(n) + " finite numbers, one for each axis, that are accepted");
}

/// Sets the position of the voxels in the world, with a notice for missing information.
Expected<void> place(ImageHeader &header, const Keys &keys, std::size_t n) {
  auto stated = lengthsOf(header, keys, {"ElementSpacing", "ElementSize"}, n);
  if (!stated) return tl::unexpected(stated.error());
  std::vector<double> &spacing = *stated;
  if (spacing.empty()) {
    header.notices.push_back("The header gives no spacing: 1 mm is taken.");
    spacing.assign(n, 1.0);
  }
  double unit_mm = 1.0;
  if (const std::string unit = valueOf(keys, {"DistanceUnits"}); !unit.empty() && unit != "?") {
    const auto known = millimetresOf(unit);
    if (!known)
      header.notices.push_back("The DistanceUnits of the header, '" + unit.substr(0, 40) +
                               "', are no unit of length that is known: mm is taken.");
    unit_mm = known.value_or(1.0);
  }
  for (std::size_t a = 0; a < std::min<std::size_t>(n, 3); ++a) spacing[a] *= unit_mm;
  auto matrix = numbersIn(valueOf(keys, {"TransformMatrix", "Rotation", "Orientation"}));
  if (matrix.size() < n * n) {
    header.notices.push_back(
        "The header does not state the orientation of the image in the patient: the index axes are assumed to be left, "
        "posterior and superior.");
    matrix.assign(n * n, 0.0);
    for (std::size_t a = 0; a < n; ++a) matrix[a * n + a] = 1.0;
  }
  auto origin = lengthsOf(header, keys, {"Offset", "Position", "Origin"}, n);
  if (!origin) return tl::unexpected(origin.error());
  std::vector<double> &offset = *origin;
  for (double &x : offset) x *= unit_mm;
  if (offset.empty())
    header.notices.push_back("The header does not state the position of the first voxel (Offset): 0, 0, 0 is assumed.");
  offset.resize(std::max<std::size_t>(offset.size(), 3), 0.0);
  if (n == 2) header.notices.push_back("The image is a single slice without a thickness: 1 mm is assumed.");
  const auto direction = [&](std::size_t a) -> Vec3 {  // each group of n numbers is the direction of one index axis
    if (n == 2) return a < 2 ? spacing[a] * Vec3{matrix[2 * a], matrix[2 * a + 1], 0.0} : Vec3{0.0, 0.0, 1.0};
    return spacing[a] * Vec3{matrix[a * n], matrix[a * n + 1], matrix[a * n + 2]};
  };
  return setAffine(header, direction(0), direction(1), direction(2), {offset[0], offset[1], n == 2 ? 0.0 : offset[2]});
}

void readIntensities(ImageHeader &header, const Keys &keys) {
  if (const auto slope = numberOf(keys, "ElementToIntensityFunctionSlope");
      slope && std::isfinite(*slope) && *slope != 0.0)
    header.slope = *slope;
  if (const auto intercept = numberOf(keys, "ElementToIntensityFunctionOffset"); intercept && std::isfinite(*intercept))
    header.intercept = *intercept;
  if (valueOf(keys, {"Modality"}) == "MET_MOD_CT") header.unit = "HU", header.modality = "CT";
}

/// Determines which files hold the voxels, from which byte on, and how.
Expected<void> findData(ImageHeader &header, const Parsed &parsed) {
  const bool binary = !parsed.keys.contains("BinaryData") || isTrue(parsed.keys.at("BinaryData"));
  header.encoding = !binary                                            ? ImageHeader::Encoding::text
                    : isTrue(valueOf(parsed.keys, {"CompressedData"})) ? ImageHeader::Encoding::deflated
                                                                       : ImageHeader::Encoding::raw;
  const auto files = dataFiles(header.path, parsed);
  if (!files) return tl::unexpected(files.error());
  const double headerSize = numberOf(parsed.keys, "HeaderSize").value_or(0.0);
  for (const std::string &name : *files) {
    const bool local = name == "LOCAL" || name == "Local" || name == "local";
    ImageHeader::Part part{local ? header.path : namedFile(header.path.parent_path(), name),
                           local ? parsed.dataOffset : 0};
    if (!local && headerSize != 0.0) {
      std::error_code code;
      const auto length = static_cast<double>(std::filesystem::file_size(part.path, code));
      const double bytes = bytesOfAll(header) / static_cast<double>(files->size());
      const double at = headerSize < 0.0 ? length - bytes : headerSize;  // -1: the voxels are at the end of the file
      if (code || !(at >= 0.0 && at <= length))
        return refuse(part.path, "does not hold the voxels that " + header.path.filename().string() + " says");
      part.offset = static_cast<std::uint64_t>(at);
    }
    header.parts.push_back(std::move(part));
  }
  if (header.parts.empty()) return refuse(header.path, "names no file with voxels");
  return {};
}

}  // namespace

Expected<ImageHeader> readMetaHeader(const std::filesystem::path &path) {
  const auto parsed = parse(path);
  if (!parsed) return tl::unexpected(parsed.error());
  const Keys &keys = parsed->keys;
  ImageHeader header;
  header.path = path;
  if (std::string unknown = unknownKeys(keys); !unknown.empty()) header.notices.push_back(std::move(unknown));
  if (const std::string kind = valueOf(keys, {"ObjectType"}); !kind.empty() && kind != "Image")
    return refuse(path, "holds a MetaIO object of type '" + kind + "'; images are read");
  const auto dimensions = readSize(header, keys);
  if (!dimensions) return tl::unexpected(dimensions.error());
  if (const auto good = readVoxelType(header, keys); !good) return tl::unexpected(good.error());
  if (const auto good = place(header, keys, *dimensions); !good) return tl::unexpected(good.error());
  readIntensities(header, keys);
  if (const auto good = findData(header, *parsed); !good) return tl::unexpected(good.error());
  return header;
}

}  // namespace c3de::imaging
