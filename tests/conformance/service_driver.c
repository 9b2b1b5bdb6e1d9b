/* SPDX-License-Identifier: Apache-2.0 */
/* A plugin in C that calls every function of every service with good and bad arguments and compares the status. For each
 * refused call there must be a text that names what was wrong. */
#include "service_driver.h"

#include <math.h>
#include <stdlib.h>

#include "bad_plugins/minimal.h"

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter" /* most callbacks use few of theirs */
#endif

static const c3de_host *host;
static c3de_sink differences;
static uint64_t compared;
static char error_text[512];

static c3de_status C3DE_CALL keep_error(void *self, const void *bytes, uint64_t n) {
  const size_t used = strlen(error_text), room = sizeof error_text - 1 - used;
  const size_t take = n < room ? (size_t)n : room;
  memcpy(error_text + used, bytes, take);
  error_text[used + take] = '\0';
  return C3DE_OK;
}

static void differ(int line, const char *what, const char *detail) {
  char buffer[1024];
  const int n = snprintf(buffer, sizeof buffer, "line %d: %s%s [%s]\n", line, what, detail, error_text);
  differences.put(differences.self, buffer, n < (int)sizeof buffer ? (uint64_t)n : sizeof buffer - 1);
}

static void compare_true(int line, const char *condition, int value) {
  ++compared;
  if (!value) differ(line, condition, "");
}

/* part: of the text of the error; empty: any. */
static void compare(int line, const char *call, c3de_status got, c3de_status expected, const char *part) {
  char buffer[64];
  ++compared;
  error_text[0] = '\0';
  const c3de_sink sink = {NULL, keep_error};
  host->take_error(host->ctx, sink);
  snprintf(buffer, sizeof buffer, " gave %d, expected %d", (int)got, (int)expected);
  if (got != expected)
    differ(line, call, buffer);
  else if (got < 0 && error_text[0] == '\0')
    differ(line, call, " left no text");
  if (part[0] == '\0') return;
  ++compared;
  if (!strstr(error_text, part)) differ(line, "text has: ", part);
}

/* Tables: macro(service, common, row) for each row, at most 9. A call is a row (status without C3DE_, function,
 * arguments …). */
#define PICK(_1, _2, _3, _4, _5, _6, _7, _8, _9, chosen, ...) chosen
#define ROWS_1(m, t, c, row) m(t, c, row)
#define ROWS_2(m, t, c, row, ...) m(t, c, row) ROWS_1(m, t, c, __VA_ARGS__)
#define ROWS_3(m, t, c, row, ...) m(t, c, row) ROWS_2(m, t, c, __VA_ARGS__)
#define ROWS_4(m, t, c, row, ...) m(t, c, row) ROWS_3(m, t, c, __VA_ARGS__)
#define ROWS_5(m, t, c, row, ...) m(t, c, row) ROWS_4(m, t, c, __VA_ARGS__)
#define ROWS_6(m, t, c, row, ...) m(t, c, row) ROWS_5(m, t, c, __VA_ARGS__)
#define ROWS_7(m, t, c, row, ...) m(t, c, row) ROWS_6(m, t, c, __VA_ARGS__)
#define ROWS_8(m, t, c, row, ...) m(t, c, row) ROWS_7(m, t, c, __VA_ARGS__)
#define ROWS_9(m, t, c, row, ...) m(t, c, row) ROWS_8(m, t, c, __VA_ARGS__)
#define ROWS(m, t, c, ...)                                                                     \
  PICK(__VA_ARGS__, ROWS_9, ROWS_8, ROWS_7, ROWS_6, ROWS_5, ROWS_4, ROWS_3, ROWS_2, ROWS_1, 0) \
  (m, t, c, __VA_ARGS__)
#define UNPACK(...) __VA_ARGS__
#define COMPARE_OF(t, text, part, status, function, ...) \
  compare(__LINE__, text, t->function(t->ctx, __VA_ARGS__), C3DE_##status, part)
#define COMPARE(...) COMPARE_OF(__VA_ARGS__)
#define COMPARE_ROW(t, part, call) COMPARE(t, #t "->" #call, part, UNPACK call);
#define CHANGE_OF(t, call, member, value, part)                             \
  do {                                                                      \
    char kept[sizeof(member)];                                              \
    memcpy(kept, &(member), sizeof kept);                                   \
    (member) = value;                                                       \
    COMPARE(t, #t "->" #call ", " #member " = " #value, part, UNPACK call); \
    memcpy(&(member), kept, sizeof kept);                                   \
  } while (0);
#define CHANGE(...) CHANGE_OF(__VA_ARGS__)
#define CHANGE_ROW(t, call, change) CHANGE(t, call, UNPACK change)

/* The calls of the service one after another. */
#define GIVES(service, ...) ROWS(COMPARE_ROW, service, "", __VA_ARGS__)
/* A call that is refused, with the part in the text of the error. */
#define SAYS(service, part, call) COMPARE_ROW(service, part, call)
/* The call with each change (member, value, part of the text or ""), which is then undone. */
#define CHANGED(service, call, ...) ROWS(CHANGE_ROW, service, call, __VA_ARGS__)
#define RETURNS(status, call) compare(__LINE__, #call, (call), (status), "")
#define HOLDS(condition) compare_true(__LINE__, #condition, (condition) != 0)

static const void *service(const char *id) {
  const void *table = NULL;
  GIVES(host, (OK, get_service, text(id), 1, &table));
  HOLDS(table != NULL);
  return table;
}

/* ---- data that several services want ---- */

static const double kCorners[] = {0, 0, 0, 10, 0, 0, 0, 10, 0, 0, 0, 10};
static const uint32_t kFaces[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
static const uint32_t kFacesOutOfRange[] = {0, 2, 1, 0, 1, 4};
static const c3de_view faces = {kFaces, 4, 3, C3DE_U32, 0}, far_faces = {kFacesOutOfRange, 2, 3, C3DE_U32, 0};
static const c3de_view corners = {kCorners, 4, 3, C3DE_F64, 0}, three_corners = {kCorners, 3, 3, C3DE_F64, 0};
static const c3de_handle kNone = {0};
static const c3de_handle kNoSuch = {(UINT64_C(77) << 32) | 9999};
static const c3de_sink no_sink = {NULL, NULL};

static c3de_view points_of(const double *data, uint64_t count) {
  c3de_view v = {data, count, 3, C3DE_F64, 0};
  return v;
}
static c3de_handle handle_of(uint64_t v) {
  c3de_handle h = {v};
  return h;
}
static int is_text(c3de_str s, const char *expected) {
  return s.len == strlen(expected) && memcmp(s.ptr, expected, strlen(expected)) == 0;
}
static c3de_status C3DE_CALL count_bytes(void *self, const void *bytes, uint64_t n) {
  *(uint64_t *)self += n;
  return C3DE_OK;
}
static void C3DE_CALL count_call(void *self) { ++*(int *)self; }

/* ---- host ---- */

static void drive_host(void) {
  const void *table = NULL, *again = NULL;
  const c3de_str broken = {NULL, 12};
  SAYS(host, "teapot", (E_NOT_FOUND, get_service, text("draft/c3de.teapot/0"), 1, &table));
  HOLDS(table == NULL);
  SAYS(host, "rev >= 99, host has 1", (E_VERSION, get_service, text(C3DE_LOG_ID), 99, &table));
  GIVES(host, (E_ARG, get_service, text(C3DE_LOG_ID), 1, NULL), (E_ARG, get_service, broken, 1, &table),
        (OK, get_service, text(C3DE_LOG_ID), 0, &table), (OK, get_service, text(C3DE_LOG_ID), 1, &again));
  HOLDS(table == again);
  HOLDS(host->size >= sizeof(c3de_host) && host->rev >= 1);

  host->set_error(host->ctx, C3DE_E_IO, text("the disk is full"));
  error_text[0] = '\0';
  const c3de_sink sink = {NULL, keep_error};
  HOLDS(host->take_error(host->ctx, no_sink) == C3DE_E_ARG);
  HOLDS(host->take_error(host->ctx, sink) == C3DE_OK);
  HOLDS(strstr(error_text, "the disk is full") != NULL);
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
  ++*(int *)self;
  return C3DE_E_CANCELLED;
}

static void drive_registry(void) {
  const c3de_registry_v1 *registry = service(C3DE_REGISTRY_ID);
  const c3de_str ifaces[] = {TEXT("test.iface.a/0"), TEXT("test.iface.b/0")};
  c3de_class cls = {sizeof cls, 1, TEXT("test.A/0"), TEXT("A"), TEXT("doc"), ifaces, 2, NULL, make_no_object};
  GIVES(registry, (OK, add_class, &cls));
  SAYS(registry, "test.service_driver", (E_EXISTS, add_class, &cls));
  GIVES(registry, (E_ARG, add_class, NULL));
  RETURNS(C3DE_E_ARG, registry->add_class(NULL, &cls));
  CHANGED(registry, (E_ARG, add_class, &cls), (cls.size, 4, "size is 4"));
  cls.id = text("test.B/0");
  CHANGED(registry, (E_ARG, add_class, &cls), (cls.id, text(""), ""), (cls.id, text("with space"), "with space"),
          (cls.create, NULL, ""), (cls.ifaces, NULL, ""), (cls.ifaces_n, UINT64_MAX, ""));

  int seen = 0;
  GIVES(registry, (OK, enum_classes, text("test.iface.b/0"), &seen, count_class));
  HOLDS(seen == 1);
  GIVES(registry, (OK, enum_classes, text("test.iface.none/0"), &seen, count_class));
  HOLDS(seen == 1);
  GIVES(registry, (OK, enum_classes, text(""), &seen, count_class));
  HOLDS(seen >= 3); /* the one above, and the driver's own beside */
  seen = 0;
  HOLDS(registry->enum_classes(registry->ctx, text(""), &seen, stop_at_first) == C3DE_E_CANCELLED && seen == 1);
  GIVES(registry, (E_ARG, enum_classes, text(""), &seen, NULL));

  c3de_object *object = NULL;
  GIVES(registry, (OK, create, text(TEST_DRIVER_CLASS), &object));
  HOLDS(object != NULL);
  if (object) object->vt->release(object);
  GIVES(registry, (E_UNSUPPORTED, create, text("test.A/0"), &object));
  HOLDS(object == NULL);
  SAYS(registry, "did you mean test.Driver/0", (E_NOT_FOUND, create, text("test.Drover/0"), &object));
  GIVES(registry, (E_ARG, create, text("test.A/0"), NULL), (OK, remove_class, text("test.A/0")),
        (E_NOT_FOUND, remove_class, text("test.A/0")));
}

/* ---- views, on the mesh service ---- */

static void drive_mesh_views(const c3de_mesh_v1 *mesh) {
  c3de_handle h = kNoSuch;
  c3de_view v = corners, f = faces;
  double bad[12];
  memcpy(bad, kCorners, sizeof bad);
  CHANGED(mesh, (E_ARG, create, v, f, &h), (v.dtype, 99, "dtype 99"), (v.comps, 2, "comps 2"),
          (v.stride, 8, "stride 8"), (v.stride, -24, ""), (v.data, NULL, ""), (v.count, UINT64_MAX, ""),
          (v.stride, INT64_MAX - 7, ""), (f, far_faces, "refers to vertex 4, there are 4"), (f.count, 0, ""));
  v.data = bad;
  CHANGED(mesh, (E_ARG, create, v, f, &h), (bad[7], NAN, "row 2"), (bad[7], INFINITY, ""));
  GIVES(mesh, (E_ARG, create, corners, faces, NULL));
  HOLDS(h.v == 0); /* a call that fails leaves no old handle behind */

  /* f32 rows with a stride, not tight. */
  struct {
    float p[3];
    uint32_t other;
  } packed[4];
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) packed[i].p[k] = (float)kCorners[3 * i + k];
  c3de_view strided = {packed, 4, 3, C3DE_F32, sizeof packed[0]};
  GIVES(mesh, (OK, create, strided, faces, &h), (OK, release, h), (E_STALE, release, h));
}

static void drive_mesh(void) {
  const c3de_mesh_v1 *mesh = service(C3DE_MESH_ID);
  c3de_handle h = {0}, flat = {0};
  GIVES(mesh, (OK, create, corners, faces, &h));
  HOLDS(h.v != 0);

  c3de_mesh_info info = {.size = sizeof info};
  GIVES(mesh, (OK, info, h, &info));
  HOLDS(info.vertices == 4 && info.triangles == 4 && info.closed == 1 && info.size == sizeof info);
  HOLDS(fabs(info.volume_mm3 - 1000.0 / 6.0) < 1e-9 && info.max_mm[2] == 10.0);
  CHANGED(mesh, (E_ARG, info, h, &info), (info.size, 8, ""));
  GIVES(mesh, (E_ARG, info, h, NULL), (E_STALE, info, kNoSuch, &info));

  c3de_view view;
  GIVES(mesh, (OK, positions, h, &view));
  HOLDS(view.count == 4 && view.comps == 3 && view.dtype == C3DE_F64 && ((const double *)view.data)[3] == 10.0);
  GIVES(mesh, (OK, triangles, h, &view));
  HOLDS(view.count == 4 && view.comps == 3 && view.dtype == C3DE_U32);
  GIVES(mesh, (E_ARG, positions, h, NULL), (E_STALE, triangles, kNone, &view));

  uint64_t bytes = 0;
  const c3de_sink sink = {&bytes, count_bytes};
  GIVES(mesh, (OK, report, h, sink));
  HOLDS(bytes > 20);
  GIVES(mesh, (E_ARG, report, h, no_sink));

  const double probes[] = {1, 1, 1, 20, 20, 20};
  double winding[2] = {-1, -1};
  c3de_mview out = {winding, 2, 1, C3DE_F64, 0};
  GIVES(mesh, (OK, winding_numbers, h, points_of(probes, 2), out));
  HOLDS(fabs(winding[0] - 1.0) < 1e-3 && fabs(winding[1]) < 1e-3);
  CHANGED(mesh, (E_ARG, winding_numbers, h, points_of(probes, 2), out), (out.count, 1, ""), (out.dtype, C3DE_F32, ""));

  GIVES(mesh, (OK, check_fillable, h), (E_STALE, check_fillable, kNoSuch));
  const double sheet_corners[] = {0, 0, 0, 10, 0, 0, 10, 10, 0, 0, 10, 0, 5, 5, 0};
  const uint32_t sheet_faces[] = {0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4};
  const c3de_view sheet = {sheet_faces, 4, 3, C3DE_U32, 0};
  GIVES(mesh, (OK, create, points_of(sheet_corners, 5), sheet, &flat), (E_FORMAT, check_fillable, flat),
        (OK, release, flat));
  drive_mesh_views(mesh);

  SAYS(mesh, "no/such/file.obj", (E_IO, load, text("no/such/file.obj"), C3DE_UNIT_MM, NULL, &h));
  GIVES(mesh, (E_IO, load, text("no/such/file.obj"), C3DE_UNIT_UNKNOWN, NULL, &h));
  SAYS(mesh, "unit is 9", (E_ARG, load, text("a.obj"), 9, NULL, &h));
  GIVES(mesh, (E_ARG, load, text(""), C3DE_UNIT_MM, NULL, &h), (E_ARG, load, text("a.obj"), C3DE_UNIT_MM, NULL, NULL));
}

/* ---- scene, render ---- */

static void drive_scene(void) {
  const c3de_scene_v1 *scene = service(C3DE_SCENE_ID);
  c3de_handle node, child;
  GIVES(scene, (OK, add_node, kNone, text("parent"), &node), (OK, add_node, node, text("child"), &child),
        (E_STALE, add_node, kNoSuch, text("orphan"), &child));
  HOLDS(child.v == 0);
  GIVES(scene, (OK, add_node, node, text("child"), &child), (E_ARG, add_node, kNone, text(""), &child),
        (OK, add_node, node, text("child"), &child), (E_ARG, add_node, kNone, text("x"), NULL));

  double m[16];
  GIVES(scene, (OK, world_from_node, child, m));
  HOLDS(m[0] == 1.0 && m[15] == 1.0 && m[12] == 0.0);
  GIVES(scene, (E_ARG, world_from_node, child, NULL), (E_STALE, world_from_node, kNoSuch, m));

  uint32_t visible = 9;
  GIVES(scene, (OK, set_visible, node, 0), (OK, is_visible, child, &visible));
  HOLDS(visible == 0);
  GIVES(scene, (OK, set_visible, node, 1), (OK, is_visible, child, &visible));
  HOLDS(visible == 1);
  GIVES(scene, (E_ARG, is_visible, child, NULL), (E_STALE, set_visible, kNoSuch, 1));

  const double lo[] = {-1, -1, -1}, hi[] = {1, 1, 1}, nan3[] = {NAN, 0, 0};
  GIVES(scene, (OK, set_bounds, node, lo, hi), (E_ARG, set_bounds, node, hi, lo), (E_ARG, set_bounds, node, nan3, hi),
        (E_ARG, set_bounds, node, NULL, hi), (OK, remove_node, node), (E_STALE, remove_node, child),
        (E_STALE, remove_node, node));
}

static void drive_render(void) {
  const c3de_render_v1 *render = service(C3DE_RENDER_ID);
  const c3de_scene_v1 *scene = service(C3DE_SCENE_ID);
  const void *table = NULL;
  GIVES(host, (OK, get_service, text(C3DE_RENDER_ID), 2, &table));
  HOLDS(table == (const void *)render && render->rev == 2 && C3DE_HAS(c3de_render_v1, render, set_legend));
  SAYS(host, "rev >= 3, host has 2", (E_VERSION, get_service, text(C3DE_RENDER_ID), 3, &table));
  c3de_handle node, mesh, spheres, lines, label, legend, none;
  c3de_material material = {sizeof material, 0, {0.5f, 0.5f, 0.5f, 1.0f}, 0};
  const double at[] = {1, 2, 3}, nowhere[] = {NAN, 0, 0};
  GIVES(scene, (OK, add_node, kNone, text("drawn"), &node));
  GIVES(render, (OK, create_mesh, node, corners, faces, &material, &mesh),
        (OK, create_spheres, node, corners, 0.5, &material, &spheres),
        (OK, create_lines, node, corners, 2.0f, &material, &lines),
        (OK, create_label, node, at, text("tip"), &material, &label));

  GIVES(render, (E_STALE, create_mesh, kNone, corners, faces, &material, &none),
        (E_ARG, create_mesh, node, corners, faces, NULL, &none),
        (E_ARG, create_mesh, node, corners, faces, &material, NULL),
        (E_ARG, create_spheres, node, corners, 0.0, &material, &none),
        (E_ARG, create_spheres, node, corners, NAN, &material, &none),
        (E_ARG, create_lines, node, three_corners, 2.0f, &material, &none),
        (E_ARG, create_lines, node, corners, -1.0f, &material, &none),
        (E_ARG, create_label, node, nowhere, text("tip"), &material, &none));
  CHANGED(render, (E_ARG, set_material, mesh, &material), (material.colour[3], 2.0f, "colour[3] is 2"));
  CHANGED(render, (OK, set_material, mesh, &material), (material.colour[3], 0.5f, ""));

  const uint8_t bytes[] = {255, 0, 0, 0, 255, 0, 0, 0, 255, 9, 9, 9};
  const float too_bright[] = {2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  const double radii[] = {1, 2, 3, 4}, negative[] = {1, 2, 3, -4};
  const c3de_view colours = {bytes, 4, 3, C3DE_U8, 0}, bright = {too_bright, 4, 3, C3DE_F32, 0};
  const c3de_view radius_view = {radii, 4, 1, C3DE_F64, 0}, negative_view = {negative, 4, 1, C3DE_F64, 0};
  const c3de_view no_colours = {NULL, 0, 3, C3DE_U8, 0};
  GIVES(render, (OK, update, mesh, C3DE_ATTR_POSITIONS, corners), (OK, update, mesh, C3DE_ATTR_NORMALS, corners),
        (OK, update, mesh, C3DE_ATTR_COLOURS, colours), (OK, update, spheres, C3DE_ATTR_RADII, radius_view),
        (OK, update, spheres, C3DE_ATTR_POSITIONS, three_corners));
  SAYS(render, "4 rows, the proxy has 3 points", (E_ARG, update, spheres, C3DE_ATTR_RADII, radius_view));
  GIVES(render, (OK, update, spheres, C3DE_ATTR_POSITIONS, corners),
        (E_ARG, update, spheres, C3DE_ATTR_RADII, negative_view),
        (E_ARG, update, mesh, C3DE_ATTR_POSITIONS, three_corners), (E_ARG, update, mesh, C3DE_ATTR_COLOURS, bright),
        (E_ARG, update, mesh, C3DE_ATTR_RADII, radius_view), (E_ARG, update, lines, C3DE_ATTR_NORMALS, corners),
        (E_ARG, update, lines, C3DE_ATTR_POSITIONS, three_corners), (E_ARG, update, mesh, 42, corners),
        (E_ARG, update, label, C3DE_ATTR_POSITIONS, corners));
  GIVES(render, (E_STALE, update, kNoSuch, C3DE_ATTR_POSITIONS, corners),
        (OK, update, mesh, C3DE_ATTR_COLOURS, no_colours)); /* back to the material's */

  c3de_legend meaning = {sizeof meaning, 0, text("Stress"), text("kPa"), text(""), 0.0, 2.5, colours};
  GIVES(render, (OK, create_legend, node, &meaning, &legend), (E_STALE, create_legend, kNone, &meaning, &none),
        (E_STALE, set_legend, kNoSuch, &meaning), (E_ARG, create_legend, node, NULL, &none),
        (E_ARG, create_legend, node, &meaning, NULL), (E_ARG, update, legend, C3DE_ATTR_POSITIONS, corners),
        (E_ARG, set_label, legend, at, text("end")), (E_ARG, set_legend, mesh, &meaning));
  CHANGED(render, (E_ARG, set_legend, legend, &meaning), (meaning.low, 2.5, "low is 2.5, high is 2.5"),
          (meaning.low, NAN, ""), (meaning.colours.count, 1, "accepted: 2 to 1024"), (meaning.colours, bright, ""),
          (meaning.size, 0, ""));
  CHANGED(render, (OK, set_legend, legend, &meaning), (meaning.low, -2.5, ""));

  GIVES(render, (OK, set_visible, legend, 0), (OK, set_label, label, at, text("end")),
        (E_ARG, set_label, mesh, at, text("end")), (OK, set_visible, mesh, 0), (OK, destroy, mesh),
        (E_STALE, destroy, mesh));
  GIVES(scene, (OK, remove_node, node));
  GIVES(render, (E_STALE, set_visible, spheres, 1), (E_STALE, destroy, legend)); /* gone with their node */
}

/* ---- collision ---- */

static void drive_rays(const c3de_collision_v1 *collision, c3de_handle tree) {
  const double starts[] = {2, 2, -5, 50, 50, 50}, directions[] = {0, 0, 1, 0, 0, 1}, ends[] = {2, 2, 1, 50, 50, 60};
  const c3de_view from = points_of(starts, 2), along = points_of(directions, 2), to = points_of(ends, 2);
  const c3de_view one = points_of(directions, 1), nothing = points_of(NULL, 0);
  c3de_ray_hit hits[2];
  GIVES(collision, (OK, rays, tree, from, along, INFINITY, hits));
  HOLDS(fabs(hits[0].t - 5.0) < 1e-12 && hits[0].triangle == 0);
  HOLDS(hits[1].t < 0.0 && hits[1].triangle == 0xffffffffu);
  GIVES(collision, (OK, segments, tree, from, to, hits));
  HOLDS(fabs(hits[0].t - 5.0 / 6.0) < 1e-12 && hits[1].triangle == 0xffffffffu);
  SAYS(collision, "2 rows", (E_ARG, rays, tree, from, one, 1.0, hits));
  GIVES(collision, (E_ARG, rays, tree, from, along, -1.0, hits), (E_ARG, rays, tree, from, along, NAN, hits),
        (E_ARG, rays, tree, from, along, 1.0, NULL), (E_ARG, segments, tree, from, to, NULL),
        (OK, rays, tree, nothing, nothing, 1.0, NULL), (E_STALE, rays, kNoSuch, from, along, 1.0, hits));
}

static void drive_closest(const c3de_collision_v1 *collision, c3de_handle tree) {
  const double numbers[] = {1, 1, -2, 1, 1, 0.5, 100, 100, 100};
  const double ranges[] = {10, 10, 10}, nan_range[] = {NAN};
  const c3de_view points = points_of(numbers, 3), range_view = {ranges, 3, 1, C3DE_F64, 0};
  const c3de_view one = {ranges, 1, 1, C3DE_F64, 0}, two = {ranges, 2, 1, C3DE_F64, 0};
  const c3de_view not_a_number = {nan_range, 1, 1, C3DE_F64, 0};
  c3de_closest nearest[3];
  GIVES(collision, (OK, closest, tree, points, range_view, nearest));
  HOLDS(fabs(nearest[0].distance - 2.0) < 1e-12 && nearest[0].normal[2] < -0.99);
  HOLDS(fabs(nearest[1].distance + 0.5) < 1e-12);
  HOLDS(isinf(nearest[2].distance) && nearest[2].triangle == 0xffffffffu);
  GIVES(collision, (OK, closest, tree, points, one, nearest), (E_ARG, closest, tree, points, two, nearest),
        (E_ARG, closest, tree, points, not_a_number, nearest), (E_ARG, closest, tree, points, one, NULL));
}

static void drive_pairs(const c3de_collision_v1 *collision, c3de_handle tree) {
  uint32_t found[16];
  uint64_t needed = 0;
  c3de_handle second;
  GIVES(collision, (OK, create, corners, faces, &second), (S_TRUNCATED, pairs, tree, second, 0.0, found, 2, &needed));
  HOLDS(needed > 2);
  GIVES(collision, (S_TRUNCATED, pairs, tree, second, 0.0, NULL, 0, &needed),
        (OK, pairs, tree, tree, 0.0, found, 8, &needed));
  HOLDS(needed == 0); /* all of a tetrahedron share vertices */
  GIVES(collision, (E_ARG, pairs, tree, second, -1.0, found, 8, &needed),
        (E_ARG, pairs, tree, second, NAN, found, 8, &needed), (E_ARG, pairs, tree, second, 0.0, NULL, 8, &needed),
        (E_ARG, pairs, tree, second, 0.0, found, 8, NULL), (OK, destroy, second),
        (E_STALE, pairs, tree, second, 0.0, found, 8, &needed));

  const double centre[] = {1, 1, 0}, nan3[] = {NAN, 0, 0};
  GIVES(collision, (OK, sphere, tree, centre, 50.0, found, 4, &needed));
  HOLDS(needed == 4 && found[0] == 0 && found[3] == 3);
  GIVES(collision, (S_TRUNCATED, sphere, tree, centre, 50.0, found, 2, &needed));
  HOLDS(needed == 4);
  GIVES(collision, (S_TRUNCATED, sphere, tree, centre, 50.0, NULL, 0, &needed),
        (E_ARG, sphere, tree, centre, 50.0, NULL, 4, &needed), (E_ARG, sphere, tree, centre, 50.0, found, 4, NULL),
        (E_ARG, sphere, tree, centre, -1.0, found, 4, &needed), (E_ARG, sphere, tree, nan3, 1.0, found, 4, &needed),
        (E_ARG, sphere, tree, NULL, 1.0, found, 4, &needed));
}

static void drive_collision(void) {
  const c3de_collision_v1 *collision = service(C3DE_COLLISION_ID);
  c3de_handle tree, none;
  GIVES(collision, (OK, create, corners, faces, &tree), (E_ARG, create, corners, faces, NULL),
        (E_ARG, create, corners, far_faces, &none));
  drive_rays(collision, tree);
  drive_closest(collision, tree);
  drive_pairs(collision, tree);

  const double from[] = {2, 2, -5}, along[] = {0, 0, 1};
  c3de_ray_hit hit;
  double moved[12];
  for (int i = 0; i < 12; ++i) moved[i] = kCorners[i] + 100.0;
  GIVES(collision, (OK, refit, tree, points_of(moved, 4)), (OK, rebuild, tree),
        (OK, rays, tree, points_of(from, 1), points_of(along, 1), INFINITY, &hit));
  HOLDS(hit.triangle == 0xffffffffu);
  SAYS(collision, "the tree has 4 vertices", (E_ARG, refit, tree, points_of(moved, 3)));
  CHANGED(collision, (E_ARG, refit, tree, points_of(moved, 4)), (moved[0], INFINITY, ""));
  GIVES(collision, (OK, destroy, tree), (E_STALE, destroy, tree), (E_STALE, rebuild, tree));
}

/* ---- params, panels, tools ---- */

static void C3DE_CALL never_changed(void *self, const c3de_param_value *value) { ++*(int *)self; }

static c3de_param_decl number(const char *id) {
  c3de_param_decl d = {.size = sizeof d, .type = C3DE_PARAM_F64, .max = 10.0, .soft_max = 10.0, .fallback = 5.0};
  d.id = text(id);
  d.label = text("Number");
  d.unit = text("Pa");
  return d;
}

static void drive_params(void) {
  const c3de_params_v1 *params = service(C3DE_PARAMS_ID);
  static const c3de_str laws[] = {TEXT("stvk"), TEXT("neo_hookean")};
  const c3de_str title = TEXT("Test");
  int told = 0;
  c3de_param_listener listener = {sizeof listener, 0, &told, never_changed};
  c3de_param_decl decls[2] = {number("modulus"), number("law")}, bad = number("modulus");
  decls[1].type = C3DE_PARAM_CHOICE;
  decls[1].choices = laws;
  decls[1].choices_n = 2;
  decls[1].fallback_text = text("stvk");
  c3de_handle set, none;
  GIVES(params, (OK, declare, title, decls, 2, sizeof decls[0], &listener, &set),
        (OK, declare, title, decls, 2, 0, NULL, &none), (OK, remove, none));

  GIVES(params, (E_ARG, declare, title, NULL, 2, 0, NULL, &none), (E_ARG, declare, title, decls, 0, 0, NULL, &none),
        (E_ARG, declare, title, decls, UINT64_MAX, 0, NULL, &none), (E_ARG, declare, title, decls, 2, 8, NULL, &none),
        (E_ARG, declare, title, decls, 2, 0, NULL, NULL));
  CHANGED(params, (E_ARG, declare, title, &bad, 1, 0, NULL, &none), (bad.type, 77, ""), (bad.min, 11.0, ""),
          (bad.fallback, 99.0, "the default does not fit"), (bad.choices_n, 3, ""), (bad.size, 12, ""));
  CHANGED(params, (E_UNSUPPORTED, declare, title, &bad, 1, 0, NULL, &none), (bad.flags, 0x80000000u, ""));
  CHANGED(params, (E_EXISTS, declare, title, decls, 2, 0, NULL, &none), (decls[1], number("modulus"), ""));
  CHANGED(params, (E_ARG, declare, title, decls, 2, 0, &listener, &none), (listener.changed, NULL, ""));

  c3de_param_value value = {.size = sizeof value};
  GIVES(params, (OK, get, set, text("modulus"), &value));
  HOLDS(value.num == 5.0 && value.type == C3DE_PARAM_F64);
  GIVES(params, (OK, get, set, text("law"), &value));
  HOLDS(is_text(value.text, "stvk"));
  SAYS(params, "did you mean 'modulus'", (E_NOT_FOUND, get, set, text("modulos"), &value));
  GIVES(params, (E_ARG, get, set, text("modulus"), NULL), (E_ARG, set, set, NULL),
        (E_STALE, get, kNoSuch, text("modulus"), &value));

  c3de_param_value wanted = {sizeof wanted, C3DE_PARAM_F64, TEXT("modulus"), 7.0, {NULL, 0}, {0, 0, 0}};
  GIVES(params, (OK, set, set, &wanted), (OK, get, set, text("modulus"), &value));
  HOLDS(value.num == 7.0 && told == 0);
  CHANGED(params, (E_ARG, set, set, &wanted), (wanted.num, 11.0, "<= 10"), (wanted.num, NAN, ""));
  CHANGED(params, (E_NOT_FOUND, set, set, &wanted), (wanted.id, text("nobody"), ""));
  GIVES(params, (OK, remove, set), (E_STALE, remove, set));
}

static void C3DE_CALL draw_nothing(void *self, const c3de_ui_v1 *ui) {}

static void drive_panels(void) {
  const c3de_panels_v1 *panels = service(C3DE_PANELS_ID);
  c3de_panel panel = {sizeof panel, 1, TEXT("test.driver.panel"), TEXT("Driver"), NULL, draw_nothing};
  c3de_handle h, none;
  GIVES(panels, (OK, add, &panel, &h), (E_EXISTS, add, &panel, &none), (E_ARG, add, NULL, &none),
        (E_ARG, add, &panel, NULL));
  panel.id = text("test.driver.other");
  CHANGED(panels, (E_ARG, add, &panel, &none), (panel.on_ui, NULL, ""), (panel.title, text(""), ""),
          (panel.size, 0, ""));
  GIVES(panels, (OK, notify, C3DE_LOG_INFO, text("Title"), text("Text")),
        (E_ARG, notify, 17, text("Title"), text("Text")), (OK, remove, h), (E_STALE, remove, h));
}

static c3de_status C3DE_CALL activate(void *self) {
  ++*(int *)self;
  return C3DE_OK;
}
static void C3DE_CALL cancel(void *self) { *(int *)self += 10; }
static c3de_status C3DE_CALL refuse_to_activate(void *self) {
  host->set_error(host->ctx, C3DE_E_STATE, text("no body to touch"));
  return C3DE_E_STATE;
}
static c3de_status C3DE_CALL on_event(void *self, const c3de_event *event, uint32_t *consumed) {
  *consumed = 1;
  return C3DE_OK;
}

static void drive_tools(void) {
  const c3de_tools_v1 *tools = service(C3DE_TOOLS_ID);
  int calls = 0;
  c3de_tool tool = {sizeof tool,
                    1,
                    TEXT("test.driver.tool"),
                    TEXT("Driver"),
                    TEXT("hint"),
                    'D',
                    0,
                    &calls,
                    activate,
                    cancel,
                    on_event,
                    0,
                    0};
  c3de_handle h, stubborn, none;
  uint32_t active = 9;
  GIVES(tools, (OK, add, &tool, &h), (E_EXISTS, add, &tool, &none), (E_ARG, add, NULL, &none),
        (E_ARG, add, &tool, NULL));
  tool.id = text("test.driver.stubborn");
  CHANGED(tools, (E_ARG, add, &tool, &none), (tool.shortcut, 7, ""));
  tool.shortcut = 0;
  CHANGED(tools, (E_ARG, add, &tool, &none), (tool.cancel, NULL, ""));
  tool.activate = refuse_to_activate;
  CHANGED(tools, (E_UNSUPPORTED, add, &tool, &none), (tool.flags, 2, "accepted: 0, 1 (C3DE_TOOL_IN_SLICES)"));
  tool.flags = C3DE_TOOL_IN_SLICES;
  GIVES(tools, (OK, add, &tool, &stubborn), (OK, activate, h), (OK, is_active, h, &active));
  HOLDS(active == 1 && calls == 1);
  SAYS(tools, "no body to touch", (E_STATE, activate, stubborn));
  GIVES(tools, (OK, is_active, h, &active));
  HOLDS(active == 0 && calls == 11);
  GIVES(tools, (OK, activate, h), (OK, activate, kNone));
  HOLDS(calls == 22);
  GIVES(tools, (E_STALE, activate, kNoSuch), (E_STALE, is_active, kNoSuch, &active), (E_ARG, is_active, h, NULL),
        (OK, remove, h), (E_STALE, remove, h), (OK, remove, stubborn));
  double marked[3] = {0, 0, 0};
  HOLDS(tools->rev >= 2);
  GIVES(tools, (OK, marked_point, marked));
  HOLDS(marked[0] == 1 && marked[1] == -2 && marked[2] == 3.5);
  GIVES(tools, (E_ARG, marked_point, NULL));
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
static void C3DE_CALL release_edit(void *self) { *(int *)self += 100; }

static void drive_history(void) {
  const c3de_history_v1 *history = service(C3DE_HISTORY_ID);
  static int calls, quiet;
  c3de_edit edit = {sizeof edit, 1, TEXT("pull"), &calls, take_back, do_again, release_edit};
  c3de_handle h, none;
  calls = quiet = 0;
  GIVES(history, (OK, add, &edit, &h), (E_ARG, add, NULL, &none), (E_ARG, add, &edit, NULL));
  CHANGED(history, (E_ARG, add, &edit, &none), (edit.label, text(""), "label"), (edit.undo, NULL, ""),
          (edit.redo, NULL, ""), (edit.size, 8, ""));
  HOLDS(none.v == 0 && calls == 0);
  GIVES(history, (E_STALE, remove, kNoSuch), (OK, remove, h));
  HOLDS(calls == 100);
  GIVES(history, (E_STALE, remove, h));
  /* Two stay for the test program to undo and redo; the second without release. */
  GIVES(history, (OK, add, &edit, &h));
  edit.label = text("quiet");
  edit.self = &quiet;
  edit.release = NULL;
  GIVES(history, (OK, add, &edit, &h));
}

/* After undo, undo, redo by the test program. */
static void drive_history_after(void) {
  const c3de_history_v1 *history = service(C3DE_HISTORY_ID);
  static int last;
  c3de_edit edit = {sizeof edit, 1, TEXT("last"), &last, take_back, do_again, release_edit};
  c3de_handle h;
  GIVES(history, (OK, add, &edit, &h));
}

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
  double fraction = 0.0;
  GIVES(jobs, (OK, submit, &job, &h), (OK, progress, h, &fraction, no_sink), (E_ARG, progress, h, NULL, no_sink),
        (E_ARG, submit, NULL, &none), (E_ARG, submit, &job, NULL), (OK, cancel, h), (E_STALE, cancel, kNoSuch),
        (E_STALE, progress, kNoSuch, &fraction, no_sink));
  CHANGED(jobs, (E_ARG, submit, &job, &none), (job.title, text(""), ""), (job.run, NULL, ""), (job.done, NULL, ""));
}

static int posted_calls, frame_calls;

static void drive_time(void) {
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

static void drive_simulation(c3de_handle node) {
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

static void drive_kinds(c3de_handle node) {
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

static void drive_forces(c3de_handle node) {
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

/* ---- imaging: the store has what test_services.cpp puts there ---- */

static c3de_status C3DE_CALL sum_labels(void *self, const c3de_label *label) {
  HOLDS(label->size >= sizeof *label);
  if (label->value == 3) HOLDS(is_text(label->name, "liver"));
  if (label->value == 3) HOLDS(label->colour[0] == 0.5f && label->colour[1] == 0.25f);
  *(uint32_t *)self += label->value;
  return C3DE_OK;
}
static c3de_status C3DE_CALL stop_at_label(void *self, const c3de_label *label) {
  *(uint32_t *)self += label->value;
  return C3DE_E_CANCELLED;
}

static c3de_handle kept_image, kept_map;

static void drive_samples(const c3de_imaging_v1 *imaging, c3de_handle image) {
  /* World of index (i, j, k): (10 + 3 j, 20 + 2 i + k, 30 + 4 k); value: 2 (5 + i + 10 j + 100 k) - 100. */
  const double at[] = {10,    20,     30, /* voxel 0 0 0 */
                       19,    28,     46, /* voxel 2 3 4 */
                       11.5,  22.75,  33, /* index 1 0.5 0.75 */
                       8.8,   19.2,   30, /* index -0.4 -0.4 0: the border goes on */
                       8.2,   20,     30, /* index 0 -0.6 0: outside */
                       1e300, -1e300, 0};
  const double expected[] = {-90, 774, 72, -90, -7, -7}, nowhere[] = {0, NAN, 0};
  const c3de_view six = points_of(at, 6);
  double values[12];
  for (int i = 0; i < 12; ++i) values[i] = 1234.0;
  c3de_mview out = {values, 6, 1, C3DE_F64, 16}; /* every other number */
  GIVES(imaging, (OK, sample, image, six, -7.0, out));
  for (int i = 0; i < 6; ++i) {
    HOLDS(fabs(values[2 * i] - expected[i]) < 1e-9); /* rounding of numbers up to 1000 */
    HOLDS(values[2 * i + 1] == 1234.0);
  }
  const c3de_mview one = {values, 1, 1, C3DE_F64, 0}, none = {NULL, 0, 1, C3DE_F64, 0};
  GIVES(imaging, (OK, sample, image, points_of(at + 12, 1), NAN, one));
  HOLDS(isnan(values[0]));
  GIVES(imaging, (OK, sample, image, points_of(NULL, 0), 0.0, none), (E_STALE, sample, kNoSuch, six, -7.0, out));
  SAYS(imaging, "points_mm is null", (E_ARG, sample, image, points_of(NULL, 6), -7.0, out));
  SAYS(imaging, "row 0 is not finite", (E_ARG, sample, image, points_of(nowhere, 1), -7.0, one));
  CHANGED(imaging, (E_ARG, sample, image, six, -7.0, out), (out.count, 5, "room for 5 rows, there are 6"),
          (out.dtype, C3DE_F32, ""), (out.data, NULL, "out is null"));
}

static void drive_images(const c3de_imaging_v1 *imaging) {
  c3de_handle found[4] = {{0}, {0}, {0}, {0}};
  uint64_t needed = 0;
  GIVES(imaging, (S_TRUNCATED, images, NULL, 0, &needed));
  HOLDS(needed == 2);
  GIVES(imaging, (S_TRUNCATED, images, found, 1, &needed));
  HOLDS(found[0].v != 0 && found[1].v == 0 && needed == 2);
  GIVES(imaging, (OK, images, found, 4, &needed));
  HOLDS(found[1].v != 0 && found[0].v != found[1].v && found[2].v == 0 && needed == 2);
  GIVES(imaging, (E_ARG, images, NULL, 1, &needed));
  SAYS(imaging, "needed is null", (E_ARG, images, found, 4, NULL));
  const c3de_handle image = kept_image = found[0];

  c3de_image_info info = {.size = sizeof info};
  GIVES(imaging, (OK, image_info, image, &info));
  HOLDS(info.size == sizeof info && is_text(info.name, "phantom"));
  HOLDS(is_text(info.unit, "HU"));
  HOLDS(info.points[0] == 3 && info.points[1] == 4 && info.points[2] == 5);
  HOLDS(info.world_from_index[1] == 2.0 && info.world_from_index[4] == 3.0 && info.world_from_index[14] == 30.0);
  HOLDS(info.min == -90.0 && info.max == 800.0 && info.low == -50.0 && info.high == 700.0);
  CHANGED(imaging, (E_ARG, image_info, image, &info), (info.size, 8, "size is 8"));
  GIVES(imaging, (E_ARG, image_info, image, NULL));
  SAYS(imaging, "no image of handle", (E_STALE, image_info, kNoSuch, &info));
  GIVES(imaging, (E_STALE, image_info, kNone, &info));
  drive_samples(imaging, image);
}

static void drive_label_maps(const c3de_imaging_v1 *imaging) {
  c3de_handle map = {0};
  uint64_t needed = 0;
  GIVES(imaging, (OK, label_maps, &map, 1, &needed));
  HOLDS(needed == 1 && map.v != 0);
  GIVES(imaging, (E_ARG, label_maps, NULL, 1, &needed), (E_ARG, label_maps, &map, 1, NULL));
  kept_map = map;

  c3de_label_map_info info = {.size = sizeof info};
  GIVES(imaging, (OK, label_map_info, map, &info));
  HOLDS(is_text(info.name, "organs") && info.labels == 2);
  HOLDS(info.points[0] == 2 && info.points[1] == 1 && info.points[2] == 1 && info.world_from_index[0] == 10.0);
  GIVES(imaging, (E_ARG, label_map_info, map, NULL));
  SAYS(imaging, "no label map of handle", (E_STALE, label_map_info, kNoSuch, &info));

  const double at[] = {4.9, -4.9, 4.9, 5.1, 0, 0, 15.1, 0, 0, 0, 5.1, 0};
  uint32_t labels[4] = {9, 9, 9, 9}, sum = 0, first = 0;
  c3de_mview out = {labels, 4, 1, C3DE_U32, 0};
  GIVES(imaging, (OK, labels_at, map, points_of(at, 4), out));
  HOLDS(labels[0] == 3 && labels[1] == 40000 && labels[2] == 0 && labels[3] == 0);
  GIVES(imaging, (E_STALE, labels_at, kNone, points_of(at, 4), out), (E_ARG, labels_at, map, points_of(NULL, 4), out),
        (E_ARG, labels_at, map, points_of(at, 3), out));
  CHANGED(imaging, (E_ARG, labels_at, map, points_of(at, 4), out), (out.dtype, C3DE_F64, "accepted: u32"),
          (out.data, NULL, ""));

  GIVES(imaging, (OK, enum_labels, map, &sum, sum_labels));
  HOLDS(sum == 40003);
  GIVES(imaging, (E_ARG, enum_labels, map, &sum, NULL), (E_STALE, enum_labels, kNoSuch, &sum, sum_labels));
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
  GIVES(imaging, (OK, images, NULL, 0, &needed));
  HOLDS(needed == 0);
  c3de_image_info info = {.size = sizeof info};
  HOLDS(kept_image.v != 0 && kept_map.v != 0);
  const c3de_mview value_out = {&value, 1, 1, C3DE_F64, 0}, label_out = {&label, 1, 1, C3DE_U32, 0};
  GIVES(imaging, (OK, label_maps, NULL, 0, &needed), (E_STALE, image_info, kept_image, &info),
        (E_STALE, sample, kept_image, points_of(at, 1), 0.0, value_out),
        (E_STALE, labels_at, kept_map, points_of(at, 1), label_out),
        (E_STALE, enum_labels, kept_map, &label, sum_labels));
}

static void drive_imaging_without_a_store(void) {
  const void *table = NULL;
  SAYS(host, "it needs images", (E_UNSUPPORTED, get_service, text(C3DE_IMAGING_ID), 1, &table));
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
  const c3de_handle any = handle_of(1);
  c3de_object *object;
  c3de_handle h;
  uint32_t flag;
  SAYS(registry, "main thread", (E_THREAD, create, text(TEST_DRIVER_CLASS), &object));
  GIVES(registry, (E_THREAD, remove_class, text("x")));
  GIVES(scene, (E_THREAD, add_node, kNone, text("x"), &h), (E_THREAD, is_visible, any, &flag));
  GIVES(render, (E_THREAD, destroy, any), (E_THREAD, update, any, C3DE_ATTR_POSITIONS, corners));
  GIVES(params, (E_THREAD, remove, any));
  GIVES(panels, (E_THREAD, notify, 1, text("a"), text("b")));
  GIVES(tools, (E_THREAD, activate, kNone));
  GIVES(jobs, (E_THREAD, cancel, any));
  GIVES(time, (E_THREAD, remove_frame_callback, any));
  /* And what may be called anywhere. */
  int seen = 0;
  GIVES(registry, (OK, enum_classes, text(""), &seen, count_class));
  GIVES(mesh, (OK, create, corners, faces, &h), (OK, release, h));
  GIVES(collision, (OK, create, corners, faces, &h), (OK, destroy, h));
  GIVES(time, (OK, post_to_main, &posted_calls, count_call));
  log->write(log->ctx, C3DE_LOG_WARN, text("a warning from another thread"));
}

/* ---- files, settings, commands ---- */

static c3de_status C3DE_CALL read_nothing(void *self, const c3de_mesh_source *source, const c3de_progress *progress,
                                          const c3de_mesh_sink *sink) {
  return C3DE_E_UNSUPPORTED;
}
static c3de_status C3DE_CALL write_nothing(void *self, const c3de_mesh_contents *mesh, const c3de_progress *progress,
                                           c3de_sink bytes) {
  return C3DE_E_UNSUPPORTED;
}

static void drive_writers(const c3de_files_v1 *files) {
  const c3de_str extensions[] = {TEXT("one"), TEXT("obj")};
  c3de_mesh_writer writer = {sizeof writer, 1, TEXT("test.reader"), TEXT("Writer"), extensions, 2, NULL, write_nothing};
  c3de_handle h, none;
  HOLDS(files->rev >= 2);
  GIVES(files, (OK, add_mesh_writer, &writer, &h)); /* a reader may have the same id */
  GIVES(files, (E_EXISTS, add_mesh_writer, &writer, &none));
  HOLDS(none.v == 0);
  GIVES(files, (E_ARG, add_mesh_writer, NULL, &none), (E_ARG, add_mesh_writer, &writer, NULL));
  writer.id = text("test.other");
  CHANGED(files, (E_ARG, add_mesh_writer, &writer, &none), (writer.write, NULL, "write"), (writer.extensions_n, 0, ""),
          (writer.size, 24, ""));
  GIVES(files, (OK, remove, h), (E_STALE, remove, h));
}

static void drive_files(void) {
  const c3de_files_v1 *files = service(C3DE_FILES_ID);
  const c3de_str extensions[] = {TEXT("one"), TEXT("TWO")}, dotted[] = {TEXT(".one"), TEXT("two")};
  const c3de_str empty[] = {TEXT(""), TEXT("two")};
  c3de_mesh_reader reader = {sizeof reader, 1,    TEXT("test.reader"), TEXT("Reader"), extensions, 2,
                             TEXT(""),      NULL, read_nothing};
  c3de_handle h, none;
  GIVES(files, (OK, add_mesh_reader, &reader, &h));
  SAYS(files, "test.service_driver", (E_EXISTS, add_mesh_reader, &reader, &none));
  HOLDS(none.v == 0);
  reader.id = text("test.other");
  GIVES(files, (E_ARG, add_mesh_reader, NULL, &none), (E_ARG, add_mesh_reader, &reader, NULL));
  CHANGED(files, (E_ARG, add_mesh_reader, &reader, &none), (reader.extensions_n, 0, "extensions_n"),
          (reader.extensions, dotted, "without the dot"), (reader.extensions, empty, ""), (reader.extensions, NULL, ""),
          (reader.read, NULL, "read"), (reader.label, text(""), ""), (reader.id, text("a b"), ""),
          (reader.size, 16, ""));
  drive_writers(files);
  GIVES(files, (E_STALE, remove, kNoSuch), (OK, remove, h), (E_STALE, remove, h));
}

static c3de_status C3DE_CALL count_key(void *self, c3de_str key) {
  *(uint64_t *)self += key.len;
  return C3DE_OK;
}
static c3de_status C3DE_CALL stop_at_key(void *self, c3de_str key) {
  ++*(uint64_t *)self;
  return C3DE_S_TRUNCATED;
}

static void drive_settings(void) {
  const c3de_settings_v1 *settings = service(C3DE_SETTINGS_ID);
  uint64_t bytes = 0, keys = 0, calls = 0;
  const c3de_sink sink = {&bytes, count_bytes};
  const c3de_str broken = {"\xff\xfe", 2};
  SAYS(settings, "colour", (E_NOT_FOUND, get, text("colour"), sink));
  GIVES(settings, (E_NOT_FOUND, remove, text("colour")), (OK, set, text("colour"), text("blue")),
        (OK, set, text("empty"), text("")), (OK, get, text("colour"), sink));
  HOLDS(bytes == 4);
  GIVES(settings, (OK, get, text("empty"), sink));
  HOLDS(bytes == 4);
  GIVES(settings, (E_ARG, get, text("colour"), no_sink), (E_ARG, get, text(""), sink));
  SAYS(settings, "key", (E_ARG, set, text("a b"), text("c")));
  SAYS(settings, "UTF-8", (E_ARG, set, text("bytes"), broken));
  GIVES(settings, (OK, keys, &keys, count_key));
  HOLDS(keys == strlen("colour") + strlen("empty"));
  GIVES(settings, (S_TRUNCATED, keys, &calls, stop_at_key));
  HOLDS(calls == 1);
  GIVES(settings, (E_ARG, keys, &calls, NULL), (OK, remove, text("empty")), (E_NOT_FOUND, get, text("empty"), sink));
}

static const c3de_commands_v1 *kept_commands;
static c3de_status C3DE_CALL count_run(void *self) {
  ++*(int *)self;
  return C3DE_OK;
}
static c3de_status C3DE_CALL fail_to_run(void *self) {
  host->set_error(host->ctx, C3DE_E_STATE, text("there is no organ"));
  return C3DE_E_STATE;
}
static c3de_status C3DE_CALL run_itself(void *self) {
  return kept_commands->run(kept_commands->ctx, text("test.again"));
}

static void drive_commands(void) {
  const c3de_commands_v1 *commands = service(C3DE_COMMANDS_ID);
  kept_commands = commands;
  static int runs;
  c3de_command command = {sizeof command, 1,     TEXT("test.count"), TEXT("Count"), TEXT("Counts."), 'Q',
                          C3DE_MOD_CTRL,  &runs, count_run};
  c3de_handle count, other, none;
  runs = 0;
  GIVES(commands, (S_NO_SHORTCUT, add, &command, &count));
  SAYS(commands, "test.service_driver", (E_EXISTS, add, &command, &none));
  GIVES(commands, (OK, run, text("test.count")));
  HOLDS(runs == 1);
  command.id = text("test.fail");
  command.key = 'K';
  command.modifiers = C3DE_MOD_CTRL | C3DE_MOD_SHIFT;
  command.run = fail_to_run;
  GIVES(commands, (OK, add, &command, &other));
  SAYS(commands, "there is no organ", (E_STATE, run, text("test.fail")));
  command.id = text("test.again");
  command.run = run_itself;
  GIVES(commands, (S_NO_SHORTCUT, add, &command, &none));
  SAYS(commands, "running already", (E_STATE, run, text("test.again")));
  GIVES(commands, (OK, remove, none));
  command.id = text("test.next");
  GIVES(commands, (E_ARG, add, NULL, &none), (E_ARG, add, &command, NULL));
  CHANGED(commands, (E_ARG, add, &command, &none), (command.modifiers, 0, "C3DE_MOD_CTRL"),
          (command.modifiers, 64, ""));
  command.modifiers = C3DE_MOD_ALT;
  CHANGED(commands, (E_ARG, add, &command, &none), (command.key, 'k', "'A' to 'Z'"));
  command.key = 0;
  CHANGED(commands, (E_ARG, add, &command, &none), (command.title, text(""), ""), (command.run, NULL, ""),
          (command.size, 16, ""));
  GIVES(commands, (OK, set_enabled, count, 0));
  SAYS(commands, "not enabled", (E_STATE, run, text("test.count")));
  GIVES(commands, (OK, set_enabled, count, 1), (OK, run, text("test.count")));
  HOLDS(runs == 2);
  SAYS(commands, "did you mean test.count?", (E_NOT_FOUND, run, text("test.cuont")));
  GIVES(commands, (E_STALE, set_enabled, kNoSuch, 1), (OK, remove, count), (E_STALE, remove, count));
}

/* ---- when the plugin was taken back but an object of it is still called ---- */

static const c3de_registry_v1 *kept_registry;

static void drive_taken_back(void) {
  const void *table = NULL;
  SAYS(host, "has been taken back", (E_STATE, get_service, text(C3DE_LOG_ID), 1, &table));
  RETURNS(C3DE_E_STATE, add_test_class(kept_registry, "test.Ghost/0"));
  GIVES(kept_registry, (E_STATE, remove_class, text("test.Ghost/0")));
}

/* ---- the object that the test program calls ---- */

static const struct {
  const char *name;
  void (*drive)(void);
  void (*drive_node)(c3de_handle);
} kDrives[] = {
    {"host", drive_host, NULL},
    {"log", drive_log, NULL},
    {"registry", drive_registry, NULL},
    {"mesh", drive_mesh, NULL},
    {"scene", drive_scene, NULL},
    {"render", drive_render, NULL},
    {"collision", drive_collision, NULL},
    {"params", drive_params, NULL},
    {"panels", drive_panels, NULL},
    {"tools", drive_tools, NULL},
    {"history", drive_history, NULL},
    {"history after", drive_history_after, NULL},
    {"jobs", drive_jobs, NULL},
    {"time", drive_time, NULL},
    {"simulation", NULL, drive_simulation},
    {"kinds", NULL, drive_kinds},
    {"forces", NULL, drive_forces},
    {"files", drive_files, NULL},
    {"settings", drive_settings, NULL},
    {"commands", drive_commands, NULL},
    {"imaging", drive_imaging, NULL},
    {"imaging of what is gone", drive_imaging_of_what_is_gone, NULL},
    {"imaging without a store", drive_imaging_without_a_store, NULL},
    {"wrong thread", drive_wrong_thread, NULL},
    {"taken back", drive_taken_back, NULL},
};

static uint64_t C3DE_CALL run(c3de_object *self, c3de_str name, c3de_handle simulation, c3de_sink out) {
  differences = out;
  compared = 0;
  for (size_t i = 0; i < sizeof kDrives / sizeof kDrives[0]; ++i) {
    if (!is_text(name, kDrives[i].name)) continue;
    if (kDrives[i].drive) kDrives[i].drive();
    if (kDrives[i].drive_node) kDrives[i].drive_node(simulation);
  }
  return compared;
}

static const test_driver_v0 driver_table = {sizeof(test_driver_v0), 1, run};

/* One object for all: it is never destroyed, so its count does not matter. */
static uint32_t C3DE_CALL retain(c3de_object *self) { return 2; }
static uint32_t C3DE_CALL release(c3de_object *self) { return 1; }
static c3de_status C3DE_CALL query(c3de_object *self, c3de_str id, uint32_t min_rev, const void **table) {
  *table = &driver_table;
  return C3DE_OK;
}
static const c3de_object_vt driver_vt = {sizeof(c3de_object_vt), 1, retain, release, query};
static c3de_object driver_object = {&driver_vt};

static c3de_status C3DE_CALL get_driver(void *factory, c3de_object **out) {
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
  const c3de_class cls = {sizeof cls, 1,         TEXT(TEST_DRIVER_CLASS), TEXT("Driver"), TEXT(""), ifaces, 1,
                          NULL,       get_driver};
  kept_registry = registry;
  return kept_registry->add_class(kept_registry->ctx, &cls);
}

static c3de_status C3DE_CALL start(void *self) {
#if defined(GOES_IN_START)
  return C3DE_E_STATE;
#else
  return C3DE_OK;
#endif
}

static const c3de_plugin plugin = {NAMED("test.service_driver"), NO_NEEDS, create, start, do_nothing, destroy_nothing};
ANSWER_WITH(&plugin)
