// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "arguments.h"
#include "c3de/registry/edit_list.h"
#include "services/callbacks.h"
#include "services/services.h"

namespace c3de::plugin_host {
namespace {

c3de_status C3DE_CALL add(void *ctx, const c3de_edit *edit, c3de_handle *out) noexcept {
  return serveOnMain(ctx, "history.add", [&](PluginContext &plugin) {
    requireNonNull(out, "out")->v = 0;
    const c3de_edit in = tableOf(edit, "edit");
    registry::Edit made;
    made.owner = plugin.id();
    made.label = labelOf(in.label, "edit label");
    if (made.label.empty()) throw Refusal(C3DE_E_ARG, "edit label is empty");
    auto callback = std::make_shared<EditCallback>(plugin, in);
    made.self = callback.get();
    made.undo = &EditCallback::undo;
    made.redo = &EditCallback::redo;
    made.release = &EditCallback::release;
    plugin.edits[callback.get()] = callback;
    callback->handle = plugin.services().edits->add(std::move(made));
    writeHandle(out, callback->handle);
  });
}

c3de_status C3DE_CALL removeEdit(void *ctx, c3de_handle edit) noexcept {
  return serveOnMain(ctx, "history.remove", [&](PluginContext &plugin) {
    for (const auto &[key, callback] : plugin.edits)
      if (callback->handle == handleOf(edit)) {
        plugin.services().edits->remove(handleOf(edit));
        return;
      }
    throw Refusal(C3DE_E_STALE, fmt::format("plugin {} has no step of handle {}", plugin.id(), textOf(edit)));
  });
}

registry::SimulationSteps &simulationSteps(const PluginContext &plugin) {
  registry::SimulationSteps *steps = plugin.services().edits->simulationSteps();
  if (!steps) throw Refusal(C3DE_E_UNSUPPORTED, "simulations are not captured in this run");
  return *steps;
}

c3de_status C3DE_CALL capture(void *ctx, void *self, void(C3DE_CALL *ready)(void *self, c3de_status status)) noexcept {
  return serveOnMain(ctx, "history.capture", [&](PluginContext &plugin) {
    requireNonNull(ready, "ready");
    registry::SimulationSteps &steps = simulationSteps(plugin);
    const std::uint64_t key = ++plugin.captures->lastKey;
    plugin.captures->waiting[key] = [self, ready](c3de_status status) { ready(self, status); };
    steps.captureBefore([weak = std::weak_ptr(plugin.captures), key, owner = &plugin](std::uint64_t number) {
      const auto captures = weak.lock();
      if (!captures) return;
      const auto waiting = captures->waiting.extract(key);
      if (waiting.empty()) return;  // the plugin was stopped
      captures->begun = number;
      callPlugin(*owner, "ready of a capture", [&] { waiting.mapped()(C3DE_OK); });
    });
  });
}

c3de_status C3DE_CALL addCaptured(void *ctx, c3de_str label) noexcept {
  return serveOnMain(ctx, "history.add_captured", [&](PluginContext &plugin) {
    const std::string text = labelOf(label, "step label");
    if (text.empty()) throw Refusal(C3DE_E_ARG, "step label is empty");
    const std::uint64_t number = std::exchange(plugin.captures->begun, 0);
    if (number == 0) throw Refusal(C3DE_E_STATE, "capture was not called, or its ready is still to come");
    if (!simulationSteps(plugin).addCaptured(number, text))
      throw Refusal(C3DE_E_STATE, "something else has begun since the capture");
  });
}

}  // namespace

c3de_history_v1 makeHistoryTable(PluginContext *plugin) {
  return {sizeof(c3de_history_v1), kHistoryRevision, plugin, &add, &removeEdit, &capture, &addCaptured};
}

}  // namespace c3de::plugin_host
