// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/tissue_voxels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/placement_matrix.h"
#include "c3de/core/text.h"
#include "c3de/imaging/fixed_regions.h"

namespace c3de::session {
namespace {

constexpr std::size_t kMaxSamples = 2000;  // per label

/// The value of the image voxel that contains a point; none outside the image.
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

/// What an image shows at the map's voxels without a label.
struct BackgroundFound {
  std::size_t asked = 0, beyond = 0, notNumbers = 0, within = 0, labelled = 0;
  double least = std::numeric_limits<double>::infinity(), most = -least;

  /// Whether the value is a finite number.
  bool add(const std::optional<double> &value) {
    ++asked;
    if (!value) {
      ++beyond;
      return false;
    }
    if (!std::isfinite(*value)) {
      ++notNumbers;
      return false;
    }
    least = std::min(least, *value);
    most = std::max(most, *value);
    return true;
  }
};

Expected<void> reportBackground(const scene::SceneVolume &volume, const BackgroundFound &found,
                                std::vector<std::string> *notices) {
  const std::string file = volume.background->image.filename().string();
  if (found.asked > 0 && found.beyond == found.asked)
    return fail(ErrorCode::input, "background: " + volume.background->image.string() + " lies beside " +
                                      volume.file.string() +
                                      ": no voxel without a label is within the image; accepted: an image of the same "
                                      "scan, whatever its grid");
  if (notices == nullptr) return {};
  const auto addNotice = [&](const std::string &text) { notices->push_back("Background: " + text + "."); };
  if (found.beyond > 0) {
    const double percent = 100.0 * static_cast<double>(found.beyond) / static_cast<double>(found.asked);
    addNotice(formatNumber(std::max(0.1, std::round(10.0 * percent) / 10.0)) +
              " % of the voxels without a label lie beyond " + file + " and are taken for empty");
  }
  if (found.notNumbers > 0)
    addNotice(std::to_string(found.notNumbers) + " voxels of " + file + " are not finite and are taken for empty");
  if (found.asked > 0 && found.within + found.labelled == 0)
    addNotice("nothing lies between the tissues, as " +
              (found.least > found.most
                   ? "no value"
                   : "no value from " + formatNumber(found.least) + " to " + formatNumber(found.most)) +
              " that " + file + " has there is from " + formatNumber(volume.background->from) + " to " +
              formatNumber(volume.background->to));
  return {};
}

}  // namespace

std::vector<std::uint16_t> tissueNumbers(const scene::SceneVolume &volume, const imaging::LabelMap &map,
                                         std::size_t layer) {
  std::vector<std::uint16_t> numbers(0x10000, 0);
  if (volume.background)
    for (const imaging::LabelMap::Label &label : map.labels)
      numbers[label.value] = static_cast<std::uint16_t>(volume.tissues.size() + 1);
  for (std::size_t i = 0; i < volume.tissues.size(); ++i)
    for (const scene::SceneLabel &label : volume.tissues[i].labels)
      if (label.layer == layer)
        numbers[label.value] = volume.tissues[i].isEmpty ? std::uint16_t{0} : static_cast<std::uint16_t>(i + 1);
  return numbers;
}

Expected<imaging::LabelMap> pickTissues(const scene::SceneVolume &volume, const std::vector<imaging::LabelMap> &layers,
                                        const imaging::Volume *image, const ProgressFn &progress,
                                        std::vector<std::string> *notices) {
  imaging::LabelMap out;
  out.geometry = layers.front().geometry;
  out.voxels.assign(out.geometry.voxelCount(), 0);
  const auto background = static_cast<std::uint16_t>(volume.tissues.size() + 1);
  for (std::size_t layer = 0; layer < layers.size(); ++layer) {
    const imaging::LabelMap &map = layers[layer];
    if (map.voxels.size() != out.voxels.size())
      return fail(ErrorCode::input, volume.file.string() + ": its layers of labels have different grids");
    const std::vector<std::uint16_t> tissueOf = tissueNumbers(volume, map, layer);
    for (std::size_t v = 0; v < map.voxels.size(); ++v) {
      const std::uint16_t tissue = tissueOf[map.voxels[v]];
      if (tissue != 0 && (tissue != background || out.voxels[v] == 0)) out.voxels[v] = tissue;
    }
  }
  if (image != nullptr && volume.background) {
    const ValueAt valueAt(*image);
    BackgroundFound found;
    const auto &size = out.geometry.size;
    std::size_t v = 0;
    for (std::size_t k = 0; k < size[2]; ++k) {
      if (progress && !progress(static_cast<double>(k) / static_cast<double>(size[2]), "finding tissues"))
        return fail(ErrorCode::cancelled, "cancelled");
      for (std::size_t j = 0; j < size[1]; ++j)
        for (std::size_t i = 0; i < size[0]; ++i, ++v) {
          if (out.voxels[v] != 0) {
            found.labelled += out.voxels[v] == background ? 1 : 0;
            continue;
          }
          const auto value =
              valueAt(out.geometry.worldAt({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}));
          if (found.add(value) && *value >= volume.background->from && *value <= volume.background->to) {
            out.voxels[v] = background;
            ++found.within;
          }
        }
    }
    if (auto good = reportBackground(volume, found, notices); !good) return tl::unexpected(good.error());
  }
  return out;
}

std::vector<double> thicknessOf(const imaging::LabelMap &picked, std::size_t tissues) {
  // The voxel faces of a tube along the voxel axes have 4/π times its surface: its diameter is 4 V / A.
  constexpr double kOfSides = 4.0 * 4.0 / 3.14159265358979;
  const auto &n = picked.geometry.size;
  const Mat4 &m = picked.geometry.indexToWorld;
  std::array<Vec3, 3> steps;
  for (std::size_t a = 0; a < 3; ++a) steps[a] = {m[4 * a], m[4 * a + 1], m[4 * a + 2]};
  std::array<std::vector<std::size_t>, 3> sides;
  for (auto &of : sides) of.assign(0x10000, 0);
  std::vector<std::size_t> voxels(0x10000, 0);
  const std::array<std::size_t, 3> stride{1, n[0], n[0] * n[1]};
  std::size_t v = 0;
  for (std::size_t k = 0; k < n[2]; ++k)
    for (std::size_t j = 0; j < n[1]; ++j)
      for (std::size_t i = 0; i < n[0]; ++i, ++v) {
        const std::uint16_t own = picked.voxels[v];
        ++voxels[own];
        const std::array<std::size_t, 3> at{i, j, k};
        for (std::size_t a = 0; a < 3; ++a) {
          if (at[a] == 0) ++sides[a][own];
          const std::uint16_t next = at[a] + 1 < n[a] ? picked.voxels[v + stride[a]] : std::uint16_t{0};
          if (next == own && at[a] + 1 < n[a]) continue;
          ++sides[a][own];
          if (at[a] + 1 < n[a]) ++sides[a][next];
        }
      }
  std::vector<double> out(tissues, 0.0);
  for (std::size_t t = 0; t < tissues; ++t) {
    double area = 0.0;
    for (std::size_t a = 0; a < 3; ++a)
      area += norm(cross(steps[(a + 1) % 3], steps[(a + 2) % 3])) * static_cast<double>(sides[a][t + 1]);
    if (area > 0.0) out[t] = kOfSides * picked.geometry.voxelVolume() * static_cast<double>(voxels[t + 1]) / area;
  }
  return out;
}

TissueVoxels tissuePlaces(const scene::SceneBody &body, const std::vector<imaging::LabelMap> &layers,
                          const imaging::LabelMap &picked) {
  const scene::SceneVolume &volume = body.volume;
  const auto background = static_cast<std::uint16_t>(volume.tissues.size() + 1);
  TissueVoxels out{body.name, volume.tissues, body.placement, picked.geometry.voxelVolume(), {}, {}};
  // Index by layer and value; unlabelled voxels are last.
  std::vector<std::vector<std::size_t>> entryOf(layers.size(), std::vector<std::size_t>(0x10000, 0));
  std::vector<std::vector<std::uint16_t>> numbers;
  for (std::size_t layer = 0; layer < layers.size(); ++layer)
    numbers.push_back(tissueNumbers(volume, layers[layer], layer));
  for (std::uint16_t number = 1; number <= background; ++number)
    for (std::size_t layer = 0; layer < layers.size(); ++layer)
      for (const imaging::LabelMap::Label &label : layers[layer].labels)
        if (numbers[layer][label.value] == number) {
          entryOf[layer][label.value] = out.labels.size();
          out.labels.push_back({label.name, label.value, number - std::size_t{1}, 0, label.colour, {}});
        }
  const std::size_t unlabelled = out.labels.size();
  out.labels.push_back({"", 0, volume.tissues.size(), 0, {}, {}});
  const auto entryAt = [&](std::size_t v) {
    for (std::size_t layer = layers.size(); layer-- > 0;) {
      const std::uint16_t value = layers[layer].voxels[v];
      if (value != 0 && numbers[layer][value] == picked.voxels[v]) return entryOf[layer][value];
    }
    return unlabelled;
  };
  for (std::size_t v = 0; v < picked.voxels.size(); ++v)
    if (picked.voxels[v] != 0) ++out.labels[entryAt(v)].voxels;
  if (out.labels.back().voxels == 0) out.labels.pop_back();
  // An odd step does not stay in one column of the grid.
  std::vector<std::size_t> step, seen(out.labels.size(), 0);
  for (const LabelVoxels &label : out.labels) step.push_back((label.voxels / kMaxSamples) | 1U);
  const auto &size = picked.geometry.size;
  std::size_t v = 0;
  for (std::size_t k = 0; k < size[2]; ++k)
    for (std::size_t j = 0; j < size[1]; ++j)
      for (std::size_t i = 0; i < size[0]; ++i, ++v) {
        if (picked.voxels[v] == 0) continue;
        const std::size_t entry = entryAt(v);
        if (seen[entry]++ % step[entry] != 0) continue;
        out.labels[entry].sample.push_back(
            picked.geometry.worldAt({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}));
      }
  return out;
}

void markTissues(const std::vector<TissueVoxels> &bodies, imaging::Mask &places) {
  for (const TissueVoxels &body : bodies) {
    std::vector<std::uint16_t> rigid;
    for (std::size_t i = 0; i < body.tissues.size(); ++i)
      if (body.tissues[i].isRigid) rigid.push_back(static_cast<std::uint16_t>(i + 1));
    if (!body.map) continue;
    imaging::markTissues(*body.map, matrixOf(body.placement), rigid, places);
  }
}

}  // namespace c3de::session
