// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "app.h"
#include "c3de/session/tissue_tracker.h"
#include "workstation/latest_job.h"
#include "workstation/tissue_presenter.h"

namespace c3de::app {

/// Builds the surfaces of the tissues of bodies in a background job and shows them where the tracker places them. Main
/// thread. The session must outlive it.
class TissueSurfaceController {
 public:
  TissueSurfaceController(Session &session, render::Renderer &renderer)
      : session_(session), presenter_(renderer, session.sceneGraph()), job_(session.jobs()) {}

  /// Replaces the surfaces. The simulation has begun: it is shown without them until they are ready.
  /// @param bodies  null: none
  void rebuild(std::shared_ptr<const std::vector<TissueVoxels>> bodies);
  /// Called before a frame: positions, while the tree shows a surface that moves.
  void update(TissueTracker &tracker);

 private:
  Session &session_;
  TissuePresenter presenter_;
  LatestJob job_;
};

}  // namespace c3de::app
