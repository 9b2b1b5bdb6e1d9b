// SPDX-License-Identifier: Apache-2.0
// Chooses the stack of a DICOM folder and reads it.
#include <algorithm>
#include <cmath>

#include "dicom/dicom_segments.h"
#include "dicom/dicom_series.h"
#include "formats/image_header.h"
#include "formats/voxel_reader.h"

namespace c3de::imaging {
namespace {

std::string describe(const SeriesInfo &info) {
  return "  " + info.id + (info.number.empty() ? "" : "  number " + info.number) + "  " + info.modality + " " +
         std::to_string(info.size[0]) + " x " + std::to_string(info.size[1]) + " x " + std::to_string(info.size[2]) +
         (info.orientation.empty() ? "" : " " + info.orientation) +
         (info.description.empty() ? "" : "  \"" + info.description + "\"") +
         (info.refusal.empty() ? "" : "  (" + info.refusal + ")");
}

/// `name#2.1` to name and "2.1"; a name without a part to itself and "".
std::pair<std::string, std::string> partedName(const std::string &text) {
  const std::size_t hash = text.rfind('#');
  if (hash == std::string::npos || hash + 1 == text.size() ||
      text.find_first_not_of("0123456789.", hash + 1) != std::string::npos)
    return {text, ""};
  return {text.substr(0, hash), text.substr(hash + 1)};
}

/// Whether a text denotes a series, by its identifier, its number or its description, with the part after a # for a
/// part of a series.
bool matchesSeries(const SeriesInfo &info, const std::string &wanted) {
  if (info.id == wanted) return true;
  const auto own = partedName(info.id), asked = partedName(wanted);
  const auto named = [&](const std::string &name) {
    return name.empty() || name == own.first || name == info.number || name == info.description;
  };
  if (!asked.second.empty() && asked.second == own.second && named(asked.first)) return true;
  return !info.isPart && !wanted.empty() && named(wanted);
}

Expected<const DicomStack *> chooseByName(const std::filesystem::path &path, const DicomFolder &folder,
                                          const std::string &wanted, const std::string &list) {
  std::vector<const DicomStack *> meant;
  for (const DicomStack &stack : folder.stacks) {
    if (stack.info.id == wanted) return &stack;
    if (matchesSeries(stack.info, wanted)) meant.push_back(&stack);
  }
  const auto readable =
      std::count_if(meant.begin(), meant.end(), [](const DicomStack *stack) { return stack->info.refusal.empty(); });
  if (meant.empty()) return refuse(path, "has no series '" + wanted + "'; there are:" + list);
  if (meant.size() > 1 && readable == 1)
    std::erase_if(meant, [](const DicomStack *stack) { return !stack->info.refusal.empty(); });
  if (meant.size() == 1) return meant.front();
  return refuse(path, "has " + std::to_string(meant.size()) + " series '" + wanted +
                          "'; name one by its identifier, or a part by #1, #2, … behind it:" + list);
}

/// The candidates of a choice without a name.
enum class Kind { images, segmentations };

/// The stack requested by name or by one of its files, or the only readable one.
Expected<const DicomStack *> choose(const std::filesystem::path &path, const DicomFolder &folder,
                                    const ReadOptions &options, Kind kind, std::vector<std::string> &notices) {
  std::string list;
  for (const DicomStack &stack : folder.stacks) list += "\n" + describe(stack.info);
  if (!options.series.empty()) return chooseByName(path, folder, options.series, list);
  std::error_code code;
  const bool isFolder = std::filesystem::is_directory(path, code);
  std::vector<const DicomStack *> candidates;
  std::size_t refused = 0;
  for (const DicomStack &stack : folder.stacks) {
    if (stack.info.isPart) continue;
    refused += stack.info.refusal.empty() ? 0 : 1;
    const bool asked = isFolder ? stack.info.refusal.empty()
                                : std::any_of(stack.slices.begin(), stack.slices.end(), [&](const SliceRef &ref) {
                                    return folder.files[ref.file].path.filename() == path.filename();
                                  });
    if (asked) candidates.push_back(&stack);
  }
  const auto isOther = [&](const DicomStack *stack) {
    return stack->info.isSegmentation != (kind == Kind::segmentations);
  };
  const auto others = static_cast<std::size_t>(std::count_if(candidates.begin(), candidates.end(), isOther));
  if (others > 0 && others < candidates.size()) {
    std::erase_if(candidates, isOther);
    if (kind == Kind::images)
      notices.push_back("The folder also holds " + std::to_string(others) +
                        (others == 1 ? " segmentation" : " segmentations") +
                        ", to be opened as a label map by its file.");
  }
  if (candidates.size() == 1) {
    if (isFolder && refused > 0)
      notices.push_back("The folder also holds " + std::to_string(refused) +
                        " series that cannot be read as a volume.");
    return candidates.front();
  }
  if (candidates.empty() && folder.stacks.empty())
    return refuse(path, isFolder ? "holds no DICOM image"
                                 : "is damaged or holds no image: no DICOM header with rows and columns can be read");
  if (candidates.empty()) {
    if (folder.stacks.size() == 1) return &folder.stacks.front();
    return refuse(path, isFolder ? "holds no series that can be read:" + list
                                 : "is damaged or holds no image: no DICOM header with rows and columns can be read");
  }
  return refuse(path, "holds " + std::to_string(candidates.size()) + " series and none was chosen:" + list);
}

struct Chosen {
  DicomFolder folder;
  std::size_t stack = 0;
  std::filesystem::path file;  ///< named file of the stack; empty: a folder was named
  std::vector<std::string> notices;
  [[nodiscard]] const DicomStack &it() const { return folder.stacks[stack]; }
};

Expected<Chosen> find(const std::filesystem::path &named, const ReadOptions &options, Kind kind) {
  Chosen out;
  const std::filesystem::path path = imageFolderOf(named);
  if (path != named)
    out.notices.push_back(named.filename().string() +
                          " is a list of files (DICOMDIR): the folder in which it lies is read.");
  auto folder = scanDicom(path, partOf(options.progress, 0.0, 0.2));
  if (!folder) return tl::unexpected(folder.error());
  out.folder = std::move(*folder);
  const auto stack = choose(path, out.folder, options, kind, out.notices);
  if (!stack) return tl::unexpected(stack.error());
  out.stack = static_cast<std::size_t>(*stack - out.folder.stacks.data());
  for (const SliceRef &ref : (*stack)->slices)
    if (out.folder.files[ref.file].path.filename() == path.filename()) out.file = out.folder.files[ref.file].path;
  if (!(*stack)->info.refusal.empty()) return refuse(out.file.empty() ? path : out.file, (*stack)->info.refusal);
  if (out.it().info.isSegmentation && options.time > 0)
    return refuse(path,
                  "time " + std::to_string(options.time) + " is asked for; a segmentation has one time point (0)");
  return out;
}

Expected<LoadedLabels> segmentsOf(const Chosen &chosen, const ReadOptions &options) {
  ReadOptions rest = options;
  rest.progress = partOf(options.progress, 0.2, 1.0);
  auto out = readSegments(chosen.folder, chosen.it(), rest);
  if (out) out->notices.insert(out->notices.begin(), chosen.notices.begin(), chosen.notices.end());
  return out;
}

}  // namespace

ProgressFn partOf(const ProgressFn &progress, double from, double to) {
  if (!progress) return {};
  return [&progress, from, to](double fraction, const std::string &what) {
    return progress(from + (to - from) * fraction, what);
  };
}

Expected<LoadedVolume> readDicom(const std::filesystem::path &path, const ReadOptions &options) {
  const auto chosen = find(path, options, Kind::images);
  if (!chosen) return tl::unexpected(chosen.error());
  if (chosen->it().info.isSegmentation) {
    auto labels = segmentsOf(*chosen, options);
    if (!labels) return tl::unexpected(labels.error());
    LoadedVolume out;
    out.notices = std::move(labels->notices);
    out.notices.push_back(std::string("A segmentation: its values are the numbers of its segments") +
                          (labels->layers.empty() ? "." : ", of the first layer only; as a label map all are read."));
    out.volume.geometry = labels->labels.geometry;
    out.volume.voxels = std::move(labels->labels.voxels);
    return out;
  }
  const auto plan = planStack(chosen->folder, chosen->it(), chosen->file, options.time);
  if (!plan) return tl::unexpected(plan.error());
  ReadOptions rest = options;
  rest.progress = partOf(options.progress, 0.2, 1.0);
  auto out = readStack(chosen->folder, chosen->it(), *plan, rest);
  if (out) out->notices.insert(out->notices.begin(), chosen->notices.begin(), chosen->notices.end());
  return out;
}

Expected<std::optional<LoadedLabels>> readDicomSegments(const std::filesystem::path &path, const ReadOptions &options) {
  const auto chosen = find(path, options, Kind::segmentations);
  if (!chosen) return tl::unexpected(chosen.error());
  if (!chosen->it().info.isSegmentation) return std::optional<LoadedLabels>();
  auto labels = segmentsOf(*chosen, options);
  if (!labels) return tl::unexpected(labels.error());
  return std::optional(std::move(*labels));
}

Expected<std::vector<SeriesInfo>> listDicom(const std::filesystem::path &path, const ProgressFn &progress) {
  const auto folder = scanDicom(imageFolderOf(path), progress);
  if (!folder) return tl::unexpected(folder.error());
  std::vector<SeriesInfo> all;
  for (const DicomStack &stack : folder->stacks) {
    SeriesInfo &info = all.emplace_back(stack.info);
    info.holdsNamedFile = std::any_of(stack.slices.begin(), stack.slices.end(), [&](const SliceRef &slice) {
      return folder->files[slice.file].path.filename() == path.filename();
    });
    if (!info.refusal.empty()) continue;
    if (info.isSegmentation) {
      if (const auto grid = gridOfSegments(*folder, stack)) info.size = grid->geometry.size;
    } else if (const auto plan = planStack(*folder, stack, {}, 0)) {
      info.size[2] = plan->slices.size();
      info.times = plan->times;
    }
  }
  if (all.empty()) return refuse(path, "holds no DICOM image");
  return all;
}

}  // namespace c3de::imaging
