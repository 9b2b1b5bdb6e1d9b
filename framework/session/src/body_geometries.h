// SPDX-License-Identifier: Apache-2.0
// Private to the session.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "c3de/geometry/mesh_formats.h"
#include "c3de/session/body_sources.h"
#include "fitted_scene.h"

namespace c3de::session {

/// The geometry of the bodies of a scene, from their meshes and volumes. That of a volume, which takes much time and
/// memory, is made when it is taken, but for pieces. Errors begin with the place in the scene.
class BodyGeometries {
 public:
  /// All of it outlives this.
  BodyGeometries(const FittedScene &scene, const geometry::MeshFormats &formats, BodySources &sources)
      : scene_(scene), formats_(formats), sources_(sources), ready_(scene.scene.bodies.size()) {}

  /// Makes what has to be there before the first body is built: all meshes, since what is wrong with the last of them
  /// is not to be heard after minutes of building, and pieces of bodies, since their skins are fitted to each other.
  /// @param progress  asked with a fraction of 0
  [[nodiscard]] Expected<void> prepare(const ProgressFn &progress);

  /// Of one body, once, after prepare().
  [[nodiscard]] Expected<BodyGeometry> take(std::size_t body, const ProgressFn &progress);

 private:
  [[nodiscard]] Expected<BodyGeometry> ofMesh(const scene::SceneBody &body, const ProgressFn &progress) const;
  [[nodiscard]] Expected<BodyGeometry> ofVolume(std::size_t body, const ProgressFn &progress);
  /// The pieces of a body of which this is the first.
  [[nodiscard]] Expected<void> preparePieces(std::size_t first, const ProgressFn &progress);

  const FittedScene &scene_;
  const geometry::MeshFormats &formats_;
  BodySources &sources_;
  std::vector<std::optional<BodyGeometry>> ready_;  ///< per body
};

}  // namespace c3de::session
