// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "c3de/abi/c3de.h"

namespace c3de::sdk {

/// Id of the service or interface that a table belongs to. A plugin that publishes a table of its own specialises it.
template <class Table>
inline constexpr std::string_view kTableId{};

template <>
inline constexpr std::string_view kTableId<c3de_log_v1>{C3DE_LOG_ID};
template <>
inline constexpr std::string_view kTableId<c3de_registry_v1>{C3DE_REGISTRY_ID};
template <>
inline constexpr std::string_view kTableId<c3de_mesh_v1>{C3DE_MESH_ID};
template <>
inline constexpr std::string_view kTableId<c3de_scene_v1>{C3DE_SCENE_ID};
template <>
inline constexpr std::string_view kTableId<c3de_render_v1>{C3DE_RENDER_ID};
template <>
inline constexpr std::string_view kTableId<c3de_collision_v1>{C3DE_COLLISION_ID};
template <>
inline constexpr std::string_view kTableId<c3de_forces_v1>{C3DE_FORCES_ID};
template <>
inline constexpr std::string_view kTableId<c3de_files_v1>{C3DE_FILES_ID};
template <>
inline constexpr std::string_view kTableId<c3de_settings_v1>{C3DE_SETTINGS_ID};
template <>
inline constexpr std::string_view kTableId<c3de_commands_v1>{C3DE_COMMANDS_ID};
template <>
inline constexpr std::string_view kTableId<c3de_params_v1>{C3DE_PARAMS_ID};
template <>
inline constexpr std::string_view kTableId<c3de_panels_v1>{C3DE_PANELS_ID};
template <>
inline constexpr std::string_view kTableId<c3de_tools_v1>{C3DE_TOOLS_ID};
template <>
inline constexpr std::string_view kTableId<c3de_jobs_v1>{C3DE_JOBS_ID};
template <>
inline constexpr std::string_view kTableId<c3de_time_v1>{C3DE_TIME_ID};
template <>
inline constexpr std::string_view kTableId<c3de_simulation_v1>{C3DE_SIMULATION_ID};
template <>
inline constexpr std::string_view kTableId<c3de_history_v1>{C3DE_HISTORY_ID};
template <>
inline constexpr std::string_view kTableId<c3de_imaging_v1>{C3DE_IMAGING_ID};

template <>
inline constexpr std::string_view kTableId<c3de_attachment_v1>{C3DE_IFACE_ATTACHMENT_ID};
template <>
inline constexpr std::string_view kTableId<c3de_contact_v1>{C3DE_IFACE_CONTACT_ID};
template <>
inline constexpr std::string_view kTableId<c3de_changes_v1>{C3DE_IFACE_CHANGES_ID};
template <>
inline constexpr std::string_view kTableId<c3de_grasp_v1>{C3DE_IFACE_GRASP_ID};
template <>
inline constexpr std::string_view kTableId<c3de_simulator_v1>{C3DE_IFACE_SIMULATOR_ID};

}  // namespace c3de::sdk
