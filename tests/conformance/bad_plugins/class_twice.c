/* SPDX-License-Identifier: Apache-2.0 */
/* Registers two of its classes, then one of them again; create fails with the host's status. */
#include "minimal.h"

static c3de_status C3DE_CALL create(const c3de_host *host, void **self) {
  static const char *const ids[] = {"test.First/0", "test.Second/0", "test.First/0"};
  const void *registry = NULL;
  c3de_status status = host->get_service(host->ctx, text(C3DE_REGISTRY_ID), 1, &registry);
  *self = NULL;
  for (int i = 0; status >= 0 && i < 3; ++i) status = add_test_class(registry, ids[i]);
  return status;
}

static const c3de_plugin plugin = {NAMED("test.class_twice"), NO_NEEDS, create, do_nothing, do_nothing, destroy_nothing};
ANSWER_WITH(&plugin)
