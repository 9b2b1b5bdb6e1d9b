// SPDX-License-Identifier: Apache-2.0
#include "c3de/registry/parameter_registry.h"

#include <algorithm>

namespace c3de::registry {

Handle ParameterRegistry::declare(ParameterSet set) {
  // One value per declaration, in its order, regardless of the values that were passed.
  std::vector<ParameterValue> values;
  values.reserve(set.decls.size());
  for (const ParameterDecl &decl : set.decls) {
    const auto given =
        std::find_if(set.values.begin(), set.values.end(), [&](const ParameterValue &v) { return v.id == decl.id; });
    values.push_back(given != set.values.end() ? *given : decl.fallbackValue());
  }
  set.values = std::move(values);
  return sets_.add(std::move(set));
}

bool ParameterRegistry::remove(Handle set) { return sets_.remove(set); }

void ParameterRegistry::removeOwnedBy(const std::string &plugin) {
  std::vector<Handle> owned;
  sets_.forEach([&](Handle handle, const ParameterSet &set) {
    if (set.owner == plugin) owned.push_back(handle);
  });
  for (const Handle handle : owned) sets_.remove(handle);
}

std::vector<Handle> ParameterRegistry::ownedBy(const std::string &plugin) const {
  std::vector<Handle> found;
  sets_.forEach([&](Handle handle, const ParameterSet &set) {
    if (set.owner == plugin) found.push_back(handle);
  });
  return found;
}

ParameterSet *ParameterRegistry::find(Handle set) { return sets_.find(set); }

Expected<void> ParameterRegistry::set(Handle handle, const ParameterValue &value, bool notifyListener) {
  ParameterSet *set = sets_.find(handle);
  if (!set) return fail(ErrorCode::state, "the parameter set of '" + value.id + "' does not exist any more");
  const auto decl = findParameter(set->decls, value.id);
  if (!decl) return tl::unexpected(decl.error());
  if (auto checked = checkParameter(**decl, value); !checked) return checked;

  const auto index = static_cast<std::size_t>(*decl - set->decls.data());
  set->values[index] = value;
  if (!notifyListener) history_.forget(handle);
  if (notifyListener && set->listener.changed) {
    // The listener may remove the set, so it receives a copy that outlives it.
    const c3de_param_listener listener = set->listener;
    const ParameterValue copy = value;
    const c3de_param_value abi = copy.abi();
    listener.changed(listener.self, &abi);
  }
  return {};
}

Expected<void> ParameterRegistry::edit(Handle handle, const ParameterValue &value) {
  const ParameterSet *set = sets_.find(handle);
  if (!set) return this->set(handle, value, true);
  const auto decl = findParameter(set->decls, value.id);
  if (!decl) return tl::unexpected(decl.error());
  const std::string label = (*decl)->label.empty() ? value.id : (*decl)->label;
  const ParameterValue before = set->values[static_cast<std::size_t>(*decl - set->decls.data())];
  auto done = this->set(handle, value, true);
  // If the listener has removed the set or shown other values, there is nothing to return to.
  if (done && sets_.find(handle)) history_.record(handle, label, before, value);
  return done;
}

Expected<void> ParameterRegistry::edit(Handle handle, const std::string &label,
                                       const std::vector<ParameterValue> &values) {
  const ParameterSet *set = sets_.find(handle);
  if (!set) return fail(ErrorCode::state, "the parameter set of '" + label + "' does not exist any more");
  std::vector<ParameterHistory::Change> changes;
  for (const ParameterValue &value : values) {
    const auto decl = findParameter(set->decls, value.id);
    if (!decl) return tl::unexpected(decl.error());
    if (auto checked = checkParameter(**decl, value); !checked) return checked;
    const ParameterValue &before = set->values[static_cast<std::size_t>(*decl - set->decls.data())];
    const bool isSame =
        before.type == value.type && before.num == value.num && before.text == value.text && before.vec == value.vec;
    if (!isSame) changes.push_back({before, value});
  }
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const auto done = this->set(handle, changes[i].after, true);
    if (done) continue;
    while (i-- > 0) (void)this->set(handle, changes[i].before, true);
    return done;
  }
  if (sets_.find(handle)) history_.record(handle, label, changes);
  return {};
}

}  // namespace c3de::registry
