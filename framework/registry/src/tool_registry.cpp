// SPDX-License-Identifier: Apache-2.0
#include "c3de/registry/tool_registry.h"

#include <algorithm>

namespace c3de::registry {

// A callback may add or remove tools, including its own, so every call uses a copy of the function and its `self`.

Handle ToolRegistry::add(Tool tool) {
  const Handle handle = tools_.add(std::move(tool));
  order_.push_back(handle);
  return handle;
}

bool ToolRegistry::remove(Handle tool) {
  if (!tools_.find(tool)) return false;
  if (tool == active_) {
    cancelActive();
    active_ = {};
  }
  std::erase(order_, tool);
  return tools_.remove(tool);
}

void ToolRegistry::removeOwnedBy(const std::string &plugin) {
  const std::vector<Handle> all = order_;
  for (const Handle handle : all)
    if (const Tool *tool = tools_.find(handle); tool && tool->owner == plugin) remove(handle);
}

bool ToolRegistry::activate(Handle tool) {
  if (!tool.isNull() && !tools_.find(tool)) return false;
  cancelActive();
  active_ = {};
  const Tool *found = tools_.find(tool);
  if (!found) return tool.isNull();
  const auto activateFn = found->activate;
  if (activateFn && activateFn(found->self) < 0) return false;
  active_ = tools_.find(tool) ? tool : Handle{};
  return !active_.isNull();
}

void ToolRegistry::cancelActive() {
  const Tool *tool = tools_.find(active_);
  if (!tool || !tool->cancel) return;
  const auto cancel = tool->cancel;
  cancel(tool->self);
}

bool ToolRegistry::worksInSlices() const {
  const Tool *tool = tools_.find(active_);
  return tool && tool->inSlices;
}

bool ToolRegistry::dispatch(const c3de_event &event) {
  const Tool *tool = tools_.find(active_);
  if (!tool || !tool->onEvent || (event.where != C3DE_IN_SPACE && !tool->inSlices)) return false;
  const auto onEvent = tool->onEvent;
  std::uint32_t consumed = 0;
  return onEvent(tool->self, &event, &consumed) >= 0 && consumed != 0;
}

std::vector<ToolRegistry::Entry> ToolRegistry::tools() const {
  std::vector<Entry> result;
  result.reserve(order_.size());
  for (const Handle handle : order_)
    if (const Tool *tool = tools_.find(handle)) result.push_back({handle, tool});
  return result;
}

}  // namespace c3de::registry
