/* SPDX-License-Identifier: Apache-2.0 */
/* Ends the program with "all is well": in create, or, with EXITS_IN_PANEL, at once from a panel. */
#include <stdlib.h>

#include "minimal.h"

#if defined(EXITS_IN_PANEL)
static void C3DE_CALL on_ui(void *self, const c3de_ui_v1 *ui) {
  (void)self;
  (void)ui;
#if defined(__MINGW32__) /* which has no quick_exit */
  exit(0);
#else
  quick_exit(0);
#endif
}

static c3de_status C3DE_CALL create(const c3de_host *host, void **self) {
  const void *table = NULL;
  const c3de_panel panel = {sizeof panel, 1, TEXT("test.exits.panel"), TEXT("Exits"), NULL, on_ui};
  c3de_handle handle;
  *self = NULL;
  const c3de_status status = host->get_service(host->ctx, text(C3DE_PANELS_ID), 1, &table);
  if (status < 0) return status;
  const c3de_panels_v1 *panels = table;
  return panels->add(panels->ctx, &panel, &handle);
}
#else
static c3de_status C3DE_CALL create(const c3de_host *host, void **self) {
  (void)host;
  (void)self;
  exit(0);
}
#endif

static const c3de_plugin plugin = {NAMED("test.exits"), NO_NEEDS, create, do_nothing, do_nothing, destroy_nothing};
ANSWER_WITH(&plugin)
