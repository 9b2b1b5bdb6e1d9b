// SPDX-License-Identifier: Apache-2.0
#include "services/catalogue.h"

#include <fmt/format.h>

#include <array>
#include <vector>

#include "c3de/core/text.h"
#include "plugin_context.h"
#include "refusal.h"
#include "services/services.h"

namespace c3de::plugin_host {
namespace {

bool always(const Services &) { return true; }

template <auto Member>
bool has(const Services &services) {
  return services.*Member != nullptr;
}

template <auto Member>
const void *member(const ServiceTables &tables) {
  return &(tables.*Member);
}

bool hasRender(const Services &s) { return s.renderer && s.sceneGraph; }

constexpr std::array kCatalogue{
    ServiceEntry{C3DE_LOG_ID, &always, "", &member<&ServiceTables::log>},
    ServiceEntry{C3DE_REGISTRY_ID, &always, "", &member<&ServiceTables::registry>},
    ServiceEntry{C3DE_MESH_ID, &has<&Services::meshes>, "meshes", &member<&ServiceTables::mesh>},
    ServiceEntry{C3DE_SCENE_ID, &has<&Services::sceneGraph>, "a scene", &member<&ServiceTables::scene>},
    ServiceEntry{C3DE_RENDER_ID, &hasRender, "a window", &member<&ServiceTables::render>, kRenderRevision},
    ServiceEntry{C3DE_COLLISION_ID, &always, "", &member<&ServiceTables::collision>, kCollisionRevision},
    ServiceEntry{C3DE_PARAMS_ID, &has<&Services::parameters>, "parameters", &member<&ServiceTables::params>},
    ServiceEntry{C3DE_PANELS_ID, &has<&Services::panels>, "a window", &member<&ServiceTables::panels>},
    ServiceEntry{C3DE_TOOLS_ID, &has<&Services::tools>, "a window", &member<&ServiceTables::tools>, kToolsRevision},
    ServiceEntry{C3DE_JOBS_ID, &has<&Services::jobs>, "background jobs", &member<&ServiceTables::jobs>},
    ServiceEntry{C3DE_TIME_ID, &has<&Services::mainQueue>, "a main loop", &member<&ServiceTables::time>},
    ServiceEntry{C3DE_SIMULATION_ID, &has<&Services::simulations>, "simulations", &member<&ServiceTables::simulation>,
                 kSimulationRevision},
    ServiceEntry{C3DE_FORCES_ID, &has<&Services::forces>, "simulations", &member<&ServiceTables::forces>},
    ServiceEntry{C3DE_IMAGING_ID, &has<&Services::images>, "images", &member<&ServiceTables::imaging>},
    ServiceEntry{C3DE_FILES_ID, &has<&Services::meshFormats>, "meshes", &member<&ServiceTables::files>, kFilesRevision},
    ServiceEntry{C3DE_SETTINGS_ID, &has<&Services::settings>, "settings", &member<&ServiceTables::settings>},
    ServiceEntry{C3DE_COMMANDS_ID, &has<&Services::commands>, "a window", &member<&ServiceTables::commands>},
    ServiceEntry{C3DE_HISTORY_ID, &has<&Services::edits>, "a window", &member<&ServiceTables::history>,
                 kHistoryRevision},
};

/// Services that were published as "draft/c3de.NAME/0" before they were frozen as "c3de.NAME/1", with the same layout:
/// a request for the draft returns the frozen service.
constexpr std::array<std::string_view, 18> kFormerDrafts{
    "log",   "registry", "mesh",    "jobs",       "params", "panels",  "scene", "render",   "collision",
    "tools", "time",     "history", "simulation", "forces", "imaging", "files", "settings", "commands"};

std::string presentId(const std::string &id) {
  for (const std::string_view name : kFormerDrafts)
    if (id == fmt::format("draft/c3de.{}/0", name)) return fmt::format("c3de.{}/1", name);
  return id;
}

}  // namespace

std::span<const ServiceEntry> serviceCatalogue() { return kCatalogue; }

const ServiceEntry &findService(const std::string &id, std::uint32_t minRev, const Services &services) {
  const std::string present = presentId(id);
  for (const ServiceEntry &entry : kCatalogue) {
    if (present != entry.id) continue;
    if (minRev > entry.revision)
      throw Refusal(C3DE_E_VERSION, fmt::format("{} rev >= {}, host has {}", id, minRev, entry.revision));
    if (!entry.isServed(services))
      throw Refusal(C3DE_E_UNSUPPORTED,
                    fmt::format("{}, which is not available in this run (it needs {})", id, entry.needs));
    return entry;
  }
  std::vector<std::string> known;
  for (const ServiceEntry &entry : kCatalogue) known.emplace_back(entry.id);
  const std::string nearest = nearestName(id, known);
  throw Refusal(C3DE_E_NOT_FOUND, fmt::format("{}, which this host does not have{}", id,
                                              nearest.empty() ? "" : "; did you mean " + nearest + "?"));
}

}  // namespace c3de::plugin_host
