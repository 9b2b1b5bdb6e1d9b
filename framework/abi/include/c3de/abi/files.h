/* SPDX-License-Identifier: Apache-2.0 */
/* Formats of files that a plugin brings. What it reads is checked, welded, oriented and reported like every mesh, and
 * scenes, the window's dialog and `c3de info` open it; what it writes is what *Export surface* and `c3de run` offer. */
#ifndef C3DE_ABI_FILES_H
#define C3DE_ABI_FILES_H

#include "base.h"
#include "jobs.h"
#include "mesh.h"

#define C3DE_FILES_ID "c3de.files/1"

/* A file to read. Valid during the call. */
typedef struct c3de_mesh_source {
  uint32_t size;
  uint32_t reserved;
  c3de_str path;     /* UTF-8; for messages, and for files that lie beside it */
  const void *bytes; /* all of it; no 0 follows */
  uint64_t bytes_n;  /* at least 1, at most 2^30 */
} c3de_mesh_source;

/* Where a reader puts what it finds; may be called any number of times, in any order. Valid during the call, on its
 * thread. What a function refuses ends the read: return its status. */
typedef struct c3de_mesh_sink {
  uint32_t size;
  uint32_t reserved;
  void *self;
  /* positions: comps 3, f32 or f64, finite, in the unit of the file; they follow those that were added before. */
  c3de_status(C3DE_CALL *add_vertices)(void *self, c3de_view positions);
  /* triangles: comps 3, u32, indices of vertices from 0, outwards by the right-hand rule where the file knows it. */
  c3de_status(C3DE_CALL *add_triangles)(void *self, c3de_view triangles);
  /* What the file says of its numbers: C3DE_UNIT_M, _MM or _CM. Without it: what the person says, else mm. */
  c3de_status(C3DE_CALL *set_unit)(void *self, uint32_t unit);
  /* A sentence for the mesh report: what was left out, what was assumed. */
  c3de_status(C3DE_CALL *note)(void *self, c3de_str sentence);
} c3de_mesh_sink;

typedef struct c3de_mesh_reader { /* copied, strings included */
  uint32_t size;
  uint32_t rev;
  c3de_str id;                /* for example "org.example.tetra"; what asks for it by name */
  c3de_str label;             /* shown to people: "Points and triangles" */
  const c3de_str *extensions; /* letters and digits without the dot: "tri"; at least one */
  uint64_t extensions_n;
  c3de_str magic; /* what its files begin with; empty: anything */
  void *self;
  /* Fails with a text (set_error) that says what is wrong with the file, in which line or byte; the host adds the names
   * of file, reader and plugin. progress is never null: ask it several times a second, and return C3DE_E_CANCELLED when
   * it does. [any] */
  c3de_status(C3DE_CALL *read)(void *self, const c3de_mesh_source *source, const c3de_progress *progress,
                               const c3de_mesh_sink *sink);
} c3de_mesh_reader;

/* A surface to write. Valid during the call. */
typedef struct c3de_mesh_contents {
  uint32_t size;
  uint32_t reserved;
  c3de_str name;          /* of the body, for people; may be empty */
  c3de_view positions_mm; /* comps 3, f64: LPS, at least 1 */
  c3de_view triangles;    /* comps 3, u32: indices of positions, outwards by the right-hand rule, at least 1 */
} c3de_mesh_contents;

typedef struct c3de_mesh_writer { /* copied, strings included */
  uint32_t size;
  uint32_t rev;
  c3de_str id;                /* for example "org.example.tetra" */
  c3de_str label;             /* shown to people: "Points and triangles" */
  const c3de_str *extensions; /* letters and digits without the dot: "tri"; at least one */
  uint64_t extensions_n;
  void *self;
  /* Puts the bytes of the file, in order, in as many pieces as it likes; the host writes it whole or not at all. Fails
   * with a text (set_error) that says why; the host adds the names of file, writer and plugin. Progress as of
   * c3de_mesh_reader. [any] */
  c3de_status(C3DE_CALL *write)(void *self, const c3de_mesh_contents *mesh, const c3de_progress *progress,
                                c3de_sink bytes);
} c3de_mesh_writer;

typedef struct c3de_files_v1 {
  uint32_t size;
  uint32_t rev; /* 2: has add_mesh_writer() */
  void *ctx;
  /* From now on such files are meshes. An extension that the host, or a reader before this one, has stays theirs: the
   * log names both, and this one reads such files where it is asked for by its id. C3DE_E_EXISTS: the id is taken. [any] */
  c3de_status(C3DE_CALL *add_mesh_reader)(void *ctx, const c3de_mesh_reader *reader, c3de_handle *out);
  /* A reader or writer. When this returns, read or write is not running (its progress said C3DE_E_CANCELLED) and will
   * not be called again. C3DE_E_STALE: it is gone already; C3DE_E_STATE: called from its read or write. [any] */
  c3de_status(C3DE_CALL *remove)(void *ctx, c3de_handle format);
  /* Since revision 2. From now on surfaces are exported as such files, too. An extension that the host, or a writer
   * before this one, has stays theirs; the log names both. C3DE_E_EXISTS: the id is taken by a writer. [any] */
  c3de_status(C3DE_CALL *add_mesh_writer)(void *ctx, const c3de_mesh_writer *writer, c3de_handle *out);
} c3de_files_v1;

#endif
