/* SPDX-License-Identifier: Apache-2.0 */
/* Opens and closes simulations, with every kind of memory that a caller can obtain: run by test_embed under valgrind.
 * Arguments: a scene, a folder for files. */
#include <c3de/embed.h>
#include <stdio.h>

static int failed = 0;

static void check(c3de_status status) {
  if (status >= 0) return;
  failed = 1;
  fprintf(stderr, "%s\n", c3de_embed_last_error());
}

static void use(const c3de_embed_options *options, const char *folder) {
  c3de_sim sim = 0;
  c3de_image image = 0;
  check(c3de_embed_open(options, &sim));
  char file[4096];
  snprintf(file, sizeof file, "%s/open_close.c3dr", folder);
  check(c3de_embed_record(sim, file, 1));
  c3de_embed_condition force = {.size = sizeof force, .kind = C3DE_EMBED_FORCE, .box_min_m = {-9, -9, -9},
                                .box_max_m = {9, 9, 9}, .vector = {0, 1, 0}};
  uint64_t condition = 0;
  check(c3de_embed_set_condition(sim, 0, &force, &condition));
  check(c3de_embed_step(sim, 2, NULL));
  c3de_embed_condition_state state = {.size = sizeof state};
  check(c3de_embed_condition_read(sim, condition, &state));
  c3de_embed_array view = {.size = sizeof view};
  check(c3de_embed_view_field(sim, 0, C3DE_EMBED_ON_POINTS, "displacement", &view));
  check(c3de_embed_view_triangles(sim, 0, &view));
  const char *json = NULL;
  check(c3de_embed_report(sim, &json));
  check(c3de_embed_remove_condition(sim, condition));
  check(c3de_embed_end_recording(sim));
  if (c3de_embed_set(sim, "nonsense", "1") != C3DE_E_ARG) failed = 1;
  if (c3de_embed_warp(sim, C3DE_EMBED_IMAGE, NULL, NULL, &image) != C3DE_E_ARG) failed = 1; /* the scene has none */
  check(c3de_embed_close(sim));
}

int main(int argc, char **argv) {
  if (argc != 3) return 2;
  c3de_embed_options options = {.size = sizeof options, .file = argv[1], .threads = 1};
  for (int i = 0; i < 3; ++i) {
    c3de_sim before = 0, sim = 0;
    use(&options, argv[2]);
    check(c3de_embed_open(&options, &before));
    check(c3de_embed_open(&options, &sim)); /* two at the same time */
    check(c3de_embed_step(sim, 1, NULL));
    check(c3de_embed_close(before));
    check(c3de_embed_close(sim));
  }
  c3de_embed_options missing = {.size = sizeof missing, .file = "missing.toml"};
  c3de_sim none = 0;
  if (c3de_embed_open(&missing, &none) >= 0) failed = 1;
  return failed;
}
