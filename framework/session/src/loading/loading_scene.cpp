// SPDX-License-Identifier: Apache-2.0
#include "loading/loading_scene.h"

#include "c3de/session/scene_to_abi.h"
#include "c3de/session/simulator_access.h"

namespace c3de::session {

Expected<LoadingScene> LoadingScene::into(c3de_object *simulator, plugin_host::PluginHost &host, FittedScene scene) {
  const auto table = simulatorTable(simulator);
  if (!table) return tl::unexpected(table.error());
  return LoadingScene(simulator, *table, host, std::move(scene));
}

Error LoadingScene::failure(c3de_status code, const std::string &doing, int line, const scene::SceneBody *body) const {
  if (code == C3DE_E_CANCELLED) return {ErrorCode::cancelled, doing + " was cancelled"};
  const plugin_host::PluginError error = host_->takeErrorAt();
  if (body != nullptr) line = sceneLineOf(scene(), *body, error).value_or(line);
  return {ErrorCode::input, scene().where(line) + ": " +
                                (error.text.empty() ? doing + " failed (status " + std::to_string(code) + ")"
                                                    : plugin_host::describe(error))};
}

}  // namespace c3de::session
