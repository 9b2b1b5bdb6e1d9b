// SPDX-License-Identifier: Apache-2.0
#include "workstation/tissue_surface_controller.h"

#include <utility>

namespace c3de::app {

void TissueSurfaceController::rebuild(std::shared_ptr<const std::vector<TissueVoxels>> bodies) {
  presenter_.forget();
  job_.cancel();
  if (!bodies) return;
  const auto made = std::make_shared<std::vector<TissueSurface>>();
  job_.start(
      "Surfaces of tissues",
      [bodies = std::move(bodies), made](const ProgressFn &progress) -> Expected<void> {
        auto surfaces = tissueSurfaces(*bodies, progress);
        if (!surfaces) return tl::unexpected(surfaces.error());
        *made = std::move(*surfaces);
        return {};
      },
      [this, made](const Expected<void> &result) {
        if (result) presenter_.show(made, session_.simulationNode());  // otherwise cancelled
      });
}

void TissueSurfaceController::update(TissueTracker &tracker) {
  presenter_.followTree();
  tracker.follow(presenter_.seen());
  presenter_.place(tracker.places());
}

}  // namespace c3de::app
