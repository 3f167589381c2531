/* A contact source in C: a sphere at the origin, for a tool with a round tip or a ball. Build:
 *
 *     gcc -std=c11 -O2 -fPIC -shared -Ialgorithms/module algorithms/module/examples/sphere.c -lm -o sphere.so
 *
 * Use in a scenario: "contact_source": {"type": "plugin", "file": "sphere.so", "config": {"radius_m": 0.002}}. Run:
 *
 *     hapbench run scene.json --module sphere.so */
#include <hapbench_module.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct Sphere {
  double radius, tool;
};

static void* create(const double* values, const char* config, const HapbenchRun* run, char* fault) {
  const char* field = strstr(config, "\"radius_m\":");
  struct Sphere* sphere = malloc(sizeof *sphere);
  if (sphere != NULL && field != NULL && sscanf(field, "\"radius_m\":%lf", &sphere->radius) == 1) {
    sphere->tool = run->tool_radius;
    return sphere;
  }
  snprintf(fault, HAPBENCH_FAULT_SIZE, "its config has no number radius_m");
  free(sphere);
  return NULL;
}

static int step(void* state, const HapbenchPose* pose, HapbenchContacts* c, HapbenchForce* force, char* fault) {
  const struct Sphere* sphere = state;
  const double *p = pose->tip, distance = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
  c->n = distance > 0.0 && distance <= sphere->radius + sphere->tool;
  if (c->n == 0) return 0;
  const double x = p[0] / distance, y = p[1] / distance, z = p[2] / distance; /* outward normal of the sphere */
  c->index[0] = 0;
  c->depth[0] = sphere->radius + sphere->tool - distance;
  c->gx[0] = -x, c->gy[0] = -y, c->gz[0] = -z;
  c->x[0] = sphere->radius * x, c->y[0] = sphere->radius * y, c->z[0] = sphere->radius * z;
  return 0;
}

const HapbenchModule* hapbench_module(uint32_t version) {
  static const HapbenchModule module = {.version = HAPBENCH_MODULE_VERSION,
                                        .kind = HAPBENCH_CONTACTS,
                                        .name = "sphere",
                                        .create = create,
                                        .step = step,
                                        .destroy = free};
  return version == HAPBENCH_MODULE_VERSION ? &module : NULL;
}
