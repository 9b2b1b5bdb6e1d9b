// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/handle.h"
#include "c3de/core/vec.h"

namespace c3de::scene {

struct Node {
  std::string name;
  Handle parent;
  Mat4 parentFromNode = kIdentity4;
  bool visible = true;
  bool isFolded = false;  ///< a list of nodes hides its descendants
  bool hasBounds = false;
  Vec3 boundsMin{}, boundsMax{};  ///< node space
};

/// The tree of scene nodes. World space is LPS in millimetres. Main thread only.
class SceneGraph {
 public:
  Handle add(Handle parent, std::string name);  ///< null handle when the parent is stale
  bool remove(Handle node);                     ///< with all descendants
  [[nodiscard]] Node *find(Handle node);
  [[nodiscard]] const Node *find(Handle node) const;
  [[nodiscard]] Mat4 worldFromNode(Handle node) const;
  [[nodiscard]] bool isVisible(Handle node) const;  ///< the node and all its ancestors are
  /// Nodes in depth-first order with their depth.
  struct Row {
    Handle node;
    int depth;
  };
  [[nodiscard]] std::vector<Row> rows() const;
  /// World bounds of the visible nodes.
  struct Bounds {
    Vec3 min, max;
  };
  [[nodiscard]] std::optional<Bounds> bounds() const;
  /// Incremented when a node is added or removed, and by touch().
  [[nodiscard]] std::uint64_t generation() const { return generation_; }
  void touch() { ++generation_; }  ///< to be called after changing a node through find()

 private:
  HandleTable<Node, HandleKind::node> nodes_;
  std::vector<Handle> order_;
  std::uint64_t generation_ = 0;
};

}  // namespace c3de::scene
