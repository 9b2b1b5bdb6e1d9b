// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <vector>

#include "c3de/core/expected.h"
#include "report.h"

namespace c3de::app {

/// Probes over time as CSV: `time [s],tip.x [m],…,tip.vx [m/s],…`, one row per sample.
class ProbeTable {
 public:
  [[nodiscard]] static Expected<ProbeTable> create(const std::filesystem::path &file,
                                                   const std::vector<ProbeSample> &probes);
  void add(double time_s, const std::vector<ProbeSample> &probes);
  /// Error (ErrorCode::output) when not everything could be written.
  [[nodiscard]] Expected<void> close();

 private:
  std::filesystem::path file_;
  std::ofstream out_;
};

}  // namespace c3de::app
