/* A force stage in C: takes the edge off a landing by a low-pass. A force that falls is followed at once.
 *
 *     gcc -std=c11 -O2 -fPIC -shared -Ialgorithms/plugin algorithms/plugin/examples/soft_landing.c -lm -o soft.so
 *
 * and in a scenario "force_stage": {"type": "plugin", "file": "soft.so", "config": {"cutoff_Hz": 100}}. */
#include <hapbench_force_stage.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct Stage {
  double share, last[3];
} Stage;

static void* create(const char* config, const HapbenchStageRun* run, char* fault, size_t fault_size) {
  const char* field = strstr(config, "\"cutoff_Hz\":");
  Stage* stage = calloc(1, sizeof *stage);
  if (stage != NULL && field != NULL && sscanf(field, "\"cutoff_Hz\":%lf", &stage->share) == 1) {
    stage->share = 1.0 - exp(-6.283185307179586 * stage->share * run->time_step);
    return stage;
  }
  snprintf(fault, fault_size, "its config has no number cutoff_Hz");
  free(stage);
  return NULL;
}

static void reset(void* state) {
  memset(((Stage*)state)->last, 0, sizeof(double[3]));
}

static int force(void* state, const HapbenchStageStep* step, double out[3], char* fault, size_t fault_size) {
  Stage* stage = state;
  (void)fault, (void)fault_size;
  for (int k = 0; k < 3; ++k) {
    const double more = step->force[k] - stage->last[k];
    out[k] = stage->last[k] += fabs(step->force[k]) > fabs(stage->last[k]) ? stage->share * more : more;
  }
  return 0;
}

const HapbenchForceStage* hapbench_force_stage(uint32_t version) {
  static const HapbenchForceStage stage = {HAPBENCH_FORCE_STAGE_VERSION, "soft_landing", create, free, reset, force};
  return version == HAPBENCH_FORCE_STAGE_VERSION ? &stage : NULL;
}
