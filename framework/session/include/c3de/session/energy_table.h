// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "c3de/core/output_file.h"

namespace c3de::session {

/// Energies summed over all bodies over time as CSV: `time [s],elastic [J],gravity [J],…`, one row per sample, with the
/// energies of the first sample. The file grows row by row and always ends with a complete row. Errors:
/// ErrorCode::output; ErrorCode::plugin, where a simulator reports no energies.
class EnergyTable {
 public:
  /// @param simulatorJson  the simulator's report
  [[nodiscard]] static Expected<EnergyTable> create(const std::filesystem::path &file,
                                                    const std::string &simulatorJson);
  [[nodiscard]] Expected<void> add(double time_s, const std::string &simulatorJson);
  [[nodiscard]] Expected<void> close() { return rows_.close(); }

 private:
  EnergyTable(OutputRows rows, std::vector<std::string> names) : rows_(std::move(rows)), names_(std::move(names)) {}
  OutputRows rows_;
  std::vector<std::string> names_;
};

/// Energies of a simulator's report, by name, summed over the bodies.
[[nodiscard]] Expected<std::map<std::string, double>> energiesOf(const std::string &simulatorJson);

}  // namespace c3de::session
