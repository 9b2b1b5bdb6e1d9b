/* SPDX-License-Identifier: Apache-2.0 */
/* Chooses a boundary that the host does not offer. */
#include "minimal.h"

static const c3de_plugin plugin = {NAMED("test.wrong_abi_major"), NO_NEEDS, create_nothing, do_nothing, do_nothing,
                                   destroy_nothing};

C3DE_EXPORT c3de_status C3DE_CALL c3de_plugin_query(const c3de_offer *offer, c3de_answer *answer) {
  (void)offer;
  answer->abi_major = 7;
  answer->plugin = &plugin;
  return C3DE_OK;
}
