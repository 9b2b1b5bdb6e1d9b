// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/change_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "c3de/core/text.h"
#include "c3de/session/simulator_access.h"

namespace c3de::session {
namespace {

std::string textOf(c3de_str text) { return text.ptr ? std::string(text.ptr, text.len) : std::string(); }

/// Reordering is safe only among changes with no scene and no reset between them.
bool isBarrier(const SimulationSource::value_type &entry) {
  const auto *change = std::get_if<SimulationChange>(&entry);
  return !change || (change->flags & C3DE_SIM_CHANGE_RESETS) != 0;
}

}  // namespace

Expected<void> applyChange(c3de_object *simulator, const SimulationChange &change,
                           const std::function<std::string()> &takeError) {
  const auto table = changesTable(simulator);
  if (!table) return tl::unexpected(table.error());
  const std::string what = fmt::format("the change '{}' ({})", displayText(change.text), displayText(change.id));
  if (*table == nullptr) return fail(ErrorCode::input, what + " cannot be repeated: the simulator reports no changes");
  c3de_sim_change abi{};
  abi.size = sizeof abi;
  abi.flags = change.flags;
  abi.id = {change.id.data(), change.id.size()};
  abi.key = {change.key.data(), change.key.size()};
  abi.text = {change.text.data(), change.text.size()};
  abi.steps = change.steps;
  abi.bytes = change.bytes.data();
  abi.n = change.bytes.size();
  const c3de_status code = (*table)->apply(simulator, &abi);
  if (code >= 0) return {};
  const std::string reason = takeError ? takeError() : std::string();
  return fail(ErrorCode::input,
              fmt::format("{} cannot be repeated: {}", what, reason.empty() ? fmt::format("status {}", code) : reason));
}

Expected<std::unique_ptr<ChangeLog>> ChangeLog::create(c3de_object *simulator, SimulationSource source) {
  const auto table = changesTable(simulator);
  if (!table) return tl::unexpected(table.error());
  std::unique_ptr<ChangeLog> log(new ChangeLog(simulator, std::move(source)));
  simulator->vt->retain(simulator);
  if (*table == nullptr) return log;
  const c3de_status code = (*table)->observe(simulator, log.get(), [](void *observer, const c3de_sim_change *change) {
    if (change != nullptr) static_cast<ChangeLog *>(observer)->add(*change);
  });
  if (code < 0)
    return fail(ErrorCode::plugin, fmt::format("the simulator does not report its changes (status {})", code));
  log->table_ = *table;
  return log;
}

ChangeLog::~ChangeLog() {
  if (table_ != nullptr) table_->observe(simulator_, nullptr, nullptr);
  simulator_->vt->release(simulator_);
}

void ChangeLog::addScene(SharedScene scene) {
  const std::lock_guard lock(mutex_);
  source_.emplace_back(std::move(scene));
  ++count_;
}

SimulationSource ChangeLog::source() const {
  const std::lock_guard lock(mutex_);
  return source_;
}

std::uint64_t ChangeLog::count() const {
  const std::lock_guard lock(mutex_);
  return count_;
}

void ChangeLog::setListener(std::function<void(const SimulationChange &)> listener) {
  const std::lock_guard lock(listenerMutex_);
  listener_ = std::move(listener);
}

void ChangeLog::add(const c3de_sim_change &change) {
  if (unrecorded_.load() == std::this_thread::get_id()) return;
  SimulationChange copy{textOf(change.id), textOf(change.key), textOf(change.text), change.flags, change.steps, {}};
  if (change.bytes != nullptr) copy.bytes.assign(static_cast<const char *>(change.bytes), change.n);
  {
    const std::lock_guard lock(listenerMutex_);
    if (listener_) listener_(copy);
  }
  if (change.flags & C3DE_SIM_CHANGE_TRANSIENT) return;
  const std::lock_guard lock(mutex_);
  ++count_;
  if (!copy.key.empty()) {
    const auto after = std::find_if(source_.rbegin(), source_.rend(), isBarrier).base();
    source_.erase(std::remove_if(after, source_.end(),
                                 [&](const auto &entry) {
                                   const auto &earlier = std::get<SimulationChange>(entry);
                                   return earlier.id == copy.id && earlier.key == copy.key;
                                 }),
                  source_.end());
  }
  source_.emplace_back(std::move(copy));
}

}  // namespace c3de::session
