/* The deepest contact alone: the law of contact_trace.md. */
#include <hapbench_module.h>

static int step(void* state, const HapbenchPose* pose, HapbenchContacts* c, HapbenchForce* force, char* fault) {
  size_t deepest = 0;
  for (size_t i = 0; i < c->n; ++i) {
    c->weight[i] = 0;
    if (c->depth[i] > c->depth[deepest]) deepest = i;
  }
  c->weight[deepest] = 1;
  return 0;
}

const HapbenchModule* hapbench_module(uint32_t version) {
  static const HapbenchModule module = {.version = HAPBENCH_MODULE_VERSION,
                                        .kind = HAPBENCH_LAW,
                                        .name = "deepest",
                                        .summary = "the spring of the deepest contact alone",
                                        .formula = "c_i = 1 for the deepest, 0 for the others",
                                        .source = "a tutorial",
                                        .known_failure = "the force jumps when another contact gets deepest",
                                        .step = step};
  return version == HAPBENCH_MODULE_VERSION ? &module : NULL;
}
