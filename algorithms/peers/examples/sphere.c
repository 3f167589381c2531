/* A source of contacts: a sphere about the origin that a round tip or a ball touches.
 *
 *     gcc -std=c11 -O2 -fPIC -shared -Ialgorithms/peers algorithms/peers/examples/sphere.c -lm -o sphere.so
 *
 * and in a scenario "contact_source": {"type": "plugin", "file": "sphere.so", "config": {"radius_m": 0.002}}. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hapbench_contacts.h"

struct Sphere {
  double radius, tool;
};

static void* create(const char* config, const HapbenchSurface* surface, const HapbenchTool* tool, char* fault,
                    size_t fault_size) {
  const char* field = strstr(config, "\"radius_m\":");
  struct Sphere* sphere = malloc(sizeof *sphere);
  (void)surface;
  if (sphere != NULL && field != NULL && sscanf(field, "\"radius_m\":%lf", &sphere->radius) == 1) {
    sphere->tool = tool->radius;
    return sphere;
  }
  snprintf(fault, fault_size, "its config has no number radius_m");
  free(sphere);
  return NULL;
}

static int64_t contacts_at(void* source, const HapbenchPose* pose, HapbenchContact* contacts, size_t room, char* fault,
                           size_t fault_size) {
  const struct Sphere* sphere = source;
  const double* p = pose->tip;
  const double distance = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
  (void)fault, (void)fault_size;
  if (room == 0 || distance == 0.0 || distance > sphere->radius + sphere->tool) return 0;
  contacts[0].index = 0;
  contacts[0].depth = sphere->radius + sphere->tool - distance;
  for (int k = 0; k < 3; ++k) {
    contacts[0].gradient[k] = -p[k] / distance;
    contacts[0].point[k] = sphere->radius * p[k] / distance;
  }
  return 1;
}

const HapbenchContactSource* hapbench_contacts(uint32_t version) {
  static const HapbenchContactSource source = {HAPBENCH_CONTACTS_VERSION, "sphere", create, free, contacts_at};
  return version == HAPBENCH_CONTACTS_VERSION ? &source : NULL;
}
