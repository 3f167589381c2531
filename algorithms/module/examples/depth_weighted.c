/* A force law in C: weights proportional to a power of the depth. Build and run from the root of hapbench's tree:
 *
 *     gcc -std=c11 -O2 -fPIC -shared -Ialgorithms/module algorithms/module/examples/depth_weighted.c -lm -o law.so
 *     hapbench --module ./law.so compare peg_in_hole_2d_shaped_stiffness
 *
 * With hapbench installed: use -IPREFIX/include; if PREFIX is /usr, no -I is needed. */
#include <hapbench_module.h>
#include <math.h>
#include <stdlib.h>

static void* create(const double* values, const char* config, const HapbenchRun* run, char* fault) {
  double* power = malloc(sizeof *power);
  if (power != NULL) *power = values[0];
  return power;
}

static int step(void* power, const HapbenchPose* pose, HapbenchContacts* c, HapbenchForce* force, char* fault) {
  double sum = 0.0;
  for (size_t i = 0; i < c->n; ++i) sum += c->weight[i] = pow(fabs(c->depth[i]), *(double*)power);
  for (size_t i = 0; i < c->n; ++i) c->weight[i] = sum > 0.0 ? c->weight[i] / sum : 1.0 / (double)c->n;
  return 0;
}

const HapbenchModule* hapbench_module(uint32_t version) {
  static const HapbenchParameter power = {"power", "1", 0.0, 8.0, 1.0, "p of the weights"};
  static const HapbenchModule module = {.version = HAPBENCH_MODULE_VERSION,
                                        .kind = HAPBENCH_LAW,
                                        .name = "depth_weighted",
                                        .summary = "penalty springs averaged by a power of their depths",
                                        .formula = "c_i = |d_i|^p / sum_j |d_j|^p",
                                        .source = "example of hapbench_module.h",
                                        .known_failure = "turns from step to step where two contacts are equally deep",
                                        .parameters = &power,
                                        .parameter_count = 1,
                                        .create = create,
                                        .step = step,
                                        .destroy = free};
  return version == HAPBENCH_MODULE_VERSION ? &module : NULL;
}
