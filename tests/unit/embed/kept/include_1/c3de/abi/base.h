/* SPDX-License-Identifier: Apache-2.0 */
/* Basic types of the plugin boundary: status codes, strings, array views, handles.
 *
 * Rules that hold in every header of this folder:
 *  - C11 and C++20; fixed-width types; no bool, no enum-typed field, no size_t, no C++ type.
 *  - A struct that may grow begins with `uint32_t size`; new members go last and zero means "as before".
 *    One that may grow stands in no other by value.
 *    In-structs: the callee reads min(size, what it knows). Out-structs: the caller sets size, the callee writes that
 *    much. Arrays of structs come with a stride, 0 = tight in the size of who made them.
 *  - Strings and views are borrowed for the duration of the call unless the comment says otherwise.
 *  - Thread tags: [main] the thread of the window, [sim] the simulation's thread, [any] every thread, concurrently.
 *  - A function pointer of a table is never null for the revision that was asked for, unless its comment says that it
 *    may be.
 *  - No exception may leave a function that is called through this boundary. */
#ifndef C3DE_ABI_BASE_H
#define C3DE_ABI_BASE_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32)
#define C3DE_CALL __cdecl
#define C3DE_EXPORT_ATTR __declspec(dllexport)
#else
#define C3DE_CALL
#define C3DE_EXPORT_ATTR __attribute__((visibility("default")))
#endif

#if defined(__cplusplus)
#define C3DE_EXTERN_C extern "C"
#else
#define C3DE_EXTERN_C
#endif
#define C3DE_EXPORT C3DE_EXTERN_C C3DE_EXPORT_ATTR

/* Number of the boundary itself (entry, calling rules, this file); not the product's version. */
#define C3DE_ABI_MAJOR 1u
#define C3DE_ABI_MINOR 0u

/* 0 done; > 0 done, with a remark; < 0 not done. */
typedef int32_t c3de_status;
#define C3DE_OK ((c3de_status)0)
#define C3DE_S_TRUNCATED ((c3de_status)1)    /* the result did not fit; what fitted was written */
#define C3DE_E_ARG ((c3de_status)-1)         /* an argument is outside what is accepted */
#define C3DE_E_VERSION ((c3de_status)-2)     /* ABI or service revision too old or too new */
#define C3DE_E_UNSUPPORTED ((c3de_status)-3) /* known, but not offered here */
#define C3DE_E_EXISTS ((c3de_status)-4)      /* the id is taken */
#define C3DE_E_NOT_FOUND ((c3de_status)-5)
#define C3DE_E_STALE ((c3de_status)-6)  /* the handle's object is gone */
#define C3DE_E_STATE ((c3de_status)-7)  /* not in this state */
#define C3DE_E_THREAD ((c3de_status)-8) /* not on this thread */
#define C3DE_E_NOMEM ((c3de_status)-9)
#define C3DE_E_IO ((c3de_status)-10)
#define C3DE_E_FORMAT ((c3de_status)-11) /* a file or text is malformed */
#define C3DE_E_CANCELLED ((c3de_status)-12)
#define C3DE_E_TIMEOUT ((c3de_status)-13)
#define C3DE_E_DIVERGED ((c3de_status)-14) /* the simulation left the finite numbers; the last good state is kept */
#define C3DE_E_GPU ((c3de_status)-15)
#define C3DE_E_EXCEPTION ((c3de_status)-16) /* an exception was caught at the boundary */
#define C3DE_E_INTERNAL ((c3de_status)-17)

/* Kind, index and generation of an object on the other side; 0 is none, and those of two kinds are never equal. A stale
 * handle answers C3DE_E_STALE. */
typedef struct c3de_handle {
  uint64_t v;
} c3de_handle;

/* UTF-8 text, not necessarily terminated by a zero byte. */
typedef struct c3de_str {
  const char *ptr;
  uint64_t len;
} c3de_str;

#define C3DE_F32 1u
#define C3DE_F64 2u
#define C3DE_U8 3u
#define C3DE_I32 4u
#define C3DE_U32 5u
#define C3DE_U64 6u

/* A borrowed array of `count` rows of `comps` numbers; `stride` is the distance of rows in bytes, 0 = tight.
 * Positions have comps = 3; 3x3 matrices comps = 9 and 4x4 comps = 16, both column-major. */
typedef struct c3de_view {
  const void *data;
  uint64_t count;
  uint32_t comps;
  uint32_t dtype;
  int64_t stride;
} c3de_view;

typedef struct c3de_mview {
  void *data;
  uint64_t count;
  uint32_t comps;
  uint32_t dtype;
  int64_t stride;
} c3de_mview;

/* Where text of unknown length goes: `put` may be called several times, in order. */
typedef struct c3de_sink {
  void *self;
  c3de_status(C3DE_CALL *put)(void *self, const void *bytes, uint64_t n);
} c3de_sink;

/* True if the growable struct of type T at p reaches as far as the member. */
#define C3DE_HAS(T, p, member) ((p)->size >= offsetof(T, member) + sizeof(((const T *)0)->member))

#endif
