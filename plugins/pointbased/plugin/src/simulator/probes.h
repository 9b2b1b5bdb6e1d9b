// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulator/simulated_world.h"

namespace pointbased {

/// Material points of bodies whose motion is reported.
class Probes {
 public:
  using Each = c3de_status(C3DE_CALL *)(void *visitor, const c3de_sim_probe *probe);

  explicit Probes(SimulatedWorld &world) : world_(world) {}

  void add(c3de_str name, c3de_handle body, const double *at_m3, c3de_handle *out);
  c3de_status enumerate(void *visitor, Each each);

 private:
  SimulatedWorld &world_;
  Simulator &simulator_ = world_.simulator;
  BodyTable &table_ = world_.table;
};

}  // namespace pointbased
