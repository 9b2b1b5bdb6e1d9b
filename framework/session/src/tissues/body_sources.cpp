// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/body_sources.h"

#include <algorithm>
#include <utility>

#include "c3de/core/log.h"
#include "c3de/core/path_text.h"
#include "c3de/core/text.h"
#include "c3de/imaging/label_names.h"
#include "tissues/region_mask.h"

namespace c3de::session {
namespace {

std::string listOf(const std::vector<imaging::LabelMap> &layers) {
  constexpr std::size_t kMost = 12;
  std::string text;
  std::size_t count = 0;
  for (const imaging::LabelMap &map : layers)
    for (const imaging::LabelMap::Label &label : map.labels)
      if (count++ < kMost) text += (text.empty() ? "" : ", ") + std::to_string(label.value) + " " + label.name;
  return count > kMost ? text + " and " + std::to_string(count - kMost) + " more" : text;
}

bool matchesLabel(const scene::SceneVolume &volume, const imaging::LabelMap::Label &label) {
  if (volume.label) return label.value == *volume.label;
  return label.name == volume.labelName ||
         imaging::readableName(label.name) == imaging::readableName(volume.labelName) ||
         "label " + std::to_string(label.value) == volume.labelName;
}

/// A label, and the layer it is in.
struct FoundLabel {
  const imaging::LabelMap *map = nullptr;
  const imaging::LabelMap::Label *label = nullptr;
};

Expected<FoundLabel> labelOf(const scene::SceneVolume &volume, const std::vector<imaging::LabelMap> &layers) {
  std::vector<FoundLabel> found;
  std::vector<std::string> names;
  for (const imaging::LabelMap &map : layers)
    for (const imaging::LabelMap::Label &label : map.labels) {
      names.push_back(label.name);
      if (!volume.label && label.name == volume.labelName) return FoundLabel{&map, &label};
      if (matchesLabel(volume, label)) found.push_back({&map, &label});
    }
  if (found.size() == 1) return found.front();
  const std::string wanted = volume.label ? std::to_string(*volume.label) : "'" + volume.labelName + "'";
  if (found.size() > 1)
    return fail(ErrorCode::input, volume.file.string() + " has label " + wanted + " in " +
                                      std::to_string(found.size()) +
                                      " of its layers; accepted: the name of one: " + listOf(layers));
  const std::string nearest = volume.label ? "" : nearestName(volume.labelName, names);
  return fail(ErrorCode::input, volume.file.string() + " has no label " + wanted + "; " +
                                    (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") +
                                    "there are: " + (names.empty() ? "none" : listOf(layers)));
}

// The voxels of a piece.
PickedVoxels pieceOf(const scene::SceneBodyPieces &cut, std::uint8_t piece) {
  PickedVoxels out;
  auto tissues = std::make_shared<imaging::LabelMap>(cut.tissues);
  out.mask.geometry = tissues->geometry;
  out.mask.voxels.resize(tissues->voxels.size());
  for (std::size_t v = 0; v < tissues->voxels.size(); ++v) {
    if (cut.pieces[v] != piece) tissues->voxels[v] = 0;
    out.mask.voxels[v] = tissues->voxels[v] != 0 ? 1 : 0;
  }
  out.tissues = std::move(tissues);
  return out;
}

}  // namespace

Expected<std::shared_ptr<const BodySources::Layers>> BodySources::labels(const std::filesystem::path &file,
                                                                         const imaging::ReadOptions &options) {
  auto &stored = labels_[{file, options.series, options.time}];
  if (stored) return stored;
  auto loaded = imaging::readLabelMap(file, options);
  if (!loaded) return tl::unexpected(loaded.error());
  notices_.insert(notices_.end(), loaded->notices.begin(), loaded->notices.end());
  auto layers = std::make_shared<Layers>(std::move(loaded->layers));
  layers->insert(layers->begin(), std::move(loaded->labels));
  return stored = std::move(layers);
}

Expected<std::shared_ptr<const imaging::Volume>> BodySources::volume(const std::filesystem::path &file,
                                                                     const imaging::ReadOptions &options) {
  auto &stored = volumes_[{file, options.series, options.time}];
  if (stored) return stored;
  auto loaded = imaging::readVolume(file, options);
  if (!loaded) return tl::unexpected(loaded.error());
  notices_.insert(notices_.end(), loaded->notices.begin(), loaded->notices.end());
  return stored = std::make_shared<const imaging::Volume>(std::move(loaded->volume));
}

Expected<std::shared_ptr<const BodySources::Layers>> BodySources::layersOf(const scene::SceneVolume &volume,
                                                                           const ProgressFn &progress) {
  if (volume.ruled) return volume.ruled;
  imaging::ReadOptions options;
  options.progress = progress;
  options.series = volume.series;
  options.time = volume.time;
  return labels(volume.file, options);
}

Expected<PickedVoxels> BodySources::pick(const scene::SceneVolume &volume, const ProgressFn &progress,
                                         Preparation &took) {
  imaging::ReadOptions options;
  options.progress = progress;
  options.series = volume.series;
  options.time = volume.time;
  std::shared_ptr<const Layers> map;
  std::shared_ptr<const imaging::Volume> image, background;
  if (!volume.mask) {
    const ScopedTimer reading(took.reading_s);
    if (volume.background && !volume.cut) {
      imaging::ReadOptions whole;
      whole.progress = progress;
      whole.series = volume.background->series;
      whole.time = volume.background->time;
      auto read = this->volume(volume.background->image, whole);
      if (!read) return tl::unexpected(read.error());
      background = *read;
    }
    if (volume.threshold) {
      auto read = this->volume(volume.file, options);
      if (!read) return tl::unexpected(read.error());
      image = *read;
    } else {
      auto read = layersOf(volume, progress);
      if (!read) return tl::unexpected(read.error());
      map = *read;
    }
  }
  const ScopedTimer masking(took.masks_s);
  Expected<imaging::Mask> mask = imaging::Mask{};
  std::optional<std::array<float, 3>> colour = volume.colour;
  std::shared_ptr<imaging::LabelMap> tissues;
  if (volume.mask) {
    mask = *volume.mask;
  } else if (volume.cut) {
    PickedVoxels piece = pieceOf(*volume.cut, volume.piece);
    if (imaging::voxelCount(piece.mask) == 0) return fail(ErrorCode::internal, "a piece of a body has no voxel");
    return piece;
  } else if (volume.hasTissues()) {
    if (!volume.isSettled) return fail(ErrorCode::internal, "the tissues of a body are not settled");
    auto picked = pickTissues(volume, *map, background.get(), progress, &notices_);
    if (!picked) return tl::unexpected(picked.error());
    mask->geometry = picked->geometry;
    mask->voxels.resize(picked->voxels.size());
    std::transform(picked->voxels.begin(), picked->voxels.end(), mask->voxels.begin(),
                   [](std::uint16_t tissue) { return static_cast<std::uint8_t>(tissue != 0 ? 1 : 0); });
    tissues = std::make_shared<imaging::LabelMap>(std::move(*picked));
  } else if (image) {
    mask = imaging::threshold(*image, (*volume.threshold)[0], (*volume.threshold)[1], progress);
  } else {
    const auto label = labelOf(volume, *map);
    if (!label) return tl::unexpected(label.error());
    mask = imaging::maskOf(*label->map, label->label->value);
    colour = label->label->colour;
  }
  if (mask && volume.region) keepWithin(*volume.region, *mask);
  if (mask) mask = imaging::mended(std::move(*mask), volume.mend, progress);
  if (mask && imaging::voxelCount(*mask) == 0)
    return fail(ErrorCode::input, volume.file.string() +
                                      ": nothing is left of what was asked for; accepted: a label or a "
                                      "threshold, " +
                                      (volume.region ? "within the region and " : "") + "mended, that holds voxels");
  if (!mask) return tl::unexpected(mask.error());
  // Voxels removed by mending have no tissue; voxels added by it belong to the background.
  if (tissues)
    for (std::size_t v = 0; v < tissues->voxels.size(); ++v) {
      std::uint16_t &tissue = tissues->voxels[v];
      if (mask->voxels[v] == 0)
        tissue = 0;
      else if (tissue == 0 && volume.background)
        tissue = static_cast<std::uint16_t>(volume.tissues.size() + 1);
    }
  return PickedVoxels{std::move(*mask), colour, std::move(tissues)};
}

Expected<TissueVoxels> BodySources::placesOf(const scene::SceneBody &body, const PickedVoxels &picked) {
  const auto layers = layersOf(body.volume, {});
  if (!layers) return tl::unexpected(layers.error());
  TissueVoxels tissueVoxels = tissuePlaces(body, **layers, *picked.tissues);
  tissueVoxels.map = picked.tissues;
  if (!body.volume.cut) return tissueVoxels;
  // A label without a voxel is reported once, with the rest.
  std::erase_if(tissueVoxels.labels, [&](const LabelVoxels &label) {
    const auto &sliding = body.volume.cut->labels;
    return label.voxels == 0 &&
           (body.volume.piece != 0 || std::any_of(sliding.begin(), sliding.end(), [&](const auto &labels) {
              return std::any_of(labels.begin(), labels.end(), [&](const scene::SceneLabel &other) {
                return other.value == label.value && other.name == label.name;
              });
            }));
  });
  return tissueVoxels;
}

std::vector<std::string> BodySources::popNotices() { return std::exchange(notices_, {}); }

void BodySources::reportNotices(const std::filesystem::path &file) {
  for (const std::string &notice : popNotices()) {
    log(LogLevel::warn, file.string() + ": " + notice);
    std::string line = pathText(file.filename()) + ": " + notice;
    if (std::find(reportedNotices_.begin(), reportedNotices_.end(), line) == reportedNotices_.end())
      reportedNotices_.push_back(std::move(line));
  }
}

tl::unexpected<Error> failInScene(const Error &error, const scene::SceneFile &scene, int line) {
  return fail(error.code == ErrorCode::usage ? ErrorCode::input : error.code, scene.where(line) + ": " + error.message);
}

}  // namespace c3de::session
