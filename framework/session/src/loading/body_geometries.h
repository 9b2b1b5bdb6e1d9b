// SPDX-License-Identifier: Apache-2.0
// Private to the session.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "c3de/geometry/mesh_formats.h"
#include "c3de/session/body_sources.h"
#include "loading/body_geometry.h"
#include "loading/fitted_scene.h"

namespace c3de::session {

/// The geometry of the bodies of a scene, from their meshes and volumes. The geometry of a volume, which needs much
/// time and memory, is built by take(), except for pieces. Errors begin with the location in the scene.
class BodyGeometries {
 public:
  /// All arguments must outlive this object.
  BodyGeometries(const FittedScene &scene, const geometry::MeshFormats &formats, BodySources &sources)
      : scene_(scene), formats_(formats), sources_(sources), ready_(scene.scene.bodies.size()) {}

  /// Builds what is needed before the first body: all meshes, so that an error in the last of them is not reported only
  /// after minutes of building, and pieces of bodies, since their skins are fitted to each other.
  /// @param progress  called with a fraction of 0
  [[nodiscard]] Expected<void> prepare(const ProgressFn &progress);

  /// The geometry of one body, once, after prepare().
  [[nodiscard]] Expected<BodyGeometry> build(std::size_t body, const ProgressFn &progress);

 private:
  [[nodiscard]] Expected<BodyGeometry> ofMesh(const scene::SceneBody &body, const ProgressFn &progress) const;
  [[nodiscard]] Expected<BodyGeometry> ofVolume(std::size_t body, const ProgressFn &progress);
  /// Builds the pieces of the body whose first piece this is.
  [[nodiscard]] Expected<void> preparePieces(std::size_t first, const ProgressFn &progress);

  const FittedScene &scene_;
  const geometry::MeshFormats &formats_;
  BodySources &sources_;
  std::vector<std::optional<BodyGeometry>> ready_;  ///< per body
};

}  // namespace c3de::session
