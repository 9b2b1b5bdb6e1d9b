// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
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
  std::chrono::steady_clock::time_point madeAt{};  ///< set by EditList::add()
};

/// Steps whose undo restores the whole simulation. Main thread.
class SimulationSteps {
 public:
  SimulationSteps() = default;
  SimulationSteps(const SimulationSteps &) = delete;
  SimulationSteps &operator=(const SimulationSteps &) = delete;
  virtual ~SimulationSteps() = default;
  /// Stores the present simulation, then calls `begin` with the number of this capture, also if it could not be stored.
  virtual void captureBefore(const std::function<void(std::uint64_t capture)> &begin) = 0;
  /// The change started by `begin` has succeeded: adds a step, or reports why it cannot be undone.
  /// @return false: another capture has been made since
  virtual bool addCaptured(std::uint64_t capture, const std::string &label) = 0;
};

/// The undo and redo steps of plugins, in order. Main thread only.
class EditList {
 public:
  EditList() = default;
  EditList(const EditList &) = delete;
  EditList &operator=(const EditList &) = delete;
  ~EditList();
  /// Adds a step that has been done. Undone steps are removed, and the oldest ones while the list needs more than
  /// kBudget. The states that a step restores belong to its owner, who limits them and removes its oldest steps.
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
  using Time = std::chrono::steady_clock::time_point;
  /// When the step was made that would be undone or redone; the epoch of the clock if there is none.
  [[nodiscard]] Time undoTime() const { return done_ > 0 ? table_.find(order_[done_ - 1])->madeAt : Time(); }
  [[nodiscard]] Time redoTime() const { return done_ < order_.size() ? table_.find(order_[done_])->madeAt : Time(); }
  /// An undo or redo that was only begun has not been made: the step is again what it was before. No effect if it is
  /// removed.
  void takeBack(Handle edit, bool isUndo);
  /// Removes what was undone: something else has been edited since.
  void forgetUndone();
  [[nodiscard]] std::size_t undoCount() const { return done_; }
  /// A step that fails is removed; the cause is logged.
  void undo();
  void redo();
  /// Null where there are none, and before the window exists.
  [[nodiscard]] SimulationSteps *simulationSteps() const { return simulationSteps_; }
  void setSimulationSteps(SimulationSteps *steps) { simulationSteps_ = steps; }

  /// Bytes of the list itself: about 100 000 steps.
  static constexpr std::size_t kBudget = std::size_t{16} << 20;
  /// Of the list, as they count for kBudget.
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  void forget(std::size_t index);
  bool apply(std::size_t index, bool isUndo);

  HandleTable<Edit, HandleKind::edit> table_;
  std::vector<Handle> order_;
  std::size_t done_ = 0;  ///< index in the order: earlier steps can be undone, the others redone
  std::uint64_t edits_ = 0;
  std::size_t bytes_ = 0;
  SimulationSteps *simulationSteps_ = nullptr;
};

}  // namespace c3de::registry
