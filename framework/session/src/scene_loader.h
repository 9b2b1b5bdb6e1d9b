// SPDX-License-Identifier: Apache-2.0
// Private to the session.
#pragma once

#include "c3de/scene/mesh_store.h"
#include "c3de/session/body_sources.h"
#include "loading_scene.h"

namespace c3de::session {

/// Fills a simulator from a scene: settles tissues, checks every value, then adds one thing after the other. Errors
/// begin with the place in the scene. Any thread.
class SceneLoader {
 public:
  /// What a session lends. All of it outlives this.
  struct Services {
    plugin_host::PluginHost &host;
    scene::MeshStore &meshes;
    const geometry::MeshFormats &meshFormats;
    const scene::MaterialLibrary &materials;
  };
  /// @param sources   reads images, and keeps them
  /// @param prepared  what the bodies took and stand for is added
  SceneLoader(const Services &services, c3de_object *simulator, BodySources &sources, Prepared &prepared,
              const ProgressFn &progress)
      : services_(services), simulator_(simulator), sources_(sources), prepared_(prepared), progress_(progress) {}

  /// All of the scene, into an empty simulator.
  [[nodiscard]] Expected<void> populate(const scene::SceneFile &scene);
  /// Its bodies with what the scene says of each; the rest of the simulator stays as it is.
  [[nodiscard]] Expected<void> addBodies(const scene::SceneFile &scene);

 private:
  [[nodiscard]] Expected<LoadingScene> begin(const scene::SceneFile &asked);
  [[nodiscard]] Expected<NamedHandles> addSkins(const LoadingScene &loading);

  Services services_;
  c3de_object *simulator_;
  BodySources &sources_;
  Prepared &prepared_;
  const ProgressFn &progress_;
};

}  // namespace c3de::session
