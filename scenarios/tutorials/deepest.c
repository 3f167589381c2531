/* The deepest contact alone: the law of contact_trace.md. */
#include <hapbench_plugin.h>

static void* create(const double* parameters, double stiffness, size_t capacity) {
  static char nothing; /* this law remembers nothing from step to step */
  (void)parameters, (void)stiffness, (void)capacity;
  return &nothing;
}

static int evaluate(void* state, const HapbenchContacts* contacts, double* weights, HapbenchForce* answer) {
  size_t deepest = 0;
  (void)state, (void)answer;
  for (size_t i = 0; i < contacts->n; ++i) {
    weights[i] = 0;
    if (contacts->depth[i] > contacts->depth[deepest]) deepest = i;
  }
  weights[deepest] = 1;
  return 0;
}

static const HapbenchPlugin plugin = {
    .version = HAPBENCH_PLUGIN_VERSION,
    .gives = HAPBENCH_WEIGHTS,
    .name = "deepest",
    .summary = "the spring of the deepest contact alone",
    .formula = "c_i = 1 for the deepest, 0 for the others",
    .source = "a tutorial",
    .known_failure = "the force jumps when another contact gets deepest",
    .create = create,
    .evaluate = evaluate,
};

const HapbenchPlugin* hapbench_plugin(uint32_t version) {
  return version == HAPBENCH_PLUGIN_VERSION ? &plugin : NULL;
}
