// SPDX-License-Identifier: Apache-2.0
#include "commands/version.h"

#include <array>
#include <nlohmann/json.hpp>
#include <string>

#include "c3de/abi/c3de.h"
#include "commands/standard_output.h"

namespace c3de::app {
namespace {

constexpr std::array kServices{C3DE_COLLISION_ID,  C3DE_COMMANDS_ID, C3DE_FILES_ID,    C3DE_SETTINGS_ID, C3DE_FORCES_ID,
                               C3DE_HISTORY_ID,    C3DE_IMAGING_ID,  C3DE_JOBS_ID,     C3DE_LOG_ID,      C3DE_MESH_ID,
                               C3DE_PANELS_ID,     C3DE_PARAMS_ID,   C3DE_REGISTRY_ID, C3DE_RENDER_ID,   C3DE_SCENE_ID,
                               C3DE_SIMULATION_ID, C3DE_TIME_ID,     C3DE_TOOLS_ID};

}  // namespace

void printVersion(bool json) {
  if (!json) {
    printOut("c3de " C3DE_VERSION ", plugin ABI " + std::to_string(C3DE_ABI_MAJOR) + "." +
             std::to_string(C3DE_ABI_MINOR) + "\n");
    return;
  }
  const nlohmann::ordered_json out{{"product", "c3de"},
                                   {"version", C3DE_VERSION},
                                   {"abi", {{"major", C3DE_ABI_MAJOR}, {"minor", C3DE_ABI_MINOR}}},
                                   {"services", kServices}};
  printOut(out.dump(2) + "\n");
}

}  // namespace c3de::app
