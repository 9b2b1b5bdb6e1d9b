// SPDX-License-Identifier: Apache-2.0
#include "reading/mask_folder.h"

#include <algorithm>
#include <array>

#include "c3de/imaging/label_names.h"
#include "dicom/dicom_series.h"
#include "formats/image_header.h"
#include "formats/label_table.h"
#include "formats/voxel_reader.h"

namespace c3de::imaging {
namespace {

constexpr std::size_t kMaxMasks = 1000, kMaxNames = 12;

bool isImageFile(const std::filesystem::path &file) {
  constexpr std::array kExtensions{".nii", ".nii.gz", ".nrrd", ".nhdr", ".mha", ".mhd"};
  const std::string extension = imageExtension(file);
  return std::any_of(kExtensions.begin(), kExtensions.end(), [&](const char *one) { return extension == one; });
}

std::string listOf(const std::vector<std::string> &names) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMaxNames); ++i) text += (i == 0 ? "" : ", ") + names[i];
  return names.size() > kMaxNames ? text + " and " + std::to_string(names.size() - kMaxNames) + " more" : text;
}

/// Grids whose voxels differ in position by at most a hundredth of a voxel.
bool isSame(const VolumeGeometry &a, const VolumeGeometry &b) {
  if (a.size != b.size) return false;
  const Vec3 edges = a.spacing();
  const double least = 0.01 * std::min({edges[0], edges[1], edges[2]});
  for (const std::size_t corner : {0U, 1U, 2U, 4U, 7U}) {
    Vec3 index{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      index[axis] = (corner >> axis & 1U) != 0 ? static_cast<double>(a.size[axis]) : 0.0;
    if (norm(a.worldAt(index) - b.worldAt(index)) > least) return false;
  }
  return true;
}

std::string sizeOf(const VolumeGeometry &grid) {
  return std::to_string(grid.size[0]) + " x " + std::to_string(grid.size[1]) + " x " + std::to_string(grid.size[2]);
}

/// Label maps in which each voxel holds one mask.
class Layers {
 public:
  Layers(std::filesystem::path folder, std::size_t memoryLimit)
      : folder_(std::move(folder)), memoryLimit_(memoryLimit) {}

  Expected<void> add(const LabelMap &mask, const LabelMap::Label &label) {
    const auto isFree = [&](const LabelMap &layer) {
      for (std::size_t v = 0; v < mask.voxels.size(); ++v)
        if (mask.voxels[v] != 0 && layer.voxels[v] != 0) return false;
      return true;
    };
    auto layer = std::find_if(layers_.begin(), layers_.end(), isFree);
    if (layer == layers_.end()) {
      const double bytes = 2.0 * static_cast<double>(mask.voxels.size()) * static_cast<double>(layers_.size() + 2);
      if (const auto fits = checkMemory(folder_, bytes, memoryLimit_); !fits) return fits;
      LabelMap made;
      made.geometry = mask.geometry;
      made.voxels.assign(mask.voxels.size(), 0);
      layer = layers_.insert(layers_.end(), std::move(made));
    }
    for (std::size_t v = 0; v < mask.voxels.size(); ++v)
      if (mask.voxels[v] != 0) layer->voxels[v] = label.value;
    layer->labels.push_back(label);
    return {};
  }
  [[nodiscard]] std::vector<LabelMap> &all() { return layers_; }

 private:
  std::filesystem::path folder_;
  std::size_t memoryLimit_;
  std::vector<LabelMap> layers_;
};

}  // namespace

std::vector<std::filesystem::path> maskFilesIn(const std::filesystem::path &folder) {
  std::vector<std::filesystem::path> files;
  std::error_code code;
  if (!std::filesystem::is_directory(folder, code) || isLikelyImage(folder)) return files;
  std::filesystem::directory_iterator at(folder, code), end;
  for (; !code && at != end; at.increment(code)) {
    std::error_code ignored;
    if (at->is_regular_file(ignored) && isImageFile(at->path()) && !isSystemArtefact(at->path()))
      files.push_back(at->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

Expected<LoadedLabels> readMaskFolder(const std::filesystem::path &folder,
                                      const std::vector<std::filesystem::path> &files, const ReadOptions &options) {
  if (files.size() > kMaxMasks)
    return refuse(folder, "holds " + std::to_string(files.size()) + " files of images; accepted: a folder of up to " +
                              std::to_string(kMaxMasks) + " masks, or one label map");
  Layers layers(folder, options.memoryLimit);
  VolumeGeometry grid;
  std::vector<std::string> empty, notices;
  for (std::size_t f = 0; f < files.size(); ++f) {
    ReadOptions one = options;
    one.progress = partOf(options.progress, static_cast<double>(f) / static_cast<double>(files.size()),
                          static_cast<double>(f + 1) / static_cast<double>(files.size()));
    auto read = readLabelMap(files[f], one);
    if (!read) return tl::unexpected(read.error());
    for (const std::string &notice : read->notices) notices.push_back(files[f].filename().string() + ": " + notice);
    const LabelMap &mask = read->labels;
    if (!read->layers.empty() || mask.labels.size() > 1)
      return refuse(files[f], "holds " + std::to_string(mask.labels.size()) +
                                  " labels; accepted in a folder of masks: one each, or name this file instead");
    if (f == 0) grid = mask.geometry;
    if (!isSame(mask.geometry, grid))
      return refuse(files[f], "has another grid (" + sizeOf(mask.geometry) + " voxels) than " +
                                  files[0].filename().string() + " (" + sizeOf(grid) +
                                  " voxels), in size or place; accepted: masks of one grid");
    std::string name = nameFromFile(files[f]);
    if (name.empty()) name = "label " + std::to_string(f + 1);
    if (mask.labels.empty()) {
      empty.push_back(std::move(name));
      continue;
    }
    const auto number = static_cast<std::uint16_t>(f + 1);
    if (auto added = layers.add(mask, {number, std::move(name), distinctColour(f)}); !added)
      return tl::unexpected(added.error());
  }
  LoadedLabels out;
  std::size_t shared = 0;
  const std::vector<LabelMap> &all = layers.all();
  for (std::size_t v = 0; all.size() > 1 && v < all.front().voxels.size(); ++v)
    shared += std::count_if(all.begin(), all.end(), [v](const LabelMap &layer) { return layer.voxels[v] != 0; }) > 1;
  std::string text = std::to_string(files.size()) +
                     " masks of the folder are labels, numbered in the order of their "
                     "names";
  if (shared > 0)
    text += "; they share " + std::to_string(shared) + " voxels and lie in " + std::to_string(all.size()) + " layers";
  out.notices.push_back(text + ".");
  out.notices.insert(out.notices.end(), notices.begin(), notices.end());
  if (!empty.empty()) out.notices.push_back("Masks without a voxel: " + listOf(empty) + ".");
  out.labels.geometry = grid;
  if (all.empty()) {
    out.labels.voxels.assign(grid.voxelCount(), 0);
  } else {
    out.labels = std::move(layers.all().front());
    out.layers.assign(std::make_move_iterator(layers.all().begin() + 1), std::make_move_iterator(layers.all().end()));
  }
  return out;
}

}  // namespace c3de::imaging
