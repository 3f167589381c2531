#ifndef HAPBENCH_RENDERER_H
#define HAPBENCH_RENDERER_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

/* C11 interface of the renderer: the force algorithm of a scenario in your own haptic loop. Link with the library
 * hapbench_renderer: `pkg-config --cflags --libs hapbench_renderer`, or in CMake find_package(hapbench_renderer) and
 * the target hapbench::renderer. The manual is scenarios/LOOP.md, "In your own loop".
 *
 *     HapbenchSetup setup = HAPBENCH_SETUP_INIT;
 *     setup.scenario = "drag_molar";
 *     setup.mount.max_force = 3.0;
 *     char error[HAPBENCH_ERROR_SIZE];
 *     HapbenchRenderer* renderer = hapbench_renderer_open(&setup, error);
 *     if (renderer == NULL) { puts(error); return 2; }
 *     // once in every period of your loop:
 *     hapbench_renderer_step(renderer, &input, &output);
 *     // at the end:
 *     hapbench_renderer_close(renderer);
 *
 * Units: m, s, N, rad. Frames are right-handed. Quaternions are w, x, y, z. A pose `a_from_b` turns coordinates of
 * frame b into coordinates of frame a: x_a = rotation(orientation) x_b + position.
 *
 * World:  the frame of the scenario. In three-dimensional scenes z points up.
 * Device: the frame in which your device reports positions and takes forces.
 * Handle: the body whose pose the device measures; its origin is the point where the device applies the force.
 * Tool:   origin at the tip's centre; the tool points along -z, as the tools of a scenario do.
 *
 * Threads: a renderer is used by one thread at a time. Several renderers work in several threads at the same time.
 * Real time: hapbench_renderer_step does not allocate, lock, wait or throw. This guarantee holds for the code of
 * hapbench, but not for the code of a module that you load. All other functions may do these things.
 * Floating point: every function sets the mode that it needs (round to nearest, subnormal numbers on, traps off) and
 * restores the mode of the caller. */

#define HAPBENCH_RENDERER_VERSION 1u
#define HAPBENCH_ERROR_SIZE 1000

#if defined(__GNUC__)
#define HAPBENCH_API __attribute__((visibility("default")))
#else
#define HAPBENCH_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Modes of a renderer.
 *
 * IMPEDANCE: the pose of the handle goes in, a force comes out. The tool is at the measured pose. Use this mode also
 * for an admittance device whose own controller takes a force as its input.
 *
 * ADMITTANCE: the hand's force and the pose of the handle go in, set-points of the handle's position and velocity come
 * out. The hand's force, after the scenario's input force limit, and the rendered force move the scenario's virtual
 * mass by its integrator. The tool has the measured orientation. */
enum { HAPBENCH_IMPEDANCE = 1, HAPBENCH_ADMITTANCE = 2 };

/* Flags of a setup.
 * ALLOW_MODULES: load the libraries in HapbenchSetup::modules and the libraries that the scenario names. Their code
 *                can do anything that your program can do. Without this flag, opening never loads code.
 * TORQUE:        compute HapbenchOutput::torque. */
enum { HAPBENCH_ALLOW_MODULES = 1, HAPBENCH_TORQUE = 2 };

typedef struct HapbenchPose3 {
  double position[3];    /* [m] */
  double orientation[4]; /* unit quaternion w, x, y, z; a norm within 0.001 of 1 is normalised */
} HapbenchPose3;

/* Pose and scale of the device in the scene, and the limits that protect the hand. */
typedef struct HapbenchMount {
  HapbenchPose3 world_from_device; /* position in the world's metres, applied after `scale` */
  /* Virtual metres per metre of the device, > 0: x_world = scale rotation x_device + position. A force is not scaled.
   * Stiffness, damping and virtual mass that the hand feels are `scale` times the values of the scenario. */
  double scale;
  HapbenchPose3 handle_from_tip; /* pose of the tool in the handle's frame; position in metres of the device */
  /* Impedance mode: largest norm of the force [N], > 0, and of its rate of change [N/s], > 0. INFINITY: no limit. If
   * the scenario's device has a limit as well, the smaller limit holds. */
  double max_force, max_force_rate;
  double ramp_s;       /* time in which the force rises from 0 and falls to 0 [s], 0 to 60 */
  double stale_s;      /* longest time between two calls [s], > the period */
  double engage_force; /* the force begins to rise after four successive rendered forces below this norm [N], > 0 */
} HapbenchMount;

/* Default values. `max_force` is 0, which hapbench_renderer_open refuses: set a force that your device and the hand
 * bear. */
#define HAPBENCH_MOUNT_INIT \
  { {{0, 0, 0}, {1, 0, 0, 0}}, 1, {{0, 0, 0}, {1, 0, 0, 0}}, 0, INFINITY, 0.5, 0.01, 0.2 }

typedef struct HapbenchSetup {
  uint32_t version;  /* HAPBENCH_RENDERER_VERSION */
  uint32_t mode;     /* HAPBENCH_IMPEDANCE or HAPBENCH_ADMITTANCE */
  uint32_t flags;    /* HAPBENCH_ALLOW_MODULES, HAPBENCH_TORQUE; 0: neither */
  uint32_t reserved; /* 0 */
  /* Name of a bundled scenario, path of a scenario file, or the JSON text of a scenario, which begins with "{". A text
   * cannot extend another scenario. */
  const char* scenario;
  const char* folder; /* where relative paths in a scenario text start; NULL: the working folder */
  /* "path=value", as for `hapbench run --set`, such as "time.step_s=0.001"; ends with NULL. NULL: no override. */
  const char* const* overrides;
  /* Files of modules with a law (hapbench_module.h); ends with NULL; needs HAPBENCH_ALLOW_MODULES. NULL: no module. Do
   * not open a renderer with modules while another thread opens a renderer. */
  const char* const* modules;
  HapbenchMount mount;
} HapbenchSetup;

#define HAPBENCH_SETUP_INIT \
  { HAPBENCH_RENDERER_VERSION, HAPBENCH_IMPEDANCE, 0, 0, NULL, NULL, NULL, NULL, HAPBENCH_MOUNT_INIT }

/* Bits of HapbenchInput::has. The first four bits say which vectors are given. A step ignores a vector whose bit is not
 * set.
 * CLUTCH: while the bit is set, the handle moves and the tool stays. The force falls to 0. In admittance mode, the hand
 *         moves the virtual mass without contact. In the first call without the bit, world_from_device is moved so
 *         that the tool continues from its last position; its orientation follows the handle. The renderer is then
 *         WAITING. A FAULT ends the clutch without moving the mount.
 * REARM:  ends a FAULT if the bit was not set in the previous call and the input of this call is valid. */
enum {
  HAPBENCH_VELOCITY = 1,
  HAPBENCH_ANGULAR_VELOCITY = 2,
  HAPBENCH_HAND_FORCE = 4,
  HAPBENCH_APPLIED_FORCE = 8,
  HAPBENCH_CLUTCH = 16,
  HAPBENCH_REARM = 32
};

/* All vectors are in the device frame. */
typedef struct HapbenchInput {
  uint64_t time_ns;     /* time of the measurement by a monotonic clock [ns]; increases from call to call */
  HapbenchPose3 handle; /* measured pose, in both modes */
  /* Velocity of the handle's origin [m/s]. Impedance mode: if not given, the scenario's velocity filter computes the
   * velocity of the tip. A scenario without a velocity filter (device.velocity_filter) needs the velocity in every
   * call. Admittance mode: not used. */
  double velocity[3];
  double angular_velocity[3]; /* [rad/s]; if not given, the turn since the previous call divided by the period */
  double hand_force[3];    /* hand's force on the handle, without the handle's weight [N]; needed in admittance mode */
  double applied_force[3]; /* force that the device applied in the last period [N]; for the log only */
  uint32_t has;
  uint32_t reserved; /* 0 */
} HapbenchInput;

/* Status of a call.
 *
 * WAITING: the force is 0 until the rendered force has stayed below engage_force for four calls. A renderer that is
 * opened inside the object therefore waits until the tool has been pulled out.
 *
 * RAMPING: the force rises to the rendered force, or falls to 0 because of CLUTCH or of a FAULT that was rearmed
 * meanwhile.
 *
 * ON: the force is the rendered force.
 *
 * CLAMPED: as ON, but a limit of HapbenchOutput::limited acts.
 *
 * STALE: the time since the previous call was longer than stale_s. The force of the previous call falls to 0 within
 * ramp_s, and the time since that call already counts. Then the renderer is WAITING.
 *
 * FAULT: HapbenchOutput::reason says why. The force of the last call before the FAULT falls to 0 and stays 0 until
 * REARM. Then the renderer is WAITING. */
enum {
  HAPBENCH_WAITING = 0,
  HAPBENCH_RAMPING = 1,
  HAPBENCH_ON = 2,
  HAPBENCH_CLAMPED = 3,
  HAPBENCH_STALE = 4,
  HAPBENCH_FAULT = 5
};

/* Reasons of a FAULT. hapbench_renderer_fault returns a text. */
enum {
  HAPBENCH_NO_FAULT = 0,
  HAPBENCH_NOT_FINITE = 1,       /* a given number of the input is NaN or infinite */
  HAPBENCH_BAD_ORIENTATION = 2,  /* the norm of the orientation differs from 1 by more than 0.001 */
  HAPBENCH_BAD_TIME = 3,         /* time_ns is not later than in the previous call */
  HAPBENCH_BAD_BITS = 4,         /* an unknown bit in `has`, or `reserved` is not 0 */
  HAPBENCH_NO_VELOCITY = 5,      /* the scenario has no velocity filter and the velocity is not given */
  HAPBENCH_NO_HAND_FORCE = 6,    /* admittance mode without the hand's force */
  HAPBENCH_ALGORITHM_FAILED = 7, /* a module reports a failure */
  HAPBENCH_OUT_OF_BOUNDS = 8,    /* position, velocity or force is not finite or exceeds the scenario's bounds */
  HAPBENCH_NULL_ARGUMENT = 9
};

/* Bits of HapbenchOutput::limited. */
enum { HAPBENCH_MAX_FORCE = 1, HAPBENCH_MAX_FORCE_RATE = 2, HAPBENCH_INPUT_FORCE_LIMIT = 4 };

/* All vectors are in the device frame. */
typedef struct HapbenchOutput {
  /* Force on the hand [N]. Impedance mode: to be applied by the device; positive components point along the device's
   * axes. Admittance mode: the rendered force that acts on the virtual mass, for information. */
  double force[3];
  /* Moment of the contact forces about the handle's origin [N m], which a 3-DOF device cannot render; `gain` applies,
   * the limits do not. 0 without HAPBENCH_TORQUE. */
  double torque[3];
  /* Admittance mode: position that the handle's origin shall have one period after this call [m], and its velocity
   * [m/s]. While a force falls to 0 (CLUTCH, STALE, FAULT) and during FAULT, the last position and velocity 0 are
   * written. Impedance mode: both are 0. */
  double set_position[3], set_velocity[3];
  double gain;       /* factor on the rendered force, from 0 to 1 */
  double dt;         /* time since the previous call [s]; 0 in the first call */
  uint64_t call;     /* number of the call, from 0 */
  uint32_t status;   /* HAPBENCH_WAITING … HAPBENCH_FAULT */
  uint32_t contacts; /* number of points in contact; 0 if nothing was rendered */
  uint32_t reason;   /* HAPBENCH_NO_FAULT, or why status is FAULT */
  uint32_t limited;  /* bits of the limits that act, such as HAPBENCH_MAX_FORCE */
} HapbenchOutput;

typedef struct HapbenchRenderer HapbenchRenderer;

/* Reads and checks the scenario, computes the point shell and prepares everything that a step needs; may take seconds.
 * Texts and lists of the setup are read during the call only. `error` has room for HAPBENCH_ERROR_SIZE characters, or
 * is NULL. Returns NULL if the renderer cannot be opened; `error` is then one line that says why and what is allowed.
 * On success `error` is empty. The caller closes the renderer. */
HAPBENCH_API HapbenchRenderer* hapbench_renderer_open(const HapbenchSetup* setup, char* error);

/* Renders one measurement. Call it once in every period. All fields of `output` are written. Returns output->status.
 * NULL arguments give FAULT. */
HAPBENCH_API uint32_t hapbench_renderer_step(HapbenchRenderer* renderer, const HapbenchInput* input,
                                             HapbenchOutput* output);

/* Returns the time step of the scenario [s]: the period with which you must call. Filters, friction and the virtual
 * mass use this value and not the measured time. "time.step_s=…" as an override changes it. */
HAPBENCH_API double hapbench_renderer_period(const HapbenchRenderer* renderer);

/* Returns a description of the renderer as lines of text: scenario, mode, period, the fields of the scenario's device
 * that are used, and the fields that are ignored because they describe hardware or the simulated hand. Valid until the
 * renderer is closed. */
HAPBENCH_API const char* hapbench_renderer_inspect(const HapbenchRenderer* renderer);

/* Returns the reason of the last FAULT as one line; empty if there was no FAULT. Valid until the next step. */
HAPBENCH_API const char* hapbench_renderer_fault(const HapbenchRenderer* renderer);

/* Writes the first lines of a log, or the line of one call, into `text`, terminated by 0, and returns the number of
 * characters. If `size` is not larger than this number, only an empty text is written. HAPBENCH_LOG_ROW_SIZE is enough
 * for a row. Numbers have 17 digits. `hapbench run SCENARIO --replay FILE` reads a file with the header and one row for
 * every call, in order. Not for the thread of the loop: pass the structs to another thread. */
#define HAPBENCH_LOG_ROW_SIZE 1200
HAPBENCH_API size_t hapbench_renderer_log_header(const HapbenchRenderer* renderer, char* text, size_t size);
HAPBENCH_API size_t hapbench_renderer_log_row(const HapbenchInput* input, const HapbenchOutput* output, char* text,
                                              size_t size);

/* Frees the renderer. NULL is allowed. */
HAPBENCH_API void hapbench_renderer_close(HapbenchRenderer* renderer);

#ifdef __cplusplus
}
#endif
#endif
