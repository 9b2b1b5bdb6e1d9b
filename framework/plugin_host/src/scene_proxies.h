// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "c3de/core/handle.h"

namespace c3de::render {
class Renderer;
}
namespace c3de::scene {
class SceneGraph;
}

namespace c3de::plugin_host {

enum class ProxyKind { mesh, spheres, lines, label, legend };

struct SceneProxy {
  std::string owner;
  Handle node;
  Handle drawn;  ///< handle in the renderer
  ProxyKind kind = ProxyKind::mesh;
  std::size_t count = 0;  ///< points
  float opacity = 1.0f;   ///< of the material
  bool visible = true;    ///< its own flag; it is shown only if the node is also visible
};

/// Objects that plugins have added to scene nodes. The renderer has no nodes, so transforms and visibility are applied
/// here, and a proxy is removed with its node. Main thread.
class SceneProxies {
 public:
  SceneProxies(render::Renderer *renderer, scene::SceneGraph *graph) : renderer_(renderer), graph_(graph) {}

  Handle add(SceneProxy proxy);
  [[nodiscard]] SceneProxy *find(Handle proxy);
  bool remove(Handle proxy);
  void removeOwnedBy(const std::string &plugin);
  /// Applies transforms and visibility; removes proxies whose node no longer exists. Called once per frame.
  void sync();
  [[nodiscard]] std::size_t size() const { return proxies_.size(); }

 private:
  void place(SceneProxy &proxy);

  render::Renderer *renderer_;
  scene::SceneGraph *graph_;
  HandleTable<SceneProxy, HandleKind::proxy> proxies_;
};

}  // namespace c3de::plugin_host
