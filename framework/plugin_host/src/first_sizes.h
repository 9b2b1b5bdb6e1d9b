// SPDX-License-Identifier: Apache-2.0
// How large the structs that plugins hand over, or take answers in, were when they were first published. A plugin that
// was built then still passes structs of that size, so these numbers never change; a struct without one does not
// compile.
#pragma once

#include <cstddef>

#include "c3de/abi/c3de.h"

namespace c3de::plugin_host {

template <class T>
struct FirstSize;

#define C3DE_FIRST_SIZE(T, bytes)               \
  template <>                                   \
  struct FirstSize<T> {                         \
    static constexpr std::size_t value = bytes; \
  };                                            \
  static_assert(sizeof(T) >= bytes)

C3DE_FIRST_SIZE(c3de_plugin, 144);
C3DE_FIRST_SIZE(c3de_service_req, 32);
C3DE_FIRST_SIZE(c3de_object_vt, 32);
C3DE_FIRST_SIZE(c3de_class, 88);
C3DE_FIRST_SIZE(c3de_mesh_info, 104);
C3DE_FIRST_SIZE(c3de_material, 24);
C3DE_FIRST_SIZE(c3de_legend, 104);
C3DE_FIRST_SIZE(c3de_param_decl, 192);
C3DE_FIRST_SIZE(c3de_param_value, 72);
C3DE_FIRST_SIZE(c3de_param_listener, 24);
C3DE_FIRST_SIZE(c3de_panel, 56);
C3DE_FIRST_SIZE(c3de_tool, 96);
C3DE_FIRST_SIZE(c3de_edit, 56);
C3DE_FIRST_SIZE(c3de_job, 48);
C3DE_FIRST_SIZE(c3de_image_info, 224);
C3DE_FIRST_SIZE(c3de_sim_transport, 48);  // without step_running_s
C3DE_FIRST_SIZE(c3de_label_map_info, 184);
C3DE_FIRST_SIZE(c3de_progress, 24);
C3DE_FIRST_SIZE(c3de_force_field, 40);
C3DE_FIRST_SIZE(c3de_error_place, 40);
C3DE_FIRST_SIZE(c3de_simulation_watch, 40);
C3DE_FIRST_SIZE(c3de_mesh_reader, 88);
C3DE_FIRST_SIZE(c3de_mesh_writer, 72);
C3DE_FIRST_SIZE(c3de_command, 80);

#undef C3DE_FIRST_SIZE

}  // namespace c3de::plugin_host
