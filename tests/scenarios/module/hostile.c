/* A module with a fault. The environment variable HOSTILE selects the fault; without it, the module is correct. */
#include <hapbench_module.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int is(const char* word) {
  const char* chosen = getenv("HOSTILE");
  return chosen != NULL && strcmp(chosen, word) == 0;
}

static void* create(const double* values, const char* config, const HapbenchRun* run, char* fault) {
  static int state;
  return is("not created") ? NULL : &state;
}

static int step(void* state, const HapbenchPose* pose, HapbenchContacts* contacts, HapbenchForce* force, char* fault) {
  if (force == NULL) { /* as contacts */
    contacts->n = contacts->room + 1;
    return 0;
  }
  if (is("forgets")) return 0;
  if (is("exits")) exit(0);
  if (is("loops")) {
    fputs("looping\n", stderr);
    for (;;) {
    }
  }
  for (size_t i = 0; i < contacts->n; ++i)
    contacts->weight[i] = (is("nan") ? NAN : is("inward") ? -1.0 : 1.0) / (double)contacts->n;
  if (!is("error") && !is("error without status")) return 0;
  snprintf(fault, HAPBENCH_FAULT_SIZE, "the oven\n is \xff cold");
  return is("error") ? 42 : 0;
}

static HapbenchParameter parameters[] = {
    {"gain", "1", 0.0, 2.0, 1.0, "scales nothing"},
    {"bias", "1", -1.0, 1.0, 0.0, "shifts nothing"},
};
static HapbenchModule module;

const HapbenchModule* hapbench_module(uint32_t version) {
  if (is("refuses")) return NULL;
  const HapbenchModule good = {
      .version = version,
      .kind = HAPBENCH_LAW,
      .name = "hostile",
      .summary = "the mean, until it is told otherwise",
      .formula = "c_i = 1/n",
      .source = "the tests",
      .known_failure = "all of them",
      .parameters = parameters,
      .parameter_count = 2,
      .create = create,
      .step = step,
  };
  module = good;
  if (is("version")) module.version = version + 1;
  if (is("kind")) module.kind = 5;
  if (is("contacts")) module.kind = HAPBENCH_CONTACTS;
  if (is("built in")) module.name = "mean";
  if (is("no table")) module.parameters = NULL;
  if (is("no step")) module.step = NULL;
  if (is("many")) module.parameter_count = (size_t)1 << 40;
  return &module;
}
