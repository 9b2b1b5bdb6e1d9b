// SPDX-License-Identifier: Apache-2.0
// Private to the session.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/plugin_host/plugin_host.h"
#include "loading/fitted_scene.h"

namespace c3de::session {

/// The simulator's handles of bodies and obstacles, by their names in the scene.
using NamedHandles = std::map<std::string, c3de_handle>;

/// A scene that is being loaded into a simulator.
class LoadingScene {
 public:
  /// @param simulator  an object of one of the host's plugins, which the scene has been fitted to
  /// Errors: it has no simulator table.
  [[nodiscard]] static Expected<LoadingScene> into(c3de_object *simulator, plugin_host::PluginHost &host,
                                                   FittedScene scene);

  [[nodiscard]] const FittedScene &fitted() const { return scene_; }
  [[nodiscard]] const scene::SceneFile &scene() const { return scene_.scene; }
  [[nodiscard]] c3de_object *simulator() const { return simulator_; }
  [[nodiscard]] const c3de_simulator_v1 *table() const { return table_; }
  /// The plugin that owns the simulator, as for PluginCall.
  [[nodiscard]] const char *owner() const { return host_->ownerOf(simulator_); }

  /// Why a call of the simulator failed on this thread: the plugin's error text, or that `doing` failed, prefixed with
  /// the location in the scene. Consumes the plugin's error text.
  /// @param code   below 0
  /// @param doing  "building body 'liver'"
  /// @param line   of the item passed to the simulator
  /// @param body   set where the plugin may refer to one of its fixes, loads, parts or refinements: their line is used
  /// then
  [[nodiscard]] Error failure(c3de_status code, const std::string &doing, int line,
                              const scene::SceneBody *body = nullptr) const;

 private:
  LoadingScene(c3de_object *simulator, const c3de_simulator_v1 *table, plugin_host::PluginHost &host, FittedScene scene)
      : simulator_(simulator), table_(table), host_(&host), scene_(std::move(scene)) {}

  c3de_object *simulator_;
  const c3de_simulator_v1 *table_;
  plugin_host::PluginHost *host_;
  FittedScene scene_;
};

}  // namespace c3de::session
