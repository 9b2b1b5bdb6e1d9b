// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "c3de/core/handle.h"
#include "c3de/imaging/statistics.h"
#include "c3de/imaging/volume.h"

namespace c3de::scene {

/// An image with its display name and the type of its values.
struct StoredImage {
  std::string name;
  imaging::Volume volume;
  imaging::ValueRange range;
  std::vector<std::uint64_t> histogram{};  ///< equal intervals from range.min to range.max; empty: not computed
  std::size_t time = 0, times = 1;         ///< index and number of time points
};

struct StoredLabels {
  std::string name;
  imaging::LabelMap map;
  /// The label at a point in world space (nearest voxel); 0 outside. Any thread.
  [[nodiscard]] std::uint16_t at(const Vec3 &world) const;
  /// Empty for a label that does not occur.
  [[nodiscard]] std::string nameOf(std::uint16_t value) const;
};

/// Images and label maps by handle, shared by the scene and plugins. Any thread; stored items are immutable.
class ImageStore {
 public:
  Handle add(std::shared_ptr<const StoredImage> image);
  Handle add(std::shared_ptr<const StoredLabels> labels);
  bool removeImage(Handle image);
  bool removeLabels(Handle labels);
  [[nodiscard]] std::shared_ptr<const StoredImage> image(Handle image) const;
  [[nodiscard]] std::shared_ptr<const StoredLabels> labels(Handle labels) const;
  /// Handles of all stored items, always in the same order.
  [[nodiscard]] std::vector<Handle> allImages() const;
  [[nodiscard]] std::vector<Handle> allLabels() const;

 private:
  mutable std::mutex mutex_;
  HandleTable<std::shared_ptr<const StoredImage>, HandleKind::image> images_;
  HandleTable<std::shared_ptr<const StoredLabels>, HandleKind::labelMap> labels_;
};

}  // namespace c3de::scene
