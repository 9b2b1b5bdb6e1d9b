// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/simulation_directory.h"

#include <algorithm>
#include <utility>

namespace c3de::scene {

void SimulationDirectory::add(Handle node, const std::string &title, std::shared_ptr<Simulation> simulation) {
  {
    const std::lock_guard lock(mutex_);
    entries_.push_back({node, title, std::move(simulation)});
  }
  tell(node, &Watch::added);
}

void SimulationDirectory::remove(Handle node) {
  // Destroyed after the lock: the last owner ends the simulation's thread, which may be waiting for this lock.
  std::shared_ptr<Simulation> gone;
  {
    const std::lock_guard lock(mutex_);
    const auto found =
        std::find_if(entries_.begin(), entries_.end(), [node](const Entry &entry) { return entry.node == node; });
    if (found == entries_.end()) return;
    gone = std::move(found->simulation);
    entries_.erase(found);
  }
  tell(node, &Watch::removed);
}

std::shared_ptr<Simulation> SimulationDirectory::find(Handle node) const {
  const std::lock_guard lock(mutex_);
  for (const Entry &entry : entries_)
    if (entry.node == node) return entry.simulation;
  return nullptr;
}

std::vector<SimulationDirectory::Entry> SimulationDirectory::all() const {
  const std::lock_guard lock(mutex_);
  return entries_;
}

/// Uses copies: a watcher may be added or removed from within.
void SimulationDirectory::tell(Handle node, std::function<void(Handle)> Watch::*what) {
  std::vector<std::function<void(Handle)>> told;
  {
    const std::lock_guard lock(watchMutex_);
    for (const auto &[number, watch] : watches_)
      if (watch.*what) told.push_back(watch.*what);
  }
  for (const auto &function : told) function(node);
}

Handle SimulationDirectory::watch(Watch watch) {
  const auto added = watch.added;
  Handle handle;
  {
    const std::lock_guard lock(watchMutex_);
    handle = {next_++, Handle::firstOf(HandleKind::simulationWatch)};
    watches_.emplace(handle.bits(), std::move(watch));
    watchers_ = watches_.size();
  }
  if (added)
    for (const Entry &entry : all()) added(entry.node);
  return handle;
}

SimulationDirectory::Removal SimulationDirectory::unwatch(Handle watch, const std::string &owner) {
  if (telling_ == std::this_thread::get_id()) return Removal::fromStepped;
  const std::lock_guard lock(watchMutex_);
  const auto found = watches_.find(watch.bits());
  if (found == watches_.end() || found->second.owner != owner) return Removal::stale;
  watches_.erase(found);
  watchers_ = watches_.size();
  return Removal::done;
}

void SimulationDirectory::unwatchOwnedBy(const std::string &owner) {
  const std::lock_guard lock(watchMutex_);
  std::erase_if(watches_, [&](const auto &entry) { return entry.second.owner == owner; });
  watchers_ = watches_.size();
}

void SimulationDirectory::stepped(Handle node, const c3de_sim_status &status) {
  if (watchers_ == 0) return;
  const std::lock_guard lock(watchMutex_);
  telling_ = std::this_thread::get_id();
  for (const auto &[number, watch] : watches_)
    if (watch.stepped) watch.stepped(node, status);
  telling_ = std::thread::id{};
}

}  // namespace c3de::scene
