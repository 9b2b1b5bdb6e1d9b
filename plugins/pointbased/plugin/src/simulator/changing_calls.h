// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulator/changes.h"

namespace pointbased {

/// Calls of iface.simulator that change the simulation, as changes.
class ChangingCalls {
 public:
  explicit ChangingCalls(SimulatorParts &parts) : parts_(parts) {}

  void setWorld(const c3de_param_value *values, std::uint64_t n, std::uint64_t stride);
  void setBodyParameter(c3de_handle body, const c3de_param_value *value);
  void remove(c3de_handle what);
  void clear();
  c3de_status saveState(c3de_sink bytes);
  void addLoad(c3de_handle body, const c3de_sim_load *load, c3de_handle *out);
  void hold(c3de_handle body, const c3de_sim_hold *hold, c3de_handle *out);
  void pull(c3de_handle hold, const double *target_m3, const double *quaternion4);

 private:
  [[nodiscard]] RemoveObject removalOf(std::uint64_t id) const;

  SimulatorParts &parts_;
};

}  // namespace pointbased
