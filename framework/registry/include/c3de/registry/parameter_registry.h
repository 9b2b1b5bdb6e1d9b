// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "c3de/core/handle.h"
#include "c3de/core/parameter.h"
#include "c3de/registry/parameter_history.h"

namespace c3de::registry {

/// A declared set of parameters with its present values, and the listener for the user's changes.
struct ParameterSet {
  std::string owner;  ///< plugin id
  std::string title;
  std::vector<ParameterDecl> decls;
  std::vector<ParameterValue> values;  ///< one per declaration
  c3de_param_listener listener{};
};

/// Main thread only.
class ParameterRegistry {
 public:
  Handle declare(ParameterSet set);
  bool remove(Handle set);
  void removeOwnedBy(const std::string &plugin);
  [[nodiscard]] ParameterSet *find(Handle set);
  /// The sets of a plugin.
  [[nodiscard]] std::vector<Handle> ownedBy(const std::string &plugin) const;
  /// Calls visit(const ParameterSet &) for all sets.
  template <class Visit>
  void forEach(Visit &&visit) const {
    sets_.forEach([&](Handle, const ParameterSet &set) { visit(set); });
  }
  /// Checks, stores and, if `notifyListener`, calls the listener.
  /// Without notification the owner shows other values: the set's edit history ends there.
  [[nodiscard]] Expected<void> set(Handle set, const ParameterValue &value, bool notifyListener);
  /// Same as set() with notification, recorded for undo.
  [[nodiscard]] Expected<void> edit(Handle set, const ParameterValue &value);
  /// Same for several values, which are undone together. If one of them is refused, none is set. Values that the set
  /// already has are not set again.
  [[nodiscard]] Expected<void> edit(Handle set, const std::string &label, const std::vector<ParameterValue> &values);
  [[nodiscard]] ParameterHistory &history() { return history_; }
  [[nodiscard]] const ParameterHistory &history() const { return history_; }

 private:
  HandleTable<ParameterSet, HandleKind::parameterSet> sets_;
  ParameterHistory history_;
};

}  // namespace c3de::registry
