/* SPDX-License-Identifier: Apache-2.0 */
/* A program of revision 1 of c3de/embed.h, compiled against include_1 only: calls every function of that revision with the
 * structs of that time. Arguments: a scene whose first body is called "box", and a folder for files. Prints the state hash
 * after 20 steps; exit code 0: every call behaved as published. */
#include <c3de/embed.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#if C3DE_EMBED_REV != 1u
#error "this program is compiled against another header"
#endif

/* What follows a struct must stay as it was. */
#define GUARD 0x5a5a5a5a5a5a5a5aull
#define GUARDED(T, name)  \
  struct {                \
    T in;                 \
    uint64_t guard;       \
  } name = {{0}, GUARD};  \
  name.in.size = sizeof(T)

static int failures = 0;

static void require(int good, const char *what) {
  if (good) return;
  ++failures;
  fprintf(stderr, "%s: %s\n", what, c3de_embed_last_error());
}
#define OK(call) require((call) == C3DE_OK, #call)
#define THAT(condition) require((condition), #condition)
#define WHOLE(name) require(name.guard == GUARD, #name " was written beyond its size")

static int32_t progress(void *self, double fraction, const char *what) {
  (void)fraction;
  *(int *)self += what != NULL;
  return 0;
}
static int32_t stepped(void *self, const c3de_embed_status *status, double fraction) {
  *(int *)self += status->size >= sizeof *status && fraction >= 0.0;
  return 0;
}
static void logged(void *self, int32_t level, const char *line) {
  (void)self;
  (void)level;
  (void)line;
}

static void read_fields(c3de_sim sim) {
  uint64_t body = 7;
  OK(c3de_embed_find_body(sim, "box", &body));
  GUARDED(c3de_embed_body, info);
  OK(c3de_embed_body_at(sim, body, &info.in));
  WHOLE(info);
  THAT(strcmp(info.in.name, "box") == 0 && info.in.points > 0 && info.in.mass_kg > 0.0);
  GUARDED(c3de_embed_field, field);
  OK(c3de_embed_field_at(sim, body, C3DE_EMBED_ON_POINTS, 0, &field.in));
  WHOLE(field);
  GUARDED(c3de_embed_array, x);
  OK(c3de_embed_view_field(sim, body, C3DE_EMBED_ON_POINTS, "position", &x.in));
  WHOLE(x);
  THAT(x.in.dtype == C3DE_F64 && x.in.shape[0] == info.in.points && x.in.shape[1] == 3 && strcmp(x.in.unit, "m") == 0);
  GUARDED(c3de_embed_array, triangles);
  OK(c3de_embed_view_triangles(sim, body, &triangles.in));
  WHOLE(triangles);
  THAT(triangles.in.dtype == C3DE_U32 && triangles.in.shape[0] == info.in.triangles);
  double corners[8 * 3];
  OK(c3de_embed_read_field(sim, body, C3DE_EMBED_ON_SURFACE, "position", corners, sizeof corners));
}

static void set_parameters(c3de_sim sim) {
  uint64_t count = 0;
  OK(c3de_embed_parameter_count(sim, &count));
  GUARDED(c3de_embed_parameter, parameter);
  OK(c3de_embed_parameter_at(sim, count - 1, &parameter.in));
  WHOLE(parameter);
  OK(c3de_embed_set(sim, "body.box.youngs_modulus", "2e4"));
  GUARDED(c3de_embed_value, value);
  OK(c3de_embed_get(sim, "body.box.youngs_modulus", &value.in));
  WHOLE(value);
  THAT(value.in.type == C3DE_EMBED_NUMBER && value.in.number == 2e4);
}

static void pull(c3de_sim sim) {
  GUARDED(c3de_embed_hold, hold);
  hold.in.at_m[0] = 1.0;
  hold.in.radius_m = 0.1;
  uint64_t held = 0;
  OK(c3de_embed_hold_body(sim, 0, &hold.in, &held));
  const double target[3] = {1.02, 0.0, 0.0};
  OK(c3de_embed_pull(sim, held, target));
  OK(c3de_embed_step(sim, 2, NULL));
  GUARDED(c3de_embed_hold_state, state);
  OK(c3de_embed_hold_read(sim, held, &state.in));
  WHOLE(state);
  THAT(state.in.target_m[0] == 1.02 && isfinite(state.in.force_N[0]));
  OK(c3de_embed_release(sim, held));
}

int main(int argc, char **argv) {
  if (argc != 3) return 2;
  char state[4096], session[4096];
  snprintf(state, sizeof state, "%s/client.state", argv[2]);
  snprintf(session, sizeof session, "%s/client.c3de", argv[2]);
  THAT(c3de_embed_revision() >= 1 && strlen(c3de_embed_version()) > 0);
  c3de_embed_set_log(logged, NULL);
  int calls = 0;
  const char *assign[] = {"world.gravity=[0, -5, 0]"};
  GUARDED(c3de_embed_options, options);
  options.in.file = argv[1];
  options.in.assign = assign;
  options.in.assign_n = 1;
  options.in.threads = 1;
  options.in.progress = progress;
  options.in.progress_self = &calls;
  c3de_sim sim = 0;
  OK(c3de_embed_open(&options.in, &sim));
  WHOLE(options);
  THAT(sim != 0 && calls > 0);
  set_parameters(sim);

  uint64_t done = 0, hash = 0, initial = 0, again = 0;
  OK(c3de_embed_state_hash(sim, &initial));
  OK(c3de_embed_step(sim, 15, &done));
  THAT(done == 15);
  GUARDED(c3de_embed_run_options, run);
  run.in.max_steps = 5;
  run.in.stepped = stepped;
  run.in.stepped_self = &calls;
  calls = 0;
  OK(c3de_embed_run(sim, &run.in));
  WHOLE(run);
  THAT(calls == 5);
  GUARDED(c3de_embed_status, status);
  OK(c3de_embed_get_status(sim, &status.in));
  WHOLE(status);
  THAT(status.in.steps == 20 && status.in.time_s > 0.0 && status.in.bodies == 1);
  OK(c3de_embed_state_hash(sim, &hash));
  printf("%016llx\n", (unsigned long long)hash);
  read_fields(sim);

  const char *json = NULL;
  OK(c3de_embed_events(sim, &json));
  THAT(json[0] == '[');
  OK(c3de_embed_report(sim, &json));
  THAT(strstr(json, "state_hash") != NULL);
  OK(c3de_embed_save_state(sim, state));
  OK(c3de_embed_save_session(sim, session));
  OK(c3de_embed_cancel(sim));
  pull(sim);
  OK(c3de_embed_load_state(sim, state));
  OK(c3de_embed_state_hash(sim, &again));
  THAT(again == hash);
  OK(c3de_embed_reset(sim));
  OK(c3de_embed_state_hash(sim, &again));
  THAT(again == initial);
  THAT(c3de_embed_get(sim, "nonsense", NULL) == C3DE_E_ARG && strlen(c3de_embed_last_error()) > 0);
  OK(c3de_embed_close(sim));
  THAT(c3de_embed_step(sim, 1, NULL) == C3DE_E_STALE);
  return failures == 0 ? 0 : 1;
}
