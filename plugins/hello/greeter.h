/* SPDX-License-Identifier: Apache-2.0 */
/* The interface that objects of the class "org.c3de.hello.Greeter/0" answer. A plugin that wants to use them includes
 * this header and nothing else of hello. */
#ifndef C3DE_HELLO_GREETER_H
#define C3DE_HELLO_GREETER_H

#include "c3de/abi/object.h"

#define HELLO_GREETER_CLASS "org.c3de.hello.Greeter/0"
#define HELLO_GREETER_ID "org.c3de.hello.iface.greeter/0"

typedef struct hello_greeter_v0 {
  uint32_t size;
  uint32_t rev;
  /* Writes "Hello, NAME!" to the sink. C3DE_E_ARG for an empty name. [any] */
  c3de_status(C3DE_CALL *greet)(c3de_object *self, c3de_str name, c3de_sink text);
  /* How often this object has greeted. [any] */
  uint64_t(C3DE_CALL *greetings)(c3de_object *self);
} hello_greeter_v0;

#endif
