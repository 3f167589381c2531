#ifndef HAPBENCH_FORCE_STAGE_H
#define HAPBENCH_FORCE_STAGE_H

#include <stddef.h>
#include <stdint.h>

/* A force stage from outside, in C11 or any language that can speak C: it sees the force that a law with its damping,
 * friction and limits would render, and answers the force to render in its place. A shared library defines
 * `hapbench_force_stage`;
 *
 *     "rendering": {"force_stage": {"type": "plugin", "file": "libmine.so", "config": {...}}}
 *
 * in a scenario then runs it in every row, in free air, too, behind any algorithm and before the passivity controller.
 * Units N, m, s, J; vectors in world coordinates.
 *
 * Ownership: what `create` returns belongs to the caller until `destroy`. All other memory belongs to the side that
 * allocated it, and pointers that are handed over are valid during the call only, so `create` copies what it keeps.
 * Threads: functions may be called from several threads at once, those of one stage by one thread at a time.
 * Faults: nothing may be thrown. A function that fails writes why, as a text of one line that ends with 0, into
 * `fault`, which has room for `fault_size` > 0 characters. `force` should not allocate. */

#define HAPBENCH_FORCE_STAGE_VERSION 1u

#ifdef __cplusplus
extern "C" {
#endif

/* The run that a stage is for. */
typedef struct HapbenchStageRun {
  double time_step; /* of a row */
  double mass;      /* of the virtual tool [kg]; 0 where a device's handle or a script moves the tool */
  double stiffness; /* K of one penalty spring [N/m] */
} HapbenchStageRun;

/* A row of the run. */
typedef struct HapbenchStageStep {
  uint64_t row;
  double force[3];           /* that would be rendered without the stage */
  double spring[3];          /* f_spring, the law's part of it */
  double stiffness[6];       /* the law's tensor in units of K: xx, xy, xz, yy, yz, zz */
  double position[3];        /* of the tool's tip centre */
  double velocity[3];        /* of the tool */
  double device_position[3]; /* of the handle of an admittance or impedance device; of others that of the tool */
  double device_velocity[3];
  double device_force[3]; /* of the hand on the virtual tool, as the device measures and limits it; else 0 */
  /* What the stage has absorbed and can still give back [J], by the passivity observer: the energy of the springs in
   * the first row, less the work that its answers have done on the tool since. */
  double energy;
  uint32_t in_contact; /* 1 or 0 */
} HapbenchStageStep;

typedef struct HapbenchForceStage {
  uint32_t version; /* HAPBENCH_FORCE_STAGE_VERSION */
  const char* name;

  /* A stage for one run. `config` is the scenario's object of that name as JSON text, "{}" without one. NULL: a fault.
   */
  void* (*create)(const char* config, const HapbenchStageRun* run, char* fault, size_t fault_size);
  void (*destroy)(void* stage);
  void (*reset)(void* stage); /* back to t = 0, bit for bit; may be NULL: nothing is remembered */

  /* Writes the force to render, once for each row. Returns 0; else, and with a force that is not finite, the run ends.
   */
  int (*force)(void* stage, const HapbenchStageStep* step, double force[3], char* fault, size_t fault_size);
} HapbenchForceStage;

/* The one function that the library exports. `version` is the host's HAPBENCH_FORCE_STAGE_VERSION; NULL: not supported.
 * The result lives as long as the library. */
#if defined(__GNUC__)
__attribute__((visibility("default")))
#endif
const HapbenchForceStage*
hapbench_force_stage(uint32_t version);

#ifdef __cplusplus
}
#endif
#endif
