// SPDX-License-Identifier: Apache-2.0
// One table per service and plugin; each is made in the file of its service. ctx is the PluginContext.
#pragma once

#include "c3de/abi/draft/all.h"
#include "services/catalogue.h"

namespace c3de::plugin_host {

class PluginContext;

[[nodiscard]] c3de_log_v1 makeLogTable(PluginContext *plugin);
[[nodiscard]] c3de_registry_v1 makeRegistryTable(PluginContext *plugin);
[[nodiscard]] c3de_mesh_v1 makeMeshTable(PluginContext *plugin);
[[nodiscard]] c3de_scene_v0 makeSceneTable(PluginContext *plugin);
[[nodiscard]] c3de_render_v0 makeRenderTable(PluginContext *plugin);
[[nodiscard]] c3de_collision_v0 makeCollisionTable(PluginContext *plugin);
[[nodiscard]] c3de_params_v1 makeParamsTable(PluginContext *plugin);
[[nodiscard]] c3de_panels_v1 makePanelsTable(PluginContext *plugin);
[[nodiscard]] c3de_tools_v0 makeToolsTable(PluginContext *plugin);
[[nodiscard]] c3de_jobs_v1 makeJobsTable(PluginContext *plugin);
[[nodiscard]] c3de_time_v0 makeTimeTable(PluginContext *plugin);
[[nodiscard]] c3de_simulation_v0 makeSimulationTable(PluginContext *plugin);
[[nodiscard]] c3de_forces_v0 makeForcesTable(PluginContext *plugin);
[[nodiscard]] c3de_imaging_v0 makeImagingTable(PluginContext *plugin);
[[nodiscard]] c3de_files_v0 makeFilesTable(PluginContext *plugin);
[[nodiscard]] c3de_settings_v0 makeSettingsTable(PluginContext *plugin);
[[nodiscard]] c3de_commands_v0 makeCommandsTable(PluginContext *plugin);
[[nodiscard]] c3de_history_v0 makeHistoryTable(PluginContext *plugin);

}  // namespace c3de::plugin_host
