// SPDX-License-Identifier: Apache-2.0
#include "plugin_context.h"

#include <fmt/format.h>

#include "arguments.h"
#include "c3de/core/background_jobs.h"
#include "c3de/core/log.h"
#include "c3de/core/main_queue.h"
#include "c3de/core/text.h"
#include "c3de/geometry/mesh_formats.h"
#include "c3de/registry/command_registry.h"
#include "c3de/registry/edit_list.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/registry/parameter_registry.h"
#include "c3de/registry/tool_registry.h"
#include "c3de/scene/force_fields.h"
#include "c3de/scene/mesh_store.h"
#include "c3de/scene/scene_graph.h"
#include "c3de/scene/simulation_directory.h"
#include "last_error.h"
#include "refusal.h"
#include "services/catalogue.h"
#include "services/services.h"

namespace c3de::plugin_host {
namespace {

c3de_status C3DE_CALL getService(void *ctx, c3de_str id, std::uint32_t minRev, const void **table) noexcept {
  return serve(ctx, "get_service", [&](PluginContext &plugin) {
    *requireNonNull(table, "table") = nullptr;
    const std::string name = textOf(id, "id");
    const ServiceEntry &entry = findService(name, minRev, plugin.services());
    *table = entry.table(plugin.tables());
    plugin.recordServiceRequest(name);
  });
}

/// Text of any plugin, also of one being removed, as the user will read it.
std::string readable(c3de_str message, const std::string &otherwise) {
  const std::string_view text = fromAbi(message);
  return text.empty() || text.size() > kLongestText ? otherwise : displayText(text, Lines::many);
}

void C3DE_CALL setErrorAt(void *, c3de_status status, c3de_str message, const c3de_error_place *place) noexcept {
  try {
    PluginError error{readable(message, statusName(status)), {}, 0, {}};
    if (place != nullptr && place->size >= MinimumSize<c3de_error_place>::value) {
      error.table = readable(place->table, {});
      error.index = place->index;
      error.key = readable(place->key, {});
    }
    setLastError(std::move(error));
  } catch (...) {
    setLastError(std::string_view());
  }
}

void C3DE_CALL callbackFailed(void *) noexcept { (void)exchangeCallbackFailed(true); }

void C3DE_CALL setError(void *ctx, c3de_status status, c3de_str message) noexcept {
  setErrorAt(ctx, status, message, nullptr);
}

c3de_status C3DE_CALL takeError(void *, c3de_sink sink) noexcept {
  try {
    if (!sink.put) return C3DE_E_ARG;
    const std::string text = takeLastError();
    return sink.put(sink.self, text.data(), text.size());
  } catch (...) {
    return refuse("take_error");
  }
}

}  // namespace

PluginContext::PluginContext(HostState &host, std::string id)
    : host_(host), id_(std::move(id)),
      callName_(internedName(id_)), abi_{sizeof(c3de_host), 3,          this,        &getService,
                                         &setError,         &takeError, &setErrorAt, &callbackFailed},
      tables_{makeLogTable(this),      makeRegistryTable(this),  makeMeshTable(this),   makeSceneTable(this),
              makeRenderTable(this),   makeCollisionTable(this), makeParamsTable(this), makePanelsTable(this),
              makeToolsTable(this),    makeJobsTable(this),      makeTimeTable(this),   makeSimulationTable(this),
              makeImagingTable(this),  makeHistoryTable(this),   makeForcesTable(this), makeFilesTable(this),
              makeSettingsTable(this), makeCommandsTable(this)} {}

PluginContext::~PluginContext() = default;

PluginContext &PluginContext::of(void *ctx) {
  auto *plugin = static_cast<PluginContext *>(requireNonNull(ctx, "ctx"));
  if (plugin->isClosed()) throw Refusal(C3DE_E_STATE, "the plugin " + plugin->id_ + " has been taken back");
  return *plugin;
}

void logCallbackFailure(const char *plugin, const char *what) noexcept {
  try {
    const std::string text = takeLastError();
    log(LogLevel::error,
        fmt::format("plugin {}: {} failed: {}", plugin, what, text.empty() ? "it gives no reason" : text));
  } catch (...) {  // no memory for the line
  }
}

bool PluginContext::isMainThread() const { return std::this_thread::get_id() == host_.mainThread; }

void PluginContext::requireMainThread() const {
  if (!isMainThread())
    throw Refusal(C3DE_E_THREAD, "must be called on the main thread; use post_to_main of c3de.time/1");
}

c3de_str PluginContext::internedText(const std::string &text) {
  const std::lock_guard lock(textMutex_);
  const std::string &kept = *texts_.insert(text).first;
  return {kept.data(), kept.size()};
}

void PluginContext::drainPending() {
  // While the plugin is still intact: afterwards its tool could no longer release what it holds.
  if (services().tools && tools.contains(services().tools->active().bits())) services().tools->activate({});
  if (services().edits) services().edits->removeOwnedBy(id_);
  for (auto &[key, ready] : std::exchange(captures->waiting, {}))
    callPlugin(*this, "ready of a capture", [&] { ready(C3DE_E_CANCELLED); });
  if (services().jobs) services().jobs->finishOwnedBy(id_);
  for (;;) {
    std::pair<void *, void(C3DE_CALL *)(void *)> next;
    {
      const std::lock_guard lock(posted->mutex);
      if (posted->waiting.empty()) return;
      next = posted->waiting.front();
      posted->waiting.pop_front();
    }
    callPlugin(*this, "a posted function", [&] { next.second(next.first); });
  }
}

void PluginContext::revokeAll() {
  closed_ = true;
  captures->waiting.clear();
  const Services &s = services();
  if (s.jobs) s.jobs->finishOwnedBy(id_);
  if (s.mainQueue) s.mainQueue->removeOwnedBy(id_);
  {
    const std::lock_guard lock(posted->mutex);
    posted->waiting.clear();
  }
  if (s.forces) s.forces->removeOwnedBy(id_);
  if (s.simulations) s.simulations->unwatchOwnedBy(id_);
  if (s.meshFormats) s.meshFormats->removeOwnedBy(id_);
  if (s.commands) s.commands->removeOwnedBy(id_);
  // Tools first: one of them may be active, and its callbacks are already closed.
  if (s.tools) s.tools->removeOwnedBy(id_);
  if (s.edits) s.edits->removeOwnedBy(id_);
  if (s.panels) s.panels->removeOwnedBy(id_);
  if (s.parameters) s.parameters->removeOwnedBy(id_);
  tools.clear();
  edits.clear();
  panels.clear();
  parameterSets.clear();
  host_.classes.removeOwnedBy(id_);
  host_.trees.removeOwnedBy(id_);
  host_.proxies.removeOwnedBy(id_);
  if (s.sceneGraph)
    for (const std::uint64_t node : nodes) s.sceneGraph->remove(Handle::fromBits(node));
  nodes.clear();
  if (s.meshes) {
    const std::lock_guard lock(meshMutex);
    for (const std::uint64_t mesh : meshes) s.meshes->remove(Handle::fromBits(mesh));
    meshes.clear();
  }
  frameCallbacks.clear();
  jobs.clear();
}

}  // namespace c3de::plugin_host
