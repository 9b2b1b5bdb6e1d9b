/* SPDX-License-Identifier: Apache-2.0 */
/* Panels: the plugin says what stands in them, the host draws. */
#ifndef C3DE_ABI_PANELS_H
#define C3DE_ABI_PANELS_H

#include "base.h"

#define C3DE_PANELS_ID "c3de.panels/1"

/* Results of a widget. */
#define C3DE_UI_CHANGED 1u   /* the value differs from before */
#define C3DE_UI_ACTIVE 2u    /* being dragged or typed into */
#define C3DE_UI_COMMITTED 4u /* the person has let go */

/* Valid inside on_ui only, and only on its thread. Ids are unique within a panel. */
typedef struct c3de_ui_v1 {
  uint32_t size;
  uint32_t rev;
  void *ctx;
  void(C3DE_CALL *heading)(void *ctx, c3de_str text);
  void(C3DE_CALL *text)(void *ctx, c3de_str text); /* wraps */
  void(C3DE_CALL *separator)(void *ctx);
  void(C3DE_CALL *same_line)(void *ctx);
  uint32_t(C3DE_CALL *button)(void *ctx, c3de_str id, c3de_str label,
                              uint32_t enabled); /* C3DE_UI_COMMITTED: pressed */
  uint32_t(C3DE_CALL *checkbox)(void *ctx, c3de_str id, c3de_str label, uint32_t *value);
  uint32_t(C3DE_CALL *slider)(void *ctx, c3de_str id, c3de_str label, c3de_str unit, double *value, double lo,
                              double hi);
  uint32_t(C3DE_CALL *choice)(void *ctx, c3de_str id, c3de_str label, uint32_t *index, const c3de_str *names,
                              uint64_t n);
  /* Text of up to capacity - 1 bytes in place, zero-terminated. */
  uint32_t(C3DE_CALL *input_text)(void *ctx, c3de_str id, c3de_str label, char *buffer, uint64_t capacity);
  void(C3DE_CALL *progress)(void *ctx, double fraction, c3de_str text); /* negative fraction: unknown */
  /* A line of a two-column table: name and value with its unit. */
  void(C3DE_CALL *value)(void *ctx, c3de_str name, c3de_str value);
  void(C3DE_CALL *tooltip)(void *ctx, c3de_str text); /* of the widget before */
  /* Every declared parameter of the group (empty: all) of a set: label, unit, range, tooltip. Changes reach the
   * listener. */
  void(C3DE_CALL *params)(void *ctx, c3de_handle param_set, c3de_str group);
  /* A file to open, through the host's dialog: the chosen path replaces the buffer's text. extensions: "obj;stl". */
  uint32_t(C3DE_CALL *file_button)(void *ctx, c3de_str id, c3de_str label, c3de_str extensions, char *buffer,
                                   uint64_t capacity);
  /* rev 2: a patch of colour, sRGB 0 ... 1, before what same_line puts beside it. */
  void(C3DE_CALL *swatch)(void *ctx, float red, float green, float blue);
  /* rev 3: what stands between them scrolls in a frame of its own, `rows` lines high (0: 12). Lists do not nest; the
   * end of the panel ends a list. */
  void(C3DE_CALL *list_begin)(void *ctx, c3de_str id, uint32_t rows);
  void(C3DE_CALL *list_end)(void *ctx);
  /* rev 4: n values over equal steps, the latest last, as a curve from the least to the largest of them and 0, which
   * stand beside it with the unit; a value that is not finite is a gap. `values` are borrowed during the call. */
  void(C3DE_CALL *curve)(void *ctx, c3de_str id, c3de_str label, c3de_str unit, const double *values, uint64_t n);
} c3de_ui_v1;

typedef struct c3de_panel { /* copied, strings included */
  uint32_t size;
  uint32_t rev;
  c3de_str id, title;
  void *self;
  void(C3DE_CALL *on_ui)(void *self, const c3de_ui_v1 *ui); /* once per frame while shown [main] */
} c3de_panel;

typedef struct c3de_panels_v1 {
  uint32_t size;
  uint32_t rev;
  void *ctx;
  c3de_status(C3DE_CALL *add)(void *ctx, const c3de_panel *panel, c3de_handle *out); /* [main] */
  c3de_status(C3DE_CALL *remove)(void *ctx, c3de_handle panel);                      /* [main] */
  /* A message to the person: severity as in log.h; stays until closed or replaced. [main] */
  c3de_status(C3DE_CALL *notify)(void *ctx, uint32_t severity, c3de_str title, c3de_str text);
} c3de_panels_v1;

#endif
