// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "c3de/core/handle.h"
#include "c3de/core/parameter.h"

namespace c3de::registry {

class ParameterRegistry;

/// Undo and redo of what a person changed in the parameters of a panel. One drag of a slider is one entry. Main thread
/// only.
class ParameterHistory {
 public:
  /// A person changed a value; further changes of the same parameter join until endGesture().
  void record(Handle set, const std::string &label, const ParameterValue &before, const ParameterValue &after);
  /// The person has let go of the widget.
  void endGesture() { isOpen_ = false; }
  /// The owner has shown other values, of another body say: what was changed before is not that body's history.
  void forget(Handle set);

  /// Grows with every change.
  [[nodiscard]] std::uint64_t edits() const { return edits_; }
  [[nodiscard]] bool canUndo() const { return done_ > 0; }
  [[nodiscard]] bool canRedo() const { return done_ < entries_.size(); }
  /// Label of what would be undone or redone; empty when nothing.
  [[nodiscard]] std::string undoLabel() const { return canUndo() ? entries_[done_ - 1].label : std::string(); }
  [[nodiscard]] std::string redoLabel() const { return canRedo() ? entries_[done_].label : std::string(); }
  /// Sets the value through the registry, the listener included. Entries of sets that are gone are skipped.
  void undo(ParameterRegistry &registry);
  void redo(ParameterRegistry &registry);

 private:
  struct Entry {
    Handle set;
    std::string label;
    ParameterValue before, after;
  };
  static constexpr std::size_t kMostEntries = 500;
  std::vector<Entry> entries_;
  std::size_t done_ = 0;  // entries before it can be undone, the others redone
  std::uint64_t edits_ = 0;
  bool isOpen_ = false;  // the last entry still takes changes
};

}  // namespace c3de::registry
