// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "c3de/core/handle.h"
#include "c3de/core/parameter.h"

namespace c3de::registry {

class ParameterRegistry;

/// Undo and redo of the user's changes to the parameters of a panel. One drag of a slider is one entry. Main thread
/// only.
class ParameterHistory {
 public:
  /// Records a change by the user; further changes of the same parameter join the entry until endGesture().
  void record(Handle set, const std::string &label, const ParameterValue &before, const ParameterValue &after);
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
  /// Sets the value through the registry, which also calls the listener. Entries of sets that no longer exist are
  /// skipped.
  void undo(ParameterRegistry &registry);
  void redo(ParameterRegistry &registry);

 private:
  struct Entry {
    Handle set;
    std::string label;
    ParameterValue before, after;
  };
  static constexpr std::size_t kMaxEntries = 500;
  std::vector<Entry> entries_;
  std::size_t done_ = 0;  // entries before this index can be undone, the others redone
  std::uint64_t edits_ = 0;
  bool isOpen_ = false;  // the last entry still accepts changes
};

}  // namespace c3de::registry
