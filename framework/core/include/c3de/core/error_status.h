// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/abi/base.h"
#include "c3de/core/expected.h"

namespace c3de {

/// The status that crosses a C boundary for an error: of services to plugins, of c3de/embed.h to programs.
[[nodiscard]] constexpr c3de_status statusOf(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::usage: return C3DE_E_ARG;
    case ErrorCode::input: return C3DE_E_FORMAT;
    case ErrorCode::plugin: return C3DE_E_UNSUPPORTED;
    case ErrorCode::diverged: return C3DE_E_DIVERGED;
    case ErrorCode::graphics: return C3DE_E_GPU;
    case ErrorCode::output: return C3DE_E_IO;
    case ErrorCode::cancelled: return C3DE_E_CANCELLED;
    case ErrorCode::state: return C3DE_E_STATE;
    case ErrorCode::internal: break;
  }
  return C3DE_E_INTERNAL;
}

}  // namespace c3de
