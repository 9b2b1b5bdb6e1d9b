// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/abi/iface/continuation.h"
#include "c3de/sdk/ids.hpp"
#include "simulator/external_forces.h"
#include "simulator/surface_conditions.h"

template <>
inline constexpr std::string_view c3de::sdk::kTableId<c3de_continuation_v0>{C3DE_IFACE_CONTINUATION_ID};

namespace pointbased {

/// Continues from the state of another simulation (iface/continuation.h).
class Continuation {
 public:
  Continuation(SimulatedWorld &world, SurfaceConditions &conditions) : world_(world), conditions_(conditions) {}

  void continueFrom(c3de_object *other, c3de_sink json);

 private:
  SimulatedWorld &world_;
  SurfaceConditions &conditions_;
};

}  // namespace pointbased
