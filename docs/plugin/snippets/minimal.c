/* SPDX-License-Identifier: Apache-2.0 */
/* The least that is a plugin: it can be found, loaded, started and stopped, and does nothing. */
#include <stddef.h>
#include <string.h>

#include "c3de/abi/entry.h"

#define TEXT(literal) {literal, sizeof(literal) - 1}

static c3de_status C3DE_CALL create(const c3de_host *host, void **self) {
  (void)host;
  *self = NULL; /* what stands here comes back as the argument of start, stop and destroy */
  return C3DE_OK;
}
static c3de_status C3DE_CALL start(void *self) {
  (void)self;
  return C3DE_OK;
}
static c3de_status C3DE_CALL stop(void *self) {
  (void)self;
  return C3DE_OK;
}
static void C3DE_CALL destroy(void *self) { (void)self; }

static const c3de_plugin plugin = {
    sizeof(c3de_plugin), 1, TEXT("org.example.minimal"), TEXT("1.0.0"), TEXT("Minimal"), TEXT("You"), TEXT("MIT"),
    NULL, 0, 0, /* needs no services */
    create, start, stop, destroy};

C3DE_EXPORT c3de_status C3DE_CALL c3de_plugin_query(const c3de_offer *offer, c3de_answer *answer) {
  answer->abi_major = C3DE_ABI_MAJOR;
  answer->abi_minor = C3DE_ABI_MINOR;
  if (offer->abi_min > C3DE_ABI_MAJOR || offer->abi_max < C3DE_ABI_MAJOR) {
    strcpy(answer->why_not, "built for another plugin ABI");
    return C3DE_E_VERSION;
  }
  answer->plugin = &plugin;
  return C3DE_OK;
}
