// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "c3de/abi/entry.h"
#include "c3de/core/expected.h"
#include "c3de/core/platform.h"
#include "c3de/plugin_host/plugin_host.h"

namespace c3de::plugin_host {

/// What a library states about itself, checked.
struct Candidate {
  c3de_plugin plugin{};  ///< members known to both sides
  std::string id, version, displayName, vendor, license;
};

/// Queries the library (c3de_plugin_query), and checks ABI number, descriptor and required services. The error is one
/// line.
[[nodiscard]] Expected<Candidate> negotiate(const DynamicLibrary &library, const Services &services);

}  // namespace c3de::plugin_host
