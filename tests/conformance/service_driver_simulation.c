/* SPDX-License-Identifier: Apache-2.0 */
/* Jobs, time, simulations and forces. */
#include <math.h>

#include "service_checks.h"

/* ---- jobs, time, simulation ---- */

typedef struct range_sum {
  uint32_t hits[1000];
} range_sum;

static void C3DE_CALL mark(void *self, uint64_t begin, uint64_t end) {
  for (uint64_t i = begin; i < end; ++i) ++((range_sum *)self)->hits[i];
}
static c3de_status C3DE_CALL run_nothing(void *self, const c3de_progress *progress) {
  return progress->update(progress->self, 0.5, text("half"));
}
static void C3DE_CALL done_once(void *self, c3de_status status, c3de_str error) { ++*(int *)self; }

static int jobs_done; /* outlives the calls below: done() comes with a later frame */

void drive_jobs(void) {
  const c3de_jobs_v1 *jobs = service(C3DE_JOBS_ID);
  static range_sum sum;
  memset(&sum, 0, sizeof sum);
  jobs->parallel_for(jobs->ctx, 1000, 7, &sum, mark);
  int once = 1;
  for (int i = 0; i < 1000; ++i) once = once && sum.hits[i] == 1;
  HOLDS(once);
  jobs->parallel_for(jobs->ctx, 1000, 0, &sum, mark);
  HOLDS(sum.hits[999] == 2);
  jobs->parallel_for(jobs->ctx, 0, 1, NULL, mark);
  jobs->parallel_for(jobs->ctx, 10, 1, NULL, NULL);
  HOLDS(jobs->thread_count(jobs->ctx) >= 1);

  c3de_handle h, none;
  c3de_job job = {sizeof job, 0, TEXT("Test"), &jobs_done, run_nothing, done_once};
  double fraction = 0.0;
  GIVES(jobs, (OK, submit, &job, &h), (OK, progress, h, &fraction, no_sink), (E_ARG, progress, h, NULL, no_sink),
        (E_ARG, submit, NULL, &none), (E_ARG, submit, &job, NULL), (OK, cancel, h), (E_STALE, cancel, kNoSuch),
        (E_STALE, progress, kNoSuch, &fraction, no_sink));
  CHANGED(jobs, (E_ARG, submit, &job, &none), (job.title, text(""), ""), (job.run, NULL, ""), (job.done, NULL, ""));
}

static int posted_calls, frame_calls;

void drive_time(void) {
  const c3de_time_v1 *time = service(C3DE_TIME_ID);
  const uint64_t before = time->now_ns(time->ctx);
  HOLDS(time->now_ns(time->ctx) >= before && before > 0);
  (void)time->frame_index(time->ctx);
  time->request_redraw(time->ctx);
  c3de_handle h, none;
  GIVES(time, (OK, post_to_main, &posted_calls, count_call), (OK, add_frame_callback, &frame_calls, count_call, &h),
        (E_ARG, post_to_main, NULL, NULL), (E_ARG, add_frame_callback, NULL, NULL, &none),
        (E_ARG, add_frame_callback, NULL, count_call, NULL), (OK, remove_frame_callback, h),
        (E_STALE, remove_frame_callback, h), (E_STALE, remove_frame_callback, kNoSuch));
}

static int sim_calls;

static struct {
  uint64_t added, removed, stepped, seen;
  c3de_handle node;
} watched;
static void C3DE_CALL watch_added(void *self, c3de_handle node) {
  ++watched.added;
  watched.node = node;
}
static void C3DE_CALL watch_removed(void *self, c3de_handle node) { ++watched.removed; }
static c3de_status C3DE_CALL see_simulation(void *visitor, const c3de_simulation_info *info) {
  const void *table = NULL;
  HOLDS(info->size >= sizeof *info);
  HOLDS(info->object != NULL);
  RETURNS(C3DE_OK, info->object->vt->query(info->object, text(C3DE_IFACE_SIMULATOR_ID), 1, &table));
  HOLDS(table != NULL);
  ++*(uint64_t *)visitor;
  return C3DE_OK;
}
static c3de_status C3DE_CALL stop_seeing(void *visitor, const c3de_simulation_info *info) { return C3DE_S_TRUNCATED; }

void drive_simulation(c3de_handle node) {
  const c3de_simulation_v1 *simulation = service(C3DE_SIMULATION_ID);
  c3de_sim_transport state = {.size = sizeof state};
  GIVES(simulation, (OK, transport, node, C3DE_TRANSPORT_STEP), (OK, set_target_rate, node, 0.0),
        (OK, post, node, &sim_calls, count_call), (OK, state, node, &state));
  HOLDS(state.size == sizeof state);
  GIVES(simulation, (E_ARG, transport, node, 0), (E_ARG, transport, node, 6), (E_ARG, set_target_rate, node, -1.0),
        (E_ARG, set_target_rate, node, NAN), (E_ARG, state, node, NULL), (E_ARG, post, node, NULL, NULL),
        (E_NOT_FOUND, transport, kNoSuch, C3DE_TRANSPORT_STEP), (E_NOT_FOUND, post, kNone, &sim_calls, count_call));

  c3de_simulation_watch watch = {.added = watch_added, .removed = watch_removed};
  c3de_handle h;
  memset(&watched, 0, sizeof watched);
  GIVES(simulation, (OK, enum_simulations, &watched.seen, see_simulation));
  HOLDS(watched.seen == 1);
  GIVES(simulation, (S_TRUNCATED, enum_simulations, NULL, stop_seeing), (E_ARG, enum_simulations, NULL, NULL),
        (E_ARG, watch, NULL, &h), (E_ARG, watch, &watch, &h));
  watch.size = sizeof watch; /* without it, it was refused */
  GIVES(simulation, (E_ARG, watch, &watch, NULL), (OK, watch, &watch, &h));
  HOLDS(watched.added == 1 && watched.node.v == node.v);
  GIVES(simulation, (OK, unwatch, h), (E_STALE, unwatch, h), (E_STALE, unwatch, node));
}

/* ---- handles of one kind where another is asked for ---- */

void drive_kinds(c3de_handle node) {
  const c3de_collision_v1 *collision = service(C3DE_COLLISION_ID);
  const c3de_mesh_v1 *mesh = service(C3DE_MESH_ID);
  c3de_handle tree, made;
  c3de_mesh_info info = {.size = sizeof info};
  GIVES(collision, (OK, create, corners, faces, &tree));
  GIVES(mesh, (OK, create, corners, faces, &made), (OK, info, made, &info));
  SAYS(mesh, "that of a collision tree", (E_STALE, info, tree, &info));
  SAYS(mesh, "that of a scene node", (E_STALE, info, node, &info));
  SAYS(collision, "that of a mesh", (E_STALE, destroy, made));
  GIVES(collision, (OK, destroy, tree));
}

/* ---- forces ---- */

static uint64_t force_calls;
static c3de_status C3DE_CALL push_up(void *self, const c3de_force_call *call) {
  *(uint64_t *)self += 1;
  HOLDS(call->size >= sizeof *call);
  for (uint64_t i = 0; i < call->count; ++i) call->forces_N[3 * i + 1] += 1.0;
  return C3DE_OK;
}

void drive_forces(c3de_handle node) {
  const c3de_forces_v1 *forces = service(C3DE_FORCES_ID);
  const c3de_str not_utf8 = {"\xff", 1};
  c3de_force_field field = {sizeof field, 0, {"up", 2}, &force_calls, push_up};
  c3de_handle all, one, none;
  GIVES(forces, (OK, add, kNone, &field, &all), (OK, add, node, &field, &one));
  HOLDS(all.v != 0 && one.v != 0 && all.v != one.v);
  GIVES(forces, (E_ARG, add, kNoSuch, &field, &none));
  HOLDS(none.v == 0);
  GIVES(forces, (E_ARG, add, kNone, NULL, &none), (E_ARG, add, kNone, &field, NULL));
  CHANGED(forces, (E_ARG, add, kNone, &field, &none), (field.size, 4, ""), (field.apply, NULL, ""),
          (field.name, not_utf8, ""));
  /* Of a later revision: what is known counts. */
  CHANGED(forces, (OK, add, kNone, &field, &none), (field.size, sizeof field + 64, ""));
  GIVES(forces, (OK, remove, none), (OK, remove, one), (E_STALE, remove, one), (E_STALE, remove, kNoSuch),
        (E_STALE, remove, kNone));
  /* The other one is taken back with the plugin. */
}
