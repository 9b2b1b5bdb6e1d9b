/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of a plugin that the cases of this folder do not break. */
#ifndef C3DE_TEST_MINIMAL_H
#define C3DE_TEST_MINIMAL_H

#include <stdio.h>
#include <string.h>

#include "c3de/abi/c3de.h"

#define TEXT(literal) \
  { literal, sizeof(literal) - 1 }

static inline c3de_str text(const char *s) {
  c3de_str t = {s, strlen(s)};
  return t;
}

static inline c3de_status C3DE_CALL create_nothing(const c3de_host *host, void **self) {
  (void)host;
  *self = NULL;
  return C3DE_OK;
}
static inline c3de_status C3DE_CALL do_nothing(void *self) {
  (void)self;
  return C3DE_OK;
}
static inline void C3DE_CALL destroy_nothing(void *self) { (void)self; }

static inline c3de_status C3DE_CALL make_no_object(void *factory, c3de_object **out) {
  (void)factory;
  *out = NULL;
  return C3DE_E_UNSUPPORTED;
}

static inline c3de_status add_test_class(const c3de_registry_v1 *registry, const char *id) {
  const c3de_class cls = {sizeof(c3de_class), 1, text(id), TEXT("Test"), TEXT(""), NULL, 0, NULL, make_no_object};
  return registry->add_class(registry->ctx, &cls);
}

/* The entry function for a descriptor of the given name, and nothing else. */
#define ANSWER_WITH(descriptor)                                                                       \
  C3DE_EXPORT c3de_status C3DE_CALL c3de_plugin_query(const c3de_offer *offer, c3de_answer *answer) { \
    (void)offer;                                                                                      \
    answer->abi_major = C3DE_ABI_MAJOR;                                                               \
    answer->abi_minor = C3DE_ABI_MINOR;                                                               \
    answer->plugin = descriptor;                                                                      \
    return C3DE_OK;                                                                                   \
  }

#define NAMED(id) sizeof(c3de_plugin), 1, TEXT(id), TEXT("1.0.0"), TEXT(id), TEXT(""), TEXT("")
#define NO_NEEDS NULL, 0, 0

#endif
