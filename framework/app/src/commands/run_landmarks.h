// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "c3de/session/headless_run.h"
#include "c3de/session/measurements.h"
#include "c3de/session/run_options.h"
#include "c3de/session/session.h"
#include "c3de/session/written_outputs.h"

namespace c3de::app {

/// Landmarks of the scene and of the files of the command. Also refuses an export without landmarks, or to a file whose
/// extension is not one of landmarks.
[[nodiscard]] Expected<std::vector<Landmark>> readRunLandmarks(const RunOptions &options,
                                                               const scene::SceneFile &scene);

/// Why material points cannot be followed to the end of a run: the present shape of a body has become its reference.
/// Empty: they can.
[[nodiscard]] Expected<std::string> lostPoints(const HeadlessRun &run);

/// Measures at the end of a run and writes the landmarks, where requested. A body that has lost its material points is
/// reported, and nothing is measured.
[[nodiscard]] Measurements measureEnd(const RunOptions &options, const std::vector<Landmark> &landmarks,
                                      const scene::SceneFile &scene, Session &session, c3de_object *simulator,
                                      const HeadlessRun &run, WrittenOutputs &outputs);

}  // namespace c3de::app
