// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstddef>

#include "arguments.h"
#include "c3de/scene/force_fields.h"
#include "c3de/scene/simulation_directory.h"
#include "last_error.h"
#include "services/services.h"

namespace c3de::plugin_host {
namespace {

c3de_status C3DE_CALL add(void *ctx, c3de_handle simulation, const c3de_force_field *field, c3de_handle *out) noexcept {
  return serve(ctx, "forces.add", [&](PluginContext &plugin) {
    requireNonNull(out, "out")->v = 0;
    const auto given = tableOf(field, "field");
    scene::ForceFields::Field taken;
    taken.name = labelOf(given.name, "field.name");
    taken.owner = plugin.id();
    taken.simulation = handleOf(simulation);
    const scene::SimulationDirectory *simulations = plugin.services().simulations;
    if (simulation.v != 0 && (simulations == nullptr || !simulations->find(taken.simulation)))
      throw Refusal(C3DE_E_ARG, fmt::format("simulation {} is no node of a simulation; accepted: one, or 0 for all",
                                            textOf(simulation)));
    taken.apply = [owner = &plugin, given](const c3de_force_call &call) {
      c3de_status status = C3DE_E_EXCEPTION;
      callPlugin(
          *owner, "apply of a force field", [&] { status = given.apply(given.self, &call); }, CallKind::step);
      return status;
    };
    taken.takeError = [] { return takeLastError(); };
    const Handle added = plugin.services().forces->add(std::move(taken));
    if (added.isNull())
      throw Refusal(C3DE_E_STATE, "a force field cannot be added while one is applied on this thread");
    writeHandle(out, added);
  });
}

c3de_status C3DE_CALL remove(void *ctx, c3de_handle field) noexcept {
  return serve(ctx, "forces.remove", [&](PluginContext &plugin) {
    switch (plugin.services().forces->remove(handleOf(field), plugin.id())) {
      case scene::ForceFields::Removal::done: return;
      case scene::ForceFields::Removal::fromApply:
        throw Refusal(C3DE_E_STATE, "a force field cannot be removed while one is applied on this thread");
      case scene::ForceFields::Removal::stale:
        throw Refusal(C3DE_E_STALE,
                      fmt::format("plugin {} has no force field of handle {}", plugin.id(), textOf(field)));
    }
  });
}

}  // namespace

c3de_forces_v1 makeForcesTable(PluginContext *plugin) {
  return {sizeof(c3de_forces_v1), kServiceRevision, plugin, &add, &remove};
}

}  // namespace c3de::plugin_host
