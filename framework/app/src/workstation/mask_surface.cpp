// SPDX-License-Identifier: Apache-2.0
#include "workstation/mask_surface.h"

#include <utility>
#include <vector>

#include "c3de/imaging/surface.h"

namespace c3de::app {
namespace {

constexpr std::size_t kMaxBlocks = 150'000;  // some hundredths of a second, also for the noise of a whole scan

}  // namespace

void MaskSurface::show(std::shared_ptr<const segmentation::MaskPreview> preview, const render::Colour &colour) {
  if (!preview || preview->voxels.empty()) return hide();
  if (preview == preview_) return;
  preview_ = std::move(preview);
  const auto surface = std::make_shared<geometry::TriangleMesh>();
  job_.start(
      "Surface of the mask",
      [preview = preview_, surface](const ProgressFn &progress) -> Expected<void> {
        const imaging::Mask mask{preview->geometry, {preview->voxels.begin(), preview->voxels.end()}};
        auto made = imaging::previewSurfaceOf(mask, kMaxBlocks, progress);
        if (!made) return tl::unexpected(made.error());
        *surface = std::move(*made);
        return {};
      },
      [this, surface, colour](const Expected<void> &result) {
        // `preview_` remains, so that a mask without a surface is not tried again in every frame.
        result ? replace(*surface, colour) : removeMesh();
      });
}

void MaskSurface::replace(const geometry::TriangleMesh &surface, const render::Colour &colour) {
  std::vector<render::Vec3f> positions;
  positions.reserve(surface.vertices.size());
  for (const Vec3 &x : surface.vertices)
    positions.push_back({static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])});
  render::Material material;
  material.colour = {colour[0], colour[1], colour[2], 1.0f};
  material.isInside = true;
  renderer_.destroy(std::exchange(mesh_, renderer_.createMesh(positions, surface.triangles, material)));
  if (session_.sceneGraph().find(node_) == nullptr) node_ = session_.sceneGraph().add({}, "mask");
  followTree();
}

void MaskSurface::hide() {
  if (!preview_ && mesh_.isNull()) return;
  job_.cancel();
  preview_.reset();
  removeMesh();
}

void MaskSurface::removeMesh() {
  renderer_.destroy(std::exchange(mesh_, {}));
  session_.sceneGraph().remove(std::exchange(node_, {}));
}

void MaskSurface::followTree() {
  if (!mesh_.isNull()) renderer_.setVisible(mesh_, session_.sceneGraph().isVisible(node_));
}

}  // namespace c3de::app
