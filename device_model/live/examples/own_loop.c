/* A haptic loop of 1 kHz around hapbench's renderer: own_loop [SCENARIO [SECONDS [LOG.csv]]]
 *
 *     cc own_loop.c -o own_loop $(pkg-config --cflags --libs hapbench_renderer) -lm -lpthread
 *
 * The device is a stand-in behind three functions; put your vendor's calls there. A second thread writes the log, so
 * that the loop never waits for a disk. SCHED_FIFO and locked memory are used where the system permits them. */
#define _GNU_SOURCE
#include <hapbench_renderer.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <time.h>

#define PERIOD_NS 1000000u
#define RING 4096u /* number of calls that the writer may lag behind; a power of 2 */

static uint64_t now_ns(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
}

/* ---- The device. Replace the bodies by your vendor's calls. ---- */
static double stand_in_time;

static int device_open(void) { /* vendor: open, initialise, enable forces; returns 0 on success */
  return 0;
}
static void device_read(HapbenchInput* input) {
  /* vendor: position [m] and orientation of the handle. Impedance device: linear velocity if the device measures it;
   * otherwise leave out HAPBENCH_VELOCITY and give the scenario a device.velocity_filter. Admittance device: the force
   * sensor, without the handle's weight, as hand_force with HAPBENCH_HAND_FORCE. */
  const double z = 0.0055 - 0.0015 * (1.0 - cos(2.0 * stand_in_time)), rate = -0.003 * sin(2.0 * stand_in_time);
  stand_in_time += 1e-9 * PERIOD_NS;
  input->handle = (HapbenchPose3){{0.0, 0.0, z}, {1.0, 0.0, 0.0, 0.0}};
  input->velocity[0] = input->velocity[1] = 0.0;
  input->velocity[2] = rate;
  input->has = HAPBENCH_VELOCITY;
  input->time_ns = now_ns();
}
static void device_write(const HapbenchOutput* output) {
  /* vendor, impedance device: apply output->force [N]. Admittance device: send output->set_position and set_velocity to
   * the position controller. Enable the device's own watchdog: the renderer cannot notice that calls have stopped. */
  (void)output;
}

/* ---- The log: a ring with one writer and one reader. ---- */
typedef struct Call {
  HapbenchInput input;
  HapbenchOutput output;
} Call;
static Call ring[RING];
static atomic_ulong written, logged; /* calls put into the ring, calls written to the file */
static atomic_int running = 1;

static void* write_log(void* file) {
  static char line[HAPBENCH_LOG_ROW_SIZE];
  for (;;) {
    const int last = !atomic_load(&running);
    for (; atomic_load(&logged) < atomic_load(&written); atomic_fetch_add(&logged, 1)) {
      const Call* call = &ring[atomic_load(&logged) % RING];
      hapbench_renderer_log_row(&call->input, &call->output, line, sizeof line);
      if (file != NULL) fputs(line, file);
    }
    if (last) return NULL;
    nanosleep(&(struct timespec){0, 10000000}, NULL);
  }
}

/* ---- Latencies: bucket i counts calls of less than 2^i microseconds. ---- */
static unsigned long buckets[20], missed;

static void count(uint64_t ns) {
  unsigned i = 0;
  while (i < 19 && ns >= (1000u << i)) ++i;
  ++buckets[i];
  if (ns > PERIOD_NS) ++missed;
}

int main(int argc, char** argv) {
  /* Open the renderer before the loop: it may take seconds. */
  const char* overrides[] = {"time.step_s=0.001", NULL};
  HapbenchSetup setup = HAPBENCH_SETUP_INIT;
  setup.scenario = argc > 1 ? argv[1] : "drag_molar";
  setup.overrides = overrides;
  setup.mount.max_force = 3.0;
  char error[HAPBENCH_ERROR_SIZE];
  HapbenchRenderer* renderer = hapbench_renderer_open(&setup, error);
  if (renderer == NULL || device_open() != 0) {
    fprintf(stderr, "own_loop: %s\n", renderer == NULL ? error : "no device");
    return 2;
  }
  fputs(hapbench_renderer_inspect(renderer), stdout);
  FILE* log = argc > 3 ? fopen(argv[3], "w") : NULL;
  static char header[8192];
  hapbench_renderer_log_header(renderer, header, sizeof header);
  if (log != NULL) fputs(header, log);
  pthread_t writer;
  if (pthread_create(&writer, NULL, write_log, log) != 0) return 1;
  const int locked = mlockall(MCL_CURRENT | MCL_FUTURE);
  const int realtime = sched_setscheduler(0, SCHED_FIFO, &(struct sched_param){.sched_priority = 80});
  printf("locked memory: %s, SCHED_FIFO: %s\n", locked == 0 ? "yes" : "no", realtime == 0 ? "yes" : "no");

  /* The loop. */
  static HapbenchInput input;
  static HapbenchOutput output;
  const unsigned long calls = (unsigned long)(1000.0 * (argc > 2 ? atof(argv[2]) : 3.0));
  unsigned long lost = 0, stale = 0;
  uint64_t next = now_ns();
  for (unsigned long i = 0; i < calls; ++i) {
    next += PERIOD_NS;
    const struct timespec wake = {(time_t)(next / 1000000000u), (long)(next % 1000000000u)};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &wake, NULL) != 0) {
    }
    device_read(&input);
    hapbench_renderer_step(renderer, &input, &output);
    device_write(&output);
    if (output.status == HAPBENCH_STALE) ++stale; /* the force falls to 0, because a call came too late */
    if (atomic_load(&written) - atomic_load(&logged) < RING) {
      ring[atomic_load(&written) % RING] = (Call){input, output};
      atomic_fetch_add(&written, 1);
    } else {
      ++lost; /* a replay of this log will name the missing call */
    }
    count(now_ns() - next);
  }

  /* Stop the device, write the rest of the log, and report. */
  device_write(&(HapbenchOutput){0});
  atomic_store(&running, 0);
  pthread_join(writer, NULL);
  if (log != NULL) fclose(log);
  printf("status at the end (enumeration in hapbench_renderer.h): %u %s\n", output.status,
         hapbench_renderer_fault(renderer));
  printf("calls with status HAPBENCH_STALE: %lu\n", stale);
  puts("time from wake-up to force, wake-up delay included:");
  for (unsigned i = 0; i < 20; ++i)
    if (buckets[i] > 0) printf("  < %6lu us: %lu calls\n", 1ul << i, buckets[i]);
  printf("missed deadlines: %lu, calls missing in the log: %lu\n", missed, lost);
  hapbench_renderer_close(renderer);
  return 0;
}
