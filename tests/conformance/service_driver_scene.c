/* SPDX-License-Identifier: Apache-2.0 */
/* Log, registry, meshes, scene, renderer, collision, and calls from other threads. */
#include <math.h>

#include "service_checks.h"
#include "service_driver.h"

/* ---- log, registry ---- */

void drive_log(void) {
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

void drive_registry(void) {
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

void drive_mesh(void) {
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

void drive_scene(void) {
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

void drive_render(void) {
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

void drive_collision(void) {
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

/* ---- from a thread that is not the main one: the test calls run() there with this name ---- */

void drive_wrong_thread(void) {
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
  static int posted;
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
  GIVES(time, (OK, post_to_main, &posted, count_call));
  log->write(log->ctx, C3DE_LOG_WARN, text("a warning from another thread"));
}
