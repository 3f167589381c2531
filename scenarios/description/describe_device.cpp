#include "scenarios/description/descriptions.hpp"

namespace hapbench {

static void describe_force_limit(Fields& f, std::optional<double>& limit) {
  f.number("force_limit_N", limit, {0.0, 1e9, "N", true}, "input force limit f_th; null: off");
}

static void describe(Fields& f, IdealDeviceFields& device) {
  describe_force_limit(f, device.force_limit);
}

static void describe(Fields& f, ForceSensorConfig& sensor) {
  f.number("weight_offset_N", sensor.weight, {-1000.0, 1000.0, "N"}, "weight of the dummy drill, read downwards");
  f.boolean("weight_compensated", sensor.compensated,
            "the weight is taken off again before the limiter, so that it does not move the virtual tool");
  f.number("noise_N", sensor.noise, {0.0, 1000.0, "N"}, "standard deviation of every component of a sample (ours)");
}

static void describe(Fields& f, PositionServoConfig& servo) {
  f.number("stiffness_N_per_m", servo.stiffness, {0.0, 1e9, "N/m"}, "force per position error (ours)");
  f.number("damping_N_s_per_m", servo.damping, {0.0, 1e9, "N s/m"}, "force per velocity error (ours)");
  f.number("max_force_N", servo.max_force, {0.0, 1e9, "N", true}, "the actuators saturate here");
  f.integer("delay_samples", servo.delay, {0, 10'000}, "from the command to the force (ours)");
}

static void describe(Fields& f, HandleMechanicsConfig& mechanics) {
  f.number("carriage_mass_kg", mechanics.carriage_mass, {1e-6, 1e6, "kg"}, "what the actuators move (ours)");
  f.number("handle_mass_kg", mechanics.handle_mass, {1e-6, 1e6, "kg"}, "what the hand holds (ours)");
  f.number("friction_N_s_per_m", mechanics.friction, {0.0, 1e9, "N s/m"}, "viscous, on the carriage (ours)");
  f.number("structure_stiffness_N_per_m", mechanics.structure_stiffness, {0.0, 1e12, "N/m"},
           "between carriage and handle; its inverse is the compliance (ours)");
  f.number("structure_damping_N_s_per_m", mechanics.structure_damping, {0.0, 1e9, "N s/m"},
           "between carriage and handle (ours)");
}

static void describe(Fields& f, AdmittanceDeviceConfig& device) {
  describe_force_limit(f, device.force_limit);
  f.object("sensor", device.sensor, "what the force sensor adds to the hand's force");
  f.object("servo", device.servo, "the loop that makes the carriage follow the virtual tool");
  f.object("mechanics", device.mechanics, "the moving parts");
}

void describe(Fields& f, DeviceFields& device) {
  f.variant(device, "device", {"ideal", "admittance"}, [](Fields& d, auto& fields) { describe(d, fields); });
}

}  // namespace hapbench
