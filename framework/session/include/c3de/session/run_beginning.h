// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "c3de/core/progress.h"
#include "c3de/session/replay.h"
#include "c3de/session/run_options.h"
#include "c3de/session/saved_session.h"
#include "c3de/session/session.h"

namespace c3de::session {

/// What a run begins with.
struct RunBeginning {
  std::optional<SessionFile> saved;  ///< the session that is continued
  std::vector<FoundFile> files{};    ///< of that session
  std::unique_ptr<Replay> replay;    ///< null: not a recording
  SimulationSource source;           ///< the first scene has the values of --set
};

/// Reads the scene, mesh, session or recording of a run. Errors name the file, and for scenes the line.
/// @param progress  of the files of a session
[[nodiscard]] Expected<RunBeginning> readBeginning(const RunOptions &options, Session &session,
                                                   const ProgressFn &progress);

}  // namespace c3de::session
