/* My plugin: a wind along x on every body that is simulated. */
#include <string.h>

#include "c3de/abi/forces.h"
#include "c3de/abi/entry.h"

#define TEXT(literal) \
  { literal, sizeof(literal) - 1 }

static c3de_str text(const char *s) {
  c3de_str t = {s, strlen(s)};
  return t;
}

static const double kAcceleration_m_s2 = 1.0;

/* On the simulation's thread, before each step, for each body. */
static c3de_status C3DE_CALL apply(void *self, const c3de_force_call *call) {
  uint64_t i;
  (void)self;
  for (i = 0; i < call->count; ++i) call->forces_N[3 * i] += call->masses_kg[i] * kAcceleration_m_s2;
  return C3DE_OK;
}

static c3de_status C3DE_CALL create(const c3de_host *host, void **self) {
  const void *table = NULL;
  const c3de_forces_v1 *forces;
  const c3de_force_field field = {sizeof field, 0, TEXT("wind"), NULL, apply};
  const c3de_handle everywhere = {0};
  c3de_handle handle;
  const c3de_status status = host->get_service(host->ctx, text(C3DE_FORCES_ID), 1, &table);
  *self = NULL;
  if (status < 0) return status;
  forces = table;
  return forces->add(forces->ctx, everywhere, &field, &handle);
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

static const c3de_service_req needs[] = {{sizeof(c3de_service_req), C3DE_REQUIRED, TEXT(C3DE_FORCES_ID), 1, 0}};
static const c3de_plugin plugin = {sizeof(c3de_plugin), 1, TEXT("org.example.my_plugin"), TEXT("0.1.0"), TEXT("My plugin"),
                                   TEXT("Your name"), TEXT("MIT"), needs, 1, sizeof needs[0], create, start, stop, destroy};

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
