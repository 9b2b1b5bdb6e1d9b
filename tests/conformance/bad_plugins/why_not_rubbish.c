/* SPDX-License-Identifier: Apache-2.0 */
/* Declines with bytes that would steer a terminal, and without the zero at the end. */
#include "minimal.h"

C3DE_EXPORT c3de_status C3DE_CALL c3de_plugin_query(const c3de_offer *offer, c3de_answer *answer) {
  (void)offer;
  memset(answer->why_not, 0xff, sizeof answer->why_not);
  memcpy(answer->why_not, "no \x1b[2J way ", 11);
  return C3DE_E_UNSUPPORTED;
}
