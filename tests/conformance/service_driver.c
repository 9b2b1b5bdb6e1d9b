/* SPDX-License-Identifier: Apache-2.0 */
/* A plugin in C that calls every function of every service with good and bad arguments and compares the status. For each
 * refused call there must be a text that names what was wrong. The services are in service_driver_*.c. */
#include "service_driver.h"

#include "service_checks.h"

const c3de_host *host;
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

static void differ(const char *file, int line, const char *what, const char *detail) {
  char buffer[1024];
  const int n = snprintf(buffer, sizeof buffer, "%s:%d: %s%s [%s]\n", file, line, what, detail, error_text);
  differences.put(differences.self, buffer, n < (int)sizeof buffer ? (uint64_t)n : sizeof buffer - 1);
}

void compare_true(const char *file, int line, const char *condition, int value) {
  ++compared;
  if (!value) differ(file, line, condition, "");
}

void compare(const char *file, int line, const char *call, c3de_status got, c3de_status expected, const char *part) {
  char buffer[64];
  ++compared;
  error_text[0] = '\0';
  const c3de_sink sink = {NULL, keep_error};
  host->take_error(host->ctx, sink);
  snprintf(buffer, sizeof buffer, " gave %d, expected %d", (int)got, (int)expected);
  if (got != expected)
    differ(file, line, call, buffer);
  else if (got < 0 && error_text[0] == '\0')
    differ(file, line, call, " left no text");
  if (part[0] == '\0') return;
  ++compared;
  if (!strstr(error_text, part)) differ(file, line, "text has: ", part);
}

const void *service(const char *id) {
  const void *table = NULL;
  GIVES(host, (OK, get_service, text(id), 1, &table));
  HOLDS(table != NULL);
  return table;
}

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
    {"history capture", drive_history_capture, NULL},
    {"history captured", drive_history_captured, NULL},
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
