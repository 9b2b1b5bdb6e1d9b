// SPDX-License-Identifier: Apache-2.0
#include "c3de/registry/parameter_history.h"

#include "c3de/registry/parameter_registry.h"

namespace c3de::registry {

void ParameterHistory::record(Handle set, const std::string &label, const ParameterValue &before,
                              const ParameterValue &after) {
  ++edits_;
  entries_.resize(done_);
  if (isOpen_ && !entries_.empty() && entries_.back().set == set && entries_.back().after.id == after.id) {
    entries_.back().after = after;
    return;
  }
  if (entries_.size() == kMaxEntries) entries_.erase(entries_.begin());
  entries_.push_back({set, label, before, after});
  done_ = entries_.size();
  isOpen_ = true;
}

void ParameterHistory::forget(Handle set) {
  for (std::size_t i = entries_.size(); i-- > 0;)
    if (entries_[i].set == set) {
      entries_.erase(entries_.begin() + static_cast<std::ptrdiff_t>(i));
      if (i < done_) --done_;
    }
  isOpen_ = false;
}

void ParameterHistory::undo(ParameterRegistry &registry) {
  isOpen_ = false;
  while (done_ > 0) {
    const Entry entry = entries_[--done_];
    if (registry.set(entry.set, entry.before, true)) return;
    entries_.erase(entries_.begin() + static_cast<std::ptrdiff_t>(done_));
  }
}

void ParameterHistory::redo(ParameterRegistry &registry) {
  isOpen_ = false;
  while (done_ < entries_.size()) {
    const Entry entry = entries_[done_];
    if (registry.set(entry.set, entry.after, true)) {
      ++done_;
      return;
    }
    entries_.erase(entries_.begin() + static_cast<std::ptrdiff_t>(done_));
  }
}

}  // namespace c3de::registry
