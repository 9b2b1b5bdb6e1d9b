// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/reading.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <set>

#include "c3de/core/input_file.h"
#include "c3de/core/text.h"
#include "c3de/imaging/companion_files.h"
#include "c3de/imaging/label_names.h"
#include "dicom/dicom_series.h"
#include "formats/byte_stream.h"
#include "formats/colours.h"
#include "formats/image_header.h"
#include "formats/label_table.h"
#include "formats/label_values.h"
#include "formats/voxel_reader.h"
#include "reading/mask_folder.h"

namespace c3de::imaging {
namespace {

enum class Format { none, nifti, nrrd, meta, dicom };

Format formatOf(const std::filesystem::path &path) {
  std::error_code code;
  if (std::filesystem::is_directory(path, code)) return Format::dicom;
  const std::string extension = imageExtension(path);
  for (const char *known : {".nii", ".nii.gz", ".hdr", ".hdr.gz", ".img", ".img.gz"})
    if (extension == known) return Format::nifti;
  if (extension == ".nrrd" || extension == ".nhdr") return Format::nrrd;
  if (extension == ".mha" || extension == ".mhd") return Format::meta;
  if (isDicom(path) || extension == ".dcm" || extension == ".ima") return Format::dicom;
  auto file = openInputFile(path);
  char head[8] = {};
  if (file) file->read(head, sizeof head);
  return std::string(head, 7) == "NRRD000" ? Format::nrrd : Format::none;
}

Expected<Format> formatOrError(const std::filesystem::path &path) {
  std::error_code code;
  if (!std::filesystem::is_directory(path, code))
    if (const auto good = checkInputFile(path); !good) return tl::unexpected(good.error());
  const Format format = formatOf(path);
  if (format != Format::none) return format;
  // Some DICOM files lack the signature; no other format is guessed.
  if (readDicomHeader(path)) return Format::dicom;
  return refuse(path,
                "is no image that is read here: DICOM, NIfTI (.nii, .nii.gz, .hdr), NRRD (.nrrd, .nhdr) and MetaImage "
                "(.mha, .mhd) are");
}

Expected<ImageHeader> headerOf(const std::filesystem::path &path, Format format) {
  if (format == Format::nifti) return readNiftiHeader(path);
  if (format == Format::nrrd) return readNrrdHeader(path);
  return readMetaHeader(path);
}

Expected<LoadedVolume> readFile(const ImageHeader &header, const ReadOptions &options) {
  LoadedVolume out;
  out.notices = header.notices;
  const bool isColour = header.channels > 1;
  const auto count = static_cast<double>(header.geometry.voxelCount());
  if (isColour)  // stored values, luma and colours are in memory at the same time
    if (const auto fits = checkMemory(
            header.path, count * static_cast<double>(header.channels * bytesOf(header.scalar) + 1 + sizeof(Rgba)),
            options.memoryLimit);
        !fits)
      return tl::unexpected(fits.error());
  auto voxels = readVoxels(header, options, out.notices);
  if (!voxels) return tl::unexpected(voxels.error());
  out.times = header.layered ? 1 : header.volumes;
  out.volume.geometry = header.geometry;
  if (isColour) {
    setColours(out.volume, *voxels, header.channels);
    out.notices.push_back("A colour image: slices show its colours; its values are their brightness, from 0 to 255.");
  } else {
    out.volume.voxels = std::move(*voxels);
  }
  if (!isColour) out.volume.slope = header.slope, out.volume.intercept = header.intercept;
  out.volume.unit = header.unit;
  return out;
}

/// @param table  names and colours; labels that it lacks are numbered
/// @param notices  sentences are added
Expected<LabelMap> labelsOf(const std::filesystem::path &path, const Volume &volume, const LabelTable &table,
                            std::vector<std::string> &notices) {
  auto values = labelValuesOf(path, volume, table);
  if (!values) return tl::unexpected(values.error());
  notices.insert(notices.end(), values->notices.begin(), values->notices.end());
  LabelMap map;
  map.geometry = volume.geometry;
  map.voxels = std::move(values->voxels);
  std::vector<bool> occurs(65536, false);
  for (const std::uint16_t label : map.voxels) occurs[label] = true;
  for (std::size_t value = 1; value < occurs.size(); ++value) {
    if (!occurs[value]) continue;
    const auto number = static_cast<std::uint16_t>(value);
    const auto renumbered = values->original.find(number);
    const std::uint64_t original = renumbered == values->original.end() ? value : renumbered->second;
    const auto named = table.find(original);
    const bool known = named != table.end() && !named->second.name.empty();
    map.labels.push_back({number, known ? named->second.name : "label " + std::to_string(original),
                          known && named->second.coloured ? named->second.colour : distinctColour(map.labels.size())});
  }
  return map;
}

tl::unexpected<Error> hasOneTime(const std::filesystem::path &path, std::size_t asked) {
  return refuse(path, "time " + std::to_string(asked) + " is asked for; the file has one time point (0)");
}

tl::unexpected<Error> holdsColours(const std::filesystem::path &path) {
  return refuse(path, "is no label map: it holds colours; labels are whole numbers from 0, one per voxel");
}

/// A segmentation, or an image whose values are label numbers.
Expected<LoadedLabels> readDicomLabels(const std::filesystem::path &path, const ReadOptions &options) {
  auto segments = readDicomSegments(path, options);
  if (!segments) return tl::unexpected(segments.error());
  if (*segments) return std::move(**segments);
  const auto loaded = readDicom(path, options);
  if (!loaded) return tl::unexpected(loaded.error());
  if (!loaded->volume.colours.empty()) return holdsColours(path);
  LoadedLabels out;
  out.notices = loaded->notices;
  auto map = labelsOf(path, loaded->volume, {}, out.notices);
  if (!map) return tl::unexpected(map.error());
  out.labels = std::move(*map);
  return out;
}

constexpr std::size_t kMaxLayers = 256, kMaxEmpty = 12;

}  // namespace

Expected<LoadedVolume> readVolume(const std::filesystem::path &path, const ReadOptions &options) {
  const auto format = formatOrError(path);
  if (!format) return tl::unexpected(format.error());
  if (*format == Format::dicom) return readDicom(path, options);
  const auto header = headerOf(path, *format);
  if (!header) return tl::unexpected(header.error());
  if (header->layered && options.time > 0) return hasOneTime(path, options.time);
  auto loaded = readFile(*header, options);
  if (loaded && header->layered)
    loaded->notices.push_back(
        "The file holds " + std::to_string(header->volumes) +
        " layers of a segmentation: read as an image, only the first is used; read as a label map, all are.");
  return loaded;
}

Expected<LoadedLabels> readLabelMap(const std::filesystem::path &path, const ReadOptions &options) {
  const auto format = formatOrError(path);
  if (!format) return tl::unexpected(format.error());
  if (const auto masks = maskFilesIn(path); !masks.empty()) return readMaskFolder(path, masks, options);
  if (*format == Format::dicom) return readDicomLabels(path, options);
  const auto header = headerOf(path, *format);
  if (!header) return tl::unexpected(header.error());
  if (header->channels > 1) return holdsColours(path);
  if (header->layered && options.time > 0) return hasOneTime(path, options.time);
  const std::size_t layers = header->layered ? header->volumes : 1;
  if (layers > kMaxLayers)
    return refuse(path, "holds " + std::to_string(layers) + " layers of segments; up to " + std::to_string(kMaxLayers) +
                            " are read");
  // Labels and source voxels are in memory at the same time.
  const double needed = static_cast<double>(header->geometry.voxelCount()) *
                        (2.0 * static_cast<double>(layers) + static_cast<double>(bytesOf(header->scalar)));
  if (const auto fits = checkMemory(path, needed, options.memoryLimit); !fits) return tl::unexpected(fits.error());
  std::vector<LabelTable> tables = segmentsOf(header->keys, layers);
  if (!header->labelXml.empty()) tables[0] = caretLabelsOf(header->labelXml);

  LoadedLabels out;
  std::vector<std::string> empty;
  const bool isNamed =
      std::any_of(tables.begin(), tables.end(), [](const LabelTable &table) { return !table.empty(); });
  if (!isNamed) {
    auto [beside, from] = sidecarTable(path);
    if (!beside.empty()) out.notices.push_back("Names of labels are from " + from.filename().string() + ".");
    tables.assign(layers, beside);
  }
  for (std::size_t layer = 0; layer < layers; ++layer) {
    ReadOptions one = options;
    if (header->layered) one.time = layer;
    one.progress = partOf(options.progress, static_cast<double>(layer) / static_cast<double>(layers),
                          static_cast<double>(layer + 1) / static_cast<double>(layers));
    auto loaded = readFile(*header, one);
    if (!loaded) return tl::unexpected(loaded.error());
    if (layer == 0) out.notices.insert(out.notices.begin(), loaded->notices.begin(), loaded->notices.end());
    auto map = labelsOf(path, loaded->volume, tables[layer], out.notices);
    if (!map) return tl::unexpected(map.error());
    // A table next to a file lists all labels of a method, a table within it only those of this file.
    if (isNamed)
      for (const auto &[value, entry] : tables[layer])
        if (std::none_of(map->labels.begin(), map->labels.end(),
                         [&named = entry.name](const LabelMap::Label &label) { return label.name == named; }))
          empty.push_back(entry.name);
    if (layer == 0)
      out.labels = std::move(*map);
    else
      out.layers.push_back(std::move(*map));
  }
  if (!empty.empty() && empty.size() <= kMaxEmpty) {
    std::string names;
    for (const std::string &name : empty) names += (names.empty() ? "" : ", ") + name;
    out.notices.push_back("Labels that are named and have no voxel: " + names + ".");
  } else if (!empty.empty()) {
    out.notices.push_back(std::to_string(empty.size()) + " labels are named and have no voxel.");
  }
  if (layers == 1 && out.labels.labels.size() == 1 && !tables[0].contains(out.labels.labels[0].value))
    if (std::string name = nameFromFile(path); !name.empty()) out.labels.labels[0].name = std::move(name);
  if (layers > 1)
    out.notices.push_back("The segments lie in " + std::to_string(layers) +
                          " layers, because some of them overlap; each layer is a label map of its own.");
  return out;
}

Expected<std::vector<SeriesInfo>> listSeries(const std::filesystem::path &path, const ProgressFn &progress) {
  const auto format = formatOrError(path);
  if (!format) return tl::unexpected(format.error());
  if (*format == Format::dicom) return listDicom(path, progress);
  const auto header = headerOf(path, *format);
  if (!header) return tl::unexpected(header.error());
  SeriesInfo info;
  info.id = path.filename().string();
  info.modality = header->modality;
  info.size = header->geometry.size;
  info.times = header->layered ? 1 : header->volumes;
  info.files = 1;
  info.isSegmentation = header->segmented;
  info.holdsNamedFile = true;
  info.folder = path.parent_path();
  return std::vector<SeriesInfo>{info};
}

bool isLikelyImage(const std::filesystem::path &path) {
  std::error_code code;
  if (!std::filesystem::is_directory(path, code))
    return std::filesystem::is_regular_file(path, code) && formatOf(path) != Format::none;
  std::filesystem::recursive_directory_iterator at(path, std::filesystem::directory_options::skip_permission_denied,
                                                   code),
      end;
  for (int seen = 0; !code && at != end && seen < 1000; at.increment(code), ++seen) {
    std::error_code ignored;
    if (at->is_regular_file(ignored) && isDicom(at->path())) return true;
  }
  return false;
}

namespace {

/// The files of the series to which a DICOM file belongs.
Expected<std::vector<std::filesystem::path>> filesOfSeries(const std::filesystem::path &path,
                                                           const ProgressFn &progress) {
  const auto folder = scanDicom(path, progress);
  if (!folder) return tl::unexpected(folder.error());
  const auto isNamed = [&](const SliceRef &slice) {
    std::error_code code;
    return std::filesystem::equivalent(folder->files[slice.file].path, path, code);
  };
  std::set<std::filesystem::path> files;
  for (const DicomStack &named : folder->stacks) {
    if (std::none_of(named.slices.begin(), named.slices.end(), isNamed)) continue;
    for (const DicomStack &stack : folder->stacks)
      if (stack.info.id == named.info.id)
        for (const SliceRef &slice : stack.slices) files.insert(folder->files[slice.file].path);
  }
  return std::vector<std::filesystem::path>(files.begin(), files.end());
}

}  // namespace

Expected<std::vector<std::filesystem::path>> companionFiles(const std::filesystem::path &path,
                                                            const ProgressFn &progress) {
  std::error_code code;
  std::vector<std::filesystem::path> files;
  if (std::filesystem::is_directory(path, code)) return files;
  const Format format = formatOf(path);
  if (format == Format::none) return files;
  if (format == Format::dicom) {
    auto series = filesOfSeries(path, progress);
    if (!series) return series;
    files = std::move(*series);
  } else {
    const auto header = headerOf(path, format);
    if (!header) return tl::unexpected(header.error());
    for (const ImageHeader::Part &part : header->parts) files.push_back(part.path);
    if (const std::string extension = imageExtension(path); extension == ".img" || extension == ".img.gz")
      for (const char *ending : {".hdr", ".hdr.gz"}) {
        const std::string name = path.filename().string();
        const auto beside = path.parent_path() / (name.substr(0, name.size() - extension.size()) + ending);
        if (std::filesystem::is_regular_file(beside, code)) files.push_back(beside);
      }
    if (const auto table = sidecarTable(path).second; !table.empty()) files.push_back(table);
  }
  std::erase_if(files,
                [&](const std::filesystem::path &file) { return std::filesystem::equivalent(file, path, code); });
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return files;
}

}  // namespace c3de::imaging
