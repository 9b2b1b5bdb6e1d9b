// SPDX-License-Identifier: Apache-2.0
#include "c3de/registry/edit_list.h"

#include <algorithm>

#include "c3de/core/log.h"

namespace c3de::registry {
namespace {

std::size_t bytesOf(const Edit &edit) { return sizeof(Edit) + sizeof(Handle) + edit.owner.size() + edit.label.size(); }

}  // namespace

// A callback may add or remove steps, including its own, so every call uses a copy of the function and its `self`.

EditList::~EditList() {
  while (!order_.empty()) forget(order_.size() - 1);
}

Handle EditList::add(Edit edit) {
  ++edits_;
  forgetUndone();
  edit.madeAt = std::chrono::steady_clock::now();
  bytes_ += bytesOf(edit);
  while (bytes_ > kBudget && !order_.empty()) forget(0);
  const Handle handle = table_.add(std::move(edit));
  order_.push_back(handle);
  done_ = order_.size();
  return handle;
}

void EditList::forgetUndone() {
  while (order_.size() > done_) forget(order_.size() - 1);
}

void EditList::takeBack(Handle edit, bool isUndo) {
  const auto found = std::find(order_.begin(), order_.end(), edit);
  if (found == order_.end()) return;
  const auto index = static_cast<std::size_t>(found - order_.begin());
  done_ = isUndo ? std::max(done_, index + 1) : std::min(done_, index);
}

bool EditList::remove(Handle edit) {
  const auto found = std::find(order_.begin(), order_.end(), edit);
  if (found == order_.end()) return false;
  forget(static_cast<std::size_t>(found - order_.begin()));
  return true;
}

void EditList::removeOwnedBy(const std::string &plugin) {
  const std::vector<Handle> all = order_;
  for (const Handle handle : all)
    if (const Edit *edit = table_.find(handle); edit && edit->owner == plugin) remove(handle);
}

void EditList::forget(std::size_t index) {
  const Handle handle = order_[index];
  const Edit edit = *table_.find(handle);
  order_.erase(order_.begin() + static_cast<std::ptrdiff_t>(index));
  if (index < done_) --done_;
  table_.remove(handle);
  bytes_ -= bytesOf(edit);
  if (edit.release) edit.release(edit.self);
}

bool EditList::apply(std::size_t index, bool isUndo) {
  const Handle handle = order_[index];
  const Edit edit = *table_.find(handle);
  if ((isUndo ? edit.undo : edit.redo)(edit.self) >= 0) return true;
  log(LogLevel::warn, std::string(isUndo ? "undoing '" : "redoing '") + edit.label + "' failed; the step is removed");
  remove(handle);
  return false;
}

void EditList::undo() {
  if (done_ == 0) return;
  --done_;
  apply(done_, true);
}

void EditList::redo() {
  if (done_ == order_.size()) return;
  if (apply(done_, false)) ++done_;
}

}  // namespace c3de::registry
