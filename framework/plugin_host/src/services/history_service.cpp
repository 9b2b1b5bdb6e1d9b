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

}  // namespace

c3de_history_v1 makeHistoryTable(PluginContext *plugin) {
  return {sizeof(c3de_history_v1), kServiceRevision, plugin, &add, &removeEdit};
}

}  // namespace c3de::plugin_host
