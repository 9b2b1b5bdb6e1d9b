/* SPDX-License-Identifier: Apache-2.0 */
/* Images and label maps. */
#include <math.h>

#include "service_checks.h"

/* ---- imaging: the store has what test_services.cpp puts there ---- */

static c3de_status C3DE_CALL sum_labels(void *self, const c3de_label *label) {
  HOLDS(label->size >= sizeof *label);
  if (label->value == 3) HOLDS(is_text(label->name, "liver"));
  if (label->value == 3) HOLDS(label->colour[0] == 0.5f && label->colour[1] == 0.25f);
  *(uint32_t *)self += label->value;
  return C3DE_OK;
}
static c3de_status C3DE_CALL stop_at_label(void *self, const c3de_label *label) {
  *(uint32_t *)self += label->value;
  return C3DE_E_CANCELLED;
}

static c3de_handle kept_image, kept_map;

static void drive_samples(const c3de_imaging_v1 *imaging, c3de_handle image) {
  /* World of index (i, j, k): (10 + 3 j, 20 + 2 i + k, 30 + 4 k); value: 2 (5 + i + 10 j + 100 k) - 100. */
  const double at[] = {10,    20,     30, /* voxel 0 0 0 */
                       19,    28,     46, /* voxel 2 3 4 */
                       11.5,  22.75,  33, /* index 1 0.5 0.75 */
                       8.8,   19.2,   30, /* index -0.4 -0.4 0: the border goes on */
                       8.2,   20,     30, /* index 0 -0.6 0: outside */
                       1e300, -1e300, 0};
  const double expected[] = {-90, 774, 72, -90, -7, -7}, nowhere[] = {0, NAN, 0};
  const c3de_view six = points_of(at, 6);
  double values[12];
  for (int i = 0; i < 12; ++i) values[i] = 1234.0;
  c3de_mview out = {values, 6, 1, C3DE_F64, 16}; /* every other number */
  GIVES(imaging, (OK, sample, image, six, -7.0, out));
  for (int i = 0; i < 6; ++i) {
    HOLDS(fabs(values[2 * i] - expected[i]) < 1e-9); /* rounding of numbers up to 1000 */
    HOLDS(values[2 * i + 1] == 1234.0);
  }
  const c3de_mview one = {values, 1, 1, C3DE_F64, 0}, none = {NULL, 0, 1, C3DE_F64, 0};
  GIVES(imaging, (OK, sample, image, points_of(at + 12, 1), NAN, one));
  HOLDS(isnan(values[0]));
  GIVES(imaging, (OK, sample, image, points_of(NULL, 0), 0.0, none), (E_STALE, sample, kNoSuch, six, -7.0, out));
  SAYS(imaging, "points_mm is null", (E_ARG, sample, image, points_of(NULL, 6), -7.0, out));
  SAYS(imaging, "row 0 is not finite", (E_ARG, sample, image, points_of(nowhere, 1), -7.0, one));
  CHANGED(imaging, (E_ARG, sample, image, six, -7.0, out), (out.count, 5, "room for 5 rows, there are 6"),
          (out.dtype, C3DE_F32, ""), (out.data, NULL, "out is null"));
}

static void drive_images(const c3de_imaging_v1 *imaging) {
  c3de_handle found[4] = {{0}, {0}, {0}, {0}};
  uint64_t needed = 0;
  GIVES(imaging, (S_TRUNCATED, images, NULL, 0, &needed));
  HOLDS(needed == 2);
  GIVES(imaging, (S_TRUNCATED, images, found, 1, &needed));
  HOLDS(found[0].v != 0 && found[1].v == 0 && needed == 2);
  GIVES(imaging, (OK, images, found, 4, &needed));
  HOLDS(found[1].v != 0 && found[0].v != found[1].v && found[2].v == 0 && needed == 2);
  GIVES(imaging, (E_ARG, images, NULL, 1, &needed));
  SAYS(imaging, "needed is null", (E_ARG, images, found, 4, NULL));
  const c3de_handle image = kept_image = found[0];

  c3de_image_info info = {.size = sizeof info};
  GIVES(imaging, (OK, image_info, image, &info));
  HOLDS(info.size == sizeof info && is_text(info.name, "phantom"));
  HOLDS(is_text(info.unit, "HU"));
  HOLDS(info.points[0] == 3 && info.points[1] == 4 && info.points[2] == 5);
  HOLDS(info.world_from_index[1] == 2.0 && info.world_from_index[4] == 3.0 && info.world_from_index[14] == 30.0);
  HOLDS(info.min == -90.0 && info.max == 800.0 && info.low == -50.0 && info.high == 700.0);
  CHANGED(imaging, (E_ARG, image_info, image, &info), (info.size, 8, "size is 8"));
  GIVES(imaging, (E_ARG, image_info, image, NULL));
  SAYS(imaging, "no image of handle", (E_STALE, image_info, kNoSuch, &info));
  GIVES(imaging, (E_STALE, image_info, kNone, &info));
  drive_samples(imaging, image);
}

static void drive_label_maps(const c3de_imaging_v1 *imaging) {
  c3de_handle map = {0};
  uint64_t needed = 0;
  GIVES(imaging, (OK, label_maps, &map, 1, &needed));
  HOLDS(needed == 1 && map.v != 0);
  GIVES(imaging, (E_ARG, label_maps, NULL, 1, &needed), (E_ARG, label_maps, &map, 1, NULL));
  kept_map = map;

  c3de_label_map_info info = {.size = sizeof info};
  GIVES(imaging, (OK, label_map_info, map, &info));
  HOLDS(is_text(info.name, "organs") && info.labels == 2);
  HOLDS(info.points[0] == 2 && info.points[1] == 1 && info.points[2] == 1 && info.world_from_index[0] == 10.0);
  GIVES(imaging, (E_ARG, label_map_info, map, NULL));
  SAYS(imaging, "no label map of handle", (E_STALE, label_map_info, kNoSuch, &info));

  const double at[] = {4.9, -4.9, 4.9, 5.1, 0, 0, 15.1, 0, 0, 0, 5.1, 0};
  uint32_t labels[4] = {9, 9, 9, 9}, sum = 0, first = 0;
  c3de_mview out = {labels, 4, 1, C3DE_U32, 0};
  GIVES(imaging, (OK, labels_at, map, points_of(at, 4), out));
  HOLDS(labels[0] == 3 && labels[1] == 40000 && labels[2] == 0 && labels[3] == 0);
  GIVES(imaging, (E_STALE, labels_at, kNone, points_of(at, 4), out), (E_ARG, labels_at, map, points_of(NULL, 4), out),
        (E_ARG, labels_at, map, points_of(at, 3), out));
  CHANGED(imaging, (E_ARG, labels_at, map, points_of(at, 4), out), (out.dtype, C3DE_F64, "accepted: u32"),
          (out.data, NULL, ""));

  GIVES(imaging, (OK, enum_labels, map, &sum, sum_labels));
  HOLDS(sum == 40003);
  GIVES(imaging, (E_ARG, enum_labels, map, &sum, NULL), (E_STALE, enum_labels, kNoSuch, &sum, sum_labels));
  HOLDS(imaging->enum_labels(imaging->ctx, map, &first, stop_at_label) == C3DE_E_CANCELLED && first == 3);
}

void drive_imaging(void) {
  const c3de_imaging_v1 *imaging = service(C3DE_IMAGING_ID);
  HOLDS(imaging->size >= sizeof *imaging && imaging->rev == 1);
  drive_images(imaging);
  drive_label_maps(imaging);
}

void drive_imaging_of_what_is_gone(void) {
  const c3de_imaging_v1 *imaging = service(C3DE_IMAGING_ID);
  const double at[] = {10, 20, 30};
  double value = 0.0;
  uint32_t label = 0;
  uint64_t needed = 9;
  GIVES(imaging, (OK, images, NULL, 0, &needed));
  HOLDS(needed == 0);
  c3de_image_info info = {.size = sizeof info};
  HOLDS(kept_image.v != 0 && kept_map.v != 0);
  const c3de_mview value_out = {&value, 1, 1, C3DE_F64, 0}, label_out = {&label, 1, 1, C3DE_U32, 0};
  GIVES(imaging, (OK, label_maps, NULL, 0, &needed), (E_STALE, image_info, kept_image, &info),
        (E_STALE, sample, kept_image, points_of(at, 1), 0.0, value_out),
        (E_STALE, labels_at, kept_map, points_of(at, 1), label_out),
        (E_STALE, enum_labels, kept_map, &label, sum_labels));
}

void drive_imaging_without_a_store(void) {
  const void *table = NULL;
  SAYS(host, "it needs images", (E_UNSUPPORTED, get_service, text(C3DE_IMAGING_ID), 1, &table));
  HOLDS(table == NULL);
}
