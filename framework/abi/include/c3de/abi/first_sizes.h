/* SPDX-License-Identifier: Apache-2.0 */
/* How large each struct that is handed over with its size was when it was first published, in bytes where pointers have
 * 64 bits. A smaller one is refused wherever it is read or written; of a larger one counts what both sides know. These
 * numbers never change. Not among them: the tables of services, whose size the host sets. */
#ifndef C3DE_ABI_FIRST_SIZES_H
#define C3DE_ABI_FIRST_SIZES_H

/* X(struct, bytes) of each. */
/* clang-format off */
#define C3DE_FIRST_SIZES(X) \
  X(c3de_answer, 280) \
  X(c3de_attachment_v1, 24) \
  X(c3de_changes_v1, 24) \
  X(c3de_class, 88) \
  X(c3de_class_info, 88) \
  X(c3de_command, 80) \
  X(c3de_contact_v1, 32) \
  X(c3de_edit, 56) \
  X(c3de_error_place, 40) \
  X(c3de_event, 128) \
  X(c3de_force_call, 88) \
  X(c3de_force_field, 40) \
  X(c3de_grasp_v1, 16) \
  X(c3de_image_info, 224) \
  X(c3de_job, 48) \
  X(c3de_label, 40) \
  X(c3de_label_map_info, 184) \
  X(c3de_legend, 104) \
  X(c3de_material, 24) \
  X(c3de_mesh_contents, 88) \
  X(c3de_mesh_info, 104) \
  X(c3de_mesh_reader, 88) \
  X(c3de_mesh_sink, 48) \
  X(c3de_mesh_source, 40) \
  X(c3de_mesh_writer, 72) \
  X(c3de_object_vt, 32) \
  X(c3de_offer, 56) \
  X(c3de_panel, 56) \
  X(c3de_param_decl, 192) \
  X(c3de_param_listener, 24) \
  X(c3de_param_value, 72) \
  X(c3de_plugin, 144) \
  X(c3de_progress, 24) \
  X(c3de_service_req, 32) \
  X(c3de_sim_attachment, 80) \
  X(c3de_sim_attachment_state, 72) \
  X(c3de_sim_body, 224) \
  X(c3de_sim_body_info, 80) \
  X(c3de_sim_change, 80) \
  X(c3de_sim_contact_pair, 32) \
  X(c3de_sim_field, 48) \
  X(c3de_sim_fill, 24) \
  X(c3de_sim_fix, 40) \
  X(c3de_sim_grasp, 128) \
  X(c3de_sim_grasp_place, 72) \
  X(c3de_sim_grid, 128) \
  X(c3de_sim_hold, 64) \
  X(c3de_sim_hold_state, 120) \
  X(c3de_sim_load, 80) \
  X(c3de_sim_motion, 88) \
  X(c3de_sim_obstacle, 64) \
  X(c3de_sim_part, 32) \
  X(c3de_sim_placement, 192) \
  X(c3de_sim_points, 64) \
  X(c3de_sim_probe, 104) \
  X(c3de_sim_probe_tool, 64) \
  X(c3de_sim_probe_tool_state, 80) \
  X(c3de_sim_refinement, 24) \
  X(c3de_sim_region, 64) \
  X(c3de_sim_status, 64) \
  X(c3de_sim_tool_place, 64) \
  X(c3de_sim_transport, 48) \
  X(c3de_simulation_info, 40) \
  X(c3de_simulation_watch, 40) \
  X(c3de_simulator_v1, 264) \
  X(c3de_tool, 96)
/* clang-format on */

#endif
