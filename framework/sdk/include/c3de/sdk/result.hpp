// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

#include "c3de/abi/base.h"

namespace c3de::sdk {

/// What a call did not do, and why; status is below zero.
struct Failure {
  c3de_status status = C3DE_E_INTERNAL;
  std::string message;
};

/// A value or a failure.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  Result(Failure failure) : state_(std::in_place_index<1>, std::move(failure)) {}

  [[nodiscard]] bool ok() const noexcept { return state_.index() == 0; }
  explicit operator bool() const noexcept { return ok(); }
  /// @pre ok()
  [[nodiscard]] T &value() & { return std::get<0>(state_); }
  [[nodiscard]] const T &value() const & { return std::get<0>(state_); }
  [[nodiscard]] T &&value() && { return std::get<0>(std::move(state_)); }
  [[nodiscard]] T &operator*() & { return value(); }
  [[nodiscard]] const T &operator*() const & { return value(); }
  [[nodiscard]] T &&operator*() && { return std::move(*this).value(); }
  [[nodiscard]] T *operator->() { return &value(); }
  [[nodiscard]] const T *operator->() const { return &value(); }
  /// @pre !ok()
  [[nodiscard]] const Failure &failure() const { return std::get<1>(state_); }

 private:
  std::variant<T, Failure> state_;
};

template <>
class [[nodiscard]] Result<void> {
 public:
  Result() noexcept = default;
  Result(Failure failure) : failure_(std::move(failure)) {}

  [[nodiscard]] bool ok() const noexcept { return !failure_; }
  explicit operator bool() const noexcept { return ok(); }
  [[nodiscard]] const Failure &failure() const { return *failure_; }

 private:
  std::optional<Failure> failure_;
};

/// What of the things that a function was given an error is about: c3de_error_place.
struct ErrorPlace {
  std::string table;  ///< for example "fix"; empty: none
  std::uint32_t index = 0;
  std::string key;  ///< of a parameter; empty: none
};

/// For use inside the plugin: a thunk turns it into its status and leaves the text with the host.
class Error : public std::runtime_error {
 public:
  Error(c3de_status status, const std::string &message) : std::runtime_error(message), status_(status) {}
  explicit Error(const Failure &failure) : Error(failure.status, failure.message) {}
  /// @param message  need not name the place: the host does
  Error(c3de_status status, const std::string &message, ErrorPlace place)
      : std::runtime_error(message), status_(status), place_(std::move(place)) {}
  [[nodiscard]] c3de_status status() const noexcept { return status_; }
  [[nodiscard]] const std::optional<ErrorPlace> &place() const noexcept { return place_; }

 private:
  c3de_status status_;
  std::optional<ErrorPlace> place_;
};

/// The value, or Error thrown: for constructors, where a thunk stands above.
template <class T>
T orThrow(Result<T> result) {
  if (!result.ok()) throw Error(result.failure());
  if constexpr (!std::is_void_v<T>) return std::move(result).value();
}

}  // namespace c3de::sdk
