/* SPDX-License-Identifier: Apache-2.0 */
/* Registers one of everything and fails: in create, or, with FAILS_IN_START, in start. */
#include "minimal.h"

#if defined(FAILS_IN_START)
#define ID "test.fails_in_start"
#else
#define ID "test.fails_in_create"
#endif

static const c3de_log_v1 *logger;

static void say(const char *line) { logger->write(logger->ctx, C3DE_LOG_INFO, text(line)); }

static void made(const char *what, c3de_handle handle) {
  char line[96];
  snprintf(line, sizeof line, "made %s %llu", what, (unsigned long long)handle.v);
  say(line);
}

static void C3DE_CALL on_ui(void *self, const c3de_ui_v1 *ui) {
  (void)self;
  (void)ui;
  say("called: panel");
}
static c3de_status C3DE_CALL activate(void *self) {
  (void)self;
  return C3DE_OK;
}
static void C3DE_CALL cancel(void *self) {
  (void)self;
  say("called: cancel");
}
static c3de_status C3DE_CALL on_event(void *self, const c3de_event *event, uint32_t *consumed) {
  (void)self;
  (void)event;
  *consumed = 0;
  return C3DE_OK;
}
static void C3DE_CALL on_frame(void *self) {
  (void)self;
  say("called: frame");
}
static void C3DE_CALL posted(void *self) {
  (void)self;
  say("called: posted");
}
static c3de_status C3DE_CALL run(void *self, const c3de_progress *progress) {
  (void)self;
  /* Until it is cancelled, which is what taking the plugin back must do. */
  while (progress->update(progress->self, -1.0, text("working")) >= 0) {
  }
  return C3DE_E_CANCELLED;
}
static void C3DE_CALL done(void *self, c3de_status status, c3de_str error) {
  (void)self;
  (void)status;
  (void)error;
  say("called: done");
}
static void C3DE_CALL changed(void *self, const c3de_param_value *value) {
  (void)self;
  (void)value;
}

#define SERVICE(type, id, name)                                                              \
  const void *name##_table = NULL;                                                           \
  if ((status = host->get_service(host->ctx, text(id), 1, &name##_table)) < 0) return status; \
  const type *name = name##_table
#define DO(call) \
  if ((status = (call)) < 0) return status

static c3de_status register_everything(const c3de_host *host) {
  c3de_status status;
  c3de_handle handle, node;
  SERVICE(c3de_log_v1, C3DE_LOG_ID, log);
  SERVICE(c3de_registry_v1, C3DE_REGISTRY_ID, registry);
  SERVICE(c3de_scene_v1, C3DE_SCENE_ID, scene);
  SERVICE(c3de_mesh_v1, C3DE_MESH_ID, mesh);
  SERVICE(c3de_render_v1, C3DE_RENDER_ID, render);
  SERVICE(c3de_collision_v1, C3DE_COLLISION_ID, collision);
  SERVICE(c3de_params_v1, C3DE_PARAMS_ID, params);
  SERVICE(c3de_panels_v1, C3DE_PANELS_ID, panels);
  SERVICE(c3de_tools_v1, C3DE_TOOLS_ID, tools);
  SERVICE(c3de_jobs_v1, C3DE_JOBS_ID, jobs);
  SERVICE(c3de_time_v1, C3DE_TIME_ID, time);
  logger = log;

  DO(add_test_class(registry, "test.Late/0"));

  const double corners[] = {0, 0, 0, 10, 0, 0, 0, 10, 0, 0, 0, 10};
  const uint32_t faces[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  const c3de_view positions = {corners, 4, 3, C3DE_F64, 0}, triangles = {faces, 4, 3, C3DE_U32, 0};
  const c3de_material material = {sizeof material, 0, {1, 1, 1, 1}, 0};
  const c3de_handle root = {0};
  DO(scene->add_node(scene->ctx, root, text("Late"), &node));
  made("node", node);
  DO(render->create_mesh(render->ctx, node, positions, triangles, &material, &handle));
  DO(mesh->create(mesh->ctx, positions, triangles, &handle));
  made("mesh", handle);
  DO(collision->create(collision->ctx, positions, triangles, &handle));

  c3de_param_decl decl;
  memset(&decl, 0, sizeof decl);
  decl.size = sizeof decl;
  decl.type = C3DE_PARAM_BOOL;
  decl.id = text("late");
  const c3de_param_listener listener = {sizeof listener, 0, NULL, changed};
  DO(params->declare(params->ctx, text("Late"), &decl, 1, sizeof decl, &listener, &handle));
  made("params", handle);

  const c3de_panel panel = {sizeof panel, 1, TEXT("test.late.panel"), TEXT("Late"), NULL, on_ui};
  DO(panels->add(panels->ctx, &panel, &handle));
  const c3de_tool tool = {sizeof tool, 1, TEXT("test.late.tool"), TEXT("Late"), TEXT(""), 0, 0, NULL, activate, cancel,
                          on_event, 0, 0};
  DO(tools->add(tools->ctx, &tool, &handle));
  DO(tools->activate(tools->ctx, handle));
  DO(time->add_frame_callback(time->ctx, NULL, on_frame, &handle));
  const c3de_job job = {sizeof job, 0, TEXT("Late"), NULL, run, done};
  DO(jobs->submit(jobs->ctx, &job, &handle));
  DO(time->post_to_main(time->ctx, NULL, posted));
  return C3DE_OK;
}

#if defined(FAILS_IN_START)
static const c3de_host *kept;

static c3de_status C3DE_CALL create(const c3de_host *host, void **self) {
  *self = NULL;
  kept = host;
  return register_everything(host);
}
static c3de_status C3DE_CALL start(void *self) {
  (void)self;
  kept->set_error(kept->ctx, C3DE_E_STATE, text("the moon is in the wrong phase"));
  return C3DE_E_STATE;
}
static void C3DE_CALL destroy(void *self) {
  (void)self;
  say("called: destroy");
}
#else
static c3de_status C3DE_CALL create(const c3de_host *host, void **self) {
  *self = NULL;
  const c3de_status status = register_everything(host);
  if (status < 0) return status;
  host->set_error(host->ctx, C3DE_E_STATE, text("the moon is in the wrong phase"));
  return C3DE_E_STATE;
}
static c3de_status C3DE_CALL start(void *self) { return do_nothing(self); }
static void C3DE_CALL destroy(void *self) {
  (void)self;
  say("called: destroy");
}
#endif

static const c3de_plugin plugin = {NAMED(ID), NO_NEEDS, create, start, do_nothing, destroy};
ANSWER_WITH(&plugin)
