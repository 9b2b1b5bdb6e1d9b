/* SPDX-License-Identifier: Apache-2.0 */
/* A plugin without anything of its own: its descriptor is where C3DE_TEST_DESCRIPTOR says, in hexadecimal. */
#include <stdlib.h>

#include "c3de/abi/entry.h"

C3DE_EXPORT c3de_status C3DE_CALL c3de_plugin_query(const c3de_offer *offer, c3de_answer *answer) {
  const char *where = getenv("C3DE_TEST_DESCRIPTOR");
  (void)offer;
  answer->abi_major = C3DE_ABI_MAJOR;
  answer->abi_minor = C3DE_ABI_MINOR;
  answer->plugin = where ? (const struct c3de_plugin *)(uintptr_t)strtoull(where, NULL, 16) : NULL;
  return C3DE_OK;
}
