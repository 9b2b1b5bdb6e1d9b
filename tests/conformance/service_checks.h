/* SPDX-License-Identifier: Apache-2.0 */
/* What the parts of the plugin service_driver share: comparisons of calls, in tables, and data for them. */
#ifndef C3DE_TEST_SERVICE_CHECKS_H
#define C3DE_TEST_SERVICE_CHECKS_H

#include "bad_plugins/minimal.h"

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter" /* most callbacks use few of theirs */
#endif

extern const c3de_host *host;

void compare_true(const char *file, int line, const char *condition, int value);
/* part: of the text of the error; empty: any. */
void compare(const char *file, int line, const char *call, c3de_status got, c3de_status expected, const char *part);
/* The table of a service, which must exist. */
const void *service(const char *id);

/* Tables: macro(service, common, row) for each row, at most 9. A call is a row (status without C3DE_, function,
 * arguments …). */
#define PICK(_1, _2, _3, _4, _5, _6, _7, _8, _9, chosen, ...) chosen
#define ROWS_1(m, t, c, row) m(t, c, row)
#define ROWS_2(m, t, c, row, ...) m(t, c, row) ROWS_1(m, t, c, __VA_ARGS__)
#define ROWS_3(m, t, c, row, ...) m(t, c, row) ROWS_2(m, t, c, __VA_ARGS__)
#define ROWS_4(m, t, c, row, ...) m(t, c, row) ROWS_3(m, t, c, __VA_ARGS__)
#define ROWS_5(m, t, c, row, ...) m(t, c, row) ROWS_4(m, t, c, __VA_ARGS__)
#define ROWS_6(m, t, c, row, ...) m(t, c, row) ROWS_5(m, t, c, __VA_ARGS__)
#define ROWS_7(m, t, c, row, ...) m(t, c, row) ROWS_6(m, t, c, __VA_ARGS__)
#define ROWS_8(m, t, c, row, ...) m(t, c, row) ROWS_7(m, t, c, __VA_ARGS__)
#define ROWS_9(m, t, c, row, ...) m(t, c, row) ROWS_8(m, t, c, __VA_ARGS__)
#define ROWS(m, t, c, ...)                                                                     \
  PICK(__VA_ARGS__, ROWS_9, ROWS_8, ROWS_7, ROWS_6, ROWS_5, ROWS_4, ROWS_3, ROWS_2, ROWS_1, 0) \
  (m, t, c, __VA_ARGS__)
#define UNPACK(...) __VA_ARGS__
#define COMPARE_OF(t, text, part, status, function, ...) \
  compare(__FILE__, __LINE__, text, t->function(t->ctx, __VA_ARGS__), C3DE_##status, part)
#define COMPARE(...) COMPARE_OF(__VA_ARGS__)
#define COMPARE_ROW(t, part, call) COMPARE(t, #t "->" #call, part, UNPACK call);
#define CHANGE_OF(t, call, member, value, part)                             \
  do {                                                                      \
    char kept[sizeof(member)];                                              \
    memcpy(kept, &(member), sizeof kept);                                   \
    (member) = value;                                                       \
    COMPARE(t, #t "->" #call ", " #member " = " #value, part, UNPACK call); \
    memcpy(&(member), kept, sizeof kept);                                   \
  } while (0);
#define CHANGE(...) CHANGE_OF(__VA_ARGS__)
#define CHANGE_ROW(t, call, change) CHANGE(t, call, UNPACK change)

/* The calls of the service one after another. */
#define GIVES(service, ...) ROWS(COMPARE_ROW, service, "", __VA_ARGS__)
/* A call that is refused, with the part in the text of the error. */
#define SAYS(service, part, call) COMPARE_ROW(service, part, call)
/* The call with each change (member, value, part of the text or ""), which is then undone. */
#define CHANGED(service, call, ...) ROWS(CHANGE_ROW, service, call, __VA_ARGS__)
#define RETURNS(status, call) compare(__FILE__, __LINE__, #call, (call), (status), "")
#define HOLDS(condition) compare_true(__FILE__, __LINE__, #condition, (condition) != 0)

/* ---- data that several services want ---- */

static const double kCorners[] = {0, 0, 0, 10, 0, 0, 0, 10, 0, 0, 0, 10};
static const uint32_t kFaces[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
static const uint32_t kFacesOutOfRange[] = {0, 2, 1, 0, 1, 4};
static const c3de_view faces = {kFaces, 4, 3, C3DE_U32, 0}, far_faces = {kFacesOutOfRange, 2, 3, C3DE_U32, 0};
static const c3de_view corners = {kCorners, 4, 3, C3DE_F64, 0}, three_corners = {kCorners, 3, 3, C3DE_F64, 0};
static const c3de_handle kNone = {0};
static const c3de_handle kNoSuch = {(UINT64_C(77) << 32) | 9999};
static const c3de_sink no_sink = {NULL, NULL};

static inline c3de_view points_of(const double *data, uint64_t count) {
  c3de_view v = {data, count, 3, C3DE_F64, 0};
  return v;
}
static inline c3de_handle handle_of(uint64_t v) {
  c3de_handle h = {v};
  return h;
}
static inline int is_text(c3de_str s, const char *expected) {
  return s.len == strlen(expected) && memcmp(s.ptr, expected, strlen(expected)) == 0;
}
static inline c3de_status C3DE_CALL count_bytes(void *self, const void *bytes, uint64_t n) {
  *(uint64_t *)self += n;
  return C3DE_OK;
}
static inline void C3DE_CALL count_call(void *self) { ++*(int *)self; }

/* ---- the services ---- */

void drive_log(void);
void drive_registry(void);
void drive_mesh(void);
void drive_scene(void);
void drive_render(void);
void drive_collision(void);
void drive_params(void);
void drive_panels(void);
void drive_tools(void);
void drive_history(void);
void drive_history_after(void);
void drive_history_capture(void);
void drive_history_captured(void);
void drive_jobs(void);
void drive_time(void);
void drive_simulation(c3de_handle node);
void drive_kinds(c3de_handle node);
void drive_forces(c3de_handle node);
void drive_imaging(void);
void drive_imaging_of_what_is_gone(void);
void drive_imaging_without_a_store(void);
void drive_wrong_thread(void);
void drive_files(void);
void drive_settings(void);
void drive_commands(void);

#endif
