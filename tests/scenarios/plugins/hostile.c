/* Plugins as they should not be. HOSTILE in the environment says which. */
#include <hapbench_plugin.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int is(const char* word) {
  const char* chosen = getenv("HOSTILE");
  return chosen != NULL && strcmp(chosen, word) == 0;
}

static int state;

static void* create(const double* parameters, double stiffness, size_t capacity) {
  (void)parameters, (void)stiffness, (void)capacity;
  return is("not created") ? NULL : &state;
}

static int evaluate(void* law, const HapbenchContacts* contacts, double* weights, HapbenchForce* answer) {
  (void)law, (void)answer;
  if (is("forgets")) return 0;
  if (is("loops")) {
    fputs("looping\n", stderr);
    for (;;) {
    }
  }
  for (size_t i = 0; i < contacts->n; ++i) weights[i] = is("nan") ? NAN : 1.0 / (double)contacts->n;
  return is("error") ? 42 : 0;
}

static const char* error_text(void* law, int error) {
  (void)law, (void)error;
  return "the oven\n is \xff cold";
}

static HapbenchParameter parameters[] = {
    {"gain", "1", 0.0, 2.0, 1.0, "scales nothing"},
    {"bias", "1", -1.0, 1.0, 0.0, "shifts nothing"},
};
static HapbenchPlugin plugin;

const HapbenchPlugin* hapbench_plugin(uint32_t version) {
  if (is("refuses")) return NULL;
  const HapbenchPlugin good = {
      .version = version,
      .name = "hostile",
      .summary = "the mean, until it is told otherwise",
      .formula = "c_i = 1/n",
      .source = "the tests",
      .known_failure = "all of them",
      .parameters = parameters,
      .parameter_count = 2,
      .create = create,
      .evaluate = evaluate,
      .error_text = error_text,
  };
  plugin = good;
  parameters[1].name = "bias";
  parameters[1].initial = 0.0;
  parameters[1].min = -1.0;
  if (is("version")) plugin.version = version + 1;
  if (is("built in")) plugin.name = "mean";
  if (is("no name")) plugin.name = NULL;
  if (is("no failure")) plugin.known_failure = NULL;
  if (is("no table")) plugin.parameters = NULL;
  if (is("no create")) plugin.create = NULL;
  if (is("no evaluate")) plugin.evaluate = NULL;
  if (is("gives")) plugin.gives = 5;
  if (is("many")) plugin.parameter_count = (size_t)1 << 40;
  if (is("escape")) plugin.summary = "red: \033[31m";
  if (is("csi"))
    plugin.source =
        "\xc2\x9b"
        "31m";
  parameters[0].meaning = is("latin") ? "caf\xe9" : "scales nothing";
  return &plugin;
}
