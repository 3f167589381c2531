#include "scenarios/description/device_codec.hpp"

#include "scenarios/description/object.hpp"
#include "scenarios/description/values.hpp"

namespace hapbench {
namespace {

std::shared_ptr<ObjectCodec<IdealDeviceFields>> ideal_codec() {
  auto ideal = object<IdealDeviceFields>();
  ideal->optional(
      "force_limit_N", [](auto& d) -> std::optional<double>& { return d.force_limit; },
      nullable(number({0.0, 1e9, "N", true})), "input force limit f_th; null: off");
  return ideal;
}

std::shared_ptr<ObjectCodec<ForceSensorConfig>> sensor_codec() {
  auto sensor = object<ForceSensorConfig>();
  sensor->optional(
      "weight_offset_N", [](auto& c) -> double& { return c.weight; }, number({-1000.0, 1000.0, "N"}),
      "weight of the dummy drill, read downwards");
  sensor->optional(
      "weight_compensated", [](auto& c) -> bool& { return c.compensated; }, boolean(),
      "the weight is taken off again before the limiter, so that it does not move the virtual tool");
  sensor->optional(
      "noise_N", [](auto& c) -> double& { return c.noise; }, number({0.0, 1000.0, "N"}),
      "standard deviation of every component of a sample (ours)");
  return sensor;
}

std::shared_ptr<ObjectCodec<PositionServoConfig>> servo_codec() {
  auto servo = object<PositionServoConfig>();
  servo->optional(
      "stiffness_N_per_m", [](auto& c) -> double& { return c.stiffness; }, number({0.0, 1e9, "N/m"}),
      "force per position error (ours)");
  servo->optional(
      "damping_N_s_per_m", [](auto& c) -> double& { return c.damping; }, number({0.0, 1e9, "N s/m"}),
      "force per velocity error (ours)");
  servo->optional(
      "max_force_N", [](auto& c) -> double& { return c.max_force; }, number({0.0, 1e9, "N", true}),
      "the actuators saturate here");
  servo->optional(
      "delay_samples", [](auto& c) -> std::size_t& { return c.delay; }, integer_as<std::size_t>(0, 10'000),
      "from the command to the force (ours)");
  return servo;
}

std::shared_ptr<ObjectCodec<HandleMechanicsConfig>> mechanics_codec() {
  auto mechanics = object<HandleMechanicsConfig>();
  mechanics->optional(
      "carriage_mass_kg", [](auto& c) -> double& { return c.carriage_mass; }, number({1e-6, 1e6, "kg"}),
      "what the actuators move (ours)");
  mechanics->optional(
      "handle_mass_kg", [](auto& c) -> double& { return c.handle_mass; }, number({1e-6, 1e6, "kg"}),
      "what the hand holds (ours)");
  mechanics->optional(
      "friction_N_s_per_m", [](auto& c) -> double& { return c.friction; }, number({0.0, 1e9, "N s/m"}),
      "viscous, on the carriage (ours)");
  mechanics->optional(
      "structure_stiffness_N_per_m", [](auto& c) -> double& { return c.structure_stiffness; },
      number({0.0, 1e12, "N/m"}), "between carriage and handle; its inverse is the compliance (ours)");
  mechanics->optional(
      "structure_damping_N_s_per_m", [](auto& c) -> double& { return c.structure_damping; },
      number({0.0, 1e9, "N s/m"}), "between carriage and handle (ours)");
  return mechanics;
}

std::shared_ptr<ObjectCodec<AdmittanceDeviceConfig>> admittance_codec() {
  auto admittance = object<AdmittanceDeviceConfig>();
  admittance->optional(
      "force_limit_N", [](auto& c) -> std::optional<double>& { return c.force_limit; },
      nullable(number({0.0, 1e9, "N", true})), "input force limit f_th; null: off");
  admittance->optional(
      "sensor", [](auto& c) -> ForceSensorConfig& { return c.sensor; }, CodecPtr<ForceSensorConfig>(sensor_codec()),
      "what the force sensor adds to the hand's force");
  admittance->optional(
      "servo", [](auto& c) -> PositionServoConfig& { return c.servo; }, CodecPtr<PositionServoConfig>(servo_codec()),
      "the loop that makes the carriage follow the virtual tool");
  admittance->optional(
      "mechanics", [](auto& c) -> HandleMechanicsConfig& { return c.mechanics; },
      CodecPtr<HandleMechanicsConfig>(mechanics_codec()), "the moving parts");
  return admittance;
}

}  // namespace

CodecPtr<DeviceFields> device_codec() {
  auto device = tagged<DeviceFields>("device");
  device->alternative("ideal", ideal_codec()).alternative("admittance", admittance_codec());
  return device;
}

}  // namespace hapbench
