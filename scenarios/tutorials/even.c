/* Equal weights, as large as the stiffest direction allows: the law of my_law.md in C. */
#include <hapbench_plugin.h>
#include <math.h>

static void* create(const double* parameters, double stiffness, size_t capacity) {
  static char nothing; /* this law remembers nothing from step to step */
  (void)parameters, (void)stiffness, (void)capacity;
  return &nothing;
}

static int evaluate(void* state, const HapbenchContacts* contacts, double* weights, HapbenchForce* answer) {
  double a = 0, b = 0, c = 0, d = 0, e = 0, f = 0; /* sum of u u^T: diagonal a b c, beside it d e f */
  (void)state, (void)answer;
  for (size_t i = 0; i < contacts->n; ++i) {
    const double x = contacts->gx[i], y = contacts->gy[i], z = contacts->gz[i];
    a += x * x, b += y * y, c += z * z, d += x * y, e += x * z, f += y * z;
  }
  const double q = (a + b + c) / 3, A = a - q, B = b - q, C = c - q;
  const double p = sqrt((A * A + B * B + C * C + 2 * (d * d + e * e + f * f)) / 6);
  const double det = A * (B * C - f * f) - d * (d * C - f * e) + e * (d * f - B * e);
  const double largest = p > 0 ? q + 2 * p * cos(acos(fmin(1, fmax(-1, det / (2 * p * p * p)))) / 3) : q;
  for (size_t i = 0; i < contacts->n; ++i) weights[i] = 1 / largest;
  return 0;
}

static const HapbenchPlugin plugin = {.version = HAPBENCH_PLUGIN_VERSION,
                                      .gives = HAPBENCH_WEIGHTS,
                                      .name = "even_c",
                                      .summary = "equal weights, as large as the stiffest direction allows",
                                      .formula = "c_i = 1 / lambda_max(sum_j u_j u_j^T)",
                                      .source = "a tutorial",
                                      .known_failure = "soft where contacts agree",
                                      .create = create,
                                      .evaluate = evaluate};

const HapbenchPlugin* hapbench_plugin(uint32_t version) {
  return version == HAPBENCH_PLUGIN_VERSION ? &plugin : NULL;
}
