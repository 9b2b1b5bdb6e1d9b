// SPDX-License-Identifier: Apache-2.0
#include "probe_table.h"

#include <string>

#include "c3de/core/text.h"

namespace c3de::app {
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
  ProbeTable table;
  table.file_ = file;
  table.out_.open(file, std::ios::binary | std::ios::trunc);
  if (!table.out_) return fail(ErrorCode::output, file.string() + ": cannot be written");
  table.out_ << "time [s]";
  for (const ProbeSample &probe : probes) {
    for (const char *axis : {"x", "y", "z"}) table.out_ << ',' << quoted(probe.name + "." + axis + " [m]");
    for (const char *axis : {"vx", "vy", "vz"}) table.out_ << ',' << quoted(probe.name + "." + axis + " [m/s]");
  }
  table.out_ << '\n';
  return table;
}

void ProbeTable::add(double time_s, const std::vector<ProbeSample> &probes) {
  out_ << formatNumber(time_s);
  for (const ProbeSample &probe : probes)
    for (const Vec3 *vec : {&probe.position_m, &probe.velocity_m_s})
      for (const double x : *vec) out_ << ',' << formatNumber(x);
  out_ << '\n';
}

Expected<void> ProbeTable::close() {
  out_.close();
  if (!out_) return fail(ErrorCode::output, file_.string() + ": writing failed; is there space left?");
  return {};
}

}  // namespace c3de::app
