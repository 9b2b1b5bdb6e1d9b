// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/imaging/painting.h"
#include "c3de/scene/image_store.h"

namespace c3de::segmentation {

/// Inputs for masks. Null members are not available.
struct MaskSources {
  std::shared_ptr<const scene::StoredImage> image;
  std::shared_ptr<const scene::StoredLabels> labels;
};

/// One user action while picking an organ.
struct MaskStep {
  enum class Kind {
    label,
    labels,
    threshold,
    restored,
    component,
    largest,
    fillHoles,
    close,
    open,
    paint,
    grow,
    fillBetween
  };
  Kind kind = Kind::threshold;
  std::uint16_t label = 0;              ///< label: its value
  std::vector<std::uint16_t> labels{};  ///< labels: several, or none; no mask is made of them. restored: picked ones
  double low = 0.0, high = 0.0;         ///< threshold, restored: values of the image
  Vec3 world{};                         ///< component, grow: a point in it, LPS mm
  double radius_mm = 0.0;               ///< close, open; grow: farthest distance from `world`, 0: unlimited
  double tolerance = 0.0;               ///< grow: of image values
  imaging::BrushStroke stroke{};        ///< paint; fillBetween: only its normal
  bool isRest = false;                  ///< what remains selected after bodies were created

  /// Whether the step ignores the previous mask.
  [[nodiscard]] bool ignoresPreviousMask() const {
    return kind == Kind::label || kind == Kind::labels || kind == Kind::threshold || kind == Kind::restored;
  }
  /// Display text: "threshold 150 … 900".
  [[nodiscard]] std::string text() const;
};

/// The mask after a step, on the grid of the label map or the image. Any thread.
/// @param before  null: no mask yet
/// Errors (ErrorCode::usage) are sentences for the panel: no mask yet, a point outside the mask, those of the mask
/// functions; cancelled.
[[nodiscard]] Expected<imaging::Mask> carriedOut(const MaskStep &step, const MaskSources &sources,
                                                 const imaging::Mask *before, const ProgressFn &progress = {});

/// A mask as a label map for display over slices: 1 inside, cropped to the bounding box of the mask.
struct MaskPreview {
  imaging::VolumeGeometry geometry;
  std::vector<std::uint16_t> voxels;
  std::size_t stride = 1;  ///< every voxel, every second (third, …) in each direction
};
/// Without voxels for an empty mask.
[[nodiscard]] MaskPreview previewOf(const imaging::Mask &mask, std::size_t mostVoxels);

/// A mask for storage in the history: run lengths, or one bit per voxel where that is smaller.
class PackedMask {
 public:
  explicit PackedMask(const imaging::Mask &mask);
  [[nodiscard]] imaging::Mask mask() const;
  [[nodiscard]] std::size_t bytes() const { return sizeof(*this) + 4 * runs_.capacity() + bits_.capacity(); }

 private:
  imaging::VolumeGeometry geometry_;
  std::vector<std::uint32_t> runs_;  ///< lengths, of voxels outside and inside by turns
  std::vector<std::uint8_t> bits_;   ///< if there are no runs
};

}  // namespace c3de::segmentation
