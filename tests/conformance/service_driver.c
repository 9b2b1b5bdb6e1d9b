/* SPDX-License-Identifier: Apache-2.0 */
/* A plugin in C that calls every function of every service with good and bad arguments and compares the status. For each
 * refused call there must be a text that names what was wrong. */
#include "service_driver.h"

#include <math.h>
#include <stdlib.h>

#include "bad_plugins/minimal.h"

static const c3de_host *host;
static c3de_sink differences;
static uint64_t compared;
static char error_text[512];

static c3de_status C3DE_CALL keep_error(void *self, const void *bytes, uint64_t n) {
  (void)self;
  const size_t used = strlen(error_text), room = sizeof error_text - 1 - used;
  const size_t take = n < room ? (size_t)n : room;
  memcpy(error_text + used, bytes, take);
  error_text[used + take] = '\0';
  return C3DE_OK;
}

static void differ(int line, const char *what) {
  char buffer[1024];
  const int n = snprintf(buffer, sizeof buffer, "line %d: %s [%s]\n", line, what, error_text);
  differences.put(differences.self, buffer, n < (int)sizeof buffer ? (uint64_t)n : sizeof buffer - 1);
}

static void compare(int line, const char *call, c3de_status got, c3de_status expected) {
  char buffer[512];
  ++compared;
  error_text[0] = '\0';
  const c3de_sink sink = {NULL, keep_error};
  host->take_error(host->ctx, sink);
  if (got != expected) {
    snprintf(buffer, sizeof buffer, "%s gave %d, expected %d", call, (int)got, (int)expected);
    differ(line, buffer);
  } else if (got < 0 && error_text[0] == '\0') {
    snprintf(buffer, sizeof buffer, "%s left no text", call);
    differ(line, buffer);
  }
}

static void compare_true(int line, const char *condition, int value) {
  ++compared;
  if (!value) differ(line, condition);
}

#define GIVES(status, call) compare(__LINE__, #call, (call), (status))
#define HOLDS(condition) compare_true(__LINE__, #condition, (condition) != 0)
#define SAYS(part) compare_true(__LINE__, "text has: " part, strstr(error_text, part) != NULL)

static const void *service(const char *id) {
  const void *table = NULL;
  GIVES(C3DE_OK, host->get_service(host->ctx, text(id), 1, &table));
  HOLDS(table != NULL);
  return table;
}

/* ---- data that several services want ---- */

static const double kCorners[] = {0, 0, 0, 10, 0, 0, 0, 10, 0, 0, 0, 10};
static const uint32_t kFaces[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
static const uint32_t kFacesOutOfRange[] = {0, 2, 1, 0, 1, 4};

static c3de_view points_of(const double *data, uint64_t count) {
  c3de_view v = {data, count, 3, C3DE_F64, 0};
  return v;
}
static c3de_view corners(void) { return points_of(kCorners, 4); }
static c3de_view faces(void) {
  c3de_view v = {kFaces, 4, 3, C3DE_U32, 0};
  return v;
}
static c3de_handle handle_of(uint64_t v) {
  c3de_handle h = {v};
  return h;
}
static const c3de_handle kNone = {0};
static const c3de_handle kNoSuch = {(UINT64_C(77) << 32) | 9999};

static c3de_status C3DE_CALL count_bytes(void *self, const void *bytes, uint64_t n) {
  (void)bytes;
  *(uint64_t *)self += n;
  return C3DE_OK;
}
static void C3DE_CALL count_call(void *self) { ++*(int *)self; }

/* ---- host ---- */

static void drive_host(void) {
  const void *table = NULL, *again = NULL;
  GIVES(C3DE_E_NOT_FOUND, host->get_service(host->ctx, text("draft/c3de.teapot/0"), 1, &table));
  SAYS("teapot");
  HOLDS(table == NULL);
  GIVES(C3DE_E_VERSION, host->get_service(host->ctx, text(C3DE_LOG_ID), 99, &table));
  SAYS("rev >= 99, host has 1");
  GIVES(C3DE_E_ARG, host->get_service(host->ctx, text(C3DE_LOG_ID), 1, NULL));
  const c3de_str broken = {NULL, 12};
  GIVES(C3DE_E_ARG, host->get_service(host->ctx, broken, 1, &table));
  GIVES(C3DE_OK, host->get_service(host->ctx, text(C3DE_LOG_ID), 0, &table));
  GIVES(C3DE_OK, host->get_service(host->ctx, text(C3DE_LOG_ID), 1, &again));
  HOLDS(table == again);
  HOLDS(host->size >= sizeof(c3de_host) && host->rev >= 1);

  host->set_error(host->ctx, C3DE_E_IO, text("the disk is full"));
  error_text[0] = '\0';
  const c3de_sink sink = {NULL, keep_error}, no_sink = {NULL, NULL};
  HOLDS(host->take_error(host->ctx, no_sink) == C3DE_E_ARG);
  HOLDS(host->take_error(host->ctx, sink) == C3DE_OK);
  SAYS("the disk is full");
  error_text[0] = '\0';
  HOLDS(host->take_error(host->ctx, sink) == C3DE_OK && error_text[0] == '\0');
}

/* ---- log, registry ---- */

static void drive_log(void) {
  const c3de_log_v1 *log = service(C3DE_LOG_ID);
  const c3de_str null_text = {NULL, 5}, not_utf8 = {"\xc3\x28", 2};
  log->write(log->ctx, C3DE_LOG_INFO, text("two\nlines"));
  log->write(log->ctx, 99, text("severity beyond the last"));
  log->write(log->ctx, C3DE_LOG_DEBUG, null_text);
  log->write(log->ctx, C3DE_LOG_DEBUG, not_utf8);
  log->write(NULL, C3DE_LOG_INFO, text("without ctx"));
  HOLDS(log->size >= sizeof *log);
}

static c3de_status C3DE_CALL count_class(void *self, const c3de_class_info *info) {
  HOLDS(info->size >= sizeof *info && info->id.len > 0 && info->plugin_id.len > 0);
  ++*(int *)self;
  return C3DE_OK;
}
static c3de_status C3DE_CALL stop_at_first(void *self, const c3de_class_info *info) {
  (void)info;
  ++*(int *)self;
  return C3DE_E_CANCELLED;
}

static void drive_registry(void) {
  const c3de_registry_v1 *registry = service(C3DE_REGISTRY_ID);
  const c3de_str ifaces[] = {TEXT("test.iface.a/0"), TEXT("test.iface.b/0")};
  c3de_class cls = {sizeof cls, 1, TEXT("test.A/0"), TEXT("A"), TEXT("doc"), ifaces, 2, NULL, make_no_object};
  GIVES(C3DE_OK, registry->add_class(registry->ctx, &cls));
  GIVES(C3DE_E_EXISTS, registry->add_class(registry->ctx, &cls));
  SAYS("test.service_driver");
  GIVES(C3DE_E_ARG, registry->add_class(registry->ctx, NULL));
  GIVES(C3DE_E_ARG, registry->add_class(NULL, &cls));
  cls.size = 4;
  GIVES(C3DE_E_ARG, registry->add_class(registry->ctx, &cls));
  SAYS("size is 4");
  cls.size = sizeof cls;
  cls.id = text("");
  GIVES(C3DE_E_ARG, registry->add_class(registry->ctx, &cls));
  cls.id = text("with space");
  GIVES(C3DE_E_ARG, registry->add_class(registry->ctx, &cls));
  SAYS("with space");
  cls.id = text("test.B/0");
  cls.create = NULL;
  GIVES(C3DE_E_ARG, registry->add_class(registry->ctx, &cls));
  cls.create = make_no_object;
  cls.ifaces = NULL;
  GIVES(C3DE_E_ARG, registry->add_class(registry->ctx, &cls));
  cls.ifaces = ifaces;
  cls.ifaces_n = UINT64_MAX;
  GIVES(C3DE_E_ARG, registry->add_class(registry->ctx, &cls));

  int seen = 0;
  GIVES(C3DE_OK, registry->enum_classes(registry->ctx, text("test.iface.b/0"), &seen, count_class));
  HOLDS(seen == 1);
  GIVES(C3DE_OK, registry->enum_classes(registry->ctx, text("test.iface.none/0"), &seen, count_class));
  HOLDS(seen == 1);
  GIVES(C3DE_OK, registry->enum_classes(registry->ctx, text(""), &seen, count_class));
  HOLDS(seen >= 3); /* the one above, and the driver's own beside */
  seen = 0;
  HOLDS(registry->enum_classes(registry->ctx, text(""), &seen, stop_at_first) == C3DE_E_CANCELLED && seen == 1);
  GIVES(C3DE_E_ARG, registry->enum_classes(registry->ctx, text(""), &seen, NULL));

  c3de_object *object = NULL;
  GIVES(C3DE_OK, registry->create(registry->ctx, text(TEST_DRIVER_CLASS), &object));
  HOLDS(object != NULL);
  if (object) object->vt->release(object);
  GIVES(C3DE_E_UNSUPPORTED, registry->create(registry->ctx, text("test.A/0"), &object));
  HOLDS(object == NULL);
  GIVES(C3DE_E_NOT_FOUND, registry->create(registry->ctx, text("test.Drover/0"), &object));
  SAYS("did you mean test.Driver/0");
  GIVES(C3DE_E_ARG, registry->create(registry->ctx, text("test.A/0"), NULL));

  GIVES(C3DE_OK, registry->remove_class(registry->ctx, text("test.A/0")));
  GIVES(C3DE_E_NOT_FOUND, registry->remove_class(registry->ctx, text("test.A/0")));
}

/* ---- views, on the mesh service ---- */

static void drive_mesh(void) {
  const c3de_mesh_v1 *mesh = service(C3DE_MESH_ID);
  c3de_handle h = {0};
  GIVES(C3DE_OK, mesh->create(mesh->ctx, corners(), faces(), &h));
  HOLDS(h.v != 0);

  c3de_mesh_info info;
  memset(&info, 0, sizeof info);
  info.size = sizeof info;
  GIVES(C3DE_OK, mesh->info(mesh->ctx, h, &info));
  HOLDS(info.vertices == 4 && info.triangles == 4 && info.closed == 1 && info.size == sizeof info);
  HOLDS(fabs(info.volume_mm3 - 1000.0 / 6.0) < 1e-9 && info.max_mm[2] == 10.0);
  info.size = 8;
  GIVES(C3DE_E_ARG, mesh->info(mesh->ctx, h, &info));
  GIVES(C3DE_E_ARG, mesh->info(mesh->ctx, h, NULL));
  GIVES(C3DE_E_STALE, mesh->info(mesh->ctx, kNoSuch, &info));

  c3de_view view;
  GIVES(C3DE_OK, mesh->positions(mesh->ctx, h, &view));
  HOLDS(view.count == 4 && view.comps == 3 && view.dtype == C3DE_F64 && ((const double *)view.data)[3] == 10.0);
  GIVES(C3DE_OK, mesh->triangles(mesh->ctx, h, &view));
  HOLDS(view.count == 4 && view.comps == 3 && view.dtype == C3DE_U32);
  GIVES(C3DE_E_ARG, mesh->positions(mesh->ctx, h, NULL));
  GIVES(C3DE_E_STALE, mesh->triangles(mesh->ctx, kNone, &view));

  uint64_t bytes = 0;
  const c3de_sink sink = {&bytes, count_bytes}, no_sink = {NULL, NULL};
  GIVES(C3DE_OK, mesh->report(mesh->ctx, h, sink));
  HOLDS(bytes > 20);
  GIVES(C3DE_E_ARG, mesh->report(mesh->ctx, h, no_sink));

  const double probes[] = {1, 1, 1, 20, 20, 20};
  double winding[2] = {-1, -1};
  c3de_mview out = {winding, 2, 1, C3DE_F64, 0};
  GIVES(C3DE_OK, mesh->winding_numbers(mesh->ctx, h, points_of(probes, 2), out));
  HOLDS(fabs(winding[0] - 1.0) < 1e-3 && fabs(winding[1]) < 1e-3);
  out.count = 1;
  GIVES(C3DE_E_ARG, mesh->winding_numbers(mesh->ctx, h, points_of(probes, 2), out));
  out.count = 2;
  out.dtype = C3DE_F32;
  GIVES(C3DE_E_ARG, mesh->winding_numbers(mesh->ctx, h, points_of(probes, 2), out));

  GIVES(C3DE_OK, mesh->check_fillable(mesh->ctx, h));
  GIVES(C3DE_E_STALE, mesh->check_fillable(mesh->ctx, kNoSuch));
  const double sheet_corners[] = {0, 0, 0, 10, 0, 0, 10, 10, 0, 0, 10, 0, 5, 5, 0};
  const uint32_t sheet_faces[] = {0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4};
  const c3de_view sheet = {sheet_faces, 4, 3, C3DE_U32, 0};
  c3de_handle flat = {0};
  GIVES(C3DE_OK, mesh->create(mesh->ctx, points_of(sheet_corners, 5), sheet, &flat));
  GIVES(C3DE_E_FORMAT, mesh->check_fillable(mesh->ctx, flat));
  GIVES(C3DE_OK, mesh->release(mesh->ctx, flat));

  /* Every rule of a view, once. */
  c3de_view v = corners();
  v.dtype = 99;
  GIVES(C3DE_E_ARG, mesh->create(mesh->ctx, v, faces(), &h));
  SAYS("dtype 99");
  v = corners();
  v.comps = 2;
  GIVES(C3DE_E_ARG, mesh->create(mesh->ctx, v, faces(), &h));
  SAYS("comps 2");
  v = corners();
  v.stride = 8;
  GIVES(C3DE_E_ARG, mesh->create(mesh->ctx, v, faces(), &h));
  SAYS("stride 8");
  v.stride = -24;
  GIVES(C3DE_E_ARG, mesh->create(mesh->ctx, v, faces(), &h));
  v = corners();
  v.data = NULL;
  GIVES(C3DE_E_ARG, mesh->create(mesh->ctx, v, faces(), &h));
  v = corners();
  v.count = UINT64_MAX;
  GIVES(C3DE_E_ARG, mesh->create(mesh->ctx, v, faces(), &h));
  v = corners();
  v.stride = INT64_MAX - 7;
  GIVES(C3DE_E_ARG, mesh->create(mesh->ctx, v, faces(), &h));
  double bad[12];
  memcpy(bad, kCorners, sizeof bad);
  bad[7] = NAN;
  GIVES(C3DE_E_ARG, mesh->create(mesh->ctx, points_of(bad, 4), faces(), &h));
  SAYS("row 2");
  bad[7] = INFINITY;
  GIVES(C3DE_E_ARG, mesh->create(mesh->ctx, points_of(bad, 4), faces(), &h));
  v = faces();
  v.data = kFacesOutOfRange;
  v.count = 2;
  GIVES(C3DE_E_ARG, mesh->create(mesh->ctx, corners(), v, &h));
  SAYS("refers to vertex 4, there are 4");
  v.count = 0;
  GIVES(C3DE_E_ARG, mesh->create(mesh->ctx, corners(), v, &h));
  GIVES(C3DE_E_ARG, mesh->create(mesh->ctx, corners(), faces(), NULL));
  HOLDS(h.v == 0); /* a call that fails leaves no old handle behind */

  /* f32 rows with a stride, not tight. */
  struct {
    float p[3];
    uint32_t other;
  } packed[4];
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) packed[i].p[k] = (float)kCorners[3 * i + k];
  c3de_view strided = {packed, 4, 3, C3DE_F32, sizeof packed[0]};
  GIVES(C3DE_OK, mesh->create(mesh->ctx, strided, faces(), &h));
  GIVES(C3DE_OK, mesh->release(mesh->ctx, h));
  GIVES(C3DE_E_STALE, mesh->release(mesh->ctx, h));

  GIVES(C3DE_E_IO, mesh->load(mesh->ctx, text("no/such/file.obj"), C3DE_UNIT_MM, NULL, &h));
  SAYS("no/such/file.obj");
  GIVES(C3DE_E_IO, mesh->load(mesh->ctx, text("no/such/file.obj"), C3DE_UNIT_UNKNOWN, NULL, &h));
  GIVES(C3DE_E_ARG, mesh->load(mesh->ctx, text(""), C3DE_UNIT_MM, NULL, &h));
  GIVES(C3DE_E_ARG, mesh->load(mesh->ctx, text("a.obj"), 9, NULL, &h));
  SAYS("unit is 9");
  GIVES(C3DE_E_ARG, mesh->load(mesh->ctx, text("a.obj"), C3DE_UNIT_MM, NULL, NULL));
}

/* ---- scene, render ---- */

static void drive_scene(void) {
  const c3de_scene_v1 *scene = service(C3DE_SCENE_ID);
  c3de_handle node, child;
  GIVES(C3DE_OK, scene->add_node(scene->ctx, kNone, text("parent"), &node));
  GIVES(C3DE_OK, scene->add_node(scene->ctx, node, text("child"), &child));
  GIVES(C3DE_E_STALE, scene->add_node(scene->ctx, kNoSuch, text("orphan"), &child));
  HOLDS(child.v == 0);
  GIVES(C3DE_OK, scene->add_node(scene->ctx, node, text("child"), &child));
  GIVES(C3DE_E_ARG, scene->add_node(scene->ctx, kNone, text(""), &child));
  GIVES(C3DE_OK, scene->add_node(scene->ctx, node, text("child"), &child));
  GIVES(C3DE_E_ARG, scene->add_node(scene->ctx, kNone, text("x"), NULL));

  double m[16];
  GIVES(C3DE_OK, scene->world_from_node(scene->ctx, child, m));
  HOLDS(m[0] == 1.0 && m[15] == 1.0 && m[12] == 0.0);
  GIVES(C3DE_E_ARG, scene->world_from_node(scene->ctx, child, NULL));
  GIVES(C3DE_E_STALE, scene->world_from_node(scene->ctx, kNoSuch, m));

  uint32_t visible = 9;
  GIVES(C3DE_OK, scene->set_visible(scene->ctx, node, 0));
  GIVES(C3DE_OK, scene->is_visible(scene->ctx, child, &visible));
  HOLDS(visible == 0);
  GIVES(C3DE_OK, scene->set_visible(scene->ctx, node, 1));
  GIVES(C3DE_OK, scene->is_visible(scene->ctx, child, &visible));
  HOLDS(visible == 1);
  GIVES(C3DE_E_ARG, scene->is_visible(scene->ctx, child, NULL));
  GIVES(C3DE_E_STALE, scene->set_visible(scene->ctx, kNoSuch, 1));

  const double lo[] = {-1, -1, -1}, hi[] = {1, 1, 1}, nan3[] = {NAN, 0, 0};
  GIVES(C3DE_OK, scene->set_bounds(scene->ctx, node, lo, hi));
  GIVES(C3DE_E_ARG, scene->set_bounds(scene->ctx, node, hi, lo));
  GIVES(C3DE_E_ARG, scene->set_bounds(scene->ctx, node, nan3, hi));
  GIVES(C3DE_E_ARG, scene->set_bounds(scene->ctx, node, NULL, hi));

  GIVES(C3DE_OK, scene->remove_node(scene->ctx, node));
  GIVES(C3DE_E_STALE, scene->remove_node(scene->ctx, child));
  GIVES(C3DE_E_STALE, scene->remove_node(scene->ctx, node));
}

static void drive_render(void) {
  const c3de_render_v1 *render = service(C3DE_RENDER_ID);
  const c3de_scene_v1 *scene = service(C3DE_SCENE_ID);
  const void *table = NULL;
  GIVES(C3DE_OK, host->get_service(host->ctx, text(C3DE_RENDER_ID), 2, &table));
  HOLDS(table == (const void *)render && render->rev == 2 && C3DE_HAS(c3de_render_v1, render, set_legend));
  GIVES(C3DE_E_VERSION, host->get_service(host->ctx, text(C3DE_RENDER_ID), 3, &table));
  SAYS("rev >= 3, host has 2");
  c3de_handle node, mesh, spheres, lines, label, none;
  c3de_material material = {sizeof material, 0, {0.5f, 0.5f, 0.5f, 1.0f}, 0};
  const double at[] = {1, 2, 3}, nowhere[] = {NAN, 0, 0};
  GIVES(C3DE_OK, scene->add_node(scene->ctx, kNone, text("drawn"), &node));
  GIVES(C3DE_OK, render->create_mesh(render->ctx, node, corners(), faces(), &material, &mesh));
  GIVES(C3DE_OK, render->create_spheres(render->ctx, node, corners(), 0.5, &material, &spheres));
  GIVES(C3DE_OK, render->create_lines(render->ctx, node, corners(), 2.0f, &material, &lines));
  GIVES(C3DE_OK, render->create_label(render->ctx, node, at, text("tip"), &material, &label));

  GIVES(C3DE_E_STALE, render->create_mesh(render->ctx, kNone, corners(), faces(), &material, &none));
  GIVES(C3DE_E_ARG, render->create_mesh(render->ctx, node, corners(), faces(), NULL, &none));
  GIVES(C3DE_E_ARG, render->create_mesh(render->ctx, node, corners(), faces(), &material, NULL));
  GIVES(C3DE_E_ARG, render->create_spheres(render->ctx, node, corners(), 0.0, &material, &none));
  GIVES(C3DE_E_ARG, render->create_spheres(render->ctx, node, corners(), NAN, &material, &none));
  GIVES(C3DE_E_ARG, render->create_lines(render->ctx, node, points_of(kCorners, 3), 2.0f, &material, &none));
  GIVES(C3DE_E_ARG, render->create_lines(render->ctx, node, corners(), -1.0f, &material, &none));
  GIVES(C3DE_E_ARG, render->create_label(render->ctx, node, nowhere, text("tip"), &material, &none));
  material.colour[3] = 2.0f;
  GIVES(C3DE_E_ARG, render->set_material(render->ctx, mesh, &material));
  SAYS("colour[3] is 2");
  material.colour[3] = 0.5f;
  GIVES(C3DE_OK, render->set_material(render->ctx, mesh, &material));

  const uint8_t bytes[] = {255, 0, 0, 0, 255, 0, 0, 0, 255, 9, 9, 9};
  const float too_bright[] = {2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  const double radii[] = {1, 2, 3, 4}, negative[] = {1, 2, 3, -4};
  const c3de_view colours = {bytes, 4, 3, C3DE_U8, 0}, bright = {too_bright, 4, 3, C3DE_F32, 0};
  const c3de_view radius_view = {radii, 4, 1, C3DE_F64, 0}, negative_view = {negative, 4, 1, C3DE_F64, 0};
  GIVES(C3DE_OK, render->update(render->ctx, mesh, C3DE_ATTR_POSITIONS, corners()));
  GIVES(C3DE_OK, render->update(render->ctx, mesh, C3DE_ATTR_NORMALS, corners()));
  GIVES(C3DE_OK, render->update(render->ctx, mesh, C3DE_ATTR_COLOURS, colours));
  GIVES(C3DE_OK, render->update(render->ctx, spheres, C3DE_ATTR_RADII, radius_view));
  GIVES(C3DE_OK, render->update(render->ctx, spheres, C3DE_ATTR_POSITIONS, points_of(kCorners, 3)));
  GIVES(C3DE_E_ARG, render->update(render->ctx, spheres, C3DE_ATTR_RADII, radius_view));
  SAYS("4 rows, the proxy has 3 points");
  GIVES(C3DE_OK, render->update(render->ctx, spheres, C3DE_ATTR_POSITIONS, corners()));
  GIVES(C3DE_E_ARG, render->update(render->ctx, spheres, C3DE_ATTR_RADII, negative_view));
  GIVES(C3DE_E_ARG, render->update(render->ctx, mesh, C3DE_ATTR_POSITIONS, points_of(kCorners, 3)));
  GIVES(C3DE_E_ARG, render->update(render->ctx, mesh, C3DE_ATTR_COLOURS, bright));
  GIVES(C3DE_E_ARG, render->update(render->ctx, mesh, C3DE_ATTR_RADII, radius_view));
  GIVES(C3DE_E_ARG, render->update(render->ctx, lines, C3DE_ATTR_NORMALS, corners()));
  GIVES(C3DE_E_ARG, render->update(render->ctx, lines, C3DE_ATTR_POSITIONS, points_of(kCorners, 3)));
  GIVES(C3DE_E_ARG, render->update(render->ctx, mesh, 42, corners()));
  GIVES(C3DE_E_ARG, render->update(render->ctx, label, C3DE_ATTR_POSITIONS, corners()));
  GIVES(C3DE_E_STALE, render->update(render->ctx, kNoSuch, C3DE_ATTR_POSITIONS, corners()));

  const c3de_view no_colours = {NULL, 0, 3, C3DE_U8, 0};
  GIVES(C3DE_OK, render->update(render->ctx, mesh, C3DE_ATTR_COLOURS, no_colours)); /* back to the material's */

  c3de_handle legend;
  c3de_legend meaning = {sizeof meaning, 0, text("Stress"), text("kPa"), text(""), 0.0, 2.5, {bytes, 4, 3, C3DE_U8, 0}};
  GIVES(C3DE_OK, render->create_legend(render->ctx, node, &meaning, &legend));
  GIVES(C3DE_E_STALE, render->create_legend(render->ctx, kNone, &meaning, &none));
  GIVES(C3DE_E_ARG, render->create_legend(render->ctx, node, NULL, &none));
  GIVES(C3DE_E_ARG, render->create_legend(render->ctx, node, &meaning, NULL));
  GIVES(C3DE_E_ARG, render->update(render->ctx, legend, C3DE_ATTR_POSITIONS, corners()));
  GIVES(C3DE_E_ARG, render->set_label(render->ctx, legend, at, text("end")));
  GIVES(C3DE_E_ARG, render->set_legend(render->ctx, mesh, &meaning));
  meaning.low = 2.5;
  GIVES(C3DE_E_ARG, render->set_legend(render->ctx, legend, &meaning));
  SAYS("low is 2.5, high is 2.5");
  meaning.low = NAN;
  GIVES(C3DE_E_ARG, render->set_legend(render->ctx, legend, &meaning));
  meaning.low = -2.5;
  meaning.colours.count = 1;
  GIVES(C3DE_E_ARG, render->set_legend(render->ctx, legend, &meaning));
  SAYS("accepted: 2 to 1024");
  meaning.colours = bright;
  GIVES(C3DE_E_ARG, render->set_legend(render->ctx, legend, &meaning));
  meaning.colours = colours;
  GIVES(C3DE_OK, render->set_legend(render->ctx, legend, &meaning));
  GIVES(C3DE_OK, render->set_visible(render->ctx, legend, 0));
  meaning.size = 0;
  GIVES(C3DE_E_ARG, render->set_legend(render->ctx, legend, &meaning));
  GIVES(C3DE_E_STALE, render->set_legend(render->ctx, kNoSuch, &meaning));

  GIVES(C3DE_OK, render->set_label(render->ctx, label, at, text("end")));
  GIVES(C3DE_E_ARG, render->set_label(render->ctx, mesh, at, text("end")));
  GIVES(C3DE_OK, render->set_visible(render->ctx, mesh, 0));
  GIVES(C3DE_OK, render->destroy(render->ctx, mesh));
  GIVES(C3DE_E_STALE, render->destroy(render->ctx, mesh));
  GIVES(C3DE_OK, scene->remove_node(scene->ctx, node));
  GIVES(C3DE_E_STALE, render->set_visible(render->ctx, spheres, 1)); /* gone with its node */
  GIVES(C3DE_E_STALE, render->destroy(render->ctx, legend));
}

/* ---- collision ---- */

static void drive_collision(void) {
  const c3de_collision_v1 *collision = service(C3DE_COLLISION_ID);
  c3de_handle tree, none;
  GIVES(C3DE_OK, collision->create(collision->ctx, corners(), faces(), &tree));
  GIVES(C3DE_E_ARG, collision->create(collision->ctx, corners(), faces(), NULL));
  c3de_view v = faces();
  v.data = kFacesOutOfRange;
  v.count = 2;
  GIVES(C3DE_E_ARG, collision->create(collision->ctx, corners(), v, &none));

  const double from[] = {2, 2, -5, 50, 50, 50}, along[] = {0, 0, 1, 0, 0, 1}, to[] = {2, 2, 1, 50, 50, 60};
  c3de_ray_hit hits[2];
  GIVES(C3DE_OK, collision->rays(collision->ctx, tree, points_of(from, 2), points_of(along, 2), INFINITY, hits));
  HOLDS(fabs(hits[0].t - 5.0) < 1e-12 && hits[0].triangle == 0);
  HOLDS(hits[1].t < 0.0 && hits[1].triangle == 0xffffffffu);
  GIVES(C3DE_OK, collision->segments(collision->ctx, tree, points_of(from, 2), points_of(to, 2), hits));
  HOLDS(fabs(hits[0].t - 5.0 / 6.0) < 1e-12 && hits[1].triangle == 0xffffffffu);
  GIVES(C3DE_E_ARG, collision->rays(collision->ctx, tree, points_of(from, 2), points_of(along, 1), 1.0, hits));
  SAYS("2 rows");
  GIVES(C3DE_E_ARG, collision->rays(collision->ctx, tree, points_of(from, 2), points_of(along, 2), -1.0, hits));
  GIVES(C3DE_E_ARG, collision->rays(collision->ctx, tree, points_of(from, 2), points_of(along, 2), NAN, hits));
  GIVES(C3DE_E_ARG, collision->rays(collision->ctx, tree, points_of(from, 2), points_of(along, 2), 1.0, NULL));
  GIVES(C3DE_E_ARG, collision->segments(collision->ctx, tree, points_of(from, 2), points_of(to, 2), NULL));
  GIVES(C3DE_OK, collision->rays(collision->ctx, tree, points_of(NULL, 0), points_of(NULL, 0), 1.0, NULL));
  GIVES(C3DE_E_STALE, collision->rays(collision->ctx, kNoSuch, points_of(from, 2), points_of(along, 2), 1.0, hits));

  const double points[] = {1, 1, -2, 1, 1, 0.5, 100, 100, 100};
  const double ranges[] = {10, 10, 10}, one_range[] = {10}, nan_range[] = {NAN};
  const c3de_view range_view = {ranges, 3, 1, C3DE_F64, 0}, one = {one_range, 1, 1, C3DE_F64, 0};
  const c3de_view two = {ranges, 2, 1, C3DE_F64, 0}, not_a_number = {nan_range, 1, 1, C3DE_F64, 0};
  c3de_closest nearest[3];
  GIVES(C3DE_OK, collision->closest(collision->ctx, tree, points_of(points, 3), range_view, nearest));
  HOLDS(fabs(nearest[0].distance - 2.0) < 1e-12 && nearest[0].normal[2] < -0.99);
  HOLDS(fabs(nearest[1].distance + 0.5) < 1e-12);
  HOLDS(isinf(nearest[2].distance) && nearest[2].triangle == 0xffffffffu);
  GIVES(C3DE_OK, collision->closest(collision->ctx, tree, points_of(points, 3), one, nearest));
  GIVES(C3DE_E_ARG, collision->closest(collision->ctx, tree, points_of(points, 3), two, nearest));
  GIVES(C3DE_E_ARG, collision->closest(collision->ctx, tree, points_of(points, 3), not_a_number, nearest));
  GIVES(C3DE_E_ARG, collision->closest(collision->ctx, tree, points_of(points, 3), one, NULL));

  const double centre[] = {1, 1, 0}, nan3[] = {NAN, 0, 0};
  uint32_t found[4];
  uint64_t needed = 0;
  {
    uint32_t pairs[16];
    c3de_handle second;
    GIVES(C3DE_OK, collision->create(collision->ctx, corners(), faces(), &second));
    GIVES(C3DE_S_TRUNCATED, collision->pairs(collision->ctx, tree, second, 0.0, pairs, 2, &needed));
    HOLDS(needed > 2);
    GIVES(C3DE_S_TRUNCATED, collision->pairs(collision->ctx, tree, second, 0.0, NULL, 0, &needed));
    GIVES(C3DE_OK, collision->pairs(collision->ctx, tree, tree, 0.0, pairs, 8, &needed));
    HOLDS(needed == 0); /* all of a tetrahedron share vertices */
    GIVES(C3DE_E_ARG, collision->pairs(collision->ctx, tree, second, -1.0, pairs, 8, &needed));
    GIVES(C3DE_E_ARG, collision->pairs(collision->ctx, tree, second, NAN, pairs, 8, &needed));
    GIVES(C3DE_E_ARG, collision->pairs(collision->ctx, tree, second, 0.0, NULL, 8, &needed));
    GIVES(C3DE_E_ARG, collision->pairs(collision->ctx, tree, second, 0.0, pairs, 8, NULL));
    GIVES(C3DE_OK, collision->destroy(collision->ctx, second));
    GIVES(C3DE_E_STALE, collision->pairs(collision->ctx, tree, second, 0.0, pairs, 8, &needed));
  }
  GIVES(C3DE_OK, collision->sphere(collision->ctx, tree, centre, 50.0, found, 4, &needed));
  HOLDS(needed == 4 && found[0] == 0 && found[3] == 3);
  GIVES(C3DE_S_TRUNCATED, collision->sphere(collision->ctx, tree, centre, 50.0, found, 2, &needed));
  HOLDS(needed == 4);
  GIVES(C3DE_S_TRUNCATED, collision->sphere(collision->ctx, tree, centre, 50.0, NULL, 0, &needed));
  GIVES(C3DE_E_ARG, collision->sphere(collision->ctx, tree, centre, 50.0, NULL, 4, &needed));
  GIVES(C3DE_E_ARG, collision->sphere(collision->ctx, tree, centre, 50.0, found, 4, NULL));
  GIVES(C3DE_E_ARG, collision->sphere(collision->ctx, tree, centre, -1.0, found, 4, &needed));
  GIVES(C3DE_E_ARG, collision->sphere(collision->ctx, tree, nan3, 1.0, found, 4, &needed));
  GIVES(C3DE_E_ARG, collision->sphere(collision->ctx, tree, NULL, 1.0, found, 4, &needed));

  double moved[12];
  for (int i = 0; i < 12; ++i) moved[i] = kCorners[i] + 100.0;
  GIVES(C3DE_OK, collision->refit(collision->ctx, tree, points_of(moved, 4)));
  GIVES(C3DE_OK, collision->rebuild(collision->ctx, tree));
  GIVES(C3DE_OK, collision->rays(collision->ctx, tree, points_of(from, 1), points_of(along, 1), INFINITY, hits));
  HOLDS(hits[0].triangle == 0xffffffffu);
  GIVES(C3DE_E_ARG, collision->refit(collision->ctx, tree, points_of(moved, 3)));
  SAYS("the tree has 4 vertices");
  moved[0] = INFINITY;
  GIVES(C3DE_E_ARG, collision->refit(collision->ctx, tree, points_of(moved, 4)));
  GIVES(C3DE_OK, collision->destroy(collision->ctx, tree));
  GIVES(C3DE_E_STALE, collision->destroy(collision->ctx, tree));
  GIVES(C3DE_E_STALE, collision->rebuild(collision->ctx, tree));
}

/* ---- params, panels, tools ---- */

static void C3DE_CALL never_changed(void *self, const c3de_param_value *value) {
  (void)value;
  ++*(int *)self;
}

static c3de_param_decl number(const char *id) {
  c3de_param_decl d;
  memset(&d, 0, sizeof d);
  d.size = sizeof d;
  d.type = C3DE_PARAM_F64;
  d.id = text(id);
  d.label = text("Number");
  d.unit = text("Pa");
  d.max = d.soft_max = 10.0;
  d.fallback = 5.0;
  return d;
}

static void drive_params(void) {
  const c3de_params_v1 *params = service(C3DE_PARAMS_ID);
  static const c3de_str laws[] = {TEXT("stvk"), TEXT("neo_hookean")};
  int told = 0;
  c3de_param_listener listener = {sizeof listener, 0, &told, never_changed};
  c3de_param_decl decls[2] = {number("modulus"), number("law")};
  decls[1].type = C3DE_PARAM_CHOICE;
  decls[1].choices = laws;
  decls[1].choices_n = 2;
  decls[1].fallback_text = text("stvk");
  c3de_handle set, none;
  GIVES(C3DE_OK, params->declare(params->ctx, text("Test"), decls, 2, sizeof decls[0], &listener, &set));
  GIVES(C3DE_OK, params->declare(params->ctx, text("Test"), decls, 2, 0, NULL, &none));
  GIVES(C3DE_OK, params->remove(params->ctx, none));

  GIVES(C3DE_E_ARG, params->declare(params->ctx, text("Test"), NULL, 2, 0, NULL, &none));
  GIVES(C3DE_E_ARG, params->declare(params->ctx, text("Test"), decls, 0, 0, NULL, &none));
  GIVES(C3DE_E_ARG, params->declare(params->ctx, text("Test"), decls, UINT64_MAX, 0, NULL, &none));
  GIVES(C3DE_E_ARG, params->declare(params->ctx, text("Test"), decls, 2, 8, NULL, &none));
  GIVES(C3DE_E_ARG, params->declare(params->ctx, text("Test"), decls, 2, 0, NULL, NULL));
  c3de_param_decl bad = number("modulus");
  bad.type = 77;
  GIVES(C3DE_E_ARG, params->declare(params->ctx, text("Test"), &bad, 1, 0, NULL, &none));
  bad = number("modulus");
  bad.min = 11.0;
  GIVES(C3DE_E_ARG, params->declare(params->ctx, text("Test"), &bad, 1, 0, NULL, &none));
  bad = number("modulus");
  bad.fallback = 99.0;
  GIVES(C3DE_E_ARG, params->declare(params->ctx, text("Test"), &bad, 1, 0, NULL, &none));
  SAYS("the default does not fit");
  bad = number("modulus");
  bad.flags = 0x80000000u;
  GIVES(C3DE_E_UNSUPPORTED, params->declare(params->ctx, text("Test"), &bad, 1, 0, NULL, &none));
  bad = number("modulus");
  bad.choices_n = 3;
  GIVES(C3DE_E_ARG, params->declare(params->ctx, text("Test"), &bad, 1, 0, NULL, &none));
  bad = number("modulus");
  bad.size = 12;
  GIVES(C3DE_E_ARG, params->declare(params->ctx, text("Test"), &bad, 1, 0, NULL, &none));
  c3de_param_decl twice[2] = {number("modulus"), number("modulus")};
  GIVES(C3DE_E_EXISTS, params->declare(params->ctx, text("Test"), twice, 2, 0, NULL, &none));
  listener.changed = NULL;
  GIVES(C3DE_E_ARG, params->declare(params->ctx, text("Test"), decls, 2, 0, &listener, &none));

  c3de_param_value value;
  memset(&value, 0, sizeof value);
  value.size = sizeof value;
  GIVES(C3DE_OK, params->get(params->ctx, set, text("modulus"), &value));
  HOLDS(value.num == 5.0 && value.type == C3DE_PARAM_F64);
  GIVES(C3DE_OK, params->get(params->ctx, set, text("law"), &value));
  HOLDS(value.text.len == 4 && memcmp(value.text.ptr, "stvk", 4) == 0);
  GIVES(C3DE_E_NOT_FOUND, params->get(params->ctx, set, text("modulos"), &value));
  SAYS("did you mean 'modulus'");
  GIVES(C3DE_E_ARG, params->get(params->ctx, set, text("modulus"), NULL));
  GIVES(C3DE_E_STALE, params->get(params->ctx, kNoSuch, text("modulus"), &value));

  c3de_param_value wanted = {sizeof wanted, C3DE_PARAM_F64, TEXT("modulus"), 7.0, {NULL, 0}, {0, 0, 0}};
  GIVES(C3DE_OK, params->set(params->ctx, set, &wanted));
  GIVES(C3DE_OK, params->get(params->ctx, set, text("modulus"), &value));
  HOLDS(value.num == 7.0 && told == 0);
  wanted.num = 11.0;
  GIVES(C3DE_E_ARG, params->set(params->ctx, set, &wanted));
  SAYS("<= 10");
  wanted.num = NAN;
  GIVES(C3DE_E_ARG, params->set(params->ctx, set, &wanted));
  wanted.id = text("nobody");
  GIVES(C3DE_E_NOT_FOUND, params->set(params->ctx, set, &wanted));
  GIVES(C3DE_E_ARG, params->set(params->ctx, set, NULL));
  GIVES(C3DE_OK, params->remove(params->ctx, set));
  GIVES(C3DE_E_STALE, params->remove(params->ctx, set));
}

static void C3DE_CALL draw_nothing(void *self, const c3de_ui_v1 *ui) {
  (void)self;
  (void)ui;
}

static void drive_panels(void) {
  const c3de_panels_v1 *panels = service(C3DE_PANELS_ID);
  c3de_panel panel = {sizeof panel, 1, TEXT("test.driver.panel"), TEXT("Driver"), NULL, draw_nothing};
  c3de_handle h, none;
  GIVES(C3DE_OK, panels->add(panels->ctx, &panel, &h));
  GIVES(C3DE_E_EXISTS, panels->add(panels->ctx, &panel, &none));
  GIVES(C3DE_E_ARG, panels->add(panels->ctx, NULL, &none));
  GIVES(C3DE_E_ARG, panels->add(panels->ctx, &panel, NULL));
  panel.id = text("test.driver.other");
  panel.on_ui = NULL;
  GIVES(C3DE_E_ARG, panels->add(panels->ctx, &panel, &none));
  panel.on_ui = draw_nothing;
  panel.title = text("");
  GIVES(C3DE_E_ARG, panels->add(panels->ctx, &panel, &none));
  panel.title = text("x");
  panel.size = 0;
  GIVES(C3DE_E_ARG, panels->add(panels->ctx, &panel, &none));
  GIVES(C3DE_OK, panels->notify(panels->ctx, C3DE_LOG_INFO, text("Title"), text("Text")));
  GIVES(C3DE_E_ARG, panels->notify(panels->ctx, 17, text("Title"), text("Text")));
  GIVES(C3DE_OK, panels->remove(panels->ctx, h));
  GIVES(C3DE_E_STALE, panels->remove(panels->ctx, h));
}

static c3de_status C3DE_CALL activate(void *self) {
  ++*(int *)self;
  return C3DE_OK;
}
static void C3DE_CALL cancel(void *self) { *(int *)self += 10; }
static c3de_status C3DE_CALL refuse_to_activate(void *self) {
  (void)self;
  host->set_error(host->ctx, C3DE_E_STATE, text("no body to touch"));
  return C3DE_E_STATE;
}
static c3de_status C3DE_CALL on_event(void *self, const c3de_event *event, uint32_t *consumed) {
  (void)self;
  (void)event;
  *consumed = 1;
  return C3DE_OK;
}

static void drive_tools(void) {
  const c3de_tools_v1 *tools = service(C3DE_TOOLS_ID);
  int calls = 0;
  c3de_tool tool = {sizeof tool, 1, TEXT("test.driver.tool"), TEXT("Driver"), TEXT("hint"), 'D', 0, &calls, activate,
                    cancel, on_event, 0, 0};
  c3de_handle h, stubborn, none;
  uint32_t active = 9;
  GIVES(C3DE_OK, tools->add(tools->ctx, &tool, &h));
  GIVES(C3DE_E_EXISTS, tools->add(tools->ctx, &tool, &none));
  GIVES(C3DE_E_ARG, tools->add(tools->ctx, NULL, &none));
  GIVES(C3DE_E_ARG, tools->add(tools->ctx, &tool, NULL));
  tool.id = text("test.driver.stubborn");
  tool.shortcut = 7;
  GIVES(C3DE_E_ARG, tools->add(tools->ctx, &tool, &none));
  tool.shortcut = 0;
  tool.cancel = NULL;
  GIVES(C3DE_E_ARG, tools->add(tools->ctx, &tool, &none));
  tool.cancel = cancel;
  tool.activate = refuse_to_activate;
  tool.flags = 2;
  GIVES(C3DE_E_UNSUPPORTED, tools->add(tools->ctx, &tool, &none));
  SAYS("accepted: 0, 1 (C3DE_TOOL_IN_SLICES)");
  tool.flags = C3DE_TOOL_IN_SLICES;
  GIVES(C3DE_OK, tools->add(tools->ctx, &tool, &stubborn));

  GIVES(C3DE_OK, tools->activate(tools->ctx, h));
  GIVES(C3DE_OK, tools->is_active(tools->ctx, h, &active));
  HOLDS(active == 1 && calls == 1);
  GIVES(C3DE_E_STATE, tools->activate(tools->ctx, stubborn));
  SAYS("no body to touch");
  GIVES(C3DE_OK, tools->is_active(tools->ctx, h, &active));
  HOLDS(active == 0 && calls == 11);
  GIVES(C3DE_OK, tools->activate(tools->ctx, h));
  GIVES(C3DE_OK, tools->activate(tools->ctx, kNone));
  HOLDS(calls == 22);
  GIVES(C3DE_E_STALE, tools->activate(tools->ctx, kNoSuch));
  GIVES(C3DE_E_STALE, tools->is_active(tools->ctx, kNoSuch, &active));
  GIVES(C3DE_E_ARG, tools->is_active(tools->ctx, h, NULL));
  GIVES(C3DE_OK, tools->remove(tools->ctx, h));
  GIVES(C3DE_E_STALE, tools->remove(tools->ctx, h));
  GIVES(C3DE_OK, tools->remove(tools->ctx, stubborn));
  double marked[3] = {0, 0, 0};
  HOLDS(tools->rev >= 2);
  GIVES(C3DE_OK, tools->marked_point(tools->ctx, marked));
  HOLDS(marked[0] == 1 && marked[1] == -2 && marked[2] == 3.5);
  GIVES(C3DE_E_ARG, tools->marked_point(tools->ctx, NULL));
}

/* ---- history ---- */

static c3de_status C3DE_CALL take_back(void *self) {
  *(int *)self += 1;
  return C3DE_OK;
}
static c3de_status C3DE_CALL do_again(void *self) {
  *(int *)self += 10;
  return C3DE_OK;
}
static void C3DE_CALL let_go_of(void *self) { *(int *)self += 100; }

static void drive_history(void) {
  const c3de_history_v1 *history = service(C3DE_HISTORY_ID);
  static int calls, quiet;
  c3de_edit edit = {sizeof edit, 1, TEXT("pull"), &calls, take_back, do_again, let_go_of};
  c3de_handle h, none;
  calls = quiet = 0;
  GIVES(C3DE_OK, history->add(history->ctx, &edit, &h));
  GIVES(C3DE_E_ARG, history->add(history->ctx, NULL, &none));
  GIVES(C3DE_E_ARG, history->add(history->ctx, &edit, NULL));
  edit.label = text("");
  GIVES(C3DE_E_ARG, history->add(history->ctx, &edit, &none));
  SAYS("label");
  edit.label = text("cut");
  edit.undo = NULL;
  GIVES(C3DE_E_ARG, history->add(history->ctx, &edit, &none));
  edit.undo = take_back;
  edit.redo = NULL;
  GIVES(C3DE_E_ARG, history->add(history->ctx, &edit, &none));
  edit.redo = do_again;
  edit.size = 8;
  GIVES(C3DE_E_ARG, history->add(history->ctx, &edit, &none));
  HOLDS(none.v == 0 && calls == 0);
  GIVES(C3DE_E_STALE, history->remove(history->ctx, kNoSuch));
  GIVES(C3DE_OK, history->remove(history->ctx, h));
  HOLDS(calls == 100);
  GIVES(C3DE_E_STALE, history->remove(history->ctx, h));
  /* Two stay for the test program to undo and redo; the second without release. */
  edit.size = sizeof edit;
  edit.label = text("pull");
  GIVES(C3DE_OK, history->add(history->ctx, &edit, &h));
  edit.label = text("quiet");
  edit.self = &quiet;
  edit.release = NULL;
  GIVES(C3DE_OK, history->add(history->ctx, &edit, &h));
}

/* After undo, undo, redo by the test program. */
static void drive_history_after(void) {
  const c3de_history_v1 *history = service(C3DE_HISTORY_ID);
  static int last;
  c3de_edit edit = {sizeof edit, 1, TEXT("last"), &last, take_back, do_again, let_go_of};
  c3de_handle h;
  GIVES(C3DE_OK, history->add(history->ctx, &edit, &h));
}

/* ---- jobs, time, simulation ---- */

typedef struct range_sum {
  uint32_t hits[1000];
} range_sum;

static void C3DE_CALL mark(void *self, uint64_t begin, uint64_t end) {
  for (uint64_t i = begin; i < end; ++i) ++((range_sum *)self)->hits[i];
}
static c3de_status C3DE_CALL run_nothing(void *self, const c3de_progress *progress) {
  (void)self;
  return progress->update(progress->self, 0.5, text("half"));
}
static void C3DE_CALL done_once(void *self, c3de_status status, c3de_str error) {
  (void)status;
  (void)error;
  ++*(int *)self;
}

static int jobs_done; /* outlives the calls below: done() comes with a later frame */

static void drive_jobs(void) {
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
  GIVES(C3DE_OK, jobs->submit(jobs->ctx, &job, &h));
  double fraction = 0.0;
  const c3de_sink no_sink = {NULL, NULL};
  GIVES(C3DE_OK, jobs->progress(jobs->ctx, h, &fraction, no_sink));
  GIVES(C3DE_E_ARG, jobs->progress(jobs->ctx, h, NULL, no_sink));
  GIVES(C3DE_OK, jobs->cancel(jobs->ctx, h));
  GIVES(C3DE_E_STALE, jobs->cancel(jobs->ctx, kNoSuch));
  GIVES(C3DE_E_STALE, jobs->progress(jobs->ctx, kNoSuch, &fraction, no_sink));
  GIVES(C3DE_E_ARG, jobs->submit(jobs->ctx, NULL, &none));
  GIVES(C3DE_E_ARG, jobs->submit(jobs->ctx, &job, NULL));
  job.title = text("");
  GIVES(C3DE_E_ARG, jobs->submit(jobs->ctx, &job, &none));
  job.title = text("Test");
  job.run = NULL;
  GIVES(C3DE_E_ARG, jobs->submit(jobs->ctx, &job, &none));
  job.run = run_nothing;
  job.done = NULL;
  GIVES(C3DE_E_ARG, jobs->submit(jobs->ctx, &job, &none));
}

static int posted_calls, frame_calls;

static void drive_time(void) {
  const c3de_time_v1 *time = service(C3DE_TIME_ID);
  const uint64_t before = time->now_ns(time->ctx);
  HOLDS(time->now_ns(time->ctx) >= before && before > 0);
  (void)time->frame_index(time->ctx);
  time->request_redraw(time->ctx);
  c3de_handle h, none;
  GIVES(C3DE_OK, time->post_to_main(time->ctx, &posted_calls, count_call));
  GIVES(C3DE_E_ARG, time->post_to_main(time->ctx, NULL, NULL));
  GIVES(C3DE_OK, time->add_frame_callback(time->ctx, &frame_calls, count_call, &h));
  GIVES(C3DE_E_ARG, time->add_frame_callback(time->ctx, NULL, NULL, &none));
  GIVES(C3DE_E_ARG, time->add_frame_callback(time->ctx, NULL, count_call, NULL));
  GIVES(C3DE_OK, time->remove_frame_callback(time->ctx, h));
  GIVES(C3DE_E_STALE, time->remove_frame_callback(time->ctx, h));
  GIVES(C3DE_E_STALE, time->remove_frame_callback(time->ctx, kNoSuch));
}

static int sim_calls;

static struct {
  uint64_t added, removed, stepped, seen;
  c3de_handle node;
} watched;
static void C3DE_CALL watch_added(void *self, c3de_handle node) {
  (void)self;
  ++watched.added;
  watched.node = node;
}
static void C3DE_CALL watch_removed(void *self, c3de_handle node) {
  (void)self;
  (void)node;
  ++watched.removed;
}
static c3de_status C3DE_CALL see_simulation(void *visitor, const c3de_simulation_info *info) {
  const void *table = NULL;
  HOLDS(info->size >= sizeof *info);
  HOLDS(info->object != NULL);
  GIVES(C3DE_OK, info->object->vt->query(info->object, text(C3DE_IFACE_SIMULATOR_ID), 1, &table));
  HOLDS(table != NULL);
  ++*(uint64_t *)visitor;
  return C3DE_OK;
}
static c3de_status C3DE_CALL stop_seeing(void *visitor, const c3de_simulation_info *info) {
  (void)visitor;
  (void)info;
  return C3DE_S_TRUNCATED;
}

static void drive_watch(const c3de_simulation_v1 *simulation, c3de_handle node) {
  c3de_simulation_watch watch;
  c3de_handle h;
  memset(&watch, 0, sizeof watch);
  memset(&watched, 0, sizeof watched);
  GIVES(C3DE_OK, simulation->enum_simulations(simulation->ctx, &watched.seen, see_simulation));
  HOLDS(watched.seen == 1);
  GIVES(C3DE_S_TRUNCATED, simulation->enum_simulations(simulation->ctx, NULL, stop_seeing));
  GIVES(C3DE_E_ARG, simulation->enum_simulations(simulation->ctx, NULL, NULL));
  GIVES(C3DE_E_ARG, simulation->watch(simulation->ctx, NULL, &h));
  GIVES(C3DE_E_ARG, simulation->watch(simulation->ctx, &watch, &h)); /* without a size */
  watch.size = sizeof watch;
  watch.added = watch_added;
  watch.removed = watch_removed;
  GIVES(C3DE_E_ARG, simulation->watch(simulation->ctx, &watch, NULL));
  GIVES(C3DE_OK, simulation->watch(simulation->ctx, &watch, &h));
  HOLDS(watched.added == 1 && watched.node.v == node.v);
  GIVES(C3DE_OK, simulation->unwatch(simulation->ctx, h));
  GIVES(C3DE_E_STALE, simulation->unwatch(simulation->ctx, h));
  GIVES(C3DE_E_STALE, simulation->unwatch(simulation->ctx, node));
}

static void drive_simulation(c3de_handle node) {
  const c3de_simulation_v1 *simulation = service(C3DE_SIMULATION_ID);
  c3de_sim_transport state;
  memset(&state, 0, sizeof state);
  state.size = sizeof state;
  GIVES(C3DE_OK, simulation->transport(simulation->ctx, node, C3DE_TRANSPORT_STEP));
  GIVES(C3DE_OK, simulation->set_target_rate(simulation->ctx, node, 0.0));
  GIVES(C3DE_OK, simulation->post(simulation->ctx, node, &sim_calls, count_call));
  GIVES(C3DE_OK, simulation->state(simulation->ctx, node, &state));
  HOLDS(state.size == sizeof state);
  GIVES(C3DE_E_ARG, simulation->transport(simulation->ctx, node, 0));
  GIVES(C3DE_E_ARG, simulation->transport(simulation->ctx, node, 6));
  GIVES(C3DE_E_NOT_FOUND, simulation->transport(simulation->ctx, kNoSuch, C3DE_TRANSPORT_STEP));
  GIVES(C3DE_E_ARG, simulation->set_target_rate(simulation->ctx, node, -1.0));
  GIVES(C3DE_E_ARG, simulation->set_target_rate(simulation->ctx, node, NAN));
  GIVES(C3DE_E_ARG, simulation->state(simulation->ctx, node, NULL));
  GIVES(C3DE_E_ARG, simulation->post(simulation->ctx, node, NULL, NULL));
  GIVES(C3DE_E_NOT_FOUND, simulation->post(simulation->ctx, kNone, &sim_calls, count_call));
  drive_watch(simulation, node);
}

/* ---- handles of one kind where another is asked for ---- */

static void drive_kinds(c3de_handle node) {
  const c3de_collision_v1 *collision = service(C3DE_COLLISION_ID);
  const c3de_mesh_v1 *mesh = service(C3DE_MESH_ID);
  c3de_handle tree, made;
  c3de_mesh_info info;
  memset(&info, 0, sizeof info);
  info.size = sizeof info;
  GIVES(C3DE_OK, collision->create(collision->ctx, corners(), faces(), &tree));
  GIVES(C3DE_OK, mesh->create(mesh->ctx, corners(), faces(), &made));
  GIVES(C3DE_OK, mesh->info(mesh->ctx, made, &info));
  GIVES(C3DE_E_STALE, mesh->info(mesh->ctx, tree, &info));
  SAYS("that of a collision tree");
  GIVES(C3DE_E_STALE, mesh->info(mesh->ctx, node, &info));
  SAYS("that of a scene node");
  GIVES(C3DE_E_STALE, collision->destroy(collision->ctx, made));
  SAYS("that of a mesh");
  GIVES(C3DE_OK, collision->destroy(collision->ctx, tree));
}

/* ---- forces ---- */

static uint64_t force_calls;
static c3de_status C3DE_CALL push_up(void *self, const c3de_force_call *call) {
  *(uint64_t *)self += 1;
  HOLDS(call->size >= sizeof *call);
  for (uint64_t i = 0; i < call->count; ++i) call->forces_N[3 * i + 1] += 1.0;
  return C3DE_OK;
}

static void drive_forces(c3de_handle node) {
  const c3de_forces_v1 *forces = service(C3DE_FORCES_ID);
  c3de_force_field field = {sizeof field, 0, {"up", 2}, &force_calls, push_up};
  c3de_handle all, one, none;
  GIVES(C3DE_OK, forces->add(forces->ctx, kNone, &field, &all));
  GIVES(C3DE_OK, forces->add(forces->ctx, node, &field, &one));
  HOLDS(all.v != 0 && one.v != 0 && all.v != one.v);
  GIVES(C3DE_E_ARG, forces->add(forces->ctx, kNoSuch, &field, &none));
  HOLDS(none.v == 0);
  GIVES(C3DE_E_ARG, forces->add(forces->ctx, kNone, NULL, &none));
  GIVES(C3DE_E_ARG, forces->add(forces->ctx, kNone, &field, NULL));
  field.size = 4;
  GIVES(C3DE_E_ARG, forces->add(forces->ctx, kNone, &field, &none));
  field.size = sizeof field + 64; /* of a later revision: what is known counts */
  GIVES(C3DE_OK, forces->add(forces->ctx, kNone, &field, &none));
  GIVES(C3DE_OK, forces->remove(forces->ctx, none));
  field.size = sizeof field;
  field.apply = NULL;
  GIVES(C3DE_E_ARG, forces->add(forces->ctx, kNone, &field, &none));
  field.apply = push_up;
  field.name.ptr = "\xff";
  field.name.len = 1;
  GIVES(C3DE_E_ARG, forces->add(forces->ctx, kNone, &field, &none));
  GIVES(C3DE_OK, forces->remove(forces->ctx, one));
  GIVES(C3DE_E_STALE, forces->remove(forces->ctx, one));
  GIVES(C3DE_E_STALE, forces->remove(forces->ctx, kNoSuch));
  GIVES(C3DE_E_STALE, forces->remove(forces->ctx, kNone));
  /* The other one is taken back with the plugin. */
}

/* ---- imaging: the store has what test_services.cpp puts there ---- */

static c3de_status C3DE_CALL sum_labels(void *self, const c3de_label *label) {
  HOLDS(label->size >= sizeof *label);
  if (label->value == 3) HOLDS(label->name.len == 5 && memcmp(label->name.ptr, "liver", 5) == 0);
  if (label->value == 3) HOLDS(label->colour[0] == 0.5f && label->colour[1] == 0.25f);
  *(uint32_t *)self += label->value;
  return C3DE_OK;
}
static c3de_status C3DE_CALL stop_at_label(void *self, const c3de_label *label) {
  *(uint32_t *)self += label->value;
  return C3DE_E_CANCELLED;
}

static c3de_handle kept_image, kept_map;

static void drive_images(const c3de_imaging_v1 *imaging) {
  c3de_handle found[4] = {{0}, {0}, {0}, {0}};
  uint64_t needed = 0;
  GIVES(C3DE_S_TRUNCATED, imaging->images(imaging->ctx, NULL, 0, &needed));
  HOLDS(needed == 2);
  GIVES(C3DE_S_TRUNCATED, imaging->images(imaging->ctx, found, 1, &needed));
  HOLDS(found[0].v != 0 && found[1].v == 0 && needed == 2);
  GIVES(C3DE_OK, imaging->images(imaging->ctx, found, 4, &needed));
  HOLDS(found[1].v != 0 && found[0].v != found[1].v && found[2].v == 0 && needed == 2);
  GIVES(C3DE_E_ARG, imaging->images(imaging->ctx, NULL, 1, &needed));
  GIVES(C3DE_E_ARG, imaging->images(imaging->ctx, found, 4, NULL));
  SAYS("needed is null");
  const c3de_handle image = kept_image = found[0];

  c3de_image_info info;
  memset(&info, 0, sizeof info);
  info.size = sizeof info;
  GIVES(C3DE_OK, imaging->image_info(imaging->ctx, image, &info));
  HOLDS(info.size == sizeof info && info.name.len == 7 && memcmp(info.name.ptr, "phantom", 7) == 0);
  HOLDS(info.unit.len == 2 && memcmp(info.unit.ptr, "HU", 2) == 0);
  HOLDS(info.points[0] == 3 && info.points[1] == 4 && info.points[2] == 5);
  HOLDS(info.world_from_index[1] == 2.0 && info.world_from_index[4] == 3.0 && info.world_from_index[14] == 30.0);
  HOLDS(info.min == -90.0 && info.max == 800.0 && info.low == -50.0 && info.high == 700.0);
  info.size = 8;
  GIVES(C3DE_E_ARG, imaging->image_info(imaging->ctx, image, &info));
  SAYS("size is 8");
  GIVES(C3DE_E_ARG, imaging->image_info(imaging->ctx, image, NULL));
  GIVES(C3DE_E_STALE, imaging->image_info(imaging->ctx, kNoSuch, &info));
  SAYS("no image of handle");
  GIVES(C3DE_E_STALE, imaging->image_info(imaging->ctx, kNone, &info));

  /* World of index (i, j, k): (10 + 3 j, 20 + 2 i + k, 30 + 4 k); value: 2 (5 + i + 10 j + 100 k) - 100. */
  const double at[] = {10,   20,   30,    /* voxel 0 0 0 */
                       19,   28,   46,    /* voxel 2 3 4 */
                       11.5, 22.75, 33,   /* index 1 0.5 0.75 */
                       8.8,  19.2, 30,    /* index -0.4 -0.4 0: the border goes on */
                       8.2,  20,   30,    /* index 0 -0.6 0: outside */
                       1e300, -1e300, 0};
  const double expected[] = {-90, 774, 72, -90, -7, -7};
  double values[12];
  for (int i = 0; i < 12; ++i) values[i] = 1234.0;
  c3de_mview out = {values, 6, 1, C3DE_F64, 16}; /* every other number */
  GIVES(C3DE_OK, imaging->sample(imaging->ctx, image, points_of(at, 6), -7.0, out));
  for (int i = 0; i < 6; ++i) {
    HOLDS(fabs(values[2 * i] - expected[i]) < 1e-9); /* rounding of numbers up to 1000 */
    HOLDS(values[2 * i + 1] == 1234.0);
  }
  const c3de_mview one = {values, 1, 1, C3DE_F64, 0}, none = {NULL, 0, 1, C3DE_F64, 0};
  GIVES(C3DE_OK, imaging->sample(imaging->ctx, image, points_of(at + 12, 1), NAN, one));
  HOLDS(isnan(values[0]));
  GIVES(C3DE_OK, imaging->sample(imaging->ctx, image, points_of(NULL, 0), 0.0, none));
  GIVES(C3DE_E_STALE, imaging->sample(imaging->ctx, kNoSuch, points_of(at, 6), -7.0, out));
  GIVES(C3DE_E_ARG, imaging->sample(imaging->ctx, image, points_of(NULL, 6), -7.0, out));
  SAYS("points_mm is null");
  const double nowhere[] = {0, NAN, 0};
  GIVES(C3DE_E_ARG, imaging->sample(imaging->ctx, image, points_of(nowhere, 1), -7.0, one));
  SAYS("row 0 is not finite");
  out.count = 5;
  GIVES(C3DE_E_ARG, imaging->sample(imaging->ctx, image, points_of(at, 6), -7.0, out));
  SAYS("room for 5 rows, there are 6");
  out.count = 6;
  out.dtype = C3DE_F32;
  GIVES(C3DE_E_ARG, imaging->sample(imaging->ctx, image, points_of(at, 6), -7.0, out));
  out.dtype = C3DE_F64;
  out.data = NULL;
  GIVES(C3DE_E_ARG, imaging->sample(imaging->ctx, image, points_of(at, 6), -7.0, out));
  SAYS("out is null");
}

static void drive_label_maps(const c3de_imaging_v1 *imaging) {
  c3de_handle map = {0};
  uint64_t needed = 0;
  GIVES(C3DE_OK, imaging->label_maps(imaging->ctx, &map, 1, &needed));
  HOLDS(needed == 1 && map.v != 0);
  GIVES(C3DE_E_ARG, imaging->label_maps(imaging->ctx, NULL, 1, &needed));
  GIVES(C3DE_E_ARG, imaging->label_maps(imaging->ctx, &map, 1, NULL));
  kept_map = map;

  c3de_label_map_info info;
  memset(&info, 0, sizeof info);
  info.size = sizeof info;
  GIVES(C3DE_OK, imaging->label_map_info(imaging->ctx, map, &info));
  HOLDS(info.name.len == 6 && memcmp(info.name.ptr, "organs", 6) == 0 && info.labels == 2);
  HOLDS(info.points[0] == 2 && info.points[1] == 1 && info.points[2] == 1 && info.world_from_index[0] == 10.0);
  GIVES(C3DE_E_ARG, imaging->label_map_info(imaging->ctx, map, NULL));
  GIVES(C3DE_E_STALE, imaging->label_map_info(imaging->ctx, kNoSuch, &info));
  SAYS("no label map of handle");

  const double at[] = {4.9, -4.9, 4.9, 5.1, 0, 0, 15.1, 0, 0, 0, 5.1, 0};
  uint32_t labels[4] = {9, 9, 9, 9};
  c3de_mview out = {labels, 4, 1, C3DE_U32, 0};
  GIVES(C3DE_OK, imaging->labels_at(imaging->ctx, map, points_of(at, 4), out));
  HOLDS(labels[0] == 3 && labels[1] == 40000 && labels[2] == 0 && labels[3] == 0);
  GIVES(C3DE_E_STALE, imaging->labels_at(imaging->ctx, kNone, points_of(at, 4), out));
  GIVES(C3DE_E_ARG, imaging->labels_at(imaging->ctx, map, points_of(NULL, 4), out));
  GIVES(C3DE_E_ARG, imaging->labels_at(imaging->ctx, map, points_of(at, 3), out));
  out.dtype = C3DE_F64;
  GIVES(C3DE_E_ARG, imaging->labels_at(imaging->ctx, map, points_of(at, 4), out));
  SAYS("accepted: u32");
  out.dtype = C3DE_U32;
  out.data = NULL;
  GIVES(C3DE_E_ARG, imaging->labels_at(imaging->ctx, map, points_of(at, 4), out));

  uint32_t sum = 0, first = 0;
  GIVES(C3DE_OK, imaging->enum_labels(imaging->ctx, map, &sum, sum_labels));
  HOLDS(sum == 40003);
  GIVES(C3DE_E_ARG, imaging->enum_labels(imaging->ctx, map, &sum, NULL));
  GIVES(C3DE_E_STALE, imaging->enum_labels(imaging->ctx, kNoSuch, &sum, sum_labels));
  HOLDS(imaging->enum_labels(imaging->ctx, map, &first, stop_at_label) == C3DE_E_CANCELLED && first == 3);
}

static void drive_imaging(void) {
  const c3de_imaging_v1 *imaging = service(C3DE_IMAGING_ID);
  HOLDS(imaging->size >= sizeof *imaging && imaging->rev == 1);
  drive_images(imaging);
  drive_label_maps(imaging);
}

static void drive_imaging_of_what_is_gone(void) {
  const c3de_imaging_v1 *imaging = service(C3DE_IMAGING_ID);
  const double at[] = {10, 20, 30};
  double value = 0.0;
  uint32_t label = 0;
  uint64_t needed = 9;
  GIVES(C3DE_OK, imaging->images(imaging->ctx, NULL, 0, &needed));
  HOLDS(needed == 0);
  GIVES(C3DE_OK, imaging->label_maps(imaging->ctx, NULL, 0, &needed));
  c3de_image_info info;
  memset(&info, 0, sizeof info);
  info.size = sizeof info;
  HOLDS(kept_image.v != 0 && kept_map.v != 0);
  GIVES(C3DE_E_STALE, imaging->image_info(imaging->ctx, kept_image, &info));
  const c3de_mview value_out = {&value, 1, 1, C3DE_F64, 0}, label_out = {&label, 1, 1, C3DE_U32, 0};
  GIVES(C3DE_E_STALE, imaging->sample(imaging->ctx, kept_image, points_of(at, 1), 0.0, value_out));
  GIVES(C3DE_E_STALE, imaging->labels_at(imaging->ctx, kept_map, points_of(at, 1), label_out));
  GIVES(C3DE_E_STALE, imaging->enum_labels(imaging->ctx, kept_map, &label, sum_labels));
}

static void drive_imaging_without_a_store(void) {
  const void *table = NULL;
  GIVES(C3DE_E_UNSUPPORTED, host->get_service(host->ctx, text(C3DE_IMAGING_ID), 1, &table));
  SAYS("it needs images");
  HOLDS(table == NULL);
}

/* ---- from a thread that is not the main one: the test calls run() there with this name ---- */

static void drive_wrong_thread(void) {
  const c3de_registry_v1 *registry = service(C3DE_REGISTRY_ID);
  const c3de_scene_v1 *scene = service(C3DE_SCENE_ID);
  const c3de_render_v1 *render = service(C3DE_RENDER_ID);
  const c3de_params_v1 *params = service(C3DE_PARAMS_ID);
  const c3de_panels_v1 *panels = service(C3DE_PANELS_ID);
  const c3de_tools_v1 *tools = service(C3DE_TOOLS_ID);
  const c3de_jobs_v1 *jobs = service(C3DE_JOBS_ID);
  const c3de_time_v1 *time = service(C3DE_TIME_ID);
  const c3de_mesh_v1 *mesh = service(C3DE_MESH_ID);
  const c3de_collision_v1 *collision = service(C3DE_COLLISION_ID);
  const c3de_log_v1 *log = service(C3DE_LOG_ID);
  c3de_object *object;
  c3de_handle h;
  uint32_t flag;
  GIVES(C3DE_E_THREAD, registry->create(registry->ctx, text(TEST_DRIVER_CLASS), &object));
  SAYS("main thread");
  GIVES(C3DE_E_THREAD, registry->remove_class(registry->ctx, text("x")));
  GIVES(C3DE_E_THREAD, scene->add_node(scene->ctx, kNone, text("x"), &h));
  GIVES(C3DE_E_THREAD, scene->is_visible(scene->ctx, handle_of(1), &flag));
  GIVES(C3DE_E_THREAD, render->destroy(render->ctx, handle_of(1)));
  GIVES(C3DE_E_THREAD, render->update(render->ctx, handle_of(1), C3DE_ATTR_POSITIONS, corners()));
  GIVES(C3DE_E_THREAD, params->remove(params->ctx, handle_of(1)));
  GIVES(C3DE_E_THREAD, panels->notify(panels->ctx, 1, text("a"), text("b")));
  GIVES(C3DE_E_THREAD, tools->activate(tools->ctx, kNone));
  GIVES(C3DE_E_THREAD, jobs->cancel(jobs->ctx, handle_of(1)));
  GIVES(C3DE_E_THREAD, time->remove_frame_callback(time->ctx, handle_of(1)));
  /* And what may be called anywhere. */
  int seen = 0;
  GIVES(C3DE_OK, registry->enum_classes(registry->ctx, text(""), &seen, count_class));
  GIVES(C3DE_OK, mesh->create(mesh->ctx, corners(), faces(), &h));
  GIVES(C3DE_OK, mesh->release(mesh->ctx, h));
  GIVES(C3DE_OK, collision->create(collision->ctx, corners(), faces(), &h));
  GIVES(C3DE_OK, collision->destroy(collision->ctx, h));
  GIVES(C3DE_OK, time->post_to_main(time->ctx, &posted_calls, count_call));
  log->write(log->ctx, C3DE_LOG_WARN, text("a warning from another thread"));
}

/* ---- files, settings, commands ---- */

static c3de_status C3DE_CALL read_nothing(void *self, const c3de_mesh_source *source, const c3de_progress *progress,
                                          const c3de_mesh_sink *sink) {
  (void)self;
  (void)source;
  (void)progress;
  (void)sink;
  return C3DE_E_UNSUPPORTED;
}

static c3de_status C3DE_CALL write_nothing(void *self, const c3de_mesh_contents *mesh, const c3de_progress *progress,
                                           c3de_sink bytes) {
  (void)self;
  (void)mesh;
  (void)progress;
  (void)bytes;
  return C3DE_E_UNSUPPORTED;
}

static void drive_writers(const c3de_files_v1 *files) {
  const c3de_str extensions[] = {TEXT("one"), TEXT("obj")};
  c3de_mesh_writer writer = {sizeof writer, 1, TEXT("test.reader"), TEXT("Writer"), extensions, 2, NULL, write_nothing};
  c3de_handle h, none;
  HOLDS(files->rev >= 2);
  GIVES(C3DE_OK, files->add_mesh_writer(files->ctx, &writer, &h)); /* a reader may have the same id */
  GIVES(C3DE_E_EXISTS, files->add_mesh_writer(files->ctx, &writer, &none));
  HOLDS(none.v == 0);
  GIVES(C3DE_E_ARG, files->add_mesh_writer(files->ctx, NULL, &none));
  GIVES(C3DE_E_ARG, files->add_mesh_writer(files->ctx, &writer, NULL));
  writer.id = text("test.other");
  writer.write = NULL;
  GIVES(C3DE_E_ARG, files->add_mesh_writer(files->ctx, &writer, &none));
  SAYS("write");
  writer.write = write_nothing;
  writer.extensions_n = 0;
  GIVES(C3DE_E_ARG, files->add_mesh_writer(files->ctx, &writer, &none));
  writer.size = 24;
  GIVES(C3DE_E_ARG, files->add_mesh_writer(files->ctx, &writer, &none));
  GIVES(C3DE_OK, files->remove(files->ctx, h));
  GIVES(C3DE_E_STALE, files->remove(files->ctx, h));
}

static void drive_files(void) {
  const c3de_files_v1 *files = service(C3DE_FILES_ID);
  const c3de_str extensions[] = {TEXT("one"), TEXT("TWO")}, dotted = TEXT(".one"), empty = TEXT("");
  c3de_mesh_reader reader = {sizeof reader, 1, TEXT("test.reader"), TEXT("Reader"), extensions, 2,
                             TEXT(""), NULL, read_nothing};
  c3de_handle h, none;
  GIVES(C3DE_OK, files->add_mesh_reader(files->ctx, &reader, &h));
  GIVES(C3DE_E_EXISTS, files->add_mesh_reader(files->ctx, &reader, &none));
  SAYS("test.service_driver");
  HOLDS(none.v == 0);
  reader.id = text("test.other");
  GIVES(C3DE_E_ARG, files->add_mesh_reader(files->ctx, NULL, &none));
  GIVES(C3DE_E_ARG, files->add_mesh_reader(files->ctx, &reader, NULL));
  reader.extensions_n = 0;
  GIVES(C3DE_E_ARG, files->add_mesh_reader(files->ctx, &reader, &none));
  SAYS("extensions_n");
  reader.extensions_n = 1;
  reader.extensions = &dotted;
  GIVES(C3DE_E_ARG, files->add_mesh_reader(files->ctx, &reader, &none));
  SAYS("without the dot");
  reader.extensions = &empty;
  GIVES(C3DE_E_ARG, files->add_mesh_reader(files->ctx, &reader, &none));
  reader.extensions = NULL;
  GIVES(C3DE_E_ARG, files->add_mesh_reader(files->ctx, &reader, &none));
  reader.extensions = extensions;
  reader.read = NULL;
  GIVES(C3DE_E_ARG, files->add_mesh_reader(files->ctx, &reader, &none));
  SAYS("read");
  reader.read = read_nothing;
  reader.label = text("");
  GIVES(C3DE_E_ARG, files->add_mesh_reader(files->ctx, &reader, &none));
  reader.label = text("Reader");
  reader.id = text("a b");
  GIVES(C3DE_E_ARG, files->add_mesh_reader(files->ctx, &reader, &none));
  reader.id = text("test.other");
  reader.size = 16;
  GIVES(C3DE_E_ARG, files->add_mesh_reader(files->ctx, &reader, &none));
  drive_writers(files);
  GIVES(C3DE_E_STALE, files->remove(files->ctx, kNoSuch));
  GIVES(C3DE_OK, files->remove(files->ctx, h));
  GIVES(C3DE_E_STALE, files->remove(files->ctx, h));
}

static c3de_status C3DE_CALL count_key(void *self, c3de_str key) {
  *(uint64_t *)self += key.len;
  return C3DE_OK;
}
static c3de_status C3DE_CALL stop_at_key(void *self, c3de_str key) {
  (void)key;
  ++*(uint64_t *)self;
  return C3DE_S_TRUNCATED;
}

static void drive_settings(void) {
  const c3de_settings_v1 *settings = service(C3DE_SETTINGS_ID);
  uint64_t bytes = 0, keys = 0, calls = 0;
  const c3de_sink sink = {&bytes, count_bytes}, no_sink = {NULL, NULL};
  const c3de_str broken = {"\xff\xfe", 2};
  GIVES(C3DE_E_NOT_FOUND, settings->get(settings->ctx, text("colour"), sink));
  SAYS("colour");
  GIVES(C3DE_E_NOT_FOUND, settings->remove(settings->ctx, text("colour")));
  GIVES(C3DE_OK, settings->set(settings->ctx, text("colour"), text("blue")));
  GIVES(C3DE_OK, settings->set(settings->ctx, text("empty"), text("")));
  GIVES(C3DE_OK, settings->get(settings->ctx, text("colour"), sink));
  HOLDS(bytes == 4);
  GIVES(C3DE_OK, settings->get(settings->ctx, text("empty"), sink));
  HOLDS(bytes == 4);
  GIVES(C3DE_E_ARG, settings->get(settings->ctx, text("colour"), no_sink));
  GIVES(C3DE_E_ARG, settings->get(settings->ctx, text(""), sink));
  GIVES(C3DE_E_ARG, settings->set(settings->ctx, text("a b"), text("c")));
  SAYS("key");
  GIVES(C3DE_E_ARG, settings->set(settings->ctx, text("bytes"), broken));
  SAYS("UTF-8");
  GIVES(C3DE_OK, settings->keys(settings->ctx, &keys, count_key));
  HOLDS(keys == strlen("colour") + strlen("empty"));
  GIVES(C3DE_S_TRUNCATED, settings->keys(settings->ctx, &calls, stop_at_key));
  HOLDS(calls == 1);
  GIVES(C3DE_E_ARG, settings->keys(settings->ctx, &calls, NULL));
  GIVES(C3DE_OK, settings->remove(settings->ctx, text("empty")));
  GIVES(C3DE_E_NOT_FOUND, settings->get(settings->ctx, text("empty"), sink));
}

static const c3de_commands_v1 *kept_commands;
static c3de_status C3DE_CALL count_run(void *self) {
  ++*(int *)self;
  return C3DE_OK;
}
static c3de_status C3DE_CALL fail_to_run(void *self) {
  (void)self;
  host->set_error(host->ctx, C3DE_E_STATE, text("there is no organ"));
  return C3DE_E_STATE;
}
static c3de_status C3DE_CALL run_itself(void *self) {
  (void)self;
  return kept_commands->run(kept_commands->ctx, text("test.again"));
}

static void drive_commands(void) {
  const c3de_commands_v1 *commands = service(C3DE_COMMANDS_ID);
  kept_commands = commands;
  static int runs;
  c3de_command command = {sizeof command, 1, TEXT("test.count"), TEXT("Count"), TEXT("Counts."),
                          'Q', C3DE_MOD_CTRL, &runs, count_run};
  c3de_handle count, other, none;
  runs = 0;
  GIVES(C3DE_S_NO_SHORTCUT, commands->add(commands->ctx, &command, &count));
  GIVES(C3DE_E_EXISTS, commands->add(commands->ctx, &command, &none));
  SAYS("test.service_driver");
  GIVES(C3DE_OK, commands->run(commands->ctx, text("test.count")));
  HOLDS(runs == 1);
  command.id = text("test.fail");
  command.key = 'K';
  command.modifiers = C3DE_MOD_CTRL | C3DE_MOD_SHIFT;
  command.run = fail_to_run;
  GIVES(C3DE_OK, commands->add(commands->ctx, &command, &other));
  GIVES(C3DE_E_STATE, commands->run(commands->ctx, text("test.fail")));
  SAYS("there is no organ");
  command.id = text("test.again");
  command.run = run_itself;
  GIVES(C3DE_S_NO_SHORTCUT, commands->add(commands->ctx, &command, &none));
  GIVES(C3DE_E_STATE, commands->run(commands->ctx, text("test.again")));
  SAYS("running already");
  GIVES(C3DE_OK, commands->remove(commands->ctx, none));
  command.id = text("test.next");
  GIVES(C3DE_E_ARG, commands->add(commands->ctx, NULL, &none));
  GIVES(C3DE_E_ARG, commands->add(commands->ctx, &command, NULL));
  command.modifiers = 0;
  GIVES(C3DE_E_ARG, commands->add(commands->ctx, &command, &none));
  SAYS("C3DE_MOD_CTRL");
  command.modifiers = 64;
  GIVES(C3DE_E_ARG, commands->add(commands->ctx, &command, &none));
  command.modifiers = C3DE_MOD_ALT;
  command.key = 'k';
  GIVES(C3DE_E_ARG, commands->add(commands->ctx, &command, &none));
  SAYS("'A' to 'Z'");
  command.key = 0;
  command.title = text("");
  GIVES(C3DE_E_ARG, commands->add(commands->ctx, &command, &none));
  command.title = text("Next");
  command.run = NULL;
  GIVES(C3DE_E_ARG, commands->add(commands->ctx, &command, &none));
  command.run = count_run;
  command.size = 16;
  GIVES(C3DE_E_ARG, commands->add(commands->ctx, &command, &none));
  GIVES(C3DE_OK, commands->set_enabled(commands->ctx, count, 0));
  GIVES(C3DE_E_STATE, commands->run(commands->ctx, text("test.count")));
  SAYS("not enabled");
  GIVES(C3DE_OK, commands->set_enabled(commands->ctx, count, 1));
  GIVES(C3DE_OK, commands->run(commands->ctx, text("test.count")));
  HOLDS(runs == 2);
  GIVES(C3DE_E_NOT_FOUND, commands->run(commands->ctx, text("test.cuont")));
  SAYS("did you mean test.count?");
  GIVES(C3DE_E_STALE, commands->set_enabled(commands->ctx, kNoSuch, 1));
  GIVES(C3DE_OK, commands->remove(commands->ctx, count));
  GIVES(C3DE_E_STALE, commands->remove(commands->ctx, count));
}

/* ---- when the plugin was taken back but an object of it is still called ---- */

static const c3de_registry_v1 *kept_registry;

static void drive_taken_back(void) {
  const void *table = NULL;
  GIVES(C3DE_E_STATE, host->get_service(host->ctx, text(C3DE_LOG_ID), 1, &table));
  SAYS("has been taken back");
  GIVES(C3DE_E_STATE, add_test_class(kept_registry, "test.Ghost/0"));
  GIVES(C3DE_E_STATE, kept_registry->remove_class(kept_registry->ctx, text("test.Ghost/0")));
}

/* ---- the object that the test program calls ---- */

static uint64_t C3DE_CALL run(c3de_object *self, c3de_str name, c3de_handle simulation, c3de_sink out) {
  (void)self;
  differences = out;
  compared = 0;
  const char *p = name.ptr;
  const size_t n = (size_t)name.len;
#define IS(s) (n == sizeof(s) - 1 && memcmp(p, s, n) == 0)
  if (IS("host")) drive_host();
  if (IS("log")) drive_log();
  if (IS("registry")) drive_registry();
  if (IS("mesh")) drive_mesh();
  if (IS("scene")) drive_scene();
  if (IS("render")) drive_render();
  if (IS("collision")) drive_collision();
  if (IS("params")) drive_params();
  if (IS("panels")) drive_panels();
  if (IS("tools")) drive_tools();
  if (IS("history")) drive_history();
  if (IS("history after")) drive_history_after();
  if (IS("jobs")) drive_jobs();
  if (IS("time")) drive_time();
  if (IS("simulation")) drive_simulation(simulation);
  if (IS("kinds")) drive_kinds(simulation);
  if (IS("forces")) drive_forces(simulation);
  if (IS("files")) drive_files();
  if (IS("settings")) drive_settings();
  if (IS("commands")) drive_commands();
  if (IS("imaging")) drive_imaging();
  if (IS("imaging of what is gone")) drive_imaging_of_what_is_gone();
  if (IS("imaging without a store")) drive_imaging_without_a_store();
  if (IS("wrong thread")) drive_wrong_thread();
  if (IS("taken back")) drive_taken_back();
  return compared;
}

static const test_driver_v0 driver_table = {sizeof(test_driver_v0), 1, run};

/* One object for all: it is never destroyed, so its count does not matter. */
static uint32_t C3DE_CALL retain(c3de_object *self) {
  (void)self;
  return 2;
}
static uint32_t C3DE_CALL release(c3de_object *self) {
  (void)self;
  return 1;
}
static c3de_status C3DE_CALL query(c3de_object *self, c3de_str id, uint32_t min_rev, const void **table) {
  (void)self;
  (void)id;
  (void)min_rev;
  *table = &driver_table;
  return C3DE_OK;
}
static const c3de_object_vt driver_vt = {sizeof(c3de_object_vt), 1, retain, release, query};
static c3de_object driver_object = {&driver_vt};

static c3de_status C3DE_CALL get_driver(void *factory, c3de_object **out) {
  (void)factory;
  *out = &driver_object;
  return C3DE_OK;
}

static c3de_status C3DE_CALL create(const c3de_host *h, void **self) {
  *self = NULL; /* a plugin without state of its own may do so */
  host = h;
  const void *registry = NULL;
  const c3de_status status = host->get_service(host->ctx, text(C3DE_REGISTRY_ID), 1, &registry);
  if (status < 0) return status;
  const c3de_str ifaces[] = {TEXT(TEST_DRIVER_ID)};
  const c3de_class cls = {sizeof cls, 1, TEXT(TEST_DRIVER_CLASS), TEXT("Driver"), TEXT(""), ifaces, 1, NULL, get_driver};
  kept_registry = registry;
  return kept_registry->add_class(kept_registry->ctx, &cls);
}

static c3de_status C3DE_CALL start(void *self) {
  (void)self;
#if defined(GOES_IN_START)
  return C3DE_E_STATE;
#else
  return C3DE_OK;
#endif
}

static const c3de_plugin plugin = {NAMED("test.service_driver"), NO_NEEDS, create, start, do_nothing, destroy_nothing};
ANSWER_WITH(&plugin)
