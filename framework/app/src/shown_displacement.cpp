// SPDX-License-Identifier: Apache-2.0
#include "shown_displacement.h"

#include <utility>
#include <vector>

#include "c3de/core/log.h"

namespace c3de::app {

render::GridPlace placeOf(const imaging::VolumeGeometry &geometry) { return {geometry.size, geometry.indexToWorld}; }

bool ShownDisplacement::takesValues(const imaging::DisplacementGrid &displacement) const {
  const imaging::DisplacementGrid *shown = views_.displacement();
  return shown && shown->geometry.size == displacement.geometry.size &&
         shown->geometry.indexToWorld == displacement.geometry.indexToWorld && displacement.bodies == bodies_ &&
         images_->setDisplacement(views_.handles().displacement, displacement.xyz_mm, displacement.gap_mm);
}

void ShownDisplacement::showBodies(std::shared_ptr<const imaging::Mask> bodies) {
  if (bodies == bodies_) return;
  bodies_ = std::move(bodies);
  ui::ImageHandles handles = views_.handles();
  images_->remove(std::exchange(handles.bodies, {}));
  if (bodies_) {
    std::vector<std::uint8_t> white(bodies_->voxels);
    for (std::uint8_t &v : white) v = v == imaging::kBodyVoxel ? 255 : v == imaging::kStillVoxel ? 64 : 0;
    // Without it the image stays where bodies have gone away; that is no reason to show nothing.
    if (auto handle = images_->addImage({placeOf(bodies_->geometry), render::VoxelType::uint8, white.data()}))
      handles.bodies = *handle;
    else
      log(LogLevel::warn, "places that bodies have left are not marked: " + handle.error().message);
  }
  views_.setHandles(handles);
}

Expected<void> ShownDisplacement::show(std::shared_ptr<const imaging::DisplacementGrid> displacement) {
  if (!images_ || !views_.image()) return {};
  Expected<void> shown;
  if (!displacement || !takesValues(*displacement)) {
    showBodies(displacement ? displacement->bodies : nullptr);
    ui::ImageHandles handles = views_.handles();
    images_->remove(std::exchange(handles.displacement, {}));
    if (displacement) {
      auto handle = images_->addDisplacement(placeOf(displacement->geometry), displacement->xyz_mm, displacement->gap_mm);
      if (handle)
        handles.displacement = *handle;
      else
        shown = tl::unexpected(handle.error()), displacement = nullptr;
    }
    views_.setHandles(handles);
  }
  views_.setDisplacement(std::move(displacement));
  return shown;
}

void ShownDisplacement::forget() {
  if (!images_) return;
  ui::ImageHandles handles = views_.handles();
  for (Handle *handle : {&handles.displacement, &handles.bodies}) images_->remove(std::exchange(*handle, {}));
  bodies_.reset();
  views_.setHandles(handles);
  views_.setDisplacement(nullptr);
}

}  // namespace c3de::app
