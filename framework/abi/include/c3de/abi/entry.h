/* SPDX-License-Identifier: Apache-2.0 */
/* How host and plugin meet: one exported function, c3de_plugin_query. */
#ifndef C3DE_ABI_ENTRY_H
#define C3DE_ABI_ENTRY_H

#include "base.h"

struct c3de_plugin;

#define C3DE_OFFER_HEADLESS 1u /* no window: render, panels and tools are not served */
#define C3DE_OFFER_PROBE 2u    /* only looking: create will not follow */

typedef struct c3de_offer {
  uint32_t size;
  uint32_t abi_min, abi_max; /* ABI majors the host can serve, inclusive */
  uint32_t abi_minor;        /* minor of abi_max */
  c3de_str host_name, host_version;
  uint64_t flags; /* C3DE_OFFER_* */
} c3de_offer;

typedef struct c3de_answer { /* in the host's memory; the host sets size */
  uint32_t size;
  uint32_t abi_major; /* chosen by the plugin, within abi_min … abi_max */
  uint32_t abi_minor; /* what the plugin was built with */
  uint32_t reserved;
  const struct c3de_plugin *plugin; /* static storage in the plugin */
  char why_not[256];                /* zero-terminated, when the status is not C3DE_OK */
} c3de_answer;

#define C3DE_REQUIRED 1u
#define C3DE_OPTIONAL 2u

typedef struct c3de_service_req {
  uint32_t size;
  uint32_t flags; /* C3DE_REQUIRED or C3DE_OPTIONAL */
  c3de_str id;    /* for example "c3de.log/1" */
  uint32_t min_rev;
  uint32_t reserved;
} c3de_service_req;

/* What of the things that a function was given an error is about. */
typedef struct c3de_error_place {
  uint32_t size;
  uint32_t index; /* in the table; 0 without one */
  c3de_str table; /* for example "fix", "load"; empty: none */
  c3de_str key;   /* the parameter or member; empty: none */
} c3de_error_place;

/* What a plugin gets of the host; valid from create until destroy returns. */
typedef struct c3de_host {
  uint32_t size;
  uint32_t rev;
  void *ctx;
  /* The table of a service, valid until destroy; C3DE_E_NOT_FOUND for an unknown id, C3DE_E_VERSION if its revision is
   * below min_rev, C3DE_E_UNSUPPORTED if it is not served in this run (headless). Same table for the same id. [any] */
  c3de_status(C3DE_CALL *get_service)(void *ctx, c3de_str id, uint32_t min_rev, const void **table);
  /* Says why the call that is about to return an error failed. Kept per thread, taken by the caller's side. [any] */
  void(C3DE_CALL *set_error)(void *ctx, c3de_status status, c3de_str message);
  /* The text set last on this thread by either side, cleared by reading. [any] */
  c3de_status(C3DE_CALL *take_error)(void *ctx, c3de_sink text);
  /* May be absent (by size): rev 2. As set_error, with the place that the message is about and does not name. [any] */
  void(C3DE_CALL *set_error_at)(void *ctx, c3de_status status, c3de_str message, const c3de_error_place *place);
  /* May be absent (by size): rev 3. The function of the plugin that the host is calling on this thread returns nothing,
   * and has failed as set_error says: a panel, a frame callback, stepped(). [any] */
  void(C3DE_CALL *callback_failed)(void *ctx);
} c3de_host;

typedef struct c3de_plugin {
  uint32_t size;
  uint32_t rev;
  c3de_str id; /* reverse-DNS, for example "org.example.probe" */
  c3de_str version, display_name, vendor, license;
  const c3de_service_req *needs;
  uint64_t needs_n, needs_stride;
  /* Gets services, registers classes, panels, tools. If it fails, all it registered is taken back. [main] */
  c3de_status(C3DE_CALL *create)(const c3de_host *host, void **self);
  /* Every plugin is created; classes of others may be looked up. [main] */
  c3de_status(C3DE_CALL *start)(void *self);
  /* Ends own threads, lets go of foreign objects. [main] */
  c3de_status(C3DE_CALL *stop)(void *self);
  /* After this the plugin does not call the host. [main] */
  void(C3DE_CALL *destroy)(void *self);
} c3de_plugin;

/* Pure, no allocation, below 10 ms, any thread. Not C3DE_OK: answer->why_not says why. */
typedef c3de_status(C3DE_CALL *c3de_plugin_query_fn)(const c3de_offer *offer, c3de_answer *answer);
#define C3DE_PLUGIN_QUERY_SYMBOL "c3de_plugin_query"

C3DE_EXPORT c3de_status C3DE_CALL c3de_plugin_query(const c3de_offer *offer, c3de_answer *answer);

#endif
