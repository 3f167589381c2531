/* A force law in C: contacts weigh by a power of their depth.
 *
 *     gcc -std=c11 -O2 -fPIC -shared -Ialgorithms/plugin \
 *         algorithms/plugin/examples/depth_weighted.c -lm -o depth_weighted.so
 *     hapbench --plugin ./depth_weighted.so compare peg_in_hole_2d_shaped_stiffness
 *
 * is for the root of hapbench's tree. With hapbench installed the header is in PREFIX/include: -IPREFIX/include, or
 * no -I where PREFIX is /usr.
 *
 * Weights that add up to 1 make a force that is no larger than K times the deepest depth. */
#include <hapbench_plugin.h>
#include <math.h>
#include <stdlib.h>

typedef struct Law {
  double power;
} Law;

static const HapbenchParameter parameters[] = {
    {.name = "power", .unit = "1", .min = 0.0, .max = 64.0, .initial = 1.0, .meaning = "p of the weights"},
};

static void* create(const double* values, double stiffness, size_t capacity) {
  (void)stiffness; /* the weights do not depend on K */
  (void)capacity;
  Law* law = malloc(sizeof *law);
  if (law != NULL) law->power = values[0];
  return law;
}

static int evaluate(void* state, const HapbenchContacts* contacts, double* weights, HapbenchForce* answer) {
  const Law* law = state;
  const double p = law->power;
  double deepest = 0.0, sum = 0.0;
  (void)answer; /* of laws that give a force */
  for (size_t i = 0; i < contacts->n; ++i) deepest = fmax(deepest, fabs(contacts->depth[i]));
  for (size_t i = 0; i < contacts->n; ++i) {
    /* In parts of the deepest, so that no power leaves the numbers; contacts that only touch weigh the same. */
    weights[i] = deepest > 0.0 ? pow(fabs(contacts->depth[i]) / deepest, p) : 1.0;
    sum += weights[i];
  }
  for (size_t i = 0; i < contacts->n; ++i) weights[i] /= sum;
  return 0;
}

static const HapbenchPlugin plugin = {
    .version = HAPBENCH_PLUGIN_VERSION,
    .gives = HAPBENCH_WEIGHTS,
    .name = "depth_weighted",
    .summary = "penalty springs averaged by a power of their depths",
    .formula = "c_i = |d_i|^p / sum_j |d_j|^p; p = 0 is the mean, p -> infinity the deepest contact",
    .source = "example of hapbench_plugin.h",
    .known_failure = "the larger p, the more the force turns from step to step where two contacts are equally deep",
    .parameters = parameters,
    .parameter_count = sizeof parameters / sizeof parameters[0],
    .create = create,
    .destroy = free,
    .evaluate = evaluate,
};

const HapbenchPlugin* hapbench_plugin(uint32_t version) {
  return version == HAPBENCH_PLUGIN_VERSION ? &plugin : NULL;
}
