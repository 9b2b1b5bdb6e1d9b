// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/reading.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>

#include "byte_stream.h"
#include "c3de/core/text.h"
#include "dicom_series.h"
#include "image_header.h"
#include "label_table.h"
#include "voxel_reader.h"

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
  std::ifstream file(path, std::ios::binary);
  char head[8] = {};
  file.read(head, sizeof head);
  return std::string(head, 7) == "NRRD000" ? Format::nrrd : Format::none;
}

Expected<Format> formatOrError(const std::filesystem::path &path) {
  std::error_code code;
  if (!std::filesystem::exists(path, code)) return refuse(path, "no such file or folder");
  const Format format = formatOf(path);
  if (format != Format::none) return format;
  // DICOM without its signature exists; no other format is worth a guess.
  if (readDicomHeader(path)) return Format::dicom;
  return refuse(path, "is no image that is read here: DICOM, NIfTI (.nii, .nii.gz, .hdr), NRRD (.nrrd, .nhdr) and MetaImage (.mha, .mhd) are");
}

Expected<ImageHeader> headerOf(const std::filesystem::path &path, Format format) {
  if (format == Format::nifti) return readNiftiHeader(path);
  if (format == Format::nrrd) return readNrrdHeader(path);
  return readMetaHeader(path);
}

/// ProgressFn for a part of the whole.
ProgressFn partOf(const ProgressFn &progress, double from, double to) {
  if (!progress) return {};
  return [&progress, from, to](double fraction, const std::string &what) { return progress(from + (to - from) * fraction, what); };
}

std::string describe(const SeriesInfo &info) {
  return "  " + info.id + "  " + info.modality + " " + std::to_string(info.size[0]) + " x " + std::to_string(info.size[1]) + " x " +
         std::to_string(info.size[2]) + (info.orientation.empty() ? "" : " " + info.orientation) + (info.description.empty() ? "" : "  \"" + info.description + "\"") +
         (info.refusal.empty() ? "" : "  (" + info.refusal + ")");
}

/// The stack that was asked for by name or by one of its files, or the only one that can be read.
Expected<const DicomStack *> choose(const std::filesystem::path &path, const DicomFolder &folder, const ReadOptions &options,
                                    std::vector<std::string> &notices) {
  std::string list;
  for (const DicomStack &stack : folder.stacks) list += "\n" + describe(stack.info);
  if (!options.series.empty()) {
    for (const DicomStack &stack : folder.stacks)
      if (stack.info.id == options.series) return &stack;
    return refuse(path, "has no series '" + options.series + "'; there are:" + list);
  }
  std::error_code code;
  const bool isFolder = std::filesystem::is_directory(path, code);
  std::vector<const DicomStack *> candidates;
  for (const DicomStack &stack : folder.stacks) {
    const bool asked = isFolder ? stack.info.refusal.empty()
                                : std::any_of(stack.slices.begin(), stack.slices.end(), [&](const SliceRef &ref) {
                                    return folder.files[ref.file].path.filename() == path.filename();
                                  });
    if (asked) candidates.push_back(&stack);
  }
  if (candidates.size() == 1) {
    if (isFolder && folder.stacks.size() > 1)
      notices.push_back("The folder also holds " + std::to_string(folder.stacks.size() - 1) + " series that cannot be read as a volume.");
    return candidates.front();
  }
  if (candidates.empty() && folder.stacks.empty())
    return refuse(path, isFolder ? "holds no DICOM image" : "is damaged or holds no image: no DICOM header with rows and columns can be read");
  if (candidates.empty()) {
    if (folder.stacks.size() == 1) return &folder.stacks.front();
    return refuse(path, isFolder ? "holds no series that can be read:" + list : "is damaged or holds no image: no DICOM header with rows and columns can be read");
  }
  return refuse(path, "holds " + std::to_string(candidates.size()) + " series and none was chosen:" + list);
}

Expected<LoadedVolume> readDicom(const std::filesystem::path &path, const ReadOptions &options) {
  std::error_code code;
  std::vector<std::string> notices;
  const auto folder = scanDicom(path, partOf(options.progress, 0.0, 0.2));
  if (!folder) return tl::unexpected(folder.error());
  const auto stack = choose(path, *folder, options, notices);
  if (!stack) return tl::unexpected(stack.error());
  const auto &files = folder->files;
  std::filesystem::path preferred;
  for (const SliceRef &ref : (*stack)->slices)
    if (files[ref.file].path.filename() == path.filename()) preferred = files[ref.file].path;
  if (!(*stack)->info.refusal.empty()) return refuse(preferred.empty() ? path : preferred, (*stack)->info.refusal);
  const auto plan = planStack(*folder, **stack, preferred);
  if (!plan) return tl::unexpected(plan.error());
  ReadOptions rest = options;
  rest.progress = partOf(options.progress, 0.2, 1.0);
  auto out = readStack(*folder, **stack, *plan, rest);
  if (out) out->notices.insert(out->notices.begin(), notices.begin(), notices.end());
  return out;
}

Expected<LoadedVolume> readFile(const ImageHeader &header, const ReadOptions &options) {
  LoadedVolume out;
  out.notices = header.notices;
  auto voxels = readVoxels(header, options, out.notices);
  if (!voxels) return tl::unexpected(voxels.error());
  out.volume.geometry = header.geometry;
  out.volume.voxels = std::move(*voxels);
  out.volume.slope = header.slope;
  out.volume.intercept = header.intercept;
  out.volume.unit = header.unit;
  return out;
}

/// Whole numbers 0 … 65535, or the first voxel that is none.
template <class T>
std::optional<std::size_t> toLabels(const std::vector<T> &voxels, double slope, double intercept, std::vector<std::uint16_t> &labels) {
  labels.resize(voxels.size());
  const bool plain = slope == 1.0 && intercept == 0.0;
  for (std::size_t v = 0; v < voxels.size(); ++v) {
    const double value = plain ? static_cast<double>(voxels[v]) : slope * static_cast<double>(voxels[v]) + intercept;
    if (!(value >= 0.0 && value <= 65535.0) || value != std::floor(value)) return v;
    labels[v] = static_cast<std::uint16_t>(value);
  }
  return std::nullopt;
}

}  // namespace

Expected<LoadedVolume> readVolume(const std::filesystem::path &path, const ReadOptions &options) {
  const auto format = formatOrError(path);
  if (!format) return tl::unexpected(format.error());
  if (*format == Format::dicom) return readDicom(path, options);
  const auto header = headerOf(path, *format);
  if (!header) return tl::unexpected(header.error());
  return readFile(*header, options);
}

Expected<LoadedLabels> readLabelMap(const std::filesystem::path &path, const ReadOptions &options) {
  const auto format = formatOrError(path);
  if (!format) return tl::unexpected(format.error());
  LabelTable table;
  Expected<LoadedVolume> loaded;
  if (*format == Format::dicom) {
    loaded = readDicom(path, options);
  } else {
    const auto header = headerOf(path, *format);
    if (!header) return tl::unexpected(header.error());
    bool layered = false;
    table = header->labelXml.empty() ? segmentsOf(header->keys, layered) : caretLabelsOf(header->labelXml);
    if (layered) return refuse(path, "holds segments in several layers, which may overlap; one label per voxel is read");
    ReadOptions rest = options;
    // The labels are kept beside the voxels they come from for a moment.
    if (rest.memoryLimit > 0) {
      const double more = 2.0 * static_cast<double>(header->geometry.voxelCount());
      if (const auto fits = checkMemory(path, more * (1.0 + static_cast<double>(bytesOf(header->scalar)) / 2.0), options.memoryLimit); !fits)
        return tl::unexpected(fits.error());
    }
    loaded = readFile(*header, rest);
  }
  if (!loaded) return tl::unexpected(loaded.error());

  LoadedLabels out;
  out.notices = std::move(loaded->notices);
  const Volume &volume = loaded->volume;
  out.labels.geometry = volume.geometry;
  const auto wrong = std::visit([&](const auto &all) { return toLabels(all, volume.slope, volume.intercept, out.labels.voxels); }, volume.voxels);
  if (wrong) {
    const auto &size = volume.geometry.size;
    const std::size_t i = *wrong % size[0], j = *wrong / size[0] % size[1], k = *wrong / (size[0] * size[1]);
    return refuse(path, "is no label map: voxel (" + std::to_string(i) + ", " + std::to_string(j) + ", " + std::to_string(k) + ") is " +
                            formatNumber(volume.value(i, j, k)) + "; whole numbers from 0 to 65535 are labels");
  }
  if (table.empty() && *format != Format::dicom) {
    auto [beside, from] = tableBeside(path);
    if (!beside.empty()) out.notices.push_back("Names of labels are from " + from.filename().string() + ".");
    table = std::move(beside);
  }
  std::vector<bool> occurs(65536, false);
  for (const std::uint16_t label : out.labels.voxels) occurs[label] = true;
  for (std::size_t value = 1; value < occurs.size(); ++value) {
    if (!occurs[value]) continue;
    const auto number = static_cast<std::uint16_t>(value);
    const auto named = table.find(number);
    const bool known = named != table.end() && !named->second.name.empty();
    out.labels.labels.push_back({number, known ? named->second.name : "label " + std::to_string(value),
                                 known && named->second.coloured ? named->second.colour : distinctColour(out.labels.labels.size())});
  }
  return out;
}

Expected<std::vector<SeriesInfo>> listSeries(const std::filesystem::path &path, const ProgressFn &progress) {
  const auto format = formatOrError(path);
  if (!format) return tl::unexpected(format.error());
  std::vector<SeriesInfo> all;
  if (*format == Format::dicom) {
    const auto folder = scanDicom(path, progress);
    if (!folder) return tl::unexpected(folder.error());
    for (const DicomStack &stack : folder->stacks) all.push_back(stack.info);
    if (all.empty()) return refuse(path, "holds no DICOM image");
    return all;
  }
  const auto header = headerOf(path, *format);
  if (!header) return tl::unexpected(header.error());
  SeriesInfo info;
  info.id = path.filename().string();
  info.modality = header->modality;
  info.size = header->geometry.size;
  info.files = 1;
  info.folder = path.parent_path();
  all.push_back(info);
  return all;
}

bool looksLikeImage(const std::filesystem::path &path) {
  std::error_code code;
  if (!std::filesystem::is_directory(path, code)) return std::filesystem::is_regular_file(path, code) && formatOf(path) != Format::none;
  std::filesystem::recursive_directory_iterator at(path, std::filesystem::directory_options::skip_permission_denied, code), end;
  for (int seen = 0; !code && at != end && seen < 1000; at.increment(code), ++seen) {
    std::error_code ignored;
    if (at->is_regular_file(ignored) && isDicom(at->path())) return true;
  }
  return false;
}

}  // namespace c3de::imaging
