// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/abi/iface/simulator.h"

namespace c3de::test {

/// Makes unused slots of a stand-in that may not be null return C3DE_E_UNSUPPORTED.
template <class... A>
void serveNot(c3de_status(C3DE_CALL *&slot)(A...)) {
  if (!slot) slot = [](A...) -> c3de_status { return C3DE_E_UNSUPPORTED; };
}
template <class... Slots>
void serveNot(Slots &...slots) {
  (serveNot(slots), ...);
}

inline void serveNoMore(c3de_simulator_v1 &t) {
  serveNot(t.attach, t.declarations, t.set_world, t.add_body, t.add_obstacle, t.add_probe, t.set_body_param,
           t.get_body_param, t.remove, t.clear, t.step, t.reset, t.publish, t.status, t.state_hash, t.report, t.body_at,
           t.body_info, t.enum_fields, t.read_field, t.triangles, t.enum_probes);
}

}  // namespace c3de::test
