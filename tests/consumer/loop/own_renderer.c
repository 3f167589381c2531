/* Renders a recorded motion with hapbench's renderer and writes the log: own_renderer SCENARIO MOTION.csv LOG.csv
 * A line of the motion is x,y,z [m] of the handle. Lines are one period of the scenario apart. Uses only
 * hapbench_renderer.h and the manual page "In your own loop". */
#include <hapbench_renderer.h>
#include <stdio.h>

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  HapbenchSetup setup = HAPBENCH_SETUP_INIT;
  setup.scenario = argv[1];
  setup.mount.max_force = 10.0;
  setup.mount.ramp_s = 0.02;
  char error[HAPBENCH_ERROR_SIZE];
  HapbenchRenderer* renderer = hapbench_renderer_open(&setup, error);
  if (renderer == NULL) {
    fprintf(stderr, "own_renderer: %s\n", error);
    return 2;
  }
  FILE* motion = fopen(argv[2], "r");
  FILE* log = fopen(argv[3], "w");
  if (motion == NULL || log == NULL) return 2;
  static char text[8192];
  hapbench_renderer_log_header(renderer, text, sizeof text);
  fputs(text, log);
  const uint64_t period_ns = (uint64_t)(1e9 * hapbench_renderer_period(renderer) + 0.5);
  HapbenchInput input = {0};
  HapbenchOutput output;
  input.handle.orientation[0] = 1.0;
  input.has = HAPBENCH_VELOCITY;
  double last[3] = {0, 0, 0}, *p = input.handle.position, largest = 0.0;
  for (int call = 0; fscanf(motion, "%lf,%lf,%lf", &p[0], &p[1], &p[2]) == 3; ++call) {
    for (int i = 0; i < 3; ++i) {
      input.velocity[i] = call == 0 ? 0.0 : (p[i] - last[i]) / hapbench_renderer_period(renderer);
      last[i] = p[i];
    }
    input.time_ns += period_ns;
    if (hapbench_renderer_step(renderer, &input, &output) == HAPBENCH_FAULT) {
      fprintf(stderr, "own_renderer: %s\n", hapbench_renderer_fault(renderer));
      return 1;
    }
    hapbench_renderer_log_row(&input, &output, text, sizeof text);
    fputs(text, log);
    const double f =
        sqrt(output.force[0] * output.force[0] + output.force[1] * output.force[1] + output.force[2] * output.force[2]);
    if (f > largest) largest = f;
  }
  fclose(log);
  fclose(motion);
  hapbench_renderer_close(renderer);
  printf("%.17g\n", largest);
  return 0;
}
