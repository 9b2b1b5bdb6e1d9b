// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/probe_table.h"

#include "c3de/core/csv.h"
#include "c3de/core/text.h"

namespace c3de::session {
Expected<ProbeTable> ProbeTable::create(const std::filesystem::path &file, const std::vector<ProbeSample> &probes,
                                        const std::vector<ProbeToolSample> &tools) {
  auto rows = OutputRows::open(file);
  if (!rows) return tl::unexpected(rows.error());
  std::string head = "time [s]";
  for (const ProbeSample &probe : probes) {
    for (const char *axis : {"x", "y", "z"}) head += ',' + csvCell(probe.name + "." + axis + " [m]");
    for (const char *axis : {"vx", "vy", "vz"}) head += ',' + csvCell(probe.name + "." + axis + " [m/s]");
  }
  for (const ProbeToolSample &tool : tools) {
    for (const char *axis : {"x", "y", "z"}) head += ',' + csvCell(tool.name + "." + axis + " [m]");
    for (const char *axis : {"Fx", "Fy", "Fz"}) head += ',' + csvCell(tool.name + "." + axis + " [N]");
  }
  if (const auto added = rows->add(head + '\n'); !added) return tl::unexpected(added.error());
  return ProbeTable(std::move(*rows));
}

Expected<void> ProbeTable::add(double time_s, const std::vector<ProbeSample> &probes,
                               const std::vector<ProbeToolSample> &tools) {
  std::string row = formatNumber(time_s);
  for (const ProbeSample &probe : probes)
    for (const Vec3 *vec : {&probe.position_m, &probe.velocity_m_s})
      for (const double x : *vec) row += ',' + formatNumber(x);
  for (const ProbeToolSample &tool : tools)
    for (const Vec3 *vec : {&tool.position_m, &tool.force_N})
      for (const double x : *vec) row += ',' + formatNumber(x);
  return rows_.add(row + '\n');
}

}  // namespace c3de::session
