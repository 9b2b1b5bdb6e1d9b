// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/writing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "c3de/core/output_file.h"
#include "c3de/core/text.h"
#include "formats/image_formats.h"
#include "formats/label_table.h"
#include "formats/packing.h"

namespace c3de::imaging {
namespace {

enum class Format { nrrd, nifti, niftiZipped, meta };

tl::unexpected<Error> refuseToWrite(const std::filesystem::path &path, const std::string &what) {
  return fail(ErrorCode::output, path.string() + ": " + what);
}

Expected<Format> formatFor(const std::filesystem::path &path, const VolumeGeometry &geometry, std::size_t values) {
  for (const double x : geometry.indexToWorld)
    if (!std::isfinite(x)) return refuseToWrite(path, "the geometry of the image is not finite");
  const Vec3 spacing = geometry.spacing();
  if (!(geometry.voxelVolume() > 1e-6 * spacing[0] * spacing[1] * spacing[2]))
    return refuseToWrite(path, "the axes of the image span no volume");
  if (geometry.voxelCount() == 0 || values != geometry.voxelCount())
    return refuseToWrite(path, "the image has " + std::to_string(values) + " values for " +
                                   std::to_string(geometry.voxelCount()) + " voxels");
  const std::string extension = imageExtension(path);
  if (extension == ".nrrd") return Format::nrrd;
  if (extension == ".nii") return Format::nifti;
  if (extension == ".nii.gz") return Format::niftiZipped;
  if (extension == ".mha") return Format::meta;
  return refuseToWrite(path, "images are written as .nrrd, .nii, .nii.gz or .mha");
}

Expected<void> save(const std::filesystem::path &path, Format format, const ImageToWrite &image) {
  try {
    auto bytes = format == Format::nrrd ? nrrdFile(image) : format == Format::meta ? metaFile(image) : niftiFile(image);
    if (!bytes) return tl::unexpected(bytes.error());
    if (format == Format::niftiZipped) *bytes = packed(*bytes, Packing::gzip);
    return writeWholeFile(path, *bytes);
  } catch (const std::bad_alloc &) {
    return refuseToWrite(path, "there is not enough memory to pack the image");
  }
}

template <class T>
std::string_view bytesOfAll(const std::vector<T> &all) {
  return {reinterpret_cast<const char *>(all.data()), all.size() * sizeof(T)};
}

template <class T>
constexpr Scalar scalarOf() {
  if constexpr (std::is_same_v<T, std::int8_t>)
    return Scalar::i8;
  else if constexpr (std::is_same_v<T, std::uint8_t>)
    return Scalar::u8;
  else if constexpr (std::is_same_v<T, std::int16_t>)
    return Scalar::i16;
  else if constexpr (std::is_same_v<T, std::uint16_t>)
    return Scalar::u16;
  else if constexpr (std::is_same_v<T, std::int32_t>)
    return Scalar::i32;
  else if constexpr (std::is_same_v<T, std::uint32_t>)
    return Scalar::u32;
  else if constexpr (std::is_same_v<T, float>)
    return Scalar::f32;
  else
    return Scalar::f64;
}

template <class To, class From>
std::vector<To> valuesOf(const std::vector<From> &voxels, double slope, double intercept) {
  std::vector<To> out(voxels.size());
  std::transform(voxels.begin(), voxels.end(), out.begin(),
                 [&](From v) { return static_cast<To>(slope * static_cast<double>(v) + intercept); });
  return out;
}

/// Rescaled values in the smallest type that represents them exactly, or as floating point.
Voxels rescaled(const Volume &volume) {
  return std::visit(
      [&](const auto &all) -> Voxels {
        using T = typename std::decay_t<decltype(all)>::value_type;
        const double s = volume.slope, b = volume.intercept;
        if constexpr (std::is_integral_v<T>) {
          const auto [least, most] = std::minmax_element(all.begin(), all.end());
          const double x = s * static_cast<double>(*least) + b, y = s * static_cast<double>(*most) + b;
          const double lo = std::min(x, y), hi = std::max(x, y);
          if (s == std::floor(s) && b == std::floor(b)) {
            if (lo >= -32768.0 && hi <= 32767.0) return valuesOf<std::int16_t>(all, s, b);
            if (lo >= -2147483648.0 && hi <= 2147483647.0) return valuesOf<std::int32_t>(all, s, b);
          }
          if constexpr (sizeof(T) <= 2) return valuesOf<float>(all, s, b);
        } else if constexpr (std::is_same_v<T, float>) {
          return valuesOf<float>(all, s, b);
        }
        return valuesOf<double>(all, s, b);
      },
      volume.voxels);
}

std::string colourText(const std::array<float, 3> &colour, double scale) {
  std::string text;
  for (const float c : colour) {
    const double x = scale * srgbOf(c);
    text += (text.empty() ? "" : " ") + formatNumber(scale > 1.0 ? std::round(x) : x);
  }
  return text;
}

std::string oneLine(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == '\n' || c == '\r' || c == '"'; }, ' ');
  return name;
}

/// ITK-SNAP's table of labels.
Expected<void> saveTable(const std::filesystem::path &image, const LabelMap &labels) {
  std::filesystem::path path = image;
  if (lowerCase(path.extension().string()) == ".gz") path.replace_extension();
  path.replace_extension(".label");
  auto writer = OutputFile::open(path);
  if (!writer) return tl::unexpected(writer.error());
  writer->write("# number  red green blue  opacity  visible  mesh  name\n0 0 0 0 0 0 0 \"background\"\n");
  for (const LabelMap::Label &label : labels.labels)
    writer->write(std::to_string(label.value) + " " + colourText(label.colour, 255.0) + " 1 1 1 \"" +
                  oneLine(label.name) + "\"\n");
  return writer->commit();
}

/// Slicer's segments, including the extent of each one, which Slicer requires.
std::vector<std::pair<std::string, std::string>> segmentKeys(const LabelMap &labels) {
  std::vector<std::pair<std::string, std::string>> keys;
  const auto &size = labels.geometry.size;
  const std::string extent =
      "0 " + std::to_string(size[0] - 1) + " 0 " + std::to_string(size[1] - 1) + " 0 " + std::to_string(size[2] - 1);
  for (std::size_t n = 0; n < labels.labels.size(); ++n) {
    const std::string segment = "Segment" + std::to_string(n) + "_";
    const LabelMap::Label &label = labels.labels[n];
    keys.emplace_back(segment + "ID", "Segment_" + std::to_string(label.value));
    keys.emplace_back(segment + "Name", oneLine(label.name));
    keys.emplace_back(segment + "Color", colourText(label.colour, 1.0));
    keys.emplace_back(segment + "LabelValue", std::to_string(label.value));
    keys.emplace_back(segment + "Layer", "0");
    keys.emplace_back(segment + "Extent", extent);
  }
  return keys;
}

}  // namespace

Expected<void> writeVolume(const std::filesystem::path &path, const Volume &volume) {
  const auto format =
      formatFor(path, volume.geometry, std::visit([](const auto &all) { return all.size(); }, volume.voxels));
  if (!format) return tl::unexpected(format.error());
  const bool nifti = *format == Format::nifti || *format == Format::niftiZipped;
  const bool plain = volume.slope == 1.0 && volume.intercept == 0.0;
  // NIfTI-1 stores slope and intercept in single precision only; if that would change them, rescaled values are
  // written.
  const bool kept = nifti && static_cast<double>(static_cast<float>(volume.slope)) == volume.slope &&
                    static_cast<double>(static_cast<float>(volume.intercept)) == volume.intercept;
  ImageToWrite image;
  image.geometry = volume.geometry;
  Voxels values;
  if (!plain && !kept) values = rescaled(volume);
  if (kept) image.slope = volume.slope, image.intercept = volume.intercept;
  std::visit(
      [&](const auto &all) {
        image.scalar = scalarOf<typename std::decay_t<decltype(all)>::value_type>();
        image.voxels = bytesOfAll(all);
      },
      plain || kept ? volume.voxels : values);
  return save(path, *format, image);
}

Expected<void> writeLabelMap(const std::filesystem::path &path, const LabelMap &labels) {
  const auto format = formatFor(path, labels.geometry, labels.voxels.size());
  if (!format) return tl::unexpected(format.error());
  ImageToWrite image;
  image.geometry = labels.geometry;
  image.labels = true;
  std::vector<std::uint8_t> small;
  if (std::all_of(labels.voxels.begin(), labels.voxels.end(), [](std::uint16_t v) { return v < 256; })) {
    small.assign(labels.voxels.begin(), labels.voxels.end());
    image.scalar = Scalar::u8;
    image.voxels = bytesOfAll(small);
  } else {
    image.scalar = Scalar::u16;
    image.voxels = bytesOfAll(labels.voxels);
  }
  if (*format == Format::nrrd) image.keys = segmentKeys(labels);
  if (const auto saved = save(path, *format, image); !saved || *format == Format::nrrd) return saved;
  return saveTable(path, labels);
}

Expected<void> writeVectorField(const std::filesystem::path &path, const VolumeGeometry &geometry,
                                std::span<const float> xyz) {
  const auto format = formatFor(path, geometry, xyz.size() / 3);
  if (!format) return tl::unexpected(format.error());
  if (xyz.size() % 3 != 0) return refuseToWrite(path, std::to_string(xyz.size()) + " numbers are no vectors of three");
  ImageToWrite image;
  image.geometry = geometry;
  image.scalar = Scalar::f32;
  image.components = 3;
  image.voxels = {reinterpret_cast<const char *>(xyz.data()), xyz.size() * sizeof(float)};
  return save(path, *format, image);
}

}  // namespace c3de::imaging
