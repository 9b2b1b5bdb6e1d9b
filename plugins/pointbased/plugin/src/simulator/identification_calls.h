// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/abi/iface/identification.h"
#include "simulator/changes.h"

namespace pointbased {

/// iface.identification: the stiffness of a body from a measured curve, and sensitivities of its static solution. Any
/// thread; a fit computes with a copy of the body, and the simulation may continue meanwhile.
class IdentificationCalls {
 public:
  explicit IdentificationCalls(SimulatorParts &parts) : parts_(parts) {}

  void fit(const c3de_fit_request *request, const c3de_progress *progress, c3de_fit_result *out, c3de_sink json);
  void sensitivity(const c3de_sensitivity_request *request, const c3de_progress *progress, double *forces,
                   c3de_sink json);

 private:
  SimulatorParts &parts_;
};

}  // namespace pointbased
