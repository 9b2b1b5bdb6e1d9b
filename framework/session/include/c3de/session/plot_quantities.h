// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace c3de::session {

/// A number that a simulator states about its present state.
struct PlotQuantity {
  std::string id;     ///< unique in one report
  std::string label;  ///< for the user
  std::string unit;   ///< empty: a ratio
  double value = 0.0;
  bool isMain = false;  ///< shown by default
};

/// The quantities of a simulator's report (iface.simulator, report()): energies, smallest det F and penetration (mm) of
/// bodies, displacement (mm) and speed (mm/s) of probes, forces (N) of supports, conditions, attachments, probe tools
/// and grasps, load factor, milliseconds of each stage (median of its calls). What is absent or no number is omitted;
/// text that is no report gives none. Any thread.
[[nodiscard]] std::vector<PlotQuantity> plotQuantities(const std::string &report);

}  // namespace c3de::session
