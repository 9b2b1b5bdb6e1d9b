// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/session/body_sources.h"
#include "c3de/session/session.h"

namespace c3de::session {

/// Builds a scene for both `run` and `info`, so that they agree. Reads the image of the simulation with its label maps,
/// then fills the simulator (Session::populate). Errors begin with the location in the scene.
/// @param sources  stores the images that were read
[[nodiscard]] Expected<void> buildScene(Session &session, c3de_object *simulator, const scene::SceneFile &scene,
                                        BodySources &sources, const ProgressFn &progress, Prepared *prepared = nullptr);

/// The part of buildScene() that needs no simulator. Any thread.
[[nodiscard]] Expected<void> readSceneImage(const scene::SceneFile &scene, BodySources &sources,
                                            const ProgressFn &progress);

/// For a run without a window: passes the image of the scene, with its label maps, to plugins (c3de.imaging/1) if one
/// of them requests images. Call after buildScene(). The plugins get copies that last as long as the session.
void lendImage(Session &session, const scene::SceneFile &scene, BodySources &sources);

}  // namespace c3de::session
