// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>
#include <shared_mutex>
#include <string>

#include "c3de/collision/aabb_tree.h"
#include "c3de/core/handle.h"

namespace c3de::plugin_host {

/// A tree that plugins query. Queries lock it shared; refit and rebuild lock it exclusively. Callers must not run them
/// concurrently anyway; the lock prevents invalid reads if they do.
struct SharedTree {
  SharedTree(std::string ownerId, collision::AabbTree builtTree)
      : owner(std::move(ownerId)), tree(std::move(builtTree)) {}
  const std::string owner;
  std::shared_mutex mutex;
  collision::AabbTree tree;
};

/// The collision trees of all plugins. Any thread.
class CollisionTrees {
 public:
  Handle add(std::shared_ptr<SharedTree> tree) {
    const std::lock_guard lock(mutex_);
    return trees_.add(std::move(tree));
  }
  [[nodiscard]] std::shared_ptr<SharedTree> find(Handle handle) const {
    const std::lock_guard lock(mutex_);
    const auto *found = trees_.find(handle);
    return found ? *found : nullptr;
  }
  bool remove(Handle handle) {
    const std::lock_guard lock(mutex_);
    return trees_.remove(handle);
  }
  void removeOwnedBy(const std::string &plugin) {
    const std::lock_guard lock(mutex_);
    std::vector<Handle> gone;
    trees_.forEach([&](Handle handle, const std::shared_ptr<SharedTree> &tree) {
      if (tree->owner == plugin) gone.push_back(handle);
    });
    for (const Handle handle : gone) trees_.remove(handle);
  }
  [[nodiscard]] std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return trees_.size();
  }

 private:
  mutable std::mutex mutex_;
  HandleTable<std::shared_ptr<SharedTree>, HandleKind::tree> trees_;
};

}  // namespace c3de::plugin_host
