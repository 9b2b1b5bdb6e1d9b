// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app.h"
#include "c3de/session/body_sources.h"
#include "c3de/session/headless_run.h"
#include "c3de/session/session.h"
#include "c3de/session/simulator_access.h"
#include "c3de/session/written_outputs.h"

namespace c3de::app {

/// A scene in a simulator before its first step, for commands that compare a body with measurements.
struct SceneAtRest {
  SimulatorIdentity identity;
  ObjectRef simulator;
  const c3de_simulator_v1 *table = nullptr;
  Prepared prepared;

  /// Facts of a report: those of a run without a step, and the present state.
  [[nodiscard]] RunFacts facts(const HeadlessRun &run, const scene::SceneFile &scene,
                               const std::filesystem::path &source) const;
};

/// Errors: no such simulator; those of buildScene().
[[nodiscard]] Expected<SceneAtRest> buildAtRest(Session &session, const scene::SceneFile &scene, BodySources &sources,
                                                const ProgressFn &progress);

/// Writes a report. Errors: the simulator has none. That the file cannot be written is noted in the outputs.
[[nodiscard]] Expected<void> writeReport(const std::filesystem::path &file, const RunFacts &facts,
                                         const HeadlessRun &run, WrittenOutputs &outputs);

}  // namespace c3de::app
