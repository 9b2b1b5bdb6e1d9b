// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "c3de/abi/c3de.h"
#include "c3de/core/plugin_call.h"
#include "host_state.h"
#include "last_error.h"

namespace c3de::plugin_host {

struct PanelCallback;
struct ToolCallback;
struct EditCallback;
struct ListenerCallback;

/// All tables available to one plugin; ctx of each is its PluginContext.
struct ServiceTables {
  c3de_log_v1 log;
  c3de_registry_v1 registry;
  c3de_mesh_v1 mesh;
  c3de_scene_v1 scene;
  c3de_render_v1 render;
  c3de_collision_v1 collision;
  c3de_params_v1 params;
  c3de_panels_v1 panels;
  c3de_tools_v1 tools;
  c3de_jobs_v1 jobs;
  c3de_time_v1 time;
  c3de_simulation_v1 simulation;
  c3de_imaging_v1 imaging;
  c3de_history_v1 history;
  c3de_forces_v1 forces;
  c3de_files_v1 files;
  c3de_settings_v1 settings;
  c3de_commands_v1 commands;
};

/// Functions that a plugin has posted to the main thread and that have not run yet. Shared with the queue, which may
/// outlive the plugin.
struct PostedFunctions {
  std::mutex mutex;
  std::deque<std::pair<void *, void(C3DE_CALL *)(void *)>> waiting;
};

/// Captures of the simulation that a plugin has requested. Main thread.
struct RequestedCaptures {
  std::map<std::uint64_t, std::function<void(c3de_status)>> waiting;
  std::uint64_t lastKey = 0;
  std::uint64_t begun = 0;  ///< number of the capture whose ready was called last; 0: none, or its step was added
};

/// The host as seen by one plugin, and everything this plugin has registered, so that it can be revoked. Exists as long
/// as the host, so that a late call is refused instead of crashing.
class PluginContext {
 public:
  PluginContext(HostState &host, std::string id);
  PluginContext(const PluginContext &) = delete;
  PluginContext &operator=(const PluginContext &) = delete;
  ~PluginContext();

  /// Throws Refusal if no plugin belongs to ctx or it has been revoked.
  [[nodiscard]] static PluginContext &of(void *ctx);
  /// requireMainThread() throws Refusal (C3DE_E_THREAD) on any other thread.
  [[nodiscard]] bool isMainThread() const;
  void requireMainThread() const;

  [[nodiscard]] const c3de_host *abi() const { return &abi_; }
  [[nodiscard]] const ServiceTables &tables() const { return tables_; }
  [[nodiscard]] const std::string &id() const { return id_; }
  /// The id; valid as long as the program runs.
  [[nodiscard]] const char *callName() const { return callName_; }
  [[nodiscard]] HostState &host() const { return host_; }
  [[nodiscard]] const Services &services() const { return host_.services; }
  [[nodiscard]] bool isClosed() const { return closed_.load(); }

  /// Cancels its tool, waits for its jobs and runs its posted functions; called before destroy. Main thread.
  void drainPending();
  /// From then on the plugin is not called and its calls are refused; revokes everything it has registered. Main
  /// thread.
  void revokeAll();

  /// Records a service that the plugin has requested. Any thread.
  void recordServiceRequest(const std::string &id) {
    const std::lock_guard lock(textMutex_);
    asked_.insert(id);
  }
  [[nodiscard]] bool hasRequested(const std::string &id) {
    const std::lock_guard lock(textMutex_);
    return asked_.contains(id);
  }
  /// A text that is valid as long as the host; equal texts are stored once. Any thread.
  [[nodiscard]] c3de_str internedText(const std::string &text);

  // Registrations of the plugin, for the services; main thread, except where a mutex precedes them.
  std::mutex meshMutex;
  std::set<std::uint64_t> meshes;
  std::set<std::uint64_t> nodes, frameCallbacks, jobs;
  std::map<std::uint64_t, std::shared_ptr<PanelCallback>> panels;
  std::map<std::uint64_t, std::shared_ptr<ToolCallback>> tools;
  std::map<const EditCallback *, std::shared_ptr<EditCallback>> edits;
  std::map<std::uint64_t, std::shared_ptr<ListenerCallback>> parameterSets;
  std::shared_ptr<PostedFunctions> posted = std::make_shared<PostedFunctions>();
  std::shared_ptr<RequestedCaptures> captures = std::make_shared<RequestedCaptures>();

 private:
  HostState &host_;
  const std::string id_;
  const char *const callName_;
  std::atomic<bool> closed_{false};
  c3de_host abi_;
  ServiceTables tables_;
  std::mutex textMutex_;
  std::set<std::string> texts_, asked_;
};

/// Includes the text set by the plugin.
void logCallbackFailure(const char *plugin, const char *what) noexcept;

/// Calls into a plugin. An exception that leaves it is written to the log. So is a failure reported by a function
/// without a return value (callback_failed of c3de_host). Best effort only: exceptions of a plugin with a separate C++
/// runtime cannot be caught.
/// @param what  a literal, for messages
/// @param f  may accept the present PluginCall
template <class F>
bool callPlugin(const PluginContext &plugin, const char *what, F &&f, CallKind kind = CallKind::prompt,
                std::uint64_t subject = 0) noexcept {
  if (plugin.isClosed()) return false;
  if (PluginCall::hasReachedMaxNesting(plugin.callName(), what)) return false;
  try {
    const PluginCall call(plugin.callName(), what, kind, subject);
    struct Flag {  // a failure reported in an outer call is preserved by a nested one
      bool before = exchangeCallbackFailed(false);
      ~Flag() { (void)exchangeCallbackFailed(before); }
    } const flag;
    if constexpr (std::is_invocable_v<F, const PluginCall &>)
      f(call);
    else
      f();
    if (!exchangeCallbackFailed(false)) return true;
    logCallbackFailure(plugin.callName(), what);
    return false;
  } catch (...) {
    logException(plugin.callName(), what);
    return false;
  }
}

}  // namespace c3de::plugin_host
