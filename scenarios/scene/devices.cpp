#include "scenarios/scene/devices.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "device_model/admittance_device.hpp"
#include "device_model/impedance_device.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {

constexpr double kMaxDeviceDelay = 10'000.0;  ///< maximum delay of an impedance device [time steps]

static void describe_force_limit(Fields& f, std::optional<double>& limit) {
  f.number(
      "force_limit_N", limit, {0.0, 1e9, "N", true},
      "f_th, largest input force: the hand's measured force is limited to this norm before it moves the tool; null: "
      "no limit");
}

static void describe(Fields& f, IdealDeviceFields& device) {
  describe_force_limit(f, device.force_limit);
}

static void describe(Fields& f, ForceSensorConfig& sensor) {
  f.number("weight_offset_N", sensor.weight, {-1000.0, 1000.0, "N"},
           "weight of the dummy drill on the sensor, measured downwards (-z)");
  f.boolean("weight_compensated", sensor.compensated,
            "true: the weight is subtracted from the measured force before the limiter, so that it does not move the "
            "virtual tool");
  f.number("noise_N", sensor.noise, {0.0, 1000.0, "N"},
           "standard deviation of the noise of every force component, drawn anew for each sample (our assumption)");
}

static void describe(Fields& f, PositionServoConfig& servo) {
  f.number(
      "stiffness_N_per_m", servo.stiffness, {0.0, 1e9, "N/m"},
      "servo force per position error (our assumption); for a bandwidth of f Hz at the damping ratio 0.7: m (2 pi f / "
      "2.05)^2 with m = carriage_mass_kg + handle_mass_kg");
  f.number(
      "damping_N_s_per_m", servo.damping, {0.0, 1e9, "N s/m"},
      "servo force per velocity error (our assumption); for a bandwidth of f Hz at the damping ratio 0.7: 1.4 m 2 pi "
      "f / 2.05");
  f.number("max_force_N", servo.max_force, {0.0, 1e9, "N", true},
           "largest force of the actuators; they saturate at it");
  f.integer("delay_samples", servo.delay, {0, 10'000},
            "delay from the servo's command to its force, in time steps (our assumption)");
}

static void describe(Fields& f, HandleMechanicsConfig& mechanics) {
  f.number("carriage_mass_kg", mechanics.carriage_mass, {1e-6, 1e6, "kg"},
           "mass that the actuators move (our assumption)");
  f.number("handle_mass_kg", mechanics.handle_mass, {1e-6, 1e6, "kg"},
           "mass of the handle in the hand (our assumption)");
  f.number("friction_N_s_per_m", mechanics.friction, {0.0, 1e9, "N s/m"},
           "viscous friction of the carriage (our assumption)");
  f.number("structure_stiffness_N_per_m", mechanics.structure_stiffness, {0.0, 1e12, "N/m"},
           "stiffness of the structure between carriage and handle; its inverse is the compliance (our assumption)");
  f.number("structure_damping_N_s_per_m", mechanics.structure_damping, {0.0, 1e9, "N s/m"},
           "damping of the structure between carriage and handle (our assumption)");
}

static void describe(Fields& f, AdmittanceDeviceConfig& device) {
  describe_force_limit(f, device.force_limit);
  f.object("sensor", device.sensor, "errors that the force sensor adds to the hand's force");
  f.object("servo", device.servo, "position control that makes the carriage follow the virtual tool");
  f.object("mechanics", device.mechanics, "masses, friction and structure of the moving parts");
}

static void describe(Fields& f, LowPassFilter& filter) {
  f.number(
      "cutoff_Hz", filter.cutoff, {0.0, 1e9, "Hz", true},
      "cutoff (half-power) frequency of a continuous Butterworth low-pass whose input is held during a time step; of "
      "first order, y_k = y_(k-1) + (1 - exp(-2 pi cutoff_Hz step_s)) (x_k - y_(k-1)) (our assumption)");
  f.integer("order", filter.order, {1, LowPassFilter::kMaxOrder}, "order of the low-pass (our assumption)");
}

static void describe(Fields& f, AdaptiveWindowFilter& filter) {
  f.number(
      "noise_m", filter.noise, {0.0, 1.0, "m"},
      "largest distance of a sample from the straight line through the ends of the window; half of encoder_step_m is "
      "suitable (our assumption)");
}

static void describe(Fields& f, VelocityFilterConfig& filter) {
  f.variant(filter, "velocity filter",
            {{"difference", "difference of the last two positions, divided by the time step"},
             {"low_pass",
              "difference of the last two positions, divided by the time step and smoothed by a Butterworth low-pass"},
             {"adaptive_window",
              "slope of the line over the longest window of samples that fits a straight line (Janabi-Sharifi et al. "
              "2000)"}});
}

/// Describes the field `preset`, which replaces the defaults by the parameters of a published device. An
/// effective scenario contains these parameters and not the preset's name, because only the parameters determine
/// the simulation.
static void describe_preset(Fields& f, ImpedanceDeviceConfig& device) {
  std::optional<std::string> preset;
  const std::vector<std::string> names = names_of(device_presets(), &DevicePreset::name);
  f.if_any("preset", preset,
           "preset of a published device; it supplies the values of all device fields that the file does not give; "
           "\"hapbench describe presets\" lists the presets",
           [&names](Fields& n, std::string& name) { n.choice(name, names, "preset"); });
  if (!f.reads()) return;
  if (preset) {
    device = config_of(*find_device_preset(*preset));
  } else if (!f.given("preset") && !f.given("handle_mass_kg")) {
    fail_at(f.at(), "missing field; allowed: handle_mass_kg, or a preset, which supplies it");
  }
}

static void describe(Fields& f, Transmission& transmission) {
  f.number("motor_share", transmission.motor_share, {0.01, 0.99, "1"},
           "fraction of handle_mass_kg on the motors' side of the transmission, where encoder and friction act (our "
           "assumption)");
  f.number("stiffness_N_per_m", transmission.stiffness, {1.0, 1e9, "N/m"},
           "stiffness of the transmission between motors and handle (our assumption)");
  f.number("damping_N_s_per_m", transmission.damping, {0.0, 1e6, "N s/m"},
           "damping of the transmission, parallel to its spring (our assumption)");
}

static void describe(Fields& f, ImpedanceDeviceConfig& device) {
  describe_preset(f, device);
  f.number("handle_mass_kg", device.handle_mass, {1e-6, 1e6, "kg"},
           "mass of all moving parts, as felt at the handle; required without a preset", Presence::no_default);
  f.number("viscous_N_s_per_m", device.viscous, {0.0, 1e9, "N s/m"}, "coefficient of viscous friction along each axis");
  f.number("coulomb_N", device.coulomb, {0.0, 1e9, "N"},
           "dry friction force along each axis, the same at rest and in motion");
  f.number(
      "encoder_step_m", device.encoder_step, {0.0, 1.0, "m"},
      "encoder resolution: the measured position is rounded to the nearest multiple (halves away from zero); 0: exact");
  // If the delay is given in seconds, the number of samples is NaN until resolve_delay() computes it from the time
  // step.
  f.number(
      "delay_samples", device.delay_samples, {0.0, kMaxDeviceDelay, "time steps"},
      "delay from a position sample to the force computed from it, in time steps; with a fraction, the force changes "
      "within a time step",
      std::isnan(device.delay_samples) ? Presence::omitted : Presence::has_default);
  f.if_any(
      "delay_s", device.delay,
      "delay in seconds, in place of delay_samples = delay_s / time.step_s (not rounded). scenario.effective.json has "
      "both fields with consistent values; --set of one replaces the other",
      [](Fields& d, double& value) {
        d.number(value, {0.0, 1e4, "s"});
      });
  if (f.reads() && device.delay && !f.given("delay_samples"))
    device.delay_samples = std::numeric_limits<double>::quiet_NaN();  // resolve_delay computes it from the time step
  f.value("velocity_filter", device.velocity_filter, "how the tool's velocity is computed from measured positions");
  f.number("force_max_N", device.force_max, {0.0, 1e9, "N", true},
           "largest norm of the motors' force; they saturate at it; null: no limit");
  f.number("force_step_N", device.force_step, {0.0, 1e9, "N"},
           "resolution of the force: each component of the motors' force is rounded to the nearest multiple; 0: exact");
  f.number("force_slew_N_per_s", device.force_slew, {0.0, 1e12, "N/s", true},
           "largest rate of change of the motors' force; null: no limit");
  f.object("position_filter", device.position_filter,
           "low-pass of the measured position that the rendering receives; the velocity filter uses the unfiltered "
           "position; null: none");
  f.number(
      "position_noise_m", device.position_noise, {0.0, 1.0, "m"},
      "standard deviation of the position sensor's noise along each axis, drawn anew for each sample and added before "
      "rounding to encoder_step_m");
  f.object_if_any(
      "transmission", device.transmission,
      "elastic transmission between the motors (with the encoder) and the handle (in the hand); without it, motors "
      "and handle are one body");
}

void describe(Fields& f, DeviceFields& device) {
  f.variant(
      device, "device",
      {{"ideal", "device that measures and renders without error, mass or delay"},
       {"admittance", "admittance device of the thesis: force sensor, input-force limiter and servo"},
       {"impedance",
        "impedance device, which measures positions and renders forces: a light handle with motors, like most desktop "
        "devices"}});
}

void resolve_delay(Scenario& scenario) {
  auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device);
  if (device == nullptr || !device->delay) return;
  // Convert to time steps and check the range.
  const double delay = *device->delay, samples = delay / scenario.time.step, given = device->delay_samples;
  if (samples > kMaxDeviceDelay) {
    fail_at("/device/delay_s", fmt::format("got {} s, {:.3g} time steps; allowed: at most {} time steps", delay,
                                           samples, kMaxDeviceDelay));
  }
  // If the file gives the delay in seconds and in samples, both must be equal up to the rounding of the written
  // numbers.
  if (std::abs(given - samples) > 1e-9 * std::max(1.0, samples)) {
    fail_at(
        "/device/delay_s",
        fmt::format(
            "got {} s together with delay_samples {}; allowed: one of the two, or both with consistent values: {} s "
            "are {:.6g} time steps of {} s",
            delay, given, delay, samples, scenario.time.step));
  }
  device->delay_samples = samples;
}

std::unique_ptr<Device> make_device(const Scenario& scenario, Trial trial) {
  if (const auto* ideal = std::get_if<IdealDeviceFields>(&scenario.device))
    return std::make_unique<IdealDevice>(ideal->force_limit);
  // Build an impedance device. A hand may be fixed to the handle of this device.
  if (const auto* impedance = std::get_if<ImpedanceDeviceConfig>(&scenario.device)) {
    ImpedanceDeviceConfig config = *impedance;
    config.seed = derived_seed(scenario, trial, RandomUse::position_noise);
    AttachedHand attached;  // hand mass, spring and damper that the device integrates together with the handle
    if (const auto* hand = std::get_if<MassSpringDamperHandFields>(&scenario.hand))
      attached = {hand->mass, hand->spring.stiffness, hand->spring.damping};
    return std::make_unique<ImpedanceDevice>(config, scenario.time.step, attached);
  }
  // Build an admittance device. Its force sensor also measures the weight of the handle.
  AdmittanceDeviceConfig config = std::get<AdmittanceDeviceConfig>(scenario.device);
  if (scenario.motion.orientation) config.sensor.down = -scenario.motion.orientation->up.normalized();
  config.sensor.seed = derived_seed(scenario, trial, RandomUse::sensor_noise);
  return std::make_unique<AdmittanceDevice>(config);
}

}  // namespace hapbench
