// SPDX-License-Identifier: Apache-2.0
// Registers a class and lets an exception escape from create.
#include <stdexcept>

#include "minimal.h"

namespace {

c3de_status C3DE_CALL create(const c3de_host *host, void **) {
  const void *registry = nullptr;
  (void)host->get_service(host->ctx, text(C3DE_REGISTRY_ID), 1, &registry);
  (void)add_test_class(static_cast<const c3de_registry_v1 *>(registry), "test.Thrower/0");
  throw std::runtime_error("thrown in create");
}

const c3de_plugin plugin = {
    NAMED("test.throws_in_create"), NO_NEEDS, &create, &do_nothing, &do_nothing, &destroy_nothing};

}  // namespace

ANSWER_WITH(&plugin)
