// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "arguments.h"
#include "c3de/abi/jobs.h"
#include "c3de/core/progress.h"
#include "c3de/core/text.h"

namespace c3de::plugin_host {

/// Wraps a plugin's progress struct in the host's function type; empty for null.
[[nodiscard]] inline ProgressFn progressOf(const c3de_progress *progress) {
  if (!progress) return {};
  const c3de_progress in = structOf(progress, "progress");
  requireNonNull(in.update, "progress update");
  return [in](double fraction, const std::string &what) { return in.update(in.self, fraction, toAbi(what)) >= 0; };
}

}  // namespace c3de::plugin_host
