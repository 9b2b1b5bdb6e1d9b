/* SPDX-License-Identifier: Apache-2.0 */
/* Says in the log when which of its entry functions is called. LIFECYCLE_NAME tells the two builds apart. */
#include "bad_plugins/minimal.h"

static const c3de_log_v1 *logger;

static void say(const char *what) {
  char line[64];
  snprintf(line, sizeof line, "step %s %s", what, LIFECYCLE_NAME);
  logger->write(logger->ctx, C3DE_LOG_INFO, text(line));
}

static c3de_status C3DE_CALL create(const c3de_host *host, void **self) {
  const void *log = NULL;
  const c3de_status status = host->get_service(host->ctx, text(C3DE_LOG_ID), 1, &log);
  if (status < 0) return status;
  logger = log;
  *self = &logger;
  say("create");
  return C3DE_OK;
}
static c3de_status C3DE_CALL start(void *self) {
  say(self == &logger ? "start" : "start with a wrong self");
  return C3DE_OK;
}
static c3de_status C3DE_CALL stop(void *self) {
  say(self == &logger ? "stop" : "stop with a wrong self");
  return C3DE_E_STATE; /* is reported, and destroy follows all the same */
}
static void C3DE_CALL destroy(void *self) { say(self == &logger ? "destroy" : "destroy with a wrong self"); }

static const c3de_plugin plugin = {NAMED("test.lifecycle." LIFECYCLE_NAME), NO_NEEDS, create, start, stop, destroy};
ANSWER_WITH(&plugin)
