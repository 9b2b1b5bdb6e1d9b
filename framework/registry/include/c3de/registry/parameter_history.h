// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "c3de/core/handle.h"
#include "c3de/core/parameter.h"

namespace c3de::registry {

class ParameterRegistry;

/// Undo and redo of the user's changes to the parameters of a panel. One drag of a slider is one entry. While the
/// entries need more than kBudget, the oldest ones are removed. Main thread only.
class ParameterHistory {
 public:
  static constexpr std::size_t kBudget = std::size_t{16} << 20;  ///< bytes: about 40 000 changes
  /// Records a change by the user; further changes of the same parameter join the entry until endGesture().
  void record(Handle set, const std::string &label, const ParameterValue &before, const ParameterValue &after);
  /// Records several changes as one entry: they are undone and redone together.
  struct Change {
    ParameterValue before, after;
  };
  void record(Handle set, const std::string &label, const std::vector<Change> &changes);
  /// The user has released the widget.
  void endGesture() { isOpen_ = false; }
  /// The owner now shows other values, for example those of another body, so earlier changes do not apply to them.
  void forget(Handle set);

  /// Incremented by every change.
  [[nodiscard]] std::uint64_t edits() const { return edits_; }
  [[nodiscard]] bool canUndo() const { return done_ > 0; }
  [[nodiscard]] bool canRedo() const { return done_ < entries_.size(); }
  /// Label of what would be undone or redone; empty if nothing.
  [[nodiscard]] std::string undoLabel() const { return canUndo() ? entries_[done_ - 1].label : std::string(); }
  [[nodiscard]] std::string redoLabel() const { return canRedo() ? entries_[done_].label : std::string(); }
  using Time = std::chrono::steady_clock::time_point;
  /// When the change began that would be undone or redone; the epoch of the clock if there is none.
  [[nodiscard]] Time undoTime() const { return canUndo() ? entries_[done_ - 1].madeAt : Time(); }
  [[nodiscard]] Time redoTime() const { return canRedo() ? entries_[done_].madeAt : Time(); }
  /// Removes what was undone: something else has been edited since.
  void forgetUndone();
  [[nodiscard]] std::size_t undoCount() const { return done_; }
  /// Of the entries, as they count for kBudget.
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  /// Sets the value through the registry, which also calls the listener. Entries of sets that no longer exist are
  /// skipped.
  void undo(ParameterRegistry &registry);
  void redo(ParameterRegistry &registry);

 private:
  struct Entry {
    Handle set;
    std::string label;
    ParameterValue before, after;
    Time madeAt;
    bool joinsPrevious = false;  ///< undone and redone together with the entry before
  };
  [[nodiscard]] static std::size_t bytesOf(const Entry &entry);
  void erase(std::size_t index);
  void append(Entry entry);
  std::deque<Entry> entries_;
  std::size_t bytes_ = 0;
  std::size_t done_ = 0;  // entries before this index can be undone, the others redone
  std::uint64_t edits_ = 0;
  bool isOpen_ = false;  // the last entry still accepts changes
};

}  // namespace c3de::registry
