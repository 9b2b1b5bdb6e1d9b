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
  bool isFolded = false;  ///< a list of nodes leaves out what is below it
  bool hasBounds = false;
  Vec3 boundsMin{}, boundsMax{};  ///< node space
};

/// What exists, as a tree. World space is LPS in millimetres. Main thread only.
class SceneGraph {
 public:
  Handle add(Handle parent, std::string name);  ///< null handle when the parent is stale
  bool remove(Handle node);                     ///< and everything below it
  [[nodiscard]] Node *find(Handle node);
  [[nodiscard]] const Node *find(Handle node) const;
  [[nodiscard]] Mat4 worldFromNode(Handle node) const;
  [[nodiscard]] bool isVisible(Handle node) const;  ///< it and all above it
  /// Nodes in depth-first order with their depth.
  struct Row {
    Handle node;
    int depth;
  };
  [[nodiscard]] std::vector<Row> rows() const;
  /// World bounds of what is visible.
  struct Bounds {
    Vec3 min, max;
  };
  [[nodiscard]] std::optional<Bounds> bounds() const;
  /// Grows when a node comes or goes, and with touch().
  [[nodiscard]] std::uint64_t generation() const { return generation_; }
  void touch() { ++generation_; }  ///< for who has changed a node through find()

 private:
  HandleTable<Node, HandleKind::node> nodes_;
  std::vector<Handle> order_;
  std::uint64_t generation_ = 0;
};

}  // namespace c3de::scene
