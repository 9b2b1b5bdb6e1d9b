// SPDX-License-Identifier: Apache-2.0
#include "c3de/core/text.h"
#include "c3de/scene/simulation.h"

#include <fmt/format.h>

#include <cstddef>

#include "arguments.h"
#include "c3de/core/log.h"
#include "c3de/scene/simulation_directory.h"
#include "circuit_breaker.h"
#include "services/services.h"

namespace c3de::plugin_host {
namespace {

std::shared_ptr<scene::Simulation> find(PluginContext &plugin, c3de_handle node) {
  auto found = plugin.services().simulations->find(handleOf(node));
  if (!found) throw Refusal(C3DE_E_NOT_FOUND, fmt::format("the node of handle {} has no simulation", textOf(node)));
  return found;
}

void requireOwnThread(const scene::Simulation &simulation) {
  if (simulation.isSteppedByCaller())
    throw Refusal(C3DE_E_UNSUPPORTED, "a run without a window steps by itself to its end");
}

c3de_status C3DE_CALL transport(void *ctx, c3de_handle node, std::uint32_t action) noexcept {
  return serve(ctx, "simulation.transport", [&](PluginContext &plugin) {
    const auto simulation = find(plugin, node);
    if (action < C3DE_TRANSPORT_PLAY || action > C3DE_TRANSPORT_STEP)
      throw Refusal(C3DE_E_ARG,
                    fmt::format("action is {}, accepted: 1 (play), 2 (pause), 3 (stop), 4 (reset), 5 (step)", action));
    requireOwnThread(*simulation);
    simulation->transport(action);
  });
}

c3de_status C3DE_CALL setTargetRate(void *ctx, c3de_handle node, double rate) noexcept {
  return serve(ctx, "simulation.set_target_rate", [&](PluginContext &plugin) {
    const auto simulation = find(plugin, node);
    if (finiteOf(rate, "rate") < 0.0)
      throw Refusal(C3DE_E_ARG, fmt::format("rate is {}, accepted: 0 (as fast as possible) or above", rate));
    requireOwnThread(*simulation);
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
    simulation->post([owner = &plugin, self, fn] {
      callPlugin(
          *owner, "a command to the simulation", [&] { fn(self); }, CallKind::step);
    });
  });
}

c3de_status C3DE_CALL enumSimulations(void *ctx, void *visitor,
                                      c3de_status(C3DE_CALL *each)(void *, const c3de_simulation_info *)) noexcept {
  c3de_status answer = C3DE_OK;
  const c3de_status served = serve(ctx, "simulation.enum_simulations", [&](PluginContext &plugin) {
    requireNonNull(each, "each");
    for (const scene::SimulationDirectory::Entry &entry : plugin.services().simulations->all()) {
      const c3de_simulation_info info{
          sizeof(c3de_simulation_info), 0, {entry.node.bits()}, toAbi(entry.title), entry.simulation->object()};
      answer = each(visitor, &info);
      if (answer != C3DE_OK) return;
    }
  });
  return served < 0 ? served : answer;
}

/// How a watcher has changed the simulation it may only observe; empty if it has not.
std::string changeOf(PluginContext &plugin, Handle node, const c3de_sim_status &before) {
  const auto simulation = plugin.services().simulations->find(node);
  c3de_sim_status now{};
  now.size = sizeof now;
  if (!simulation || simulation->table()->status(simulation->object(), &now) < 0) return {};
  if (now.bodies < before.bodies)
    return fmt::format("has removed bodies: there were {}, there {} {}", before.bodies, now.bodies == 1 ? "is" : "are",
                       now.bodies);
  // A body added by another thread resets the simulation.
  if (now.bodies == before.bodies && now.steps != before.steps)
    return fmt::format("has changed the state: {} steps were made, now there are {}", before.steps, now.steps);
  return {};
}

c3de_status C3DE_CALL watch(void *ctx, const c3de_simulation_watch *given, c3de_handle *out) noexcept {
  return serveOnMain(ctx, "simulation.watch", [&](PluginContext &plugin) {
    requireNonNull(out, "out")->v = 0;
    const auto taken = structOf(given, "watch");
    scene::SimulationDirectory::Watch watch;
    watch.owner = plugin.id();
    if (taken.added)
      watch.added = [owner = &plugin, taken](Handle node) {
        callPlugin(*owner, "added of a simulation watch", [&] { taken.added(taken.self, {node.bits()}); });
      };
    if (taken.removed)
      watch.removed = [owner = &plugin, taken](Handle node) {
        callPlugin(*owner, "removed of a simulation watch", [&] { taken.removed(taken.self, {node.bits()}); });
      };
    if (taken.stepped)
      watch.stepped = [fuse = std::make_shared<CircuitBreaker>(plugin, "a simulation watch"), taken, owner = &plugin,
                       isReported = std::make_shared<bool>(false)](Handle node, const c3de_sim_status &status) {
        (void)fuse->call(
            "stepped of a simulation watch",
            [&] {
              taken.stepped(taken.self, {node.bits()}, status.steps, status.time_s);
              return C3DE_OK;
            },
            CallKind::step);
        if (*isReported) return;
        const std::string change = changeOf(*owner, node, status);
        if (change.empty()) return;
        *isReported = true;
        log(LogLevel::error, fmt::format("plugin {}: stepped of a simulation watch {}; other states are asked for "
                                         "by transport() of {}",
                                         owner->id(), change, C3DE_SIMULATION_ID));
      };
    writeHandle(out, plugin.services().simulations->watch(std::move(watch)));
  });
}

c3de_status C3DE_CALL unwatch(void *ctx, c3de_handle watch) noexcept {
  return serveOnMain(ctx, "simulation.unwatch", [&](PluginContext &plugin) {
    switch (plugin.services().simulations->unwatch(handleOf(watch), plugin.id())) {
      case scene::SimulationDirectory::Removal::done: return;
      case scene::SimulationDirectory::Removal::fromStepped:
        throw Refusal(C3DE_E_STATE, "a watch cannot be removed from within stepped()");
      case scene::SimulationDirectory::Removal::stale:
        throw Refusal(C3DE_E_STALE,
                      fmt::format("plugin {} has no simulation watch of handle {}", plugin.id(), textOf(watch)));
    }
  });
}

}  // namespace

c3de_simulation_v1 makeSimulationTable(PluginContext *plugin) {
  return {sizeof(c3de_simulation_v1),
          kSimulationRevision,
          plugin,
          &transport,
          &setTargetRate,
          &state,
          &post,
          &enumSimulations,
          &watch,
          &unwatch};
}

}  // namespace c3de::plugin_host
