/* SPDX-License-Identifier: Apache-2.0 */
/* The classes that plugins offer to each other and to the host. */
#ifndef C3DE_ABI_REGISTRY_H
#define C3DE_ABI_REGISTRY_H

#include "object.h"

#define C3DE_REGISTRY_ID "c3de.registry/1"

typedef struct c3de_class_info { /* borrowed for the call */
  uint32_t size;
  uint32_t reserved;
  c3de_str id, label, doc, plugin_id;
  const c3de_str *ifaces;
  uint64_t ifaces_n;
} c3de_class_info;

typedef struct c3de_registry_v1 {
  uint32_t size;
  uint32_t rev;
  void *ctx;
  /* C3DE_E_EXISTS names the plugin that has the id. [main] */
  c3de_status(C3DE_CALL *add_class)(void *ctx, const c3de_class *cls);
  /* Only a class of the calling plugin. [main] */
  c3de_status(C3DE_CALL *remove_class)(void *ctx, c3de_str id);
  /* Calls each() for every class that lists the interface (empty id: for every class), sorted by id, until each()
   * returns something other than C3DE_OK, which is returned. [any] */
  c3de_status(C3DE_CALL *enum_classes)(void *ctx, c3de_str iface_id, void *self,
                                       c3de_status(C3DE_CALL *each)(void *self, const c3de_class_info *info));
  /* A new object with a count of one. C3DE_E_NOT_FOUND names the classes that exist. [main] */
  c3de_status(C3DE_CALL *create)(void *ctx, c3de_str class_id, c3de_object **out);
} c3de_registry_v1;

#endif
