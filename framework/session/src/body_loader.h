// SPDX-License-Identifier: Apache-2.0
// Private to the session.
#pragma once

#include <cstddef>

#include "body_geometries.h"
#include "c3de/scene/mesh_store.h"
#include "c3de/session/preparation.h"
#include "loading_scene.h"
#include "part_progress.h"

namespace c3de::session {

/// Gives a simulator what of a scene has a skin: its obstacles, then its bodies with all that the scene says of each.
class BodyLoader {
 public:
  /// All of it outlives this.
  /// @param lent  keeps a mesh for the call that it is handed over by
  BodyLoader(const LoadingScene &scene, scene::MeshStore &lent, const geometry::MeshFormats &formats,
             BodySources &sources, const ProgressFn &progress)
      : scene_(scene), lent_(lent), formats_(formats), geometries_(scene.fitted(), formats, sources), sources_(sources),
        progress_(progress) {}

  /// Once. The log is told what readers have to say, what bodies leave out, and which tissues are thinner than the
  /// spacing.
  /// @param prepared  what the bodies took and stand for is added
  /// @returns  what the simulator calls them
  /// Errors begin with the place in the scene.
  [[nodiscard]] Expected<NamedHandles> add(Prepared &prepared);

 private:
  [[nodiscard]] Expected<c3de_handle> addObstacle(std::size_t index, PartProgress &progress) const;
  /// @param rest  of a piece: what is left of the body that it was cut from
  [[nodiscard]] Expected<c3de_handle> addBody(std::size_t index, BodyGeometry geometry, c3de_handle rest,
                                              PartProgress &progress) const;
  void sampleAsRest(c3de_handle rest, double volume_mm3, std::vector<ParameterValue> &values) const;
  void tellThin(c3de_handle added, const scene::SceneBody &body, const std::vector<double> &thickness_mm) const;

  const LoadingScene &scene_;
  scene::MeshStore &lent_;
  const geometry::MeshFormats &formats_;
  BodyGeometries geometries_;
  BodySources &sources_;
  const ProgressFn &progress_;
};

}  // namespace c3de::session
