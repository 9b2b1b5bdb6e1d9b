// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "report/report.h"
#include "simulator/simulated_world.h"

namespace pointbased {

/// Contact settings of pairs, and probe tools with the forces on them: iface.contact.
class Contacts {
 public:
  using Each = c3de_status(C3DE_CALL *)(void *visitor, const c3de_sim_probe_tool_state *state);

  explicit Contacts(SimulatedWorld &world) : world_(world) {}

  void setPair(const c3de_sim_contact_pair *pair);
  void addProbeTool(const c3de_sim_probe_tool *tool, c3de_handle *out);
  c3de_status enumProbeTools(void *visitor, Each each);
  /// The mutex of the world is held.
  [[nodiscard]] std::vector<ReportedTool> reported() const;

 private:
  [[nodiscard]] std::vector<std::string> warningsOf(const ProbeTool &tool) const;

  SimulatedWorld &world_;
  Simulator &simulator_ = world_.simulator;
  BodyTable &table_ = world_.table;
};

}  // namespace pointbased
