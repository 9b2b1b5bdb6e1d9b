// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/scene_graph.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace c3de::scene {

Handle SceneGraph::add(Handle parent, std::string name) {
  if (!parent.isNull() && nodes_.find(parent) == nullptr) return {};
  Node node;
  node.name = std::move(name);
  node.parent = parent;
  const Handle handle = nodes_.add(std::move(node));
  order_.push_back(handle);
  ++generation_;
  return handle;
}

bool SceneGraph::remove(Handle node) {
  if (nodes_.find(node) == nullptr) return false;
  // A child is always added after its parent, so one pass in order finds all descendants.
  std::vector<Handle> gone{node};
  for (const Handle candidate : order_) {
    const Node *found = nodes_.find(candidate);
    if (found != nullptr && std::find(gone.begin(), gone.end(), found->parent) != gone.end()) gone.push_back(candidate);
  }
  for (const Handle handle : gone) nodes_.remove(handle);
  std::erase_if(order_, [this](Handle handle) { return nodes_.find(handle) == nullptr; });
  ++generation_;
  return true;
}

Node *SceneGraph::find(Handle node) { return nodes_.find(node); }

const Node *SceneGraph::find(Handle node) const { return nodes_.find(node); }

Mat4 SceneGraph::worldFromNode(Handle node) const {
  Mat4 worldFromNode = kIdentity4;
  for (const Node *at = nodes_.find(node); at != nullptr; at = nodes_.find(at->parent))
    worldFromNode = multiply(at->parentFromNode, worldFromNode);
  return worldFromNode;
}

bool SceneGraph::isVisible(Handle node) const {
  const Node *at = nodes_.find(node);
  if (at == nullptr) return false;
  for (; at != nullptr; at = nodes_.find(at->parent))
    if (!at->visible) return false;
  return true;
}

std::vector<SceneGraph::Row> SceneGraph::rows() const {
  std::vector<Row> rows;
  rows.reserve(order_.size());
  // Depth-first with an explicit stack: a deep tree made by a plugin must not overflow the call stack.
  struct Pending {
    Handle node;
    int depth;
  };
  std::vector<Pending> pending;
  const auto pushChildrenOf = [&](Handle parent, int depth) {
    for (auto it = order_.rbegin(); it != order_.rend(); ++it)
      if (nodes_.find(*it)->parent == parent) pending.push_back({*it, depth});
  };
  pushChildrenOf(Handle{}, 0);
  while (!pending.empty()) {
    const Pending next = pending.back();
    pending.pop_back();
    rows.push_back({next.node, next.depth});
    pushChildrenOf(next.node, next.depth + 1);
  }
  return rows;
}

std::optional<SceneGraph::Bounds> SceneGraph::bounds() const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Bounds bounds{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  bool any = false;
  for (const Handle handle : order_) {
    const Node *node = nodes_.find(handle);
    if (!node->hasBounds || !isVisible(handle)) continue;
    const Mat4 worldFromHere = worldFromNode(handle);
    for (unsigned corner = 0; corner < 8; ++corner) {
      const Vec3 inNode{(corner & 1u) != 0 ? node->boundsMax[0] : node->boundsMin[0],
                        (corner & 2u) != 0 ? node->boundsMax[1] : node->boundsMin[1],
                        (corner & 4u) != 0 ? node->boundsMax[2] : node->boundsMin[2]};
      const Vec3 inWorld = transformPoint(worldFromHere, inNode);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        bounds.min[axis] = std::min(bounds.min[axis], inWorld[axis]);
        bounds.max[axis] = std::max(bounds.max[axis], inWorld[axis]);
      }
    }
    any = true;
  }
  if (!any) return std::nullopt;
  return bounds;
}

}  // namespace c3de::scene
