#ifndef HAPBENCH_PLUGIN_H
#define HAPBENCH_PLUGIN_H

#include <stddef.h>
#include <stdint.h>

/* A force law from outside, in C11 or any language that can speak C. A shared library defines `hapbench_plugin`;
 *
 *     hapbench --plugin ./libmy_law.so run drag_molar --set rendering.algorithm=my_law
 *
 * then has its law in every command. Units N, m. Functions may be called from several threads at once, those of one law
 * by one thread at a time. What is thrown counts as an error; `evaluate` and `springs` should not allocate. */

#define HAPBENCH_PLUGIN_VERSION 1u

#ifdef __cplusplus
extern "C" {
#endif

/* A parameter of the law: the field rendering.parameters.<law>.<name> of a scenario. Bounds are included. */
typedef struct HapbenchParameter {
  const char* name; /* letters, digits and "_", a small letter first */
  const char* unit; /* SI, as in "N/m"; "1" for none */
  double min, max;
  double initial; /* the default */
  const char* meaning;
} HapbenchParameter;

/* The contacts of a step, n > 0 entries in each array. Moving the tool along the gradient (unit vector) makes a contact
 * deeper; the penalty force on the tool of contact i alone is -K depth gradient. */
typedef struct HapbenchContacts {
  size_t n;
  const double* depth;        /* [m]; negative for some springs without a surface */
  const double *gx, *gy, *gz; /* gradient */
  const double *x, *y, *z;    /* colliding point, world [m] */
  const double *nx, *ny, *nz; /* outward normal of the environment there */
  const uint32_t* index;      /* of the point in its environment, the same from step to step */
} HapbenchContacts;

/* What a law that gives a force answers. */
typedef struct HapbenchForce {
  double force[3];     /* f_spring on the tool [N] */
  double stiffness[6]; /* tensor in units of K: xx, xy, xz, yy, yz, zz; damping, friction and integrators need it */
} HapbenchForce;

enum {
  HAPBENCH_WEIGHTS = 0, /* evaluate writes all n weights c_i: f = -K sum c_i d_i u_i, stiffness sum c_i u_i u_i^T */
  HAPBENCH_FORCE = 1    /* evaluate writes the answer; it may write the weights, by which contacts share the force */
};

typedef struct HapbenchPlugin {
  uint32_t version; /* HAPBENCH_PLUGIN_VERSION */
  uint32_t gives;   /* HAPBENCH_WEIGHTS or HAPBENCH_FORCE */

  /* What "hapbench describe" prints; none may be missing. */
  const char* name; /* as a parameter's */
  const char* summary;
  const char* formula;
  const char* source;        /* where it is published, or whose idea it is */
  const char* known_failure; /* where it loses */
  const HapbenchParameter* parameters;
  size_t parameter_count;

  /* The state of one run. `parameters` holds the values in the table's order, `stiffness` is K [N/m] of one penalty
   * spring, `capacity` the most contacts of a step. NULL: cannot be made. */
  void* (*create)(const double* parameters, double stiffness, size_t capacity);
  void (*destroy)(void* law); /* may be NULL */
  void (*reset)(void* law);   /* back to t = 0, bit for bit; may be NULL: nothing is remembered */

  /* One state of the tool; integrators may ask several times a step. `answer` is for HAPBENCH_FORCE only. Returns 0, or
   * the number of an error, which ends the run; so does what is not finite. */
  int (*evaluate)(void* law, const HapbenchContacts* contacts, double* weights, HapbenchForce* answer);
  const char* (*error_text)(void* law, int error); /* what such a number means; may be NULL */

  /* Elastic energy [J] behind the last evaluate, whose contacts are handed in, and its moment about the tip centre
   * [N m]. May be NULL: of weights 1/2 K sum c_i d_i^2 and each force at its point, else |f|^2 / 2K and f at the
   * weighted mean of the points. */
  void (*springs)(void* law, const HapbenchContacts* contacts, const double tip[3], double* energy, double moment[3]);
} HapbenchPlugin;

/* The one function that the library exports. `version` is the host's HAPBENCH_PLUGIN_VERSION; NULL: not supported. What
 * it returns lives as long as the library. */
#if defined(__GNUC__)
__attribute__((visibility("default")))
#endif
const HapbenchPlugin*
hapbench_plugin(uint32_t version);

#ifdef __cplusplus
}
#endif
#endif
