#ifndef HAPBENCH_MODULE_H
#define HAPBENCH_MODULE_H

#include <stddef.h>
#include <stdint.h>

/* C11 interface for force laws and contact sources outside hapbench, in C or any language that can export C functions.
 * A module is a shared library that exports the function `hapbench_module`. A module with a law is loaded by option,
 *
 *     hapbench --module ./my_law.so run drag_molar --set rendering.algorithm=my_law
 *
 * and a module with a contact source is named in a scenario; its contacts are the input of the laws:
 *
 *     "rendering": {"contact_source": {"type": "plugin", "file": "mine.so", "config": {...}}}
 *
 * Units: N, m. Functions may be called from several threads at the same time, but functions with the same state are
 * called by one thread at a time. Pointers passed to a function are valid during the call only.
 *
 * A function that fails writes the reason into `fault`: one line of text, terminated by 0. `fault` has room for
 * HAPBENCH_FAULT_SIZE characters and contains an empty text at the call. An exception is also a fault, and so is a
 * result that is not finite. A fault ends the run. */

#define HAPBENCH_MODULE_VERSION 1u
#define HAPBENCH_FAULT_SIZE 200

#ifdef __cplusplus
extern "C" {
#endif

enum { HAPBENCH_LAW = 1, HAPBENCH_CONTACTS = 2 };

/* A parameter of a law. A scenario sets it in the field rendering.parameters.<law>.<name>. The values `min` and `max`
 * are allowed. */
typedef struct HapbenchParameter {
  const char* name; /* letters, digits and "_"; begins with a small letter */
  const char* unit; /* SI unit such as "N/m"; "1" if dimensionless */
  double min, max;
  double initial; /* default value */
  const char* meaning;
} HapbenchParameter;

/* Input of `create`. For a law, all fields of environment and tool are 0 or NULL. */
typedef struct HapbenchRun {
  const void* data;       /* HapbenchModule::data */
  double stiffness;       /* K of one penalty spring [N/m] */
  size_t capacity;        /* largest number of contacts in a step */
  const double* vertices; /* vertices of the environment: x, y, z of each vertex [m] */
  size_t vertex_count;
  /* triangles of a block_with_hole or a mesh: three vertex indices each, counter-clockwise seen from outside */
  const uint32_t* triangles;
  size_t triangle_count;
  double tool_radius; /* half of the tool's width [m] */
  double tool_length; /* length of a cylinder with a flat tip [m]; 0 for other tools */
} HapbenchRun;

/* Pose of the tool, world frame. */
typedef struct HapbenchPose {
  double tip[3];      /* tip centre [m]: centre of a flat tip, of a round tip or of a bur's ball */
  double centre[3];   /* middle of the cylinder's axis [m]; for other tools the tip centre */
  double rotation[9]; /* matrix from tool frame to world frame, row by row; the tool's z axis points to the shank */
} HapbenchPose;

/* The contacts of a step; n entries in each array. The gradient is the unit vector along which the tool gets deeper. If
 * contact i were the only contact, the penalty force on the tool would be -K depth gradient. A law receives n > 0
 * contacts and writes the weights only: its arrays are copies, and a change of n or of another array is a fault. A
 * contact source writes n and all arrays except normals and weights, which are NULL. */
typedef struct HapbenchContacts {
  size_t n;
  size_t room;                /* capacity of the arrays */
  uint32_t* index;            /* number of the point, vertex or triangle; never changes during a run */
  double* depth;              /* penetration depth >= 0 [m]; negative only for bilateral springs */
  double *gx, *gy, *gz;       /* gradient, unit vector */
  double *x, *y, *z;          /* colliding point, world [m] */
  const double *nx, *ny, *nz; /* outward normal of the environment at this point */
  double* weight;             /* c_i, weight of the contact's spring, dimensionless */
} HapbenchContacts;

/* The result of a law. By default, hapbench computes it from the weights: force -K sum c_i d_i u_i and stiffness tensor
 * sum c_i u_i u_i^T, with depths d_i and gradients u_i. A law that sets `given` writes force and stiffness itself. Then
 * the weights, if it writes them, are the contacts' shares of the force, and energy and moment are computed for one
 * spring of stiffness K at the weighted mean of the points. */
typedef struct HapbenchForce {
  int given;           /* 0 at the call; nonzero: force and stiffness are written */
  double force[3];     /* f_spring on the tool [N] */
  double stiffness[6]; /* tensor in units of K: xx, xy, xz, yy, yz, zz; damping, friction and integrators need it */
} HapbenchForce;

typedef struct HapbenchModule {
  uint32_t version; /* HAPBENCH_MODULE_VERSION */
  uint32_t kind;    /* HAPBENCH_LAW or HAPBENCH_CONTACTS */

  const char* name; /* same characters as a parameter's name */
  /* Texts that "hapbench describe" prints. A law must have all of them. */
  const char* summary;
  const char* formula;
  const char* source;        /* publication or author */
  const char* known_failure; /* known weakness */
  const HapbenchParameter* parameters;
  size_t parameter_count;
  const void* data; /* for use by `create`; hapbench does not read it */

  /* Creates the state of one run. A contact source may take seconds for this. `values`: parameter values, in the order
   * of `parameters`. `config`: the scenario's object "config" as JSON text; "{}" for a law or without this object.
   * Returning NULL is a fault. If this function is NULL, the state is NULL. */
  void* (*create)(const double* values, const char* config, const HapbenchRun* run, char* fault);

  /* Evaluates one pose of the tool. Integrators may call this function several times in a step. For a law, `pose` is
   * NULL, and the function should not allocate. For a contact source, `force` is NULL, and its contacts must depend on
   * the pose only. Returns 0; any other value and a text in `fault` are faults. */
  int (*step)(void* state, const HapbenchPose* pose, HapbenchContacts* contacts, HapbenchForce* force, char* fault);

  void (*reset)(void* state);   /* restores the state after `create`, bitwise; NULL if the state never changes */
  void (*destroy)(void* state); /* frees the state; may be NULL */
} HapbenchModule;

/* The only function that the library exports. `version`: HAPBENCH_MODULE_VERSION of the calling program. Returns the
 * table, which must stay valid as long as the library is loaded, or NULL if this version is not supported. */
#if defined(__GNUC__)
__attribute__((visibility("default")))
#endif
const HapbenchModule*
hapbench_module(uint32_t version);

#ifdef __cplusplus
}
#endif
#endif
