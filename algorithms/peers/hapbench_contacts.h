#ifndef HAPBENCH_CONTACTS_H
#define HAPBENCH_CONTACTS_H

#include <stddef.h>
#include <stdint.h>

/* A source of contacts from outside, in C11 or any language that can speak C: another collision library that answers
 * which contacts a tool in a given pose has with an environment. A shared library defines `hapbench_contacts`.
 *
 * Ownership: what `create` returns belongs to the caller until `destroy`. All other memory belongs to the side that
 * allocated it, and pointers that are handed over are valid during the call only, so `create` copies what it keeps.
 * Threads: functions may be called from several threads at once, those of one source by one thread at a time.
 * Faults: nothing may be thrown. A function that fails writes why, as a text of one line that ends with 0, into
 * `fault`, which has room for `fault_size` > 0 characters. Queries may allocate. */

#define HAPBENCH_CONTACTS_VERSION 1u

#ifdef __cplusplus
extern "C" {
#endif

/* The environment as triangles. For a library that takes points, the vertices alone. */
typedef struct HapbenchSurface {
  const double* vertices; /* x, y, z of each [m] */
  size_t vertex_count;
  const uint32_t* triangles; /* three vertices of each, counter-clockwise from outside */
  size_t triangle_count;
} HapbenchSurface;

/* The tool: a cylinder with a flat tip. */
typedef struct HapbenchCylinder {
  double radius; /* [m] */
  double length; /* [m] */
} HapbenchCylinder;

typedef struct HapbenchPose {
  double centre[3];   /* middle of the cylinder's axis [m] */
  double rotation[9]; /* cylinder to world, row by row; its z points from the tip to the shank */
} HapbenchPose;

typedef struct HapbenchContact {
  uint32_t index;     /* of the triangle, or of the vertex */
  double point[3];    /* [m] */
  double gradient[3]; /* unit vector along which the tool gets deeper */
  double depth;       /* [m] */
} HapbenchContact;

typedef struct HapbenchContactSource {
  uint32_t version; /* HAPBENCH_CONTACTS_VERSION */
  const char* name;

  /* A source for one run, with its structure over the surface; may take seconds. NULL: a fault. */
  void* (*create)(const HapbenchSurface* surface, const HapbenchCylinder* tool, char* fault, size_t fault_size);
  void (*destroy)(void* source);

  /* Writes the contacts at the pose, at most `room` of them, and returns their number; negative: a fault. The answer
   * depends on the pose alone and not on earlier queries. */
  int64_t (*contacts_at)(void* source, const HapbenchPose* pose, HapbenchContact* contacts, size_t room, char* fault,
                         size_t fault_size);
} HapbenchContactSource;

/* The one function that the library exports. `version` is the host's HAPBENCH_CONTACTS_VERSION; NULL: not supported.
 * The result lives as long as the library. */
#if defined(__GNUC__)
__attribute__((visibility("default")))
#endif
const HapbenchContactSource*
hapbench_contacts(uint32_t version);

#ifdef __cplusplus
}
#endif
#endif
