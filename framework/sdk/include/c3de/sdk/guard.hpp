// SPDX-License-Identifier: Apache-2.0
// No exception may leave a function that the host calls: every thunk of the SDK goes through guard().
#pragma once

#include <new>
#include <type_traits>
#include <utility>

#include "c3de/sdk/host.hpp"

namespace c3de::sdk {

namespace detail {

/// The exception in flight as a status, its text left with the host. One function, so that thunks stay small.
inline c3de_status statusOfException() noexcept {
  try {
    throw;
  } catch (const Error &e) {
    // An Error thrown with a status that means "done" would hide the failure.
    const c3de_status status = e.status() < 0 ? e.status() : C3DE_E_INTERNAL;
    if (e.place())
      currentHost().setErrorAt(status, e.what(), *e.place());
    else
      currentHost().setError(status, e.what());
    return status;
  } catch (const std::bad_alloc &) {
    currentHost().setError(C3DE_E_NOMEM, "out of memory");
    return C3DE_E_NOMEM;
  } catch (const std::exception &e) {
    currentHost().setError(C3DE_E_EXCEPTION, e.what());
    return C3DE_E_EXCEPTION;
  } catch (...) {
    currentHost().setError(C3DE_E_EXCEPTION, "an exception that is not a std::exception");
    return C3DE_E_EXCEPTION;
  }
}

inline c3de_status toStatus(c3de_status status) noexcept { return status; }
inline c3de_status toStatus(const Result<void> &result) noexcept {
  if (result.ok()) return C3DE_OK;
  currentHost().setError(result.failure().status, result.failure().message);
  return result.failure().status;
}

}  // namespace detail

/// Runs f() and returns a status: f may return nothing, a c3de_status or a Result<void>, and may throw.
template <class F>
c3de_status guard(F &&f) noexcept {
  try {
    if constexpr (std::is_void_v<std::invoke_result_t<F>>) {
      std::forward<F>(f)();
      return C3DE_OK;
    } else {
      return detail::toStatus(std::forward<F>(f)());
    }
  } catch (...) {
    return detail::statusOfException();
  }
}

/// Runs f(), of which nobody takes a status: of an exception the host is told, which switches off what fails again and
/// again; an older one gets a line in its log.
template <class F>
void guardQuietly(const char *where, F &&f) noexcept {
  try {
    std::forward<F>(f)();
  } catch (...) {
    (void)detail::statusOfException();
    if (currentHost().callbackFailed()) return;
    try {
      const std::string line = std::string(where) + ": " + currentHost().takeError();
      if (const auto *log = currentHost().service<c3de_log_v1>()) log->write(log->ctx, C3DE_LOG_ERROR, str(line));
    } catch (...) {
    }
  }
}

}  // namespace c3de::sdk
