/* SPDX-License-Identifier: Apache-2.0 */
/* Registers a class that hello has, and passes the host's status on. */
#include "minimal.h"

static c3de_status C3DE_CALL create(const c3de_host *host, void **self) {
  const void *registry = NULL;
  const c3de_status status = host->get_service(host->ctx, text(C3DE_REGISTRY_ID), 1, &registry);
  *self = NULL;
  return status < 0 ? status : add_test_class(registry, "org.c3de.hello.Greeter/0");
}

static const c3de_plugin plugin = {NAMED("test.class_of_another"), NO_NEEDS, create, do_nothing, do_nothing,
                                   destroy_nothing};
ANSWER_WITH(&plugin)
