/* SPDX-License-Identifier: Apache-2.0 */
/* Takes its time where only a look is asked for; a good plugin otherwise. */
#include <time.h>

#include "minimal.h"

static const c3de_plugin plugin = {NAMED("test.slow_query"), NO_NEEDS, create_nothing, do_nothing, do_nothing,
                                   destroy_nothing};

C3DE_EXPORT c3de_status C3DE_CALL c3de_plugin_query(const c3de_offer *offer, c3de_answer *answer) {
  struct timespec now, begin;
  (void)offer;
  timespec_get(&begin, TIME_UTC);
  do {
    timespec_get(&now, TIME_UTC);
  } while ((double)(now.tv_sec - begin.tv_sec) + 1e-9 * (double)(now.tv_nsec - begin.tv_nsec) < 0.4);
  answer->abi_major = C3DE_ABI_MAJOR;
  answer->abi_minor = C3DE_ABI_MINOR;
  answer->plugin = &plugin;
  return C3DE_OK;
}
