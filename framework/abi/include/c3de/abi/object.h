/* SPDX-License-Identifier: Apache-2.0 */
/* Objects that plugins share: refcounted, asked for interfaces by id. */
#ifndef C3DE_ABI_OBJECT_H
#define C3DE_ABI_OBJECT_H

#include "base.h"

struct c3de_object_vt;

typedef struct c3de_object { /* first member of every shared object */
  const struct c3de_object_vt *vt;
} c3de_object;

typedef struct c3de_object_vt {
  uint32_t size;
  uint32_t rev;
  uint32_t(C3DE_CALL *retain)(c3de_object *self);  /* the new count [any] */
  uint32_t(C3DE_CALL *release)(c3de_object *self); /* the new count; 0: the object is gone [any] */
  /* The table of an interface; its functions take this object as `self`. C3DE_E_NOT_FOUND, C3DE_E_VERSION. [any] */
  c3de_status(C3DE_CALL *query)(c3de_object *self, c3de_str iface_id, uint32_t min_rev, const void **table);
} c3de_object_vt;

typedef struct c3de_class { /* copied by add_class, strings included */
  uint32_t size;
  uint32_t rev;
  c3de_str id;    /* for example "c3de.pointbased.WorldSimulator/1" */
  c3de_str label; /* shown to people */
  c3de_str doc;
  const c3de_str *ifaces; /* interfaces its objects answer */
  uint64_t ifaces_n;
  void *factory;
  /* A new object with a count of one. [main] */
  c3de_status(C3DE_CALL *create)(void *factory, c3de_object **out);
} c3de_class;

#endif
