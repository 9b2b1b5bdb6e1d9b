// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/scene_graph.h"

#include <fmt/format.h>

#include "arguments.h"
#include "services/services.h"

namespace c3de::plugin_host {
namespace {

scene::Node &find(PluginContext &plugin, c3de_handle node) {
  scene::Node *found = plugin.services().sceneGraph->find(handleOf(node));
  if (!found) throw Refusal(C3DE_E_STALE, fmt::format("there is no scene node of handle {}", textOf(node)));
  return *found;
}

c3de_status C3DE_CALL addNode(void *ctx, c3de_handle parent, c3de_str name, c3de_handle *out) noexcept {
  return serveOnMain(ctx, "scene.add_node", [&](PluginContext &plugin) {
    requireNonNull(out, "out")->v = 0;
    if (parent.v != 0) (void)find(plugin, parent);
    const std::string label = labelOf(name, "name");
    if (label.empty()) throw Refusal(C3DE_E_ARG, "name is empty");
    const Handle node = plugin.services().sceneGraph->add(handleOf(parent), label);
    plugin.nodes.insert(node.bits());
    writeHandle(out, node);
  });
}

c3de_status C3DE_CALL removeNode(void *ctx, c3de_handle node) noexcept {
  return serveOnMain(ctx, "scene.remove_node", [&](PluginContext &plugin) {
    if (!plugin.services().sceneGraph->find(handleOf(node))) plugin.nodes.erase(node.v);
    const scene::Node &found = find(plugin, node);
    if (!plugin.nodes.contains(node.v))
      throw Refusal(C3DE_E_STATE, fmt::format("the node '{}' was not added by plugin {}", found.name, plugin.id()));
    plugin.nodes.erase(node.v);
    plugin.services().sceneGraph->remove(handleOf(node));
    plugin.host().proxies.sync();
  });
}

c3de_status C3DE_CALL worldFromNode(void *ctx, c3de_handle node, double *out16) noexcept {
  return serveOnMain(ctx, "scene.world_from_node", [&](PluginContext &plugin) {
    requireNonNull(out16, "out16");
    (void)find(plugin, node);
    const Mat4 matrix = plugin.services().sceneGraph->worldFromNode(handleOf(node));
    std::copy(matrix.begin(), matrix.end(), out16);
  });
}

c3de_status C3DE_CALL setVisible(void *ctx, c3de_handle node, std::uint32_t visible) noexcept {
  return serveOnMain(ctx, "scene.set_visible", [&](PluginContext &plugin) {
    find(plugin, node).visible = visible != 0;
    plugin.services().sceneGraph->touch();
    plugin.host().proxies.sync();
  });
}

c3de_status C3DE_CALL isVisible(void *ctx, c3de_handle node, std::uint32_t *visible) noexcept {
  return serveOnMain(ctx, "scene.is_visible", [&](PluginContext &plugin) {
    requireNonNull(visible, "visible");
    (void)find(plugin, node);
    // Anything below a hidden node is not visible, whatever its own flag.
    *visible = plugin.services().sceneGraph->isVisible(handleOf(node)) ? 1u : 0u;
  });
}

c3de_status C3DE_CALL setBounds(void *ctx, c3de_handle node, const double *min3, const double *max3) noexcept {
  return serveOnMain(ctx, "scene.set_bounds", [&](PluginContext &plugin) {
    scene::Node &found = find(plugin, node);
    const Vec3 min = pointOf(min3, "min3"), max = pointOf(max3, "max3");
    for (std::size_t k = 0; k < 3; ++k)
      if (min[k] > max[k])
        throw Refusal(C3DE_E_ARG, fmt::format("min3[{}] = {} is above max3[{}] = {}", k, min[k], k, max[k]));
    found.hasBounds = true;
    found.boundsMin = min;
    found.boundsMax = max;
    plugin.services().sceneGraph->touch();
  });
}

}  // namespace

c3de_scene_v1 makeSceneTable(PluginContext *plugin) {
  return {sizeof(c3de_scene_v1), kServiceRevision, plugin,     &addNode,  &removeNode,
          &worldFromNode,        &setVisible,      &isVisible, &setBounds};
}

}  // namespace c3de::plugin_host
