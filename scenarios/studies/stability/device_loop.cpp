#include "scenarios/studies/stability/device_loop.hpp"

#include "algorithms/stages/damping_and_limits.hpp"

namespace hapbench {
namespace {

/// A hand whose force does not depend on the handle.
bool is_blind(const HandFields& hand) {
  return std::holds_alternative<NoHandFields>(hand) || std::holds_alternative<ForceHandFields>(hand) ||
         std::holds_alternative<PushHandFields>(hand);
}

DeviceLoop impedance_loop(const Scenario& scenario, const ImpedanceDeviceConfig& device, double lambda) {
  DeviceLoop result;
  SampledLoop& loop = result.loop.emplace<SampledLoop>();
  loop.device = device;
  loop.period = scenario.time.step;
  loop.stiffness = lambda * scenario.rendering.stiffness;
  loop.wall_damping = lambda * normal_damping(scenario.rendering);
  if (const auto* hand = std::get_if<MassSpringDamperHandFields>(&scenario.hand))
    loop.hand = {hand->mass, hand->spring.stiffness, hand->spring.damping};
  else if (!is_blind(scenario.hand))
    result.no_theory = "the hand's force is sampled";
  if (const char* nonlinearity = loop.nonlinearity()) result.no_theory = nonlinearity;
  return result;
}

DeviceLoop admittance_loop(const Scenario& scenario, const AdmittanceDeviceConfig& device, double lambda) {
  DeviceLoop result;
  AdmittanceLoop& loop = result.loop.emplace<AdmittanceLoop>();
  const RenderingConfig& r = scenario.rendering;
  loop.tool = {r.stiffness, normal_damping(r), r.mass, scenario.time.step, lambda, scenario.integrator.type};
  loop.servo = device.servo;
  loop.mechanics = device.mechanics;
  if (const auto* hand = std::get_if<ImpedanceHandFields>(&scenario.hand)) {
    loop.hand_stiffness = hand->stiffness;
    loop.hand_damping = hand->damping;
  } else if (!is_blind(scenario.hand)) {
    result.no_theory = "the hand is no spring and damper";
  }
  return result;
}

/// Eigenvalues of larger matrices take seconds.
constexpr double kLongestDelay = 200.0;

}  // namespace

DeviceLoop device_loop(const Scenario& scenario, double lambda) {
  const auto* impedance = std::get_if<ImpedanceDeviceConfig>(&scenario.device);
  const auto* admittance = std::get_if<AdmittanceDeviceConfig>(&scenario.device);
  DeviceLoop result = impedance != nullptr ? impedance_loop(scenario, *impedance, lambda)
                                           : admittance_loop(scenario, *admittance, lambda);
  const double delay = impedance != nullptr ? impedance->delay_samples : static_cast<double>(admittance->servo.delay);
  if (delay > kLongestDelay) result.no_theory = "a delay beyond 200 samples makes the loop too large to solve";
  return result;
}

}  // namespace hapbench
