// SPDX-License-Identifier: Apache-2.0
// One table per service and plugin; each is created in the file of its service. ctx is the PluginContext.
#pragma once

#include "c3de/abi/c3de.h"
#include "services/catalogue.h"

namespace c3de::plugin_host {

class PluginContext;

[[nodiscard]] c3de_log_v1 makeLogTable(PluginContext *plugin);
[[nodiscard]] c3de_registry_v1 makeRegistryTable(PluginContext *plugin);
[[nodiscard]] c3de_mesh_v1 makeMeshTable(PluginContext *plugin);
[[nodiscard]] c3de_scene_v1 makeSceneTable(PluginContext *plugin);
[[nodiscard]] c3de_render_v1 makeRenderTable(PluginContext *plugin);
[[nodiscard]] c3de_collision_v1 makeCollisionTable(PluginContext *plugin);
[[nodiscard]] c3de_params_v1 makeParamsTable(PluginContext *plugin);
[[nodiscard]] c3de_panels_v1 makePanelsTable(PluginContext *plugin);
[[nodiscard]] c3de_tools_v1 makeToolsTable(PluginContext *plugin);
[[nodiscard]] c3de_jobs_v1 makeJobsTable(PluginContext *plugin);
[[nodiscard]] c3de_time_v1 makeTimeTable(PluginContext *plugin);
[[nodiscard]] c3de_simulation_v1 makeSimulationTable(PluginContext *plugin);
[[nodiscard]] c3de_forces_v1 makeForcesTable(PluginContext *plugin);
[[nodiscard]] c3de_imaging_v1 makeImagingTable(PluginContext *plugin);
[[nodiscard]] c3de_files_v1 makeFilesTable(PluginContext *plugin);
[[nodiscard]] c3de_settings_v1 makeSettingsTable(PluginContext *plugin);
[[nodiscard]] c3de_commands_v1 makeCommandsTable(PluginContext *plugin);
[[nodiscard]] c3de_history_v1 makeHistoryTable(PluginContext *plugin);

}  // namespace c3de::plugin_host
