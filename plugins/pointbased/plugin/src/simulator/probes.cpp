// SPDX-License-Identifier: Apache-2.0
#include "simulator/probes.h"

#include "c3de/sdk/structs.hpp"

namespace pointbased {

using sdk::Error;

void Probes::add(c3de_str name, c3de_handle body, const double *at_m3, c3de_handle *out) {
  const std::lock_guard lock(world_.mutex);
  const BodyRecord &record = table_.bodyOrThrow(body.v);
  (void)sdk::notNull(at_m3, "at_m3");
  const Vec3 at(at_m3[0], at_m3[1], at_m3[2]);
  const std::string which = "probe '" + std::string(sdk::text(name)) + "': ";
  if (!at.allFinite()) throw Error(C3DE_E_ARG, which + "the point is not finite");
  // A probe is carried by the cell that contains it. Off the skin it is carried by the cell of the skin, whose
  // functions are extrapolated. Within half a spacing these are as accurate as the sampling; farther off they represent
  // no tissue.
  record.checkNearBody(world_.context.services, at, simulator_.body(body.v)->rest().spacing, which);
  for (const Probe &other : simulator_.world().probes())
    if (other.name == sdk::text(name)) throw Error(C3DE_E_EXISTS, which + "there is one of this name already");
  const std::size_t id = simulator_.world().addProbe(std::string(sdk::text(name)), body.v, at);
  if (out) *out = {id};
}

c3de_status Probes::enumerate(void *visitor, Each each) {
  if (!each) throw Error(C3DE_E_ARG, "each is null");
  const std::lock_guard lock(world_.mutex);
  for (const Probe &probe : simulator_.world().probes()) {
    const World::ProbeState state = simulator_.world().probeState(probe);
    c3de_sim_probe out{};
    out.size = sizeof out;
    out.name = sdk::str(probe.name);
    out.body = {probe.body};
    for (int a = 0; a < 3; ++a) {
      out.reference_m[a] = probe.reference[a];
      out.position_m[a] = state.position[a];
      out.velocity_m_s[a] = state.velocity[a];
    }
    if (const c3de_status status = each(visitor, &out); status != C3DE_OK) return status;
  }
  return C3DE_OK;
}

}  // namespace pointbased
