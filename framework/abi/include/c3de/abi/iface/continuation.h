/* SPDX-License-Identifier: Apache-2.0 */
/* Optional interface of a simulator, beside iface.simulator: it continues from the state of another one. The host
 * builds a second simulator whose bodies have corrected shapes, and continues with it. */
#ifndef C3DE_ABI_IFACE_CONTINUATION_H
#define C3DE_ABI_IFACE_CONTINUATION_H

#include "../object.h"

#define C3DE_IFACE_CONTINUATION_ID "draft/c3de.iface.continuation/0"

typedef struct c3de_continuation_v0 {
  uint32_t size;
  uint32_t rev;
  /* Takes time, displacements and velocities of `other`, a simulator of the same class that may be running, between two
   * of its steps. Bodies correspond by name; those without a counterpart are in their initial state. json: object with
   * `bodies`, an array of objects: `name`, `same` (the state is copied, otherwise interpolated), `energy_before_J` and
   * `energy_after_J` (elastic and kinetic). C3DE_E_ARG or C3DE_E_STATE with text: nothing has changed here. [any, while
   * nobody else uses self] */
  c3de_status(C3DE_CALL *continue_from)(c3de_object *self, c3de_object *other, c3de_sink json);
} c3de_continuation_v0;

#endif
