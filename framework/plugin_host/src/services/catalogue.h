// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "c3de/plugin_host/plugin_host.h"

namespace c3de::plugin_host {

/// Revision of services of this host that have not been extended.
inline constexpr std::uint32_t kServiceRevision = 1;
/// Revisions of extended services: legends; pairs of triangles; watching simulations; writers; the marked point;
/// captured simulations.
inline constexpr std::uint32_t kRenderRevision = 2, kCollisionRevision = 2, kSimulationRevision = 2, kFilesRevision = 2,
                               kToolsRevision = 2, kHistoryRevision = 2;

struct ServiceTables;

/// A service of this host.
struct ServiceEntry {
  const char *id;
  bool (*isServed)(const Services &);
  const char *needs;  ///< what a run needs to provide it
  const void *(*table)(const ServiceTables &);
  std::uint32_t revision = kServiceRevision;
};

[[nodiscard]] std::span<const ServiceEntry> serviceCatalogue();

/// Throws Refusal: C3DE_E_NOT_FOUND, C3DE_E_UNSUPPORTED, C3DE_E_VERSION with both revisions.
[[nodiscard]] const ServiceEntry &findService(const std::string &id, std::uint32_t minRev, const Services &services);

}  // namespace c3de::plugin_host
