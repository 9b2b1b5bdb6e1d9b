/* My plugin: a panel with a button, and a line in the log. Without a window there is the line alone. */
#include <string.h>

#include "c3de/abi/log.h"
#include "c3de/abi/panels.h"
#include "c3de/abi/entry.h"

#define TEXT(literal) \
  { literal, sizeof(literal) - 1 }

static c3de_str text(const char *s) {
  c3de_str t = {s, strlen(s)};
  return t;
}

static const c3de_log_v1 *the_log;
static int pressed;

static void C3DE_CALL on_ui(void *self, const c3de_ui_v1 *ui) {
  (void)self;
  ui->text(ui->ctx, text(pressed ? "Pressed." : "Not pressed yet."));
  if (ui->button(ui->ctx, text("press"), text("Press"), 1) & C3DE_UI_COMMITTED) pressed = 1;
}

static c3de_status C3DE_CALL create(const c3de_host *host, void **self) {
  const void *table = NULL;
  c3de_status status = host->get_service(host->ctx, text(C3DE_LOG_ID), 1, &table);
  *self = NULL;
  if (status < 0) return status;
  the_log = table;
  the_log->write(the_log->ctx, C3DE_LOG_INFO, text("My plugin is there"));
  /* Optional: without a window there are no panels, and that is no error. */
  if (host->get_service(host->ctx, text(C3DE_PANELS_ID), 1, &table) >= 0) {
    const c3de_panels_v1 *panels = table;
    const c3de_panel panel = {sizeof panel, 1, TEXT("org.example.my_plugin.panel"), TEXT("My plugin"), NULL, on_ui};
    c3de_handle handle;
    status = panels->add(panels->ctx, &panel, &handle);
  }
  return status;
}

static c3de_status C3DE_CALL start(void *self) {
  (void)self;
  return C3DE_OK;
}
static c3de_status C3DE_CALL stop(void *self) {
  (void)self;
  return C3DE_OK;
}
static void C3DE_CALL destroy(void *self) { (void)self; }

static const c3de_service_req needs[] = {
    {sizeof(c3de_service_req), C3DE_REQUIRED, TEXT(C3DE_LOG_ID), 1, 0},
    {sizeof(c3de_service_req), C3DE_OPTIONAL, TEXT(C3DE_PANELS_ID), 1, 0},
};
static const c3de_plugin plugin = {sizeof(c3de_plugin), 1, TEXT("org.example.my_plugin"), TEXT("0.1.0"), TEXT("My plugin"),
                                   TEXT("Your name"), TEXT("MIT"), needs, sizeof needs / sizeof needs[0], sizeof needs[0],
                                   create, start, stop, destroy};

C3DE_EXPORT c3de_status C3DE_CALL c3de_plugin_query(const c3de_offer *offer, c3de_answer *answer) {
  answer->abi_major = C3DE_ABI_MAJOR;
  answer->abi_minor = C3DE_ABI_MINOR;
  if (offer->abi_min > C3DE_ABI_MAJOR || offer->abi_max < C3DE_ABI_MAJOR) {
    strcpy(answer->why_not, "built for another plugin ABI");
    return C3DE_E_VERSION;
  }
  answer->plugin = &plugin;
  return C3DE_OK;
}
