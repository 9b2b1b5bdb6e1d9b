// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/session/body_sources.h"
#include "c3de/session/build_scene.h"
#include "c3de/session/run_beginning.h"
#include "c3de/session/run_options.h"
#include "c3de/session/session.h"
#include "c3de/session/written_outputs.h"

namespace c3de::app {

/// Writes options.exportImage: the scene's image, which has already been read, its labels and the displacement.
[[nodiscard]] Expected<void> writeImageExports(const RunOptions &options, Session &session,
                                               const scene::SceneFile &scene, BodySources &sources,
                                               const Prepared &prepared, const c3de_simulator_v1 *table,
                                               c3de_object *simulator, WrittenOutputs &outputs);

/// Saves the end state, alone or as a session. @param beginning  the session that is continued, if there is one
void saveEnd(const RunOptions &options, Session &session, c3de_object *simulator, const SimulatorIdentity &identity,
             const RunBeginning &beginning, WrittenOutputs &outputs);

}  // namespace c3de::app
