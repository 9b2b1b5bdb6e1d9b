// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/session/body_sources.h"
#include "c3de/session/session.h"

namespace c3de::session {

/// What `run` and `info` ask about a scene, so that both give the same answer: reads the image beside the simulation
/// with its label maps, then fills the simulator (Session::populate). Errors begin with the place in the scene.
/// @param sources  keeps the images that were read
[[nodiscard]] Expected<void> buildScene(Session &session, c3de_object *simulator, const scene::SceneFile &scene,
                                        BodySources &sources, const ProgressFn &progress, Prepared *prepared = nullptr);

/// The part of it that needs no simulator. Any thread.
[[nodiscard]] Expected<void> readSceneImage(const scene::SceneFile &scene, BodySources &sources,
                                            const ProgressFn &progress);

/// In a run without a window: hands the image of the scene, with its label maps, to plugins (c3de.imaging/1) where
/// one of them asks for images; after buildScene(). They are copies, for as long as the session.
void lendImage(Session &session, const scene::SceneFile &scene, BodySources &sources);

}  // namespace c3de::session
