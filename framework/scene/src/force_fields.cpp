// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/force_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "c3de/core/log.h"
#include "c3de/core/text.h"
#include "shared_points.h"

namespace c3de::scene {
namespace {

// The first number that is not finite. Exponents with all bits set are detected without a branch per number.
std::optional<std::size_t> firstNonFinite(const double *values, std::size_t count) {
  constexpr std::uint64_t kExponent = 0x7ff0000000000000u, kUnit = 0x0010000000000000u;
  std::uint64_t overflow = 0;
  for (std::size_t i = 0; i < count; ++i) overflow |= (std::bit_cast<std::uint64_t>(values[i]) & kExponent) + kUnit;
  if (overflow >> 63 == 0) return std::nullopt;
  for (std::size_t i = 0; i < count; ++i)
    if (!std::isfinite(values[i])) return i;
  return std::nullopt;
}

bool givesPoints(const c3de_simulator_v1 *table) { return table->points != nullptr; }

bool actsOn(const ForceFields::Field &field, Handle simulation) {
  return field.simulation.isNull() || field.simulation == simulation;
}

}  // namespace

ForceFields::ForceFields() : lent_(std::make_unique<SharedPoints>()) {}
ForceFields::~ForceFields() = default;

Handle ForceFields::add(Field field) {
  if (applying_ == std::this_thread::get_id()) return {};
  const std::lock_guard lock(mutex_);
  const Handle handle{next_++, Handle::firstOf(HandleKind::forceField)};
  fields_.emplace(handle.bits(), std::move(field));
  count_ = fields_.size();
  return handle;
}

ForceFields::Removal ForceFields::remove(Handle field, const std::string &owner) {
  if (applying_ == std::this_thread::get_id()) return Removal::fromApply;
  const std::lock_guard lock(mutex_);
  const auto found = fields_.find(field.bits());
  if (found == fields_.end() || found->second.owner != owner) return Removal::stale;
  fields_.erase(found);
  count_ = fields_.size();
  return Removal::done;
}

void ForceFields::removeOwnedBy(const std::string &owner) {
  const std::lock_guard lock(mutex_);
  std::erase_if(fields_, [&](const auto &entry) { return entry.second.owner == owner; });
  count_ = fields_.size();
}

Expected<void> ForceFields::apply(Handle simulation, c3de_object *simulator, const c3de_simulator_v1 *table) {
  if (count_ == 0) return {};
  const std::lock_guard lock(mutex_);
  const auto acts = [&](const auto &entry) { return actsOn(entry.second, simulation); };
  const auto first = std::find_if(fields_.begin(), fields_.end(), acts);
  if (first == fields_.end()) return {};
  if (!givesPoints(table)) {
    const std::string message = fmt::format(
        "the force field '{}' of {} cannot act: the simulator takes no forces from outside (points() of {} is "
        "null); it and all others that would act here are removed",
        first->second.name, first->second.owner, C3DE_IFACE_SIMULATOR_ID);
    std::erase_if(fields_, acts);
    count_ = fields_.size();
    return fail(ErrorCode::plugin, message);
  }
  c3de_sim_status status{};
  status.size = sizeof status;
  if (table->status(simulator, &status) < 0) return fail(ErrorCode::plugin, "the simulator does not say its status");
  struct Applying {
    explicit Applying(std::atomic<std::thread::id> &where) : thread(where) { thread = std::this_thread::get_id(); }
    ~Applying() { thread = std::thread::id(); }
    std::atomic<std::thread::id> &thread;
  } const applying(applying_);
  for (std::uint64_t i = 0; i < status.bodies; ++i) {
    c3de_handle body{};
    if (table->body_at(simulator, i, &body) < 0) continue;
    const auto applied = applyTo(simulation, simulator, table, body, status.time_s);
    if (applied) continue;
    // Forces written for other bodies must not act in a later step.
    for (std::uint64_t k = 0; k <= i; ++k) {
      c3de_sim_points points{};
      points.size = sizeof points;
      if (table->body_at(simulator, k, &body) >= 0) (void)table->points(simulator, body, &points);
    }
    return applied;
  }
  return {};
}

Expected<void> ForceFields::applyTo(Handle simulation, c3de_object *simulator, const c3de_simulator_v1 *table,
                                    c3de_handle body, double time_s) {
  c3de_sim_points points{};
  points.size = sizeof points;
  if (table->points(simulator, body, &points) < 0 || points.count == 0) return {};
  if (!points.positions_m || !points.velocities_m_s || !points.masses_kg || !points.forces_N)
    return fail(ErrorCode::plugin,
                fmt::format("points() of the simulator gives null for an array of body '{}', which has {} points",
                            fromAbi(points.name), points.count));
  lent_->lend(points);
  const c3de_sim_points &lent = lent_->points();
  const c3de_force_call call{sizeof(c3de_force_call),
                             0,
                             {simulation.bits()},
                             body,
                             lent.name,
                             time_s,
                             lent.count,
                             lent.positions_m,
                             lent.velocities_m_s,
                             lent.masses_kg,
                             lent.forces_N};
  const std::size_t numbers = 3 * static_cast<std::size_t>(lent.count);
  for (auto at = fields_.begin(); at != fields_.end(); ++at) {
    Field &field = at->second;
    if (!actsOn(field, simulation)) continue;
    std::string why;
    if (const c3de_status code = field.apply(call); code < 0) {
      why = field.takeError ? field.takeError() : std::string();
      if (why.empty()) why = fmt::format("status {}", code);
    } else if (const char *array = lent_->overrun()) {
      why = fmt::format("it has written beyond the end of {}, which has {} points", array, lent.count);
    } else if (const auto bad = firstNonFinite(lent.forces_N, numbers)) {
      why = fmt::format("the force on its point {} is {}", *bad / 3, lent.forces_N[*bad]);
    } else {
      const char *written = lent_->restoreReadOnly();
      if (written != nullptr && !std::exchange(field.isReported, true))
        log(LogLevel::error,
            fmt::format("the force field '{}' of {} writes to {}, which it may only read; that has no effect",
                        field.name, field.owner, written));
      continue;
    }
    const std::string message = fmt::format("the force field '{}' of {} is removed: for body '{}': {}", field.name,
                                            field.owner, fromAbi(points.name), why);
    fields_.erase(at);
    count_ = fields_.size();
    return fail(ErrorCode::plugin, message);
  }
  lent_->returnForces();
  return {};
}

}  // namespace c3de::scene
