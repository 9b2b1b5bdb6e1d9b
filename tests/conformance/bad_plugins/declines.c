/* SPDX-License-Identifier: Apache-2.0 */
/* Says itself that it does not fit, and why. */
#include "minimal.h"

C3DE_EXPORT c3de_status C3DE_CALL c3de_plugin_query(const c3de_offer *offer, c3de_answer *answer) {
  (void)offer;
  memset(answer->why_not, 'x', sizeof answer->why_not); /* not terminated, as a careless plugin leaves it */
  memcpy(answer->why_not, "needs a licence key", sizeof "needs a licence key");
  return C3DE_E_UNSUPPORTED;
}
