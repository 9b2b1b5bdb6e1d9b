// SPDX-License-Identifier: Apache-2.0
#include "simulator/changes.h"

#include "c3de/sdk/structs.hpp"
#include "simulator/world_simulator.h"

namespace pointbased {
namespace {

using sdk::Error;

std::uint32_t flagsOf(const AnyChange &change) {
  return std::visit(
      []<class Kind>(const Kind &kind) -> std::uint32_t {
        if constexpr (requires { kind.flags(); })
          return kind.flags();
        else if constexpr (requires { Kind::kFlags; })
          return Kind::kFlags;
        else
          return 0;
      },
      change);
}

std::string keyOf(const AnyChange &change) {
  return std::visit(
      [](const auto &kind) -> std::string {
        if constexpr (requires { kind.key(); })
          return kind.key();
        else
          return {};
      },
      change);
}

bool isOfTheView(const AnyChange &change) {
  const auto *values = std::get_if<SetWorldParameters>(&change);
  return values && values->isOfTheView();
}

template <std::size_t kind = 0>
AnyChange decode(std::string_view id, std::string_view bytes) {
  if constexpr (kind == std::variant_size_v<AnyChange>) {
    throw Error(C3DE_E_FORMAT, "unknown kind of change '" + std::string(id) + "'");
  } else {
    using Kind = std::variant_alternative_t<kind, AnyChange>;
    return id == Kind::kId ? AnyChange(changeOf<Kind>(bytes)) : decode<kind + 1>(id, bytes);
  }
}

}  // namespace

void Changes::observe(void *observer, Changed changed) {
  const std::lock_guard lock(observerMutex_);
  observer_ = observer;
  changed_ = changed;
}

void Changes::apply(const c3de_sim_change *change) {
  const c3de_sim_change in = sdk::readStruct(change, "change");
  if (in.bytes == nullptr && in.n > 0) throw Error(C3DE_E_ARG, "the bytes of the change are null");
  const std::string_view bytes(static_cast<const char *>(in.bytes), static_cast<std::size_t>(in.n));
  AnyChange decoded = decode(sdk::text(in.id), bytes);
  execute(decoded, sdk::Progress(nullptr));
}

void Changes::execute(AnyChange &change, const sdk::Progress &progress) {
  SimulatedWorld &world = parts_.world;
  std::optional<StepInterrupt::Waiting> waiting;
  std::visit(
      [&](auto &kind) {
        if constexpr (requires { kind.prepare(parts_, progress); }) {
          kind.prepare(parts_, progress);
          waiting.emplace(world.request);
        }
      },
      change);
  const StateLock lock(world);
  const std::uint64_t steps = world.simulator.steps(), resets = world.resets;
  std::visit([&](auto &kind) { kind.apply(parts_, ChangeAccess()); }, change);
  report(change, steps, world.resets != resets);
}

void Changes::report(AnyChange &change, std::uint64_t steps, bool isReset) {
  const std::uint32_t flags = flagsOf(change);
  std::string key = (flags & kTransient) != 0 ? std::string() : keyOf(change);
  if ((flags & kTransient) == 0 && key.empty()) ++unkeyed_;
  if (!key.empty() && unkeyed_ > 0 && !isOfTheView(change)) key += "\n#" + std::to_string(unkeyed_);
  const std::lock_guard lock(observerMutex_);
  if (changed_ == nullptr) return;
  std::visit(
      [&]<class Kind>(Kind &kind) {
        const std::string bytes = bytesOf(kind), text = kind.text();
        const c3de_sim_change out{sizeof out,          flags | (isReset ? C3DE_SIM_CHANGE_RESETS : 0u),
                                  sdk::str(Kind::kId), sdk::str(key),
                                  sdk::str(text),      steps,
                                  bytes.data(),        bytes.size()};
        changed_(observer_, &out);
      },
      change);
}

}  // namespace pointbased
