// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "c3de/abi/history.h"
#include "c3de/core/handle.h"

namespace c3de::registry {

struct Edit {
  std::string owner;  ///< plugin id
  std::string label;
  void *self = nullptr;
  c3de_status(C3DE_CALL *undo)(void *self) = nullptr;
  c3de_status(C3DE_CALL *redo)(void *self) = nullptr;
  void(C3DE_CALL *release)(void *self) = nullptr;
};

/// The undo and redo steps of plugins, in order. Main thread only.
class EditList {
 public:
  EditList() = default;
  EditList(const EditList &) = delete;
  EditList &operator=(const EditList &) = delete;
  ~EditList();
  /// Adds a step that has been done. Undone steps are removed, and the oldest one if there are too many.
  Handle add(Edit edit);
  bool remove(Handle edit);
  void removeOwnedBy(const std::string &plugin);
  /// Incremented by every add().
  [[nodiscard]] std::uint64_t edits() const { return edits_; }
  /// Label of what would be undone or redone; empty if nothing.
  [[nodiscard]] std::string undoLabel() const {
    return done_ > 0 ? table_.find(order_[done_ - 1])->label : std::string();
  }
  [[nodiscard]] std::string redoLabel() const {
    return done_ < order_.size() ? table_.find(order_[done_])->label : std::string();
  }
  /// A step that fails is removed; the cause is logged.
  void undo();
  void redo();

  static constexpr std::size_t kMost = 100;

 private:
  void forget(std::size_t index);
  bool apply(std::size_t index, bool isUndo);

  HandleTable<Edit, HandleKind::edit> table_;
  std::vector<Handle> order_;
  std::size_t done_ = 0;  ///< index in the order: earlier steps can be undone, the others redone
  std::uint64_t edits_ = 0;
};

}  // namespace c3de::registry
