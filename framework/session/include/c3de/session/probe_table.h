// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "c3de/core/output_file.h"
#include "c3de/session/simulator_access.h"

namespace c3de::session {

/// Probes over time as CSV: `time [s],tip.x [m],…,tip.vx [m/s],…`, one row per sample. The file grows row by row and
/// always ends with a complete row. Errors: ErrorCode::output.
class ProbeTable {
 public:
  [[nodiscard]] static Expected<ProbeTable> create(const std::filesystem::path &file,
                                                   const std::vector<ProbeSample> &probes,
                                                   const std::vector<ProbeToolSample> &tools = {});
  [[nodiscard]] Expected<void> add(double time_s, const std::vector<ProbeSample> &probes,
                                   const std::vector<ProbeToolSample> &tools = {});
  [[nodiscard]] Expected<void> close() { return rows_.close(); }

 private:
  explicit ProbeTable(OutputRows rows) : rows_(std::move(rows)) {}
  OutputRows rows_;
};

}  // namespace c3de::session
