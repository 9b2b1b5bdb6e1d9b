// SPDX-License-Identifier: Apache-2.0
#include "c3de/registry/parameter_history.h"

#include <utility>

#include "c3de/registry/parameter_registry.h"

namespace c3de::registry {

std::size_t ParameterHistory::bytesOf(const Entry &entry) {
  std::size_t bytes = sizeof(Entry) + entry.label.size();
  for (const ParameterValue *value : {&entry.before, &entry.after}) bytes += value->id.size() + value->text.size();
  return bytes;
}

void ParameterHistory::erase(std::size_t index) {
  bytes_ -= bytesOf(entries_[index]);
  // The rest of its group does not join the entry before it.
  if (!entries_[index].joinsPrevious && index + 1 < entries_.size()) entries_[index + 1].joinsPrevious = false;
  entries_.erase(entries_.begin() + static_cast<std::ptrdiff_t>(index));
  if (index < done_) --done_;
}

void ParameterHistory::forgetUndone() {
  while (canRedo()) erase(entries_.size() - 1);
}

void ParameterHistory::record(Handle set, const std::string &label, const ParameterValue &before,
                              const ParameterValue &after) {
  ++edits_;
  forgetUndone();
  if (isOpen_ && !entries_.empty() && entries_.back().set == set && entries_.back().after.id == after.id) {
    bytes_ -= bytesOf(entries_.back());
    entries_.back().after = after;
    bytes_ += bytesOf(entries_.back());
    return;
  }
  append({set, label, before, after, std::chrono::steady_clock::now()});
  isOpen_ = true;
}

void ParameterHistory::append(Entry entry) {
  entries_.push_back(std::move(entry));
  bytes_ += bytesOf(entries_.back());
  done_ = entries_.size();
  while (bytes_ > kBudget && entries_.size() > 1) erase(0);
}

void ParameterHistory::record(Handle set, const std::string &label, const std::vector<Change> &changes) {
  if (changes.empty()) return;
  ++edits_;
  forgetUndone();
  const Time now = std::chrono::steady_clock::now();
  bool joins = false;
  for (const Change &change : changes)
    append({set, label, change.before, change.after, now, std::exchange(joins, true)});
  isOpen_ = false;
}

void ParameterHistory::forget(Handle set) {
  for (std::size_t i = entries_.size(); i-- > 0;)
    if (entries_[i].set == set) erase(i);
  isOpen_ = false;
}

void ParameterHistory::undo(ParameterRegistry &registry) {
  isOpen_ = false;
  bool isAnyDone = false;
  while (done_ > 0) {
    const Entry entry = entries_[--done_];
    const bool isDone = registry.set(entry.set, entry.before, true).has_value();
    if (!isDone) erase(done_);
    isAnyDone = isAnyDone || isDone;
    if (isAnyDone && !entry.joinsPrevious) return;
  }
}

void ParameterHistory::redo(ParameterRegistry &registry) {
  isOpen_ = false;
  while (done_ < entries_.size()) {
    const Entry entry = entries_[done_];
    if (!registry.set(entry.set, entry.after, true)) {
      erase(done_);
      continue;
    }
    ++done_;
    if (!canRedo() || !entries_[done_].joinsPrevious) return;
  }
}

}  // namespace c3de::registry
