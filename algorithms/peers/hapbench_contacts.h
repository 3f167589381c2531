#ifndef HAPBENCH_CONTACTS_H
#define HAPBENCH_CONTACTS_H

#include <stddef.h>
#include <stdint.h>

/* A source of contacts from outside, in C11 or any language that can speak C: another collision library that answers
 * which contacts a tool in a given pose has with an environment. A shared library defines `hapbench_contacts`;
 *
 *     "rendering": {"contact_source": {"type": "plugin", "file": "libmine.so", "config": {...}}}
 *
 * in a scenario then feeds the laws with its contacts.
 *
 * Ownership: what `create` returns belongs to the caller until `destroy`. All other memory belongs to the side that
 * allocated it, and pointers that are handed over are valid during the call only, so `create` copies what it keeps.
 * Threads: functions may be called from several threads at once, those of one source by one thread at a time.
 * Faults: nothing may be thrown. A function that fails writes why, as a text of one line that ends with 0, into
 * `fault`, which has room for `fault_size` > 0 characters. Queries may allocate. */

#define HAPBENCH_CONTACTS_VERSION 2u

#ifdef __cplusplus
extern "C" {
#endif

/* The environment as triangles, where it is a block_with_hole or a mesh; else its points alone. */
typedef struct HapbenchSurface {
  const double* vertices; /* x, y, z of each [m] */
  size_t vertex_count;
  const uint32_t* triangles; /* three vertices of each, counter-clockwise from outside */
  size_t triangle_count;
} HapbenchSurface;

/* The tool: a cylinder with a flat tip, or another of which only the width is told. */
typedef struct HapbenchTool {
  double radius; /* half the width [m] */
  double length; /* of a cylinder with a flat tip, else 0 [m] */
} HapbenchTool;

typedef struct HapbenchPose {
  double tip[3];      /* tip centre: the flat's middle, the centre of a round tip or a bur's ball [m] */
  double centre[3];   /* middle of the cylinder's axis; the tip centre of other tools [m] */
  double rotation[9]; /* tool to world, row by row; its z points from the tip to the shank */
} HapbenchPose;

typedef struct HapbenchContact {
  uint32_t index;     /* of the triangle or the vertex, the same from pose to pose */
  double point[3];    /* [m] */
  double gradient[3]; /* unit vector along which the tool gets deeper */
  double depth;       /* >= 0 [m] */
} HapbenchContact;

typedef struct HapbenchContactSource {
  uint32_t version; /* HAPBENCH_CONTACTS_VERSION */
  const char* name;

  /* A source for one run, with its structure over the surface; may take seconds. `config` is the scenario's object of
   * that name as JSON text, "{}" without one. NULL: a fault. */
  void* (*create)(const char* config, const HapbenchSurface* surface, const HapbenchTool* tool, char* fault,
                  size_t fault_size);
  void (*destroy)(void* source);

  /* Writes the contacts at the pose, at most `room` of them, and returns their number; negative: a fault. So is a
   * number above `room`, and a contact that is not finite, whose gradient is not of length 1 within 0.001, or whose
   * depth is negative. The answer depends on the pose alone and not on earlier queries. */
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
