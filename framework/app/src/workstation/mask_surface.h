// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "app.h"
#include "c3de/core/handle.h"
#include "c3de/render/renderer.h"
#include "c3de/segmentation/mask_steps.h"
#include "c3de/session/session.h"
#include "workstation/latest_job.h"

namespace c3de::app {

/// The surface of what is picked or painted, in the 3D view. It is computed in a background job; of several requests the
/// latest is shown, and the former surface stays until then. Main thread. The renderer must outlive it; the session may
/// end first.
class MaskSurface {
 public:
  MaskSurface(Session &session, render::Renderer &renderer)
      : session_(session), renderer_(renderer), job_(session.jobs()) {}
  ~MaskSurface() { renderer_.destroy(mesh_); }
  MaskSurface(const MaskSurface &) = delete;
  MaskSurface &operator=(const MaskSurface &) = delete;

  /// @param preview  null or without voxels: nothing is shown
  void show(std::shared_ptr<const segmentation::MaskPreview> preview, const render::Colour &colour);
  void hide();
  /// Called before a frame: applies the visibility of the node in the tree.
  void followTree();

 private:
  void replace(const geometry::TriangleMesh &surface, const render::Colour &colour);
  void removeMesh();

  Session &session_;
  render::Renderer &renderer_;
  LatestJob job_;
  std::shared_ptr<const segmentation::MaskPreview> preview_;  ///< the requested one
  Handle mesh_, node_;
};

}  // namespace c3de::app
