/* SPDX-License-Identifier: Apache-2.0 */
/* The smallest useful plugin: says hello in the log, offers one class to other plugins and, where there is a window, a
 * panel. Read from the bottom to the top: the host calls c3de_plugin_query first. */
#include "greeter.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "c3de/abi/log.h"
#include "c3de/abi/panels.h"
#include "c3de/abi/registry.h"
#include "c3de/abi/entry.h"

#define TEXT(literal) {literal, sizeof(literal) - 1}

static c3de_str text(const char *s) {
  c3de_str t = {s, strlen(s)};
  return t;
}

/* ---- the class: an object is a struct that begins with c3de_object, counted by those who hold it ---- */

typedef struct greeter {
  c3de_object object;
  atomic_uint count;
  atomic_ullong greetings;
} greeter;

static c3de_status C3DE_CALL greet(c3de_object *self, c3de_str name, c3de_sink out) {
  if (name.len == 0 || !name.ptr || !out.put) return C3DE_E_ARG;
  c3de_status status = out.put(out.self, "Hello, ", 7);
  if (status >= 0) status = out.put(out.self, name.ptr, name.len);
  if (status >= 0) status = out.put(out.self, "!", 1);
  if (status >= 0) atomic_fetch_add(&((greeter *)self)->greetings, 1);
  return status;
}

static uint64_t C3DE_CALL greetings(c3de_object *self) { return atomic_load(&((greeter *)self)->greetings); }

static const hello_greeter_v0 greeter_table = {sizeof(hello_greeter_v0), 1, greet, greetings};

static uint32_t C3DE_CALL retain(c3de_object *self) { return atomic_fetch_add(&((greeter *)self)->count, 1) + 1; }

static uint32_t C3DE_CALL release(c3de_object *self) {
  const unsigned left = atomic_fetch_sub(&((greeter *)self)->count, 1) - 1;
  if (left == 0) free(self);
  return left;
}

static c3de_status C3DE_CALL query(c3de_object *self, c3de_str id, uint32_t min_rev, const void **table) {
  const c3de_str mine = TEXT(HELLO_GREETER_ID);
  (void)self;
  *table = NULL;
  if (id.len != mine.len || memcmp(id.ptr, mine.ptr, (size_t)mine.len) != 0) return C3DE_E_NOT_FOUND;
  if (min_rev > greeter_table.rev) return C3DE_E_VERSION;
  *table = &greeter_table;
  return C3DE_OK;
}

static const c3de_object_vt greeter_vt = {sizeof(c3de_object_vt), 1, retain, release, query};

static c3de_status C3DE_CALL create_greeter(void *factory, c3de_object **out) {
  (void)factory;
  greeter *g = calloc(1, sizeof *g);
  if (!g) return C3DE_E_NOMEM;
  g->object.vt = &greeter_vt;
  atomic_init(&g->count, 1);
  *out = &g->object;
  return C3DE_OK;
}

/* ---- the panel: says what stands in it, the host draws ---- */

typedef struct hello {
  const c3de_log_v1 *log;
  uint32_t pressed;
} hello;

static void C3DE_CALL on_ui(void *self, const c3de_ui_v1 *ui) {
  hello *h = self;
  ui->text(ui->ctx, text("A plugin in 150 lines of C."));
  if (ui->button(ui->ctx, text("hello"), text("Say hello"), 1) & C3DE_UI_COMMITTED) {
    ++h->pressed;
    h->log->write(h->log->ctx, C3DE_LOG_INFO, text("hello again"));
  }
}

/* ---- the plugin ---- */

static c3de_status C3DE_CALL create(const c3de_host *host, void **self) {
  /* Required services are there, or the host would not have called; their tables stay valid until destroy. */
  const void *log = NULL, *registry = NULL, *panels = NULL;
  c3de_status status = host->get_service(host->ctx, text(C3DE_LOG_ID), 1, &log);
  if (status >= 0) status = host->get_service(host->ctx, text(C3DE_REGISTRY_ID), 1, &registry);
  if (status < 0) return status;

  hello *h = calloc(1, sizeof *h);
  if (!h) return C3DE_E_NOMEM;
  h->log = log;

  const c3de_str ifaces[] = {TEXT(HELLO_GREETER_ID)};
  c3de_class cls = {sizeof cls, 1, TEXT(HELLO_GREETER_CLASS), TEXT("Greeter"), TEXT("Greets by name."), ifaces, 1, NULL,
                    create_greeter};
  const c3de_registry_v1 *reg = registry;
  status = reg->add_class(reg->ctx, &cls);

  /* An optional service: without a window there is none, and that is no error. */
  if (status >= 0 && host->get_service(host->ctx, text(C3DE_PANELS_ID), 1, &panels) >= 0) {
    const c3de_panels_v1 *p = panels;
    c3de_panel panel = {sizeof panel, 1, TEXT("org.c3de.hello.panel"), TEXT("Hello"), h, on_ui};
    c3de_handle handle;
    status = p->add(p->ctx, &panel, &handle);
  }
  if (status < 0) { /* the host takes back what was registered; what we allocated is ours to free */
    free(h);
    return status;
  }
  h->log->write(h->log->ctx, C3DE_LOG_INFO, text("hello from a plugin"));
  *self = h;
  return C3DE_OK;
}

/* Every plugin is created now: here one looks up classes of others. hello needs none. */
static c3de_status C3DE_CALL start(void *self) {
  (void)self;
  return C3DE_OK;
}

static c3de_status C3DE_CALL stop(void *self) {
  (void)self;
  return C3DE_OK;
}

static void C3DE_CALL destroy(void *self) { free(self); }

static const c3de_service_req needs[] = {
    {sizeof(c3de_service_req), C3DE_REQUIRED, TEXT(C3DE_LOG_ID), 1, 0},
    {sizeof(c3de_service_req), C3DE_REQUIRED, TEXT(C3DE_REGISTRY_ID), 1, 0},
    {sizeof(c3de_service_req), C3DE_OPTIONAL, TEXT(C3DE_PANELS_ID), 1, 0},
};

static const c3de_plugin plugin = {
    sizeof(c3de_plugin), 1, TEXT("org.c3de.hello"), TEXT("1.0.0"), TEXT("Hello"), TEXT("C3DE"), TEXT("Apache-2.0"),
    needs, sizeof needs / sizeof needs[0], sizeof needs[0], create, start, stop, destroy};

/* The one exported function: which plugin this is. No side effects, because the host may only be looking. */
C3DE_EXPORT c3de_status C3DE_CALL c3de_plugin_query(const c3de_offer *offer, c3de_answer *answer) {
  answer->abi_major = C3DE_ABI_MAJOR;
  answer->abi_minor = C3DE_ABI_MINOR;
  if (offer->abi_min > C3DE_ABI_MAJOR || offer->abi_max < C3DE_ABI_MAJOR) {
    strncpy(answer->why_not, "built for plugin ABI 1", sizeof answer->why_not - 1);
    return C3DE_E_VERSION;
  }
  answer->plugin = &plugin;
  return C3DE_OK;
}
