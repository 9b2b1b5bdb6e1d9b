// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "c3de/core/handle.h"
#include "c3de/core/parameter.h"

namespace c3de::ui {

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
  /// Checks, stores and, if `tellListener`, calls the listener.
  [[nodiscard]] Expected<void> set(Handle set, const ParameterValue &value, bool tellListener);

 private:
  HandleTable<ParameterSet> sets_;
};

}  // namespace c3de::ui
