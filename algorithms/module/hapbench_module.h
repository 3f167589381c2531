#ifndef HAPBENCH_MODULE_H
#define HAPBENCH_MODULE_H

#include <stddef.h>
#include <stdint.h>

/* A force law or a source of contacts from outside, in C11 or any language that can speak C. A shared library defines
 * `hapbench_module`. Every command then has its law,
 *
 *     hapbench --module ./my_law.so run drag_molar --set rendering.algorithm=my_law
 *
 * or a scenario feeds the laws with its contacts:
 *
 *     "rendering": {"contact_source": {"type": "plugin", "file": "mine.so", "config": {...}}}
 *
 * Units N, m. Functions may be called from several threads at once, those of one state by one thread at a time.
 * Pointers that are handed over are valid during the call alone.
 *
 * A function that fails writes why, as a text of one line that ends with 0, into `fault`, which has room for
 * HAPBENCH_FAULT_SIZE characters and comes empty. What is thrown counts as a fault, and so does an answer that is not
 * finite. A fault ends the run. */

#define HAPBENCH_MODULE_VERSION 1u
#define HAPBENCH_FAULT_SIZE 200

#ifdef __cplusplus
extern "C" {
#endif

enum { HAPBENCH_LAW = 1, HAPBENCH_CONTACTS = 2 };

/* A parameter of a law: the field rendering.parameters.<law>.<name> of a scenario. Bounds are included. */
typedef struct HapbenchParameter {
  const char* name; /* letters, digits and "_", a small letter first */
  const char* unit; /* SI, as in "N/m"; "1" for none */
  double min, max;
  double initial; /* the default */
  const char* meaning;
} HapbenchParameter;

/* What a state is made for. A law is not told of environment and tool. */
typedef struct HapbenchRun {
  const void* data;       /* that of the module's table */
  double stiffness;       /* K of one penalty spring [N/m] */
  size_t capacity;        /* the most contacts of a step */
  const double* vertices; /* of the environment, x, y, z of each [m] */
  size_t vertex_count;
  const uint32_t* triangles; /* of a block_with_hole or a mesh: three vertices each, counter-clockwise from outside */
  size_t triangle_count;
  double tool_radius; /* half the tool's width [m] */
  double tool_length; /* of a cylinder with a flat tip, else 0 [m] */
} HapbenchRun;

typedef struct HapbenchPose {
  double tip[3];      /* tip centre: the flat's middle, the centre of a round tip or a bur's ball [m] */
  double centre[3];   /* middle of the cylinder's axis; the tip centre of other tools [m] */
  double rotation[9]; /* tool to world, row by row; its z points from the tip to the shank */
} HapbenchPose;

/* The contacts of a step, n entries in each array. Moving the tool along the gradient, a unit vector, makes a contact
 * deeper; the penalty force on the tool of contact i alone is -K depth gradient. A law gets n > 0 of them and writes
 * the weights alone. A source of contacts writes n and all arrays but normals and weights, which are NULL. */
typedef struct HapbenchContacts {
  size_t n;
  size_t room;                /* of the arrays */
  uint32_t* index;            /* of the point, vertex or triangle, the same from step to step */
  double* depth;              /* >= 0 [m]; negative for some springs without a surface */
  double *gx, *gy, *gz;       /* gradient */
  double *x, *y, *z;          /* colliding point, world [m] */
  const double *nx, *ny, *nz; /* outward normal of the environment there */
  double* weight;             /* c_i */
} HapbenchContacts;

/* The answer of a law. The weights tell force and stiffness, f = -K sum c_i d_i u_i and sum c_i u_i u_i^T, unless the
 * law sets `given` and writes both. Then weights, if it writes them, say how contacts share the force, and its energy
 * and moment are those of one spring of stiffness K at the weighted mean of the points. */
typedef struct HapbenchForce {
  int given;           /* comes as 0 */
  double force[3];     /* f_spring on the tool [N] */
  double stiffness[6]; /* tensor in units of K: xx, xy, xz, yy, yz, zz; damping, friction and integrators need it */
} HapbenchForce;

typedef struct HapbenchModule {
  uint32_t version; /* HAPBENCH_MODULE_VERSION */
  uint32_t kind;    /* HAPBENCH_LAW or HAPBENCH_CONTACTS */

  const char* name; /* as a parameter's */
  /* What "hapbench describe" prints of a law, for which none may be missing. */
  const char* summary;
  const char* formula;
  const char* source;        /* where it is published, or whose idea it is */
  const char* known_failure; /* where it loses */
  const HapbenchParameter* parameters;
  size_t parameter_count;
  const void* data; /* the module's own, for `create` */

  /* The state of one run; contacts may take seconds for it. `values` are those of the parameters in their order;
   * `config` is the scenario's object of that name as JSON text, "{}" without one and for a law. NULL: a fault. Without
   * this function the state is NULL. */
  void* (*create)(const double* values, const char* config, const HapbenchRun* run, char* fault);

  /* One pose of the tool; integrators may ask several times a step. A law has pose NULL and should not allocate;
   * contacts have force NULL and depend on the pose alone. Returns 0; anything else is a fault. */
  int (*step)(void* state, const HapbenchPose* pose, HapbenchContacts* contacts, HapbenchForce* force, char* fault);

  void (*reset)(void* state);   /* back to t = 0, bit for bit; may be NULL: nothing is remembered */
  void (*destroy)(void* state); /* may be NULL */
} HapbenchModule;

/* The one function that the library exports. `version` is the host's HAPBENCH_MODULE_VERSION; NULL: not supported. What
 * it returns lives as long as the library. */
#if defined(__GNUC__)
__attribute__((visibility("default")))
#endif
const HapbenchModule*
hapbench_module(uint32_t version);

#ifdef __cplusplus
}
#endif
#endif
