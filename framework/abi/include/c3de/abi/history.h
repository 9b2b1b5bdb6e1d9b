/* SPDX-License-Identifier: Apache-2.0 */
/* Undo and Redo of the window: what a plugin's tool has done becomes a step of them. */
#ifndef C3DE_ABI_HISTORY_H
#define C3DE_ABI_HISTORY_H

#include "base.h"

#define C3DE_HISTORY_ID "c3de.history/1"

typedef struct c3de_edit { /* copied, strings included */
  uint32_t size;
  uint32_t rev;
  c3de_str label; /* what was done, behind "Undo" and "Redo" of the menu: "pull on liver" */
  void *self;
  /* Take it back, do it again. What fails is forgotten and said in the log. [main] */
  c3de_status(C3DE_CALL *undo)(void *self);
  c3de_status(C3DE_CALL *redo)(void *self);
  /* May be null. Called once, when the step is forgotten. [main] */
  void(C3DE_CALL *release)(void *self);
} c3de_edit;

typedef struct c3de_history_v1 {
  uint32_t size;
  uint32_t rev;
  void *ctx;
  /* A step that has been done just now. Steps that were undone are forgotten; so are the oldest when the list of the
   * host needs more than 16 MiB. The plugin limits the states that its steps keep, and removes its oldest steps.
   * [main] */
  c3de_status(C3DE_CALL *add)(void *ctx, const c3de_edit *edit, c3de_handle *out);
  /* Forgets a step whose object is gone; C3DE_E_STALE when it is forgotten already. [main] */
  c3de_status(C3DE_CALL *remove)(void *ctx, c3de_handle edit);

  /* Since revision 2, for changes without an inverse, such as another body: stores the present simulation, its scene,
   * changes and state, and calls ready once, later. C3DE_OK: begin; a state that cannot be stored is reported by
   * add_captured(). C3DE_E_CANCELLED: the plugin is being stopped. [main] */
  c3de_status(C3DE_CALL *capture)(void *ctx, void *self, void(C3DE_CALL *ready)(void *self, c3de_status status));
  /* Since revision 2. The change started by the last ready() has succeeded: a step of the host. Its undo restores the
   * stored simulation, its redo the state that undo replaced. C3DE_E_STATE: nothing was captured, or another change has
   * begun since. [main] */
  c3de_status(C3DE_CALL *add_captured)(void *ctx, c3de_str label);
} c3de_history_v1;

#endif
