// SPDX-License-Identifier: Apache-2.0
#include "refusal.h"

#include <new>

#include "last_error.h"

namespace c3de::plugin_host {
namespace {

void leaveText(const char *where, const char *what) noexcept {
  try {
    const std::string place = where ? std::string(where) + ": " : std::string();
    // If a service called itself through a plugin, its name is included only once.
    const bool isSaid = std::string_view(what).substr(0, place.size()) == place;
    setLastError(isSaid ? std::string(what) : place + what);
  } catch (...) {
    setLastError(std::string_view());
  }
}

}  // namespace

ErrorCode errorCodeOf(c3de_status status) noexcept {
  switch (status) {
    case C3DE_E_ARG:
    case C3DE_E_NOT_FOUND:
    case C3DE_E_EXISTS: return ErrorCode::usage;
    case C3DE_E_IO:
    case C3DE_E_FORMAT: return ErrorCode::input;
    case C3DE_E_CANCELLED: return ErrorCode::cancelled;
    case C3DE_E_DIVERGED: return ErrorCode::diverged;
    case C3DE_E_GPU: return ErrorCode::graphics;
    case C3DE_E_STATE:
    case C3DE_E_STALE:
    case C3DE_E_THREAD:
    case C3DE_E_TIMEOUT: return ErrorCode::state;
    case C3DE_E_VERSION:
    case C3DE_E_UNSUPPORTED:
    case C3DE_E_EXCEPTION: return ErrorCode::plugin;
    default: return ErrorCode::internal;
  }
}

c3de_status refuse(const char *where) noexcept {
  try {
    throw;
  } catch (const Refusal &refusal) {
    const bool aboutFile = refusal.status() == C3DE_E_FORMAT || refusal.status() == C3DE_E_IO;
    leaveText(aboutFile ? nullptr : where, refusal.what());
    return refusal.status();
  } catch (const std::bad_alloc &) {
    leaveText(where, "out of memory");
    return C3DE_E_NOMEM;
  } catch (const std::exception &e) {
    leaveText(where, e.what());
    return C3DE_E_EXCEPTION;
  } catch (...) {
    leaveText(where, "an exception that is not a std::exception");
    return C3DE_E_EXCEPTION;
  }
}

}  // namespace c3de::plugin_host
