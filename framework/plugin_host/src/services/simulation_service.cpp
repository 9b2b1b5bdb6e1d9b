// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/simulation.h"

#include <fmt/format.h>

#include <cstddef>

#include "arguments.h"
#include "c3de/scene/simulation_directory.h"
#include "services/services.h"

namespace c3de::plugin_host {
namespace {

std::shared_ptr<scene::Simulation> find(PluginContext &plugin, c3de_handle node) {
  auto found = plugin.services().simulations->find(handleOf(node));
  if (!found)
    throw Refusal(C3DE_E_NOT_FOUND, fmt::format("no simulation stands behind the node of handle {}", textOf(node)));
  return found;
}

c3de_status C3DE_CALL transport(void *ctx, c3de_handle node, std::uint32_t action) noexcept {
  return serve(ctx, "simulation.transport", [&](PluginContext &plugin) {
    const auto simulation = find(plugin, node);
    if (action < C3DE_TRANSPORT_PLAY || action > C3DE_TRANSPORT_STEP)
      throw Refusal(C3DE_E_ARG,
                    fmt::format("action is {}, accepted: 1 (play), 2 (pause), 3 (stop), 4 (reset), 5 (step)", action));
    simulation->transport(action);
  });
}

c3de_status C3DE_CALL setTargetRate(void *ctx, c3de_handle node, double rate) noexcept {
  return serve(ctx, "simulation.set_target_rate", [&](PluginContext &plugin) {
    const auto simulation = find(plugin, node);
    if (finiteOf(rate, "rate") < 0.0)
      throw Refusal(C3DE_E_ARG, fmt::format("rate is {}, accepted: 0 (as fast as it goes) or above", rate));
    simulation->setTargetRate(rate);
  });
}

c3de_status C3DE_CALL state(void *ctx, c3de_handle node, c3de_sim_transport *out) noexcept {
  return serve(ctx, "simulation.state",
               [&](PluginContext &plugin) { writeStruct(out, find(plugin, node)->state(), "out"); });
}

c3de_status C3DE_CALL post(void *ctx, c3de_handle node, void *self, void(C3DE_CALL *fn)(void *self)) noexcept {
  return serve(ctx, "simulation.post", [&](PluginContext &plugin) {
    const auto simulation = find(plugin, node);
    requireNonNull(fn, "fn");
    simulation->post(
        [owner = &plugin, self, fn] { callPlugin(*owner, "a command to the simulation", [&] { fn(self); }); });
  });
}

}  // namespace

c3de_simulation_v0 makeSimulationTable(PluginContext *plugin) {
  return {sizeof(c3de_simulation_v0), kServiceRevision, plugin, &transport, &setTargetRate, &state, &post};
}

}  // namespace c3de::plugin_host
