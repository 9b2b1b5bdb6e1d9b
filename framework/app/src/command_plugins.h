// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app.h"
#include "c3de/session/session.h"

namespace c3de::app {

/// `c3de plugins`: what was found, loaded, refused and why, on stdout. Returns the exit code: a plugin that was named
/// with
/// --plugin and refused counts as an error, one that lies in a folder does not.
[[nodiscard]] int listPlugins(const SessionOptions &options, bool json);

/// `c3de --version`: product, ABI and services.
void printVersion(bool json);

}  // namespace c3de::app
