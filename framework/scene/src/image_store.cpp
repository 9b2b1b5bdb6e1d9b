// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/image_store.h"

#include <cmath>
#include <utility>

namespace c3de::scene {

std::uint16_t StoredLabels::at(const Vec3 &world) const {
  const imaging::VolumeGeometry &g = map.geometry;
  const Vec3 index = transformPoint(imaging::affineInverse(g.indexToWorld), world);
  std::array<std::size_t, 3> nearest{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double rounded = std::floor(index[a] + 0.5);
    if (!(rounded >= 0.0) || !(rounded < static_cast<double>(g.size[a]))) return 0;
    nearest[a] = static_cast<std::size_t>(rounded);
  }
  return map.voxels[nearest[0] + g.size[0] * (nearest[1] + g.size[1] * nearest[2])];
}

std::string StoredLabels::nameOf(std::uint16_t value) const {
  for (const imaging::LabelMap::Label &label : map.labels)
    if (label.value == value) return label.name;
  return {};
}

Handle ImageStore::add(std::shared_ptr<const StoredImage> image) {
  const std::lock_guard lock(mutex_);
  return images_.add(std::move(image));
}

Handle ImageStore::add(std::shared_ptr<const StoredLabels> labels) {
  const std::lock_guard lock(mutex_);
  return labels_.add(std::move(labels));
}

bool ImageStore::removeImage(Handle image) {
  const std::lock_guard lock(mutex_);
  return images_.remove(image);
}

bool ImageStore::removeLabels(Handle labels) {
  const std::lock_guard lock(mutex_);
  return labels_.remove(labels);
}

std::shared_ptr<const StoredImage> ImageStore::image(Handle image) const {
  const std::lock_guard lock(mutex_);
  const auto *found = images_.find(image);
  return found ? *found : nullptr;
}

std::shared_ptr<const StoredLabels> ImageStore::labels(Handle labels) const {
  const std::lock_guard lock(mutex_);
  const auto *found = labels_.find(labels);
  return found ? *found : nullptr;
}

std::vector<Handle> ImageStore::allImages() const {
  const std::lock_guard lock(mutex_);
  std::vector<Handle> out;
  images_.forEach([&](Handle handle, const auto &) { out.push_back(handle); });
  return out;
}

std::vector<Handle> ImageStore::allLabels() const {
  const std::lock_guard lock(mutex_);
  std::vector<Handle> out;
  labels_.forEach([&](Handle handle, const auto &) { out.push_back(handle); });
  return out;
}

}  // namespace c3de::scene
