/* SPDX-License-Identifier: Apache-2.0 */
/* Tools: what the left mouse button does in the 3D view and, where a tool asks for it, in the slices of an image. One
 * tool is active at a time. */
#ifndef C3DE_ABI_TOOLS_H
#define C3DE_ABI_TOOLS_H

#include "base.h"

#define C3DE_TOOLS_ID "c3de.tools/1"

#define C3DE_EVENT_PRESS 1u
#define C3DE_EVENT_MOVE 2u
#define C3DE_EVENT_RELEASE 3u
#define C3DE_EVENT_WHEEL 4u
#define C3DE_EVENT_KEY 5u

#define C3DE_BUTTON_LEFT 1u
#define C3DE_BUTTON_RIGHT 2u
#define C3DE_BUTTON_MIDDLE 4u

#define C3DE_MOD_SHIFT 1u
#define C3DE_MOD_CTRL 2u
#define C3DE_MOD_ALT 4u

/* Where an event happened. */
#define C3DE_IN_SPACE 0u /* the 3D view */
#define C3DE_IN_AXIAL 1u /* a slice of an image, and the next two */
#define C3DE_IN_SAGITTAL 2u
#define C3DE_IN_CORONAL 3u

#define C3DE_TOOL_IN_SLICES 1u /* events of slices come, too; without it those of the 3D view only */

typedef struct c3de_event {
  uint32_t size;
  uint32_t type;      /* C3DE_EVENT_* */
  uint32_t button;    /* the one pressed or released */
  uint32_t buttons;   /* all that are down */
  uint32_t modifiers; /* C3DE_MOD_* */
  uint32_t key;       /* ASCII upper case, or 27 for Escape */
  double x_px, y_px;  /* from the view's upper left corner */
  double wheel;
  /* World; through the pixel, unit direction. From the eye; of a press in a view that is cut, from where it enters what
   * is left. In a slice: from the point of the shown plane that is under the pixel, along view_direction. */
  double ray_origin_mm[3], ray_direction[3];
  double view_direction[3]; /* world; where the camera looks; of a slice its unit normal, away from who looks at it */
  double time_s;
  uint32_t where; /* may be absent (by size). C3DE_IN_* */
  uint32_t reserved;
  /* May be absent (by size). Of a press in the 3D view: how far along the ray the inside of a body is seen, on a slice
   * that is shown there as a plane or as the surface of a tissue, with nothing else opaque before it; negative: it is
   * not. */
  double inside_mm;
} c3de_event;

typedef struct c3de_tool { /* copied, strings included */
  uint32_t size;
  uint32_t rev;
  c3de_str id, label;
  c3de_str hint;     /* one line, shown while active */
  uint32_t shortcut; /* ASCII upper case; 0: none */
  uint32_t reserved;
  void *self;
  c3de_status(C3DE_CALL *activate)(void *self); /* [main] */
  /* Also on loss of focus and before another tool: must let go of everything. [main] */
  void(C3DE_CALL *cancel)(void *self);
  /* *consumed = 1 keeps the event from the camera, and from the gestures of slices. While a press that was consumed
   * goes on and a slice moves under the mouse, for example by the wheel, a C3DE_EVENT_MOVE follows. [main] */
  c3de_status(C3DE_CALL *on_event)(void *self, const c3de_event *event, uint32_t *consumed);
  uint32_t flags; /* may be absent (by size). C3DE_TOOL_* */
  uint32_t reserved2;
} c3de_tool;

typedef struct c3de_tools_v1 {
  uint32_t size;
  uint32_t rev; /* 2: from marked_point() on */
  void *ctx;
  c3de_status(C3DE_CALL *add)(void *ctx, const c3de_tool *tool, c3de_handle *out);  /* [main] */
  c3de_status(C3DE_CALL *remove)(void *ctx, c3de_handle tool);                      /* [main] */
  c3de_status(C3DE_CALL *activate)(void *ctx, c3de_handle tool);                    /* 0: none [main] */
  c3de_status(C3DE_CALL *is_active)(void *ctx, c3de_handle tool, uint32_t *active); /* [main] */
  /* rev 2: the point that a person has marked, three numbers, mm, world: the cross-hair of the image that is open, else
   * the point that the camera turns about. C3DE_E_UNSUPPORTED where there are no views. [main] */
  c3de_status(C3DE_CALL *marked_point)(void *ctx, double *out_mm3);
} c3de_tools_v1;

#endif
