/* SPDX-License-Identifier: Apache-2.0 */
/* Parameters are declared, not drawn: one declaration feeds panel, units, command line, checks and docs. */
#ifndef C3DE_ABI_PARAMS_H
#define C3DE_ABI_PARAMS_H

#include "base.h"

#define C3DE_PARAMS_ID "c3de.params/1"

#define C3DE_PARAM_F64 1u
#define C3DE_PARAM_I64 2u
#define C3DE_PARAM_BOOL 3u
#define C3DE_PARAM_CHOICE 4u /* text, one of `choices` */
#define C3DE_PARAM_TEXT 5u
#define C3DE_PARAM_VEC3 6u

#define C3DE_PARAM_LOG_SCALE 1u   /* slider on a logarithmic scale */
#define C3DE_PARAM_NEEDS_RESET 2u /* takes effect when the body is built again */
#define C3DE_PARAM_ADVANCED 4u
#define C3DE_PARAM_MIN_OPEN 8u  /* min itself is not accepted */
#define C3DE_PARAM_MAX_OPEN 16u /* max itself is not accepted */
#define C3DE_PARAM_AUTO 32u     /* the text "auto" is accepted beside a number */
#define C3DE_PARAM_TOGETHER 64u /* a scene says all parameters of the same table (the id up to its last '.') or none */

typedef struct c3de_param_decl {
  uint32_t size;
  uint32_t type;             /* C3DE_PARAM_* */
  c3de_str id;               /* dotted, for example "material.youngs_modulus" */
  c3de_str label;            /* for example "Young's modulus" */
  c3de_str unit;             /* SI, for example "Pa"; empty: none */
  c3de_str doc;              /* meaning; effect of too small and too large */
  c3de_str group;            /* heading it stands under in a panel */
  double min, max;           /* accepted values, inclusive unless C3DE_PARAM_*_OPEN; an infinite end that is
                              * inclusive accepts infinity ("never") */
  double soft_min, soft_max; /* range of the slider */
  double fallback;           /* default of a number, boolean (0/1) */
  c3de_str fallback_text;    /* default of a choice or text; "auto" */
  double fallback_vec[3];
  const c3de_str *choices;
  uint64_t choices_n;
  uint32_t flags;
  uint32_t reserved;
  /* What follows may be absent (by size). */
  c3de_str alternative_to; /* id of the parameter that this one says in another way; scenes say one of the two */
} c3de_param_decl;

typedef struct c3de_param_value {
  uint32_t size;
  uint32_t type; /* C3DE_PARAM_*; a C3DE_PARAM_AUTO number may come as C3DE_PARAM_TEXT "auto" */
  c3de_str id;
  double num; /* F64, I64, BOOL */
  c3de_str text;
  double vec[3];
} c3de_param_value;

typedef struct c3de_param_listener {
  uint32_t size;
  uint32_t reserved;
  void *self;
  /* A person or another plugin changed the value; already checked against the declaration. [main] */
  void(C3DE_CALL *changed)(void *self, const c3de_param_value *value);
} c3de_param_listener;

typedef struct c3de_params_v1 {
  uint32_t size;
  uint32_t rev;
  void *ctx;
  /* Declarations and strings are copied; values start at their defaults. [main] */
  c3de_status(C3DE_CALL *declare)(void *ctx, c3de_str title, const c3de_param_decl *decls, uint64_t n, uint64_t stride,
                                  const c3de_param_listener *listener, c3de_handle *out);
  c3de_status(C3DE_CALL *remove)(void *ctx, c3de_handle set);
  /* The text of the value is valid until the next call on this set. [main] */
  c3de_status(C3DE_CALL *get)(void *ctx, c3de_handle set, c3de_str id, c3de_param_value *out);
  /* Checks and stores; C3DE_E_ARG says what is accepted, C3DE_E_NOT_FOUND names the nearest id. Does not call the
   * listener: it is for the owner to show what is. [main] */
  c3de_status(C3DE_CALL *set)(void *ctx, c3de_handle set, const c3de_param_value *value);
} c3de_params_v1;

#endif
