/* Equal weights, as large as the stiffest direction allows: the law of my_law.md in C. */
#include <hapbench_module.h>
#include <math.h>

static int step(void* state, const HapbenchPose* pose, HapbenchContacts* contacts, HapbenchForce* force, char* fault) {
  double a = 0, b = 0, c = 0, d = 0, e = 0, f = 0; /* sum of u u^T: xx, yy, zz, xy, xz, yz */
  for (size_t i = 0; i < contacts->n; ++i) {
    const double x = contacts->gx[i], y = contacts->gy[i], z = contacts->gz[i];
    a += x * x, b += y * y, c += z * z, d += x * y, e += x * z, f += y * z;
  }
  const double q = (a + b + c) / 3, A = a - q, B = b - q, C = c - q;
  const double p = sqrt((A * A + B * B + C * C + 2 * (d * d + e * e + f * f)) / 6);
  const double det = A * (B * C - f * f) - d * (d * C - f * e) + e * (d * f - B * e);
  const double largest = p > 0 ? q + 2 * p * cos(acos(fmin(1, fmax(-1, det / (2 * p * p * p)))) / 3) : q;
  for (size_t i = 0; i < contacts->n; ++i) contacts->weight[i] = 1 / largest;
  return 0;
}

const HapbenchModule* hapbench_module(uint32_t version) {
  static const HapbenchModule module = {.version = HAPBENCH_MODULE_VERSION,
                                        .kind = HAPBENCH_LAW,
                                        .name = "even_c",
                                        .summary = "equal weights, as large as the stiffest direction allows",
                                        .formula = "c_i = 1 / lambda_max(sum_j u_j u_j^T)",
                                        .source = "a tutorial",
                                        .known_failure = "soft where contacts agree",
                                        .step = step};
  return version == HAPBENCH_MODULE_VERSION ? &module : NULL;
}
