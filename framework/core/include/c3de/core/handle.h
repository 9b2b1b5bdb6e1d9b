// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace c3de {

/// The type of object that a handle refers to. Stored in the upper eight bits of its generation, so that handles of
/// different kinds are never equal.
enum class HandleKind : std::uint8_t {
  other,
  node,
  mesh,
  image,
  labelMap,
  tree,
  proxy,
  panel,
  tool,
  parameterSet,
  job,
  frameCallback,
  edit,
  forceField,
  simulationWatch,
  meshReader,
  command,
};
/// For messages: "scene node"; empty for `other` and invalid kinds.
[[nodiscard]] const char *nameOf(HandleKind kind);

/// Index and generation; zero is null. Represented as c3de_handle in the ABI.
struct Handle {
  std::uint32_t index = 0;
  std::uint32_t generation = 0;

  [[nodiscard]] bool isNull() const { return generation == 0; }
  [[nodiscard]] HandleKind kind() const { return static_cast<HandleKind>(generation >> 24); }
  /// The first generation of a kind.
  [[nodiscard]] static constexpr std::uint32_t firstOf(HandleKind kind) {
    return (static_cast<std::uint32_t>(kind) << 24) | 1u;
  }
  [[nodiscard]] std::uint64_t bits() const { return (std::uint64_t{generation} << 32) | index; }
  [[nodiscard]] static Handle fromBits(std::uint64_t v) {
    return {static_cast<std::uint32_t>(v), static_cast<std::uint32_t>(v >> 32)};
  }
  friend bool operator==(const Handle &, const Handle &) = default;
};

/// Slots addressed by Handle; a handle to a removed object is recognised as stale. Not synchronised.
template <class T, HandleKind kKind = HandleKind::other>
class HandleTable {
 public:
  Handle add(T value) {
    std::uint32_t index;
    if (!free_.empty()) {
      index = free_.back();
      free_.pop_back();
    } else {
      index = static_cast<std::uint32_t>(slots_.size());
      slots_.emplace_back();
    }
    Slot &slot = slots_[index];
    slot.value.emplace(std::move(value));
    return {index, slot.generation};
  }

  /// Null for a stale or null handle.
  [[nodiscard]] T *find(Handle h) { return isLive(h) ? &*slots_[h.index].value : nullptr; }
  [[nodiscard]] const T *find(Handle h) const { return isLive(h) ? &*slots_[h.index].value : nullptr; }

  bool remove(Handle h) {
    if (!isLive(h)) return false;
    Slot &slot = slots_[h.index];
    slot.value.reset();
    // Always retains its kind, and is never null.
    constexpr std::uint32_t kCounter = 0x00ffffffu;
    slot.generation = (slot.generation & kCounter) == kCounter ? Handle::firstOf(kKind) : slot.generation + 1;
    free_.push_back(h.index);
    return true;
  }

  /// Calls f(handle, value) in the order of the slots.
  template <class F>
  void forEach(F &&f) {
    for (std::uint32_t i = 0; i < slots_.size(); ++i)
      if (slots_[i].value) f(Handle{i, slots_[i].generation}, *slots_[i].value);
  }
  template <class F>
  void forEach(F &&f) const {
    for (std::uint32_t i = 0; i < slots_.size(); ++i)
      if (slots_[i].value) f(Handle{i, slots_[i].generation}, *slots_[i].value);
  }

  [[nodiscard]] std::size_t size() const { return slots_.size() - free_.size(); }

 private:
  struct Slot {
    std::optional<T> value;
    std::uint32_t generation = Handle::firstOf(kKind);
  };
  [[nodiscard]] bool isLive(Handle h) const {
    return !h.isNull() && h.index < slots_.size() && slots_[h.index].generation == h.generation &&
           slots_[h.index].value.has_value();
  }
  std::vector<Slot> slots_;
  std::vector<std::uint32_t> free_;
};

}  // namespace c3de
