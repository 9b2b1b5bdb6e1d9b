/* SPDX-License-Identifier: Apache-2.0 */
/* Images and label maps of the workstation, to be read. World space is LPS, right-handed, millimetres; a whole index is
 * the middle of its voxel, i runs fastest. Images lie as they were scanned: where the material of a deformed body was
 * then says displacement() of the simulator's interface. What is stored never changes; the workstation may take it away
 * at any time, and its handle is stale from then on. */
#ifndef C3DE_ABI_IMAGING_H
#define C3DE_ABI_IMAGING_H

#include "base.h"

#define C3DE_IMAGING_ID "c3de.imaging/1"

typedef struct c3de_image_info {
  uint32_t size;
  uint32_t reserved;
  c3de_str name;               /* for people; valid until the plugin is destroyed */
  c3de_str unit;               /* of values: "HU"; empty when the file does not say; valid as long */
  uint64_t points[3];          /* voxels along i, j, k; each at least 1 */
  double world_from_index[16]; /* column-major, affine; mm from voxels; shear and either handedness are possible */
  double min, max;             /* of the values, without what is not finite */
  double low, high;            /* without the lowest and highest thousandth of the voxels; low < high */
} c3de_image_info;

typedef struct c3de_label_map_info {
  uint32_t size;
  uint32_t reserved;
  c3de_str name; /* valid until the plugin is destroyed */
  uint64_t points[3];
  double world_from_index[16]; /* as in c3de_image_info; need not be that of any image */
  uint64_t labels;             /* how many there are, without the background */
} c3de_label_map_info;

typedef struct c3de_label {
  uint32_t size;
  uint32_t value;  /* 1 ... 65535 */
  c3de_str name;   /* "label 7" when nobody named it; valid during the call */
  float colour[3]; /* linear red, green, blue, 0 ... 1 */
  uint32_t reserved;
} c3de_label;

typedef struct c3de_imaging_v1 {
  uint32_t size;
  uint32_t rev;
  void *ctx;
  /* Up to capacity handles, always in the same order; *needed is how many images there are. C3DE_S_TRUNCATED if more
   * than capacity; out may be null when that is 0. [any] */
  c3de_status(C3DE_CALL *images)(void *ctx, c3de_handle *out, uint64_t capacity, uint64_t *needed);
  c3de_status(C3DE_CALL *image_info)(void *ctx, c3de_handle image, c3de_image_info *out); /* [any] */
  /* Rescaled values, linear between the middles of voxels. points: comps 3, f64, mm, world; out: f64, comps 1, as many
   * rows. A point in the outer half of a border voxel has the value of the border; one outside of all voxels gets
   * `outside`, which may be NaN. [any] */
  c3de_status(C3DE_CALL *sample)(void *ctx, c3de_handle image, c3de_view points_mm, double outside, c3de_mview out);
  /* As images(). [any] */
  c3de_status(C3DE_CALL *label_maps)(void *ctx, c3de_handle *out, uint64_t capacity, uint64_t *needed);
  c3de_status(C3DE_CALL *label_map_info)(void *ctx, c3de_handle map, c3de_label_map_info *out); /* [any] */
  /* The label of the nearest voxel, 0 for background and outside. points as in sample; out: u32, comps 1. [any] */
  c3de_status(C3DE_CALL *labels_at)(void *ctx, c3de_handle map, c3de_view points_mm, c3de_mview out);
  /* Calls each() for every label that occurs, by value, without the background, until each() returns something other
   * than C3DE_OK, which is returned. [any] */
  c3de_status(C3DE_CALL *enum_labels)(void *ctx, c3de_handle map, void *self,
                                      c3de_status(C3DE_CALL *each)(void *self, const c3de_label *label));
} c3de_imaging_v1;

#endif
