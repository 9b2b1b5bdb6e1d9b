// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "c3de/core/handle.h"
#include "c3de/core/parameter.h"
#include "c3de/registry/parameter_history.h"

namespace c3de::registry {

/// A declared set of parameters with its present values, and who wants to know when a person changes one.
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
  /// visit(const ParameterSet &) for all of them.
  template <class Visit>
  void forEach(Visit &&visit) const {
    sets_.forEach([&](Handle, const ParameterSet &set) { visit(set); });
  }
  /// Checks, stores and, if `tellListener`, calls the listener.
  /// Without telling it is the owner who shows what is: the set's history of edits ends there.
  [[nodiscard]] Expected<void> set(Handle set, const ParameterValue &value, bool tellListener);
  /// As set() with the listener told, remembered for undo.
  [[nodiscard]] Expected<void> edit(Handle set, const ParameterValue &value);
  [[nodiscard]] ParameterHistory &history() { return history_; }
  [[nodiscard]] const ParameterHistory &history() const { return history_; }

 private:
  HandleTable<ParameterSet, HandleKind::parameterSet> sets_;
  ParameterHistory history_;
};

}  // namespace c3de::registry
