// SPDX-License-Identifier: Apache-2.0
// Private to the session.
#pragma once

#include <cstddef>

#include "c3de/scene/mesh_store.h"
#include "c3de/session/preparation.h"
#include "loading/body_geometries.h"
#include "loading/loading_scene.h"
#include "loading/part_progress.h"

namespace c3de::session {

/// Adds to a simulator everything in a scene that has a skin: its obstacles, then its bodies with their settings.
class BodyLoader {
 public:
  /// All arguments must outlive this object.
  /// @param lent  stores a mesh during the call that passes it on
  BodyLoader(const LoadingScene &scene, scene::MeshStore &lent, const geometry::MeshFormats &formats,
             BodySources &sources, const ProgressFn &progress)
      : scene_(scene), lent_(lent), formats_(formats), geometries_(scene.fitted(), formats, sources), sources_(sources),
        progress_(progress) {}

  /// Call once. Logs the notices of readers, the parts that bodies leave out, and the tissues thinner than the spacing.
  /// @param prepared  preparation times and coverage of the bodies are added
  /// @returns  the simulator's handles
  /// Errors begin with the location in the scene.
  [[nodiscard]] Expected<NamedHandles> add(Prepared &prepared);

 private:
  [[nodiscard]] Expected<c3de_handle> addObstacle(std::size_t index, PartProgress &progress) const;
  /// @param rest  for a piece: the rest of the body that it was cut from
  [[nodiscard]] Expected<c3de_handle> addBody(std::size_t index, BodyGeometry geometry, c3de_handle rest,
                                              PartProgress &progress) const;
  void sampleAsRest(c3de_handle rest, double volume_mm3, std::vector<ParameterValue> &values) const;
  void reportThinTissue(c3de_handle added, const scene::SceneBody &body, const std::vector<double> &thickness_mm) const;

  const LoadingScene &scene_;
  scene::MeshStore &lent_;
  const geometry::MeshFormats &formats_;
  BodyGeometries geometries_;
  BodySources &sources_;
  const ProgressFn &progress_;
};

}  // namespace c3de::session
