// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/panel_registry.h"

#include <algorithm>

namespace c3de::ui {

Handle PanelRegistry::add(Panel panel) {
  const Handle handle = panels_.add(std::move(panel));
  order_.push_back(handle);
  return handle;
}

bool PanelRegistry::remove(Handle panel) {
  std::erase(order_, panel);
  return panels_.remove(panel);
}

void PanelRegistry::removeOwnedBy(const std::string &plugin) {
  const std::vector<Handle> all = order_;
  for (const Handle handle : all)
    if (const Panel *panel = panels_.find(handle); panel && panel->owner == plugin) remove(handle);
}

std::vector<Panel *> PanelRegistry::panels() {
  std::vector<Panel *> result;
  result.reserve(order_.size());
  for (const Handle handle : order_)
    if (Panel *panel = panels_.find(handle)) result.push_back(panel);
  return result;
}

void PanelRegistry::notify(std::uint32_t severity, std::string title, std::string text) {
  std::erase_if(notifications_, [&](const Notification &n) { return n.title == title; });
  notifications_.push_back({severity, std::move(title), std::move(text), ++serial_});
}

void PanelRegistry::dismiss(std::uint64_t serial) {
  std::erase_if(notifications_, [serial](const Notification &n) { return n.serial == serial; });
}

}  // namespace c3de::ui
