// SPDX-License-Identifier: Apache-2.0
#include "tissues/tissue_rules.h"

#include <algorithm>
#include <utility>

#include "c3de/core/text.h"
#include "c3de/imaging/label_names.h"
#include "c3de/session/body_sources.h"
#include "tissues/region_mask.h"

namespace c3de::session {
namespace {

/// Voxels of a grid at whose centre the value of an image is between two limits.
Expected<imaging::Mask> between(const imaging::Volume &image, const std::array<double, 2> &limits,
                                const imaging::VolumeGeometry &grid, const ProgressFn &progress) {
  auto found = imaging::threshold(image, limits[0], limits[1], progress);
  if (!found || (found->geometry.size == grid.size && found->geometry.indexToWorld == grid.indexToWorld)) return found;
  const auto there =
      imaging::resampled({found->geometry, {found->voxels.begin(), found->voxels.end()}, {}}, grid, progress);
  if (!there) return tl::unexpected(there.error());
  imaging::Mask out{grid, {}};
  for (const std::uint16_t voxel : there->voxels) out.voxels.push_back(voxel != 0 ? 1 : 0);
  return out;
}

std::string shown(const scene::SceneTissueRule &rule) {
  std::string text;
  if (rule.threshold)
    text = "values " + formatNumber((*rule.threshold)[0]) + " to " + formatNumber((*rule.threshold)[1]) +
           (rule.image.empty() ? "" : " of " + rule.image.filename().string());
  if (rule.margin_mm > 0.0)
    text += (text.empty() ? "" : ", ") + formatNumber(rule.margin_mm) + " mm around earlier tissues";
  return text + (rule.region ? ", within its region" : "");
}

}  // namespace

Expected<void> applyRules(const scene::SceneFile &scene, scene::SceneBody &body, std::vector<imaging::LabelMap> layers,
                          BodySources &sources, const ProgressFn &progress) {
  scene::SceneVolume &volume = body.volume;
  imaging::ReadOptions own;
  own.progress = progress;
  own.series = volume.series;
  own.time = volume.time;
  imaging::ReadOptions whole;
  whole.progress = progress;
  imaging::LabelMap taken;
  imaging::Mask before;
  if (layers.empty()) {
    const auto image = sources.volume(volume.file, own);
    if (!image) return failInScene(image.error(), scene, body.line);
    taken.geometry = (*image)->geometry;
  } else {
    taken.geometry = layers.front().geometry;
  }
  taken.voxels.assign(taken.geometry.voxelCount(), 0);
  before = {taken.geometry, std::vector<std::uint8_t>(taken.voxels.size(), 0)};
  for (const scene::SceneTissue &tissue : volume.tissues)
    for (const scene::SceneLabel &label : tissue.labels)
      for (std::size_t v = 0; v < before.voxels.size(); ++v)
        if (layers[label.layer].voxels[v] == label.value) before.voxels[v] = 1;

  for (scene::SceneTissue &tissue : volume.tissues) {
    if (!tissue.rule) continue;
    const scene::SceneTissueRule &rule = *tissue.rule;
    imaging::Mask mask{before.geometry, std::vector<std::uint8_t>(before.voxels.size(), 1)};
    if (rule.margin_mm > 0.0) {
      auto grown = imaging::grown(before, rule.margin_mm, progress);
      if (!grown) return failInScene(grown.error(), scene, tissue.line);
      mask = std::move(*grown);
    }
    if (rule.threshold) {
      const auto image = rule.image.empty() ? sources.volume(volume.file, own) : sources.volume(rule.image, whole);
      if (!image) return failInScene(image.error(), scene, tissue.line);
      const auto found = between(**image, *rule.threshold, before.geometry, progress);
      if (!found) return failInScene(found.error(), scene, tissue.line);
      for (std::size_t v = 0; v < mask.voxels.size(); ++v) mask.voxels[v] &= found->voxels[v];
    }
    for (std::size_t v = 0; v < mask.voxels.size(); ++v)
      if (before.voxels[v] != 0) mask.voxels[v] = 0;
    if (rule.region) keepWithin(*rule.region, mask);
    const auto value = static_cast<std::uint16_t>(taken.labels.size() + 1);
    std::size_t count = 0;
    for (std::size_t v = 0; v < mask.voxels.size(); ++v)
      if (mask.voxels[v] != 0) {
        taken.voxels[v] = value;
        before.voxels[v] = 1;
        ++count;
      }
    if (count == 0)
      return failInScene(
          {ErrorCode::input, "tissue '" + tissue.label + "' holds no voxel (" + shown(rule) +
                                 "); accepted: a rule that selects voxels not used by labels and earlier tissues"},
          scene, tissue.line);
    taken.labels.push_back({value, tissue.label, imaging::distinctColour(value)});
    tissue.labels = {{layers.size(), value, tissue.label}};
  }
  layers.push_back(std::move(taken));
  volume.ruled = std::make_shared<const std::vector<imaging::LabelMap>>(std::move(layers));
  return {};
}

}  // namespace c3de::session
