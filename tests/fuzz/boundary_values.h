// SPDX-License-Identifier: Apache-2.0
// Values on and beyond the limits of functions at the plugin boundary. Pointers refer to memory that is readable, and
// writable where they are not const, or are null: errors that no function can detect are not tried.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "c3de/abi/c3de.h"
#include "c3de/abi/object.h"

namespace fuzz {

/// The name of a type as the compiler writes it: "c3de_tool".
template <class T>
constexpr std::string_view typeName() {
  constexpr std::string_view all = __PRETTY_FUNCTION__;
  constexpr auto begin = all.find("T = ") + 4;
  return all.substr(begin, all.find_first_of(";]", begin) - begin);
}

class BoundaryValues {
 public:
  explicit BoundaryValues(std::uint64_t seed);

  /// One in n.
  [[nodiscard]] bool chance(std::size_t n) { return below(n) == 0; }
  [[nodiscard]] std::size_t below(std::size_t n) { return static_cast<std::size_t>(engine_() % n); }

  /// Before the arguments of a call.
  void beginCall() {
    rows_ = 4 + 4 * below(2);
    areDouble_ = chance(2);
  }
  [[nodiscard]] std::uint32_t u32();
  [[nodiscard]] std::uint64_t u64();
  [[nodiscard]] double real();
  [[nodiscard]] c3de_str text();
  [[nodiscard]] c3de_handle handle();
  [[nodiscard]] c3de_view view();
  [[nodiscard]] c3de_sink sink();
  /// Handles returned by functions are used again.
  void remember(c3de_handle handle);
  /// Handles that are not dropped in favour of others.
  void keep(c3de_handle handle) { keptHandles_.push_back(handle); }
  /// Texts too: ids of classes, keys.
  void remember(std::string text) { texts_.push_back(std::move(text)); }

  /// Some elements of a struct whose name is in the list of the boundary, filled with values for their types; mostly
  /// with the right size. Valid until forget().
  [[nodiscard]] void *structs(std::string_view name, std::size_t n, int depth = 0);
  [[nodiscard]] std::size_t sizeOf(std::string_view name) const;
  /// Zeroed, writable memory.
  [[nodiscard]] void *memory(std::size_t bytes);
  void forget() { kept_.clear(); }
  /// An object without interfaces that is never destroyed.
  [[nodiscard]] static c3de_object *object();

  /// An argument of any type that service functions accept.
  template <class T>
  T make() {
    using Plain = std::remove_cv_t<T>;
    if constexpr (std::is_same_v<Plain, c3de_str>) {
      return text();
    } else if constexpr (std::is_same_v<Plain, c3de_handle>) {
      return handle();
    } else if constexpr (std::is_same_v<Plain, c3de_view>) {
      return view();
    } else if constexpr (std::is_same_v<Plain, c3de_mview>) {
      const c3de_view v = view();
      return c3de_mview{const_cast<void *>(v.data), v.count, v.comps, v.dtype, v.stride};
    } else if constexpr (std::is_same_v<Plain, c3de_sink>) {
      return sink();
    } else if constexpr (std::is_floating_point_v<Plain>) {
      return static_cast<T>(real());
    } else if constexpr (std::is_same_v<Plain, std::uint64_t>) {
      return u64();
    } else if constexpr (std::is_integral_v<Plain>) {
      return static_cast<T>(u32());
    } else {
      static_assert(std::is_pointer_v<Plain>);
      return makePointer<std::remove_pointer_t<Plain>>();
    }
  }

 private:
  struct Member {
    std::string name, type;
    std::size_t offset = 0, size = 0;
  };
  struct Struct {
    std::size_t size = 0;
    std::vector<Member> members;
  };

  template <class Pointed>
  Pointed *makePointer() {
    using Plain = std::remove_cv_t<Pointed>;
    if (chance(8)) return nullptr;
    if constexpr (std::is_function_v<Pointed>) {
      return reinterpret_cast<Pointed *>(nothing());
    } else if constexpr (std::is_void_v<Plain>) {
      return memory(64);
    } else if constexpr (std::is_same_v<Plain, c3de_object>) {
      return object();
    } else if constexpr (std::is_class_v<Plain>) {
      return static_cast<Pointed *>(structs(typeName<Plain>(), kResults));
    } else if constexpr (std::is_floating_point_v<Plain>) {
      return static_cast<Pointed *>(reals(sizeof(Plain)));
    } else {
      return static_cast<Pointed *>(memory(kMemory));
    }
  }

  /// A function that does nothing and returns 0, for any signature.
  [[nodiscard]] static void *nothing();
  [[nodiscard]] void *reals(std::size_t size);
  void fill(unsigned char *at, const Struct &type, int depth);
  void fill(unsigned char *at, const Member &member, int depth);

  static constexpr std::size_t kArray = 4, kMaxRows = 12, kResults = 16, kMemory = std::size_t{1} << 16;

  std::mt19937_64 engine_;
  std::size_t rows_ = 4;   ///< common to the views of a call, as most functions require
  bool areDouble_ = true;  ///< common as well
  std::map<std::string, Struct, std::less<>> types_;
  std::deque<std::vector<std::uint64_t>> kept_;  ///< allocated memory
  std::vector<c3de_handle> handles_, keptHandles_;
  std::deque<std::string> texts_;
};

}  // namespace fuzz
