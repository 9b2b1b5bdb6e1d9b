// SPDX-License-Identifier: Apache-2.0
#include "workstation/displacement_presenter.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "c3de/core/log.h"

namespace c3de::app {

render::GridGeometry placeOf(const imaging::VolumeGeometry &geometry) { return {geometry.size, geometry.indexToWorld}; }

render::ImageVoxels voxelsOf(const imaging::Volume &volume) {
  static constexpr render::VoxelType kTypes[] = {
      render::VoxelType::int8,  render::VoxelType::uint8,  render::VoxelType::int16,   render::VoxelType::uint16,
      render::VoxelType::int32, render::VoxelType::uint32, render::VoxelType::float32, render::VoxelType::float64};
  render::ImageVoxels voxels;
  voxels.place = placeOf(volume.geometry);
  voxels.type = kTypes[volume.voxels.index()];
  voxels.voxels = std::visit([](const auto &all) { return static_cast<const void *>(all.data()); }, volume.voxels);
  voxels.slope = volume.slope;
  voxels.intercept = volume.intercept;
  voxels.colours = volume.colours.empty() ? nullptr : volume.colours.data();
  return voxels;
}

Expected<void> showMissing(render::ImageRenderer &images, ui::ImageViews &views, const std::vector<Coverage> &bodies) {
  if (!views.image()) return {};
  ui::ImageHandles handles = views.handles();
  images.remove(std::exchange(handles.missing, {}));
  views.setHandles(handles);
  views.setMissingText({});
  std::vector<Coverage> told;
  double asked = 0.0, missing = 0.0;
  for (const Coverage &body : bodies) {
    if (sentenceOf(body).empty()) continue;
    told.push_back(body);
    asked += body.requested_mm3;
    missing += body.missing_mm3;
  }
  imaging::Mask mask = missingOn(views.image()->volume.geometry, told);
  if (mask.voxels.empty()) return {};
  for (std::uint8_t &v : mask.voxels) v = v != 0 ? 255 : 0;
  auto handle = images.addImage({placeOf(mask.geometry), render::VoxelType::uint8, mask.voxels.data()});
  if (!handle) return tl::unexpected(handle.error());
  handles.missing = *handle;
  views.setHandles(handles);
  views.setMissingText(fmt::format("in no body: {:.3g} ml ({:.2g} %)", 1e-3 * missing, 100.0 * missing / asked));
  return {};
}

bool DisplacementPresenter::takesValues(const imaging::DisplacementGrid &displacement) const {
  const imaging::DisplacementGrid *shown = views_.displacement();
  return shown && shown->geometry.size == displacement.geometry.size &&
         shown->geometry.indexToWorld == displacement.geometry.indexToWorld && displacement.bodies == bodies_ &&
         images_->setDisplacement(views_.handles().displacement, displacement.xyz_mm, displacement.gap_mm);
}

void DisplacementPresenter::showBodies(std::shared_ptr<const imaging::Mask> bodies) {
  if (bodies == bodies_) return;
  bodies_ = std::move(bodies);
  ui::ImageHandles handles = views_.handles();
  images_->remove(std::exchange(handles.bodies, {}));
  if (bodies_) {
    std::vector<std::uint8_t> white(bodies_->voxels);
    for (std::uint8_t &v : white)
      v = v == imaging::kBodyVoxel ? 255 : v == imaging::kFixedVoxel ? 64 : v == imaging::kRigidVoxel ? 96 : 0;
    // Without it the image is not moved where bodies have left; that is no reason to show nothing.
    if (auto handle = images_->addImage({placeOf(bodies_->geometry), render::VoxelType::uint8, white.data()}))
      handles.bodies = *handle;
    else
      log(LogLevel::warn, "regions vacated by bodies are not marked: " + handle.error().message);
  }
  views_.setHandles(handles);
}

Expected<void> DisplacementPresenter::show(std::shared_ptr<const imaging::DisplacementGrid> displacement) {
  if (!images_ || !views_.image()) return {};
  Expected<void> shown;
  if (!displacement || !takesValues(*displacement)) {
    showBodies(displacement ? displacement->bodies : nullptr);
    ui::ImageHandles handles = views_.handles();
    images_->remove(std::exchange(handles.displacement, {}));
    if (displacement) {
      auto handle =
          images_->addDisplacement(placeOf(displacement->geometry), displacement->xyz_mm, displacement->gap_mm);
      if (handle)
        handles.displacement = *handle;
      else
        shown = tl::unexpected(handle.error()), displacement = nullptr;
    }
    views_.setHandles(handles);
  }
  views_.setDisplacement(displacement);
  shown_ = std::move(displacement);
  showField();
  return shown;
}

void DisplacementPresenter::showField() {
  if (!images_ || !views_.image()) return;
  const imaging::TissueField *field = views_.shownField();
  const Handle on = field ? views_.handles().displacement : Handle{};
  if (on == fieldOn_ && (!field || (shown_ == fieldOf_ && field->name == fieldName_))) return;
  if (!field) images_->setField(fieldOn_, {});
  if (field && !images_->setField(on, field->values)) log(LogLevel::warn, field->name + " cannot be shown in colours");
  fieldOn_ = on;
  fieldOf_ = field ? shown_ : nullptr;
  fieldName_ = field ? field->name : std::string();
}

void DisplacementPresenter::forget() {
  if (!images_) return;
  ui::ImageHandles handles = views_.handles();
  for (Handle *handle : {&handles.displacement, &handles.bodies}) images_->remove(std::exchange(*handle, {}));
  bodies_.reset();
  shown_.reset();
  fieldOf_.reset();
  fieldOn_ = {};
  views_.setHandles(handles);
  views_.setDisplacement(nullptr);
}

}  // namespace c3de::app
