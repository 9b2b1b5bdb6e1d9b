// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/tissues.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "c3de/core/text.h"
#include "c3de/imaging/label_names.h"

namespace c3de::session {
namespace {

constexpr std::size_t kMostNames = 12;

std::string listOf(const std::vector<std::string> &names) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMostNames); ++i) text += (text.empty() ? "" : ", ") + names[i];
  return names.size() > kMostNames ? text + " and " + std::to_string(names.size() - kMostNames) + " more" : text;
}

/// The value of the voxel of an image that a point lies in; nothing beyond it.
class ValueAt {
 public:
  explicit ValueAt(const imaging::Volume &image)
      : image_(image), toIndex_(imaging::affineInverse(image.geometry.indexToWorld)) {}
  [[nodiscard]] std::optional<double> operator()(const Vec3 &world) const {
    const Vec3 index = transformPoint(toIndex_, world);
    std::array<std::size_t, 3> at{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double nearest = std::floor(index[a] + 0.5);
      if (!(nearest >= 0.0) || nearest >= static_cast<double>(image_.geometry.size[a])) return std::nullopt;
      at[a] = static_cast<std::size_t>(nearest);
    }
    return image_.value(at[0], at[1], at[2]);
  }

 private:
  const imaging::Volume &image_;
  Mat4 toIndex_;
};

}  // namespace

Expected<PickedTissues> pickTissues(const scene::SceneVolume &volume, const std::vector<imaging::LabelMap> &layers,
                                    const imaging::Volume *image, const ProgressFn &progress) {
  PickedTissues out;
  out.voxels.geometry = layers.front().geometry;
  out.voxels.voxels.assign(out.voxels.geometry.voxelCount(), 0);
  out.background = static_cast<std::uint16_t>(volume.tissues.size() + 1);
  std::vector<std::uint8_t> isNamed(volume.tissues.size(), 0);
  std::vector<std::string> names, unnamed;
  for (const imaging::LabelMap &map : layers) {
    std::vector<std::uint16_t> tissueOf(0x10000, 0);  // [labels]
    for (const imaging::LabelMap::Label &label : map.labels) {
      names.push_back(label.name);
      const auto found = std::find_if(volume.tissues.begin(), volume.tissues.end(), [&](const scene::SceneTissue &one) {
        return imaging::isMeant(one.label, label);
      });
      if (found == volume.tissues.end()) {
        unnamed.push_back(label.name);
        tissueOf[label.value] = volume.background ? out.background : std::uint16_t{0};
        continue;
      }
      const auto number = static_cast<std::size_t>(found - volume.tissues.begin());
      isNamed[number] = 1;
      tissueOf[label.value] = static_cast<std::uint16_t>(number + 1);
    }
    if (map.voxels.size() != out.voxels.voxels.size())
      return fail(ErrorCode::input, volume.file.string() + ": its layers of labels have different grids");
    for (std::size_t v = 0; v < map.voxels.size(); ++v) {
      const std::uint16_t tissue = tissueOf[map.voxels[v]];
      if (tissue != 0 && (tissue != out.background || out.voxels.voxels[v] == 0)) out.voxels.voxels[v] = tissue;
    }
  }
  for (std::size_t i = 0; i < isNamed.size(); ++i) {
    if (isNamed[i] != 0) continue;
    const std::string nearest = nearestName(volume.tissues[i].label, names);
    return fail(ErrorCode::input, volume.file.string() + " has no label '" + volume.tissues[i].label + "'; " +
                                      (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") +
                                      "there are: " + (names.empty() ? "none" : listOf(names)));
  }
  if (!unnamed.empty())
    out.notices.push_back(
        std::to_string(unnamed.size()) + (unnamed.size() == 1 ? " label is" : " labels are") + " of no tissue and " +
        (volume.background ? "taken for background" : "left out, as there is no background") + ": " + listOf(unnamed));
  if (image != nullptr && volume.background) {
    const ValueAt valueAt(*image);
    const auto &size = out.voxels.geometry.size;
    std::size_t v = 0;
    for (std::size_t k = 0; k < size[2]; ++k) {
      if (progress && !progress(static_cast<double>(k) / static_cast<double>(size[2]), "finding tissues"))
        return fail(ErrorCode::cancelled, "cancelled");
      for (std::size_t j = 0; j < size[1]; ++j)
        for (std::size_t i = 0; i < size[0]; ++i, ++v) {
          if (out.voxels.voxels[v] != 0) continue;
          const auto value = valueAt(
              out.voxels.geometry.worldAt({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}));
          if (value && *value >= volume.background->from && *value <= volume.background->to)
            out.voxels.voxels[v] = out.background;
        }
    }
  }
  return out;
}

}  // namespace c3de::session
