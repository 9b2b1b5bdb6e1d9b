// SPDX-License-Identifier: Apache-2.0
#include "scene_proxies.h"

#include <utility>
#include <vector>

#include "c3de/render/renderer.h"
#include "c3de/scene/scene_graph.h"

namespace c3de::plugin_host {

Handle SceneProxies::add(SceneProxy proxy) {
  place(proxy);
  return proxies_.add(std::move(proxy));
}

SceneProxy *SceneProxies::find(Handle proxy) {
  SceneProxy *found = proxies_.find(proxy);
  if (!found || graph_->find(found->node)) return found;
  // The node was removed since the last frame, so the proxy is removed too.
  remove(proxy);
  return nullptr;
}

bool SceneProxies::remove(Handle proxy) {
  SceneProxy *found = proxies_.find(proxy);
  if (!found) return false;
  renderer_->destroy(found->drawn);
  return proxies_.remove(proxy);
}

void SceneProxies::removeOwnedBy(const std::string &plugin) {
  std::vector<Handle> gone;
  proxies_.forEach([&](Handle handle, const SceneProxy &proxy) {
    if (proxy.owner == plugin) gone.push_back(handle);
  });
  for (const Handle handle : gone) remove(handle);
}

void SceneProxies::sync() {
  std::vector<Handle> gone;
  proxies_.forEach([&](Handle handle, SceneProxy &proxy) {
    if (graph_->find(proxy.node))
      place(proxy);
    else
      gone.push_back(handle);
  });
  for (const Handle handle : gone) remove(handle);
}

void SceneProxies::place(SceneProxy &proxy) {
  renderer_->setTransform(proxy.drawn, graph_->worldFromNode(proxy.node));
  renderer_->setVisible(proxy.drawn, proxy.visible && graph_->isVisible(proxy.node));
}

}  // namespace c3de::plugin_host
