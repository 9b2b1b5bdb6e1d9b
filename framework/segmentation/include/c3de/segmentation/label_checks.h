// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/imaging/volume.h"

/// Finds contradictions in the input before a body is built from all labels of a map. Grey values are examined if the
/// image is computed tomography (imaging::isLikelyHounsfield()).
namespace c3de::segmentation {

/// The role of a label in the body.
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
    double from = 0.0, to = 0.0;  ///< image values that belong to it
    std::string material;
  };
  std::optional<Background> background;
  /// On the grid of the labels: 1 where the body may be. Null: everywhere; the map is then expected to cover the image.
  const imaging::Mask *region = nullptr;
};

struct LabelFinding {
  enum class Kind {
    coverage,  ///< the map ends within the image
    rigid,     ///< rigid labels with values other than those of bone
    contrast,  ///< contrast agent above the background's range: holes
    bone       ///< bone without a label: holes, or background
  };
  Kind kind = Kind::coverage;
  std::string text;          ///< the finding with its extent, a sentence
  std::string advice;        ///< the remedy, in terms of a scene file
  std::optional<double> to;  ///< an upper limit of the background that helps; none: no limit helps
};

/// Thresholds. A test checks each with values on both sides of it.
inline constexpr double kMinCoverage = 0.9;  ///< of the image: a map on its own grid may omit a voxel at each border
inline constexpr double kSpongyBone_HU = 100.0;      ///< minimum median of spongy bone; soft tissue has less
inline constexpr double kCorticalBone_HU = 200.0;    ///< reached by a tenth of a bone's voxels, its cortex
inline constexpr double kUnlabelledBone_HU = 150.0;  ///< above soft tissue and its partial volume with contrast agent
inline constexpr double kMinContrast_ml = 1.0;       ///< a cube of 10 mm, the size of a typical cell
inline constexpr double kMinBone_ml = 5.0;           ///< about the smallest rib; calcifications are smaller

/// Errors: layers of different grids (input), cancelled. Any thread.
[[nodiscard]] Expected<std::vector<LabelFinding>> checkLabels(const LabelCheck &check, const ProgressFn &progress = {});

}  // namespace c3de::segmentation
