// SPDX-License-Identifier: Apache-2.0
// Private to the session.
#pragma once

#include "c3de/scene/mesh_store.h"
#include "c3de/session/body_sources.h"
#include "loading/loading_scene.h"

namespace c3de::session {

/// Fills a simulator from a scene: resolves tissues, checks every value, then adds the items one by one. Errors begin
/// with the location in the scene. Any thread.
class SceneLoader {
 public:
  /// Services of a session. All of them outlive this object.
  struct Services {
    plugin_host::PluginHost &host;
    scene::MeshStore &meshes;
    const geometry::MeshFormats &meshFormats;
    const scene::MaterialLibrary &materials;
  };
  /// @param sources   reads and stores images
  /// @param prepared  preparation times and coverage of the bodies are added
  SceneLoader(const Services &services, c3de_object *simulator, BodySources &sources, Prepared &prepared,
              const ProgressFn &progress)
      : services_(services), simulator_(simulator), sources_(sources), prepared_(prepared), progress_(progress) {}

  /// Loads the whole scene into an empty simulator.
  [[nodiscard]] Expected<void> populate(const scene::SceneFile &scene);
  /// Adds the bodies of a scene with their settings; the rest of the simulator stays unchanged.
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
