// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/probe_table.h"

#include "c3de/core/text.h"

namespace c3de::session {
namespace {

/// A heading as CSV wants it when the name holds what CSV means something by.
std::string quoted(const std::string &text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

}  // namespace

Expected<ProbeTable> ProbeTable::create(const std::filesystem::path &file, const std::vector<ProbeSample> &probes) {
  auto rows = OutputRows::open(file);
  if (!rows) return tl::unexpected(rows.error());
  std::string head = "time [s]";
  for (const ProbeSample &probe : probes) {
    for (const char *axis : {"x", "y", "z"}) head += ',' + quoted(probe.name + "." + axis + " [m]");
    for (const char *axis : {"vx", "vy", "vz"}) head += ',' + quoted(probe.name + "." + axis + " [m/s]");
  }
  if (const auto added = rows->add(head + '\n'); !added) return tl::unexpected(added.error());
  return ProbeTable(std::move(*rows));
}

Expected<void> ProbeTable::add(double time_s, const std::vector<ProbeSample> &probes) {
  std::string row = formatNumber(time_s);
  for (const ProbeSample &probe : probes)
    for (const Vec3 *vec : {&probe.position_m, &probe.velocity_m_s})
      for (const double x : *vec) row += ',' + formatNumber(x);
  return rows_.add(row + '\n');
}

}  // namespace c3de::session
