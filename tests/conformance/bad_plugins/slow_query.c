/* SPDX-License-Identifier: Apache-2.0 */
/* Takes its time where only a look is asked for; a good plugin otherwise. */
#include <time.h>

#include "minimal.h"

static const c3de_plugin plugin = {NAMED("test.slow_query"), NO_NEEDS, create_nothing, do_nothing, do_nothing,
                                   destroy_nothing};

/* Seconds that have passed since some moment. */
static double seconds(void) {
#if defined(_WIN32)
  return (double)clock() / CLOCKS_PER_SEC; /* of the wall there */
#else
  struct timespec now;
  timespec_get(&now, TIME_UTC);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
#endif
}

C3DE_EXPORT c3de_status C3DE_CALL c3de_plugin_query(const c3de_offer *offer, c3de_answer *answer) {
  const double begin = seconds();
  (void)offer;
  while (seconds() - begin < 0.4) {
  }
  answer->abi_major = C3DE_ABI_MAJOR;
  answer->abi_minor = C3DE_ABI_MINOR;
  answer->plugin = &plugin;
  return C3DE_OK;
}
