// SPDX-License-Identifier: Apache-2.0
// Objects that other plugins hold: refcounted, asked for interfaces by id.
#pragma once

#include <atomic>
#include <type_traits>
#include <utility>

#include "c3de/abi/object.h"
#include "c3de/sdk/guard.hpp"

namespace c3de::sdk {

/// One interface that a class of objects answers.
struct Interface {
  std::string_view id;
  std::uint32_t rev = 1;
  const void *table = nullptr;
};

/// An entry for Derived::interfaces(); the table has static storage.
template <class Table>
[[nodiscard]] constexpr Interface interfaceOf(const Table &table) noexcept {
  static_assert(!kTableId<Table>.empty(), "specialise c3de::sdk::kTableId for this table");
  return {kTableId<Table>, table.rev, &table};
}

/// Base of a class whose objects go through the boundary. Created with a count of one by make(); gone at zero.
///
/// Derived has `static` `interfaces()` that returns an array of Interface. Virtual functions and several bases are
/// fine: what the others see is a cell inside, not the start of the C++ object.
template <class Derived>
class Object {
 public:
  Object(const Object &) = delete;
  Object &operator=(const Object &) = delete;

  [[nodiscard]] c3de_object *abi() noexcept { return &cell_.object; }
  /// @pre the object was made by this plugin as a Derived
  [[nodiscard]] static Derived *from(c3de_object *object) noexcept {
    // The cell is standard layout and begins with the object.
    return static_cast<Derived *>(reinterpret_cast<Cell *>(object)->self);
  }
  std::uint32_t retain() noexcept { return count_.fetch_add(1, std::memory_order_relaxed) + 1; }
  std::uint32_t release() noexcept {
    const std::uint32_t left = count_.fetch_sub(1, std::memory_order_acq_rel) - 1;
    if (left == 0) delete static_cast<Derived *>(this);
    return left;
  }

 protected:
  Object() noexcept : cell_{{&kVt}, this} {}
  ~Object() = default;

 private:
  struct Cell {
    c3de_object object;
    Object *self;  // no Derived yet when it is set
  };
  static_assert(std::is_standard_layout_v<Cell>);

  static std::uint32_t C3DE_CALL retainThunk(c3de_object *self) noexcept { return from(self)->retain(); }
  static std::uint32_t C3DE_CALL releaseThunk(c3de_object *self) noexcept { return from(self)->release(); }
  static c3de_status C3DE_CALL queryThunk(c3de_object *, c3de_str id, std::uint32_t minRev,
                                          const void **table) noexcept {
    return guard([&]() -> c3de_status {
      if (!table) throw Error(C3DE_E_ARG, "query: table is null");
      *table = nullptr;
      for (const Interface &entry : Derived::interfaces()) {
        if (entry.id != text(id)) continue;
        if (entry.rev < minRev)
          throw Error(C3DE_E_VERSION, std::string(entry.id) + ": revision " + std::to_string(minRev) +
                                          " asked for, the object has " + std::to_string(entry.rev));
        *table = entry.table;
        return C3DE_OK;
      }
      throw Error(C3DE_E_NOT_FOUND, "the object does not implement " + std::string(text(id)));
    });
  }

  static constexpr c3de_object_vt kVt{sizeof(c3de_object_vt), 1, &retainThunk, &releaseThunk, &queryThunk};

  Cell cell_;
  std::atomic<std::uint32_t> count_{1};
};

/// Holds a count of an object: one's own class, or c3de_object for one of somebody else.
template <class T = c3de_object>
class Ref {
 public:
  Ref() noexcept = default;
  /// Takes over a count that the caller has.
  [[nodiscard]] static Ref adopt(T *object) noexcept {
    Ref ref;
    ref.object_ = object;
    return ref;
  }
  /// Adds a count.
  [[nodiscard]] static Ref share(T *object) noexcept {
    if (object) retain(object);
    return adopt(object);
  }
  Ref(const Ref &other) noexcept : Ref(share(other.object_)) {}
  Ref(Ref &&other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Ref &operator=(Ref other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  ~Ref() {
    if (object_) release(object_);
  }

  [[nodiscard]] T *get() const noexcept { return object_; }
  [[nodiscard]] T *operator->() const noexcept { return object_; }
  [[nodiscard]] T &operator*() const noexcept { return *object_; }
  explicit operator bool() const noexcept { return object_ != nullptr; }
  /// Gives the count away, for example into an out parameter.
  [[nodiscard]] T *detach() noexcept { return std::exchange(object_, nullptr); }
  [[nodiscard]] c3de_object *abi() const noexcept {
    if constexpr (std::is_same_v<T, c3de_object>)
      return object_;
    else
      return object_ ? object_->abi() : nullptr;
  }

  /// The table of an interface, null when the object does not answer it; its functions take abi() as `self`.
  template <class Table>
  [[nodiscard]] const Table *query(std::uint32_t minRev = 1) const noexcept {
    const void *table = nullptr;
    c3de_object *object = abi();
    if (!object) return nullptr;
    const c3de_status status = guard([&] { return object->vt->query(object, str(kTableId<Table>), minRev, &table); });
    return status < 0 ? nullptr : static_cast<const Table *>(table);
  }

 private:
  static void retain(T *object) noexcept {
    if constexpr (std::is_same_v<T, c3de_object>)
      guardQuietly("retain of an object", [&] { object->vt->retain(object); });
    else
      object->retain();
  }
  static void release(T *object) noexcept {
    if constexpr (std::is_same_v<T, c3de_object>)
      guardQuietly("release of an object", [&] { object->vt->release(object); });
    else
      object->release();
  }
  T *object_ = nullptr;
};

/// A new object of one's own class.
template <class Derived, class... Args>
[[nodiscard]] Ref<Derived> make(Args &&...args) {
  return Ref<Derived>::adopt(new Derived(std::forward<Args>(args)...));
}

namespace detail {

// What a thunk returns: a member that returns nothing or a Result<void> becomes a status.
template <class R>
using ThunkResult = std::conditional_t<std::is_void_v<R> || std::is_same_v<R, Result<void>>, c3de_status, R>;

template <class Derived, auto Member, class R, class... Args>
struct ObjectThunkBody {
  static ThunkResult<R> C3DE_CALL call(c3de_object *self, Args... args) noexcept {
    if constexpr (std::is_same_v<ThunkResult<R>, c3de_status>) {
      return guard([&]() -> R { return (Object<Derived>::from(self)->*Member)(args...); });
    } else {
      try {
        return (Object<Derived>::from(self)->*Member)(args...);
      } catch (...) {
        (void)statusOfException();
        return {};
      }
    }
  }
};

template <class Derived, auto Member, class Type = decltype(Member)>
struct ObjectThunk;
template <class D, auto M, class C, class R, class... A>
struct ObjectThunk<D, M, R (C::*)(A...)> : ObjectThunkBody<D, M, R, A...> {};
template <class D, auto M, class C, class R, class... A>
struct ObjectThunk<D, M, R (C::*)(A...) const> : ObjectThunkBody<D, M, R, A...> {};
template <class D, auto M, class C, class R, class... A>
struct ObjectThunk<D, M, R (C::*)(A...) noexcept> : ObjectThunkBody<D, M, R, A...> {};
template <class D, auto M, class C, class R, class... A>
struct ObjectThunk<D, M, R (C::*)(A...) const noexcept> : ObjectThunkBody<D, M, R, A...> {};

}  // namespace detail

/// Fills a slot of an interface table from a member function: thunk<Clock, &Clock::now>. The member takes what the slot
/// takes after `self` and returns a c3de_status, a Result<void>, nothing, or the slot's own type; it may throw.
template <class Derived, auto Member>
inline constexpr auto *thunk = &detail::ObjectThunk<Derived, Member>::call;

}  // namespace c3de::sdk
