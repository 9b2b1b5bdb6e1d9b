// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/imaging/volume.h"

/// What contradicts a body that is to be made of all labels of a map, before it is made. Grey values are looked at where
/// the image is computed tomography (imaging::looksLikeHounsfield()).
namespace c3de::segmentation {

/// What a label is in the body.
enum class LabelRole {
  background,  ///< of none of its tissues
  empty,       ///< air
  rigid,
  soft
};

struct LabelCheck {
  std::vector<const imaging::LabelMap *> layers;
  std::vector<std::vector<LabelRole>> roles;  ///< of each layer's labels, in the order of LabelMap::labels
  const imaging::Volume *image = nullptr;
  struct Background {
    double from = 0.0, to = 0.0;  ///< values of the image that belong to it
    std::string material;
  };
  std::optional<Background> background;
  /// On the grid of the labels: 1 where the body may be. Null: everywhere, and the map is expected to cover the image.
  const imaging::Mask *region = nullptr;
};

struct LabelFinding {
  enum class Kind {
    coverage,  ///< the map ends within the image
    rigid,     ///< rigid labels whose values are no bone
    contrast,  ///< contrast agent above the background: holes
    bone       ///< bone without a label: holes, or background
  };
  Kind kind = Kind::coverage;
  std::string text;          ///< what is wrong and how much, a sentence
  std::string advice;        ///< what helps, in words of a scene file
  std::optional<double> to;  ///< an upper limit of the background that helps; none: another one does not
};

/// Thresholds. Each is checked by a test with values on both sides of it.
inline constexpr double kLeastCoverage =
    0.9;  ///< of the image: a map on its own grid leaves a voxel at each border out
inline constexpr double kSpongyBone_HU = 100.0;      ///< median of spongy bone, at least; soft tissue shows less
inline constexpr double kCorticalBone_HU = 200.0;    ///< reached by a tenth of a bone's voxels, its cortex
inline constexpr double kUnlabelledBone_HU = 150.0;  ///< above soft tissue and its partial volume with contrast agent
inline constexpr double kLeastContrast_ml = 1.0;     ///< a cube of 10 mm, the size of a usual cell
inline constexpr double kLeastBone_ml = 5.0;         ///< about the smallest rib; calcifications have less

/// Errors: layers of different grids (input), cancelled. Any thread.
[[nodiscard]] Expected<std::vector<LabelFinding>> checkLabels(const LabelCheck &check, const ProgressFn &progress = {});

}  // namespace c3de::segmentation
