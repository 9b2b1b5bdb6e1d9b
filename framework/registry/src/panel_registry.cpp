// SPDX-License-Identifier: Apache-2.0
#include "c3de/registry/panel_registry.h"

#include <algorithm>
#include <ctime>

#include "c3de/core/log.h"

namespace c3de::registry {
namespace {

constexpr std::size_t kMaxLogged = 1000;

std::string timeOfDay() {
  const std::time_t now = std::time(nullptr);
  char text[16] = "";
  if (const std::tm *local = std::localtime(&now)) std::strftime(text, sizeof text, "%H:%M:%S", local);
  return text;
}

}  // namespace

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

void PanelRegistry::notify(std::uint32_t severity, std::string title, std::string text, std::vector<Choice> choices,
                           About about) {
  if (wording_) {
    std::string shownTitle = wording_(title), shown = wording_(text);
    if (shownTitle != title || shown != text) c3de::log(LogLevel::info, title + ": " + text);
    title = std::move(shownTitle);
    text = std::move(shown);
  }
  std::erase_if(notifications_, [&](const Notification &n) { return n.title == title; });
  notifications_.push_back(
      {severity, std::move(title), std::move(text), ++serial_, timeOfDay(), std::move(choices), about});
  if (log_.size() == kMaxLogged) log_.erase(log_.begin());
  log_.push_back(notifications_.back());
}

bool PanelRegistry::hasViewPanel() {
  const std::vector<Panel *> all = panels();
  return std::any_of(all.begin(), all.end(), [](const Panel *panel) { return panel->isInView; });
}

void PanelRegistry::dismissAboutSimulation(std::uint64_t upTo) {
  const auto isOver = [upTo](const Notification &n) { return n.about == About::simulation && n.serial <= upTo; };
  std::erase_if(notifications_, isOver);
  for (Notification &n : log_)
    if (isOver(n)) n.choices.clear();
}

void PanelRegistry::dismiss(std::uint64_t serial) {
  std::erase_if(notifications_, [serial](const Notification &n) { return n.serial == serial; });
}

}  // namespace c3de::registry
