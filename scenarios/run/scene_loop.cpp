#include "scenarios/run/scene_loop.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <functional>
#include <utility>

#include "algorithms/stages/damping_and_limits.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/scene/devices.hpp"

namespace hapbench {
namespace {

/// Keeps the stiffness tensor S of the last step.
class LastTensor final : public Observer {
 public:
  void on_step(const StepRecord& record) noexcept override { S = record.force.S; }
  Mat3 S = Mat3::Zero();
};

/// Stiffness [N/m] and damping [N s/m], along one axis, of a sampled hand: a hand whose force is computed once in each
/// time step.
struct SampledHand {
  double stiffness = 0.0, damping = 0.0;
};

/// Returns stiffness and damping of the sampled hand along the normal of the surface. Both are zero for a hand whose
/// force does not depend on the handle, and for a hand that is attached to the handle. A subject's intended position is
/// held constant. Of several subjects, returns the hand of the first (with_each_subject()).
SampledHand sampled_hand(const Scenario& scenario) {
  if (const auto* hand = std::get_if<ImpedanceHandFields>(&scenario.hand)) return {hand->stiffness, hand->damping};
  if (const auto* drag = std::get_if<DragHandFields>(&scenario.hand)) return {0.0, drag->drag.normal_damping};
  if (const auto* tracking = std::get_if<TrackingHandFields>(&scenario.hand))
    return {tracking->subjects[0].stiffness, tracking->subjects[0].damping};
  return {};
}

/// Returns true if two subjects have the same loop.
bool have_equal_loops(const Subject& a, const Subject& b) {
  return a.stiffness == b.stiffness && a.damping == b.damping;
}

/// Returns the subjects of a tracking hand whose loops differ.
std::vector<Subject> distinct_subjects(const TrackingHandFields& hand) {
  std::vector<Subject> distinct;
  for (const Subject& subject : hand.subjects)
    if (std::ranges::none_of(distinct, [&](const Subject& known) { return have_equal_loops(known, subject); }))
      distinct.push_back(subject);
  return distinct;
}

/// Returns the contact with the hand of each subject that has a loop of its own. `contact` has the hand of the first
/// subject. All hands of subjects act equally along the axes along which the tool moves. Returns only `contact` if the
/// scenario has no subjects.
std::vector<LinearContact> with_each_hand(const Scenario& scenario, const LinearContact& contact) {
  const auto* tracking = std::get_if<TrackingHandFields>(&scenario.hand);
  if (tracking == nullptr) return {contact};
  const Mat3 along = contact.hand.stiffness / tracking->subjects[0].stiffness;
  std::vector<LinearContact> contacts;
  for (const Subject& subject : distinct_subjects(*tracking))
    contacts.emplace_back(contact).hand = {subject.stiffness * along, subject.damping * along};
  return contacts;
}

/// Returns the loop of an impedance device at a wall of stiffness lambda K and damping lambda B.
DeviceLoop impedance_loop(const Scenario& scenario, const ImpedanceDeviceConfig& device, double lambda) {
  DeviceLoop result;
  SampledLoop& loop = result.loop.emplace<SampledLoop>();
  loop.device = device;
  loop.period = scenario.time.step;
  loop.stiffness = lambda * scenario.rendering.stiffness;
  loop.wall_damping = lambda * normal_damping(scenario.rendering);
  if (const auto* hand = std::get_if<MassSpringDamperHandFields>(&scenario.hand))
    loop.hand = {hand->mass, hand->spring.stiffness, hand->spring.damping};
  const SampledHand hand = sampled_hand(scenario);
  loop.sampled_stiffness = hand.stiffness;
  loop.sampled_damping = hand.damping;
  if (const char* nonlinearity = loop.nonlinearity()) result.no_theory = nonlinearity;
  return result;
}

/// Returns the loop of an admittance device at a wall of stiffness lambda K and damping lambda B.
DeviceLoop admittance_loop(const Scenario& scenario, const AdmittanceDeviceConfig& device, double lambda) {
  DeviceLoop result;
  AdmittanceLoop& loop = result.loop.emplace<AdmittanceLoop>();
  loop.tool = tool_on_spring(scenario, lambda);
  loop.servo = device.servo;
  loop.mechanics = device.mechanics;
  const SampledHand hand = sampled_hand(scenario);
  loop.hand_stiffness = hand.stiffness;
  loop.hand_damping = hand.damping;
  return result;
}

/// Returns the scenario in which the stiffness and damping of the friction bristle replace the stiffness and damping of
/// the contacts. The linear loop of this scenario is the loop along a surface on which dry friction holds the tool. The
/// bristle integrates the velocity that the device measures. The deflection of the bristle is therefore the position,
/// filtered by the device's velocity filter.
Scenario stuck_scene(Scenario scenario) {
  RenderingConfig& r = scenario.rendering;
  const SpringDamper bristle = bristle_of(*r.dry_friction, r, scenario.time.step);
  r.stiffness = bristle.K;
  r.damping = bristle.B;
  if (auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device)) {
    const auto* filter = std::get_if<LowPassFilter>(&device->velocity_filter);
    device->position_filter = filter != nullptr ? std::optional(*filter) : std::nullopt;
  }
  return scenario;
}

/// Fields of a device that the linear model covers, as JSON pointers within the device. Each of these fields is part of
/// the loop, is reported by SampledLoop::nonlinearity(), or has no effect while nothing saturates. If any other field
/// differs from its default, there is no linear model.
constexpr std::string_view kKnownToTheory[] = {"/handle_mass_kg",
                                               "/viscous_N_s_per_m",
                                               "/coulomb_N",
                                               "/encoder_step_m",
                                               "/delay_samples",
                                               "/delay_s",
                                               "/force_max_N",
                                               "/force_step_N",
                                               "/force_slew_N_per_s",
                                               "/position_noise_m",
                                               "/velocity_filter/noise_m",
                                               "/velocity_filter/cutoff_Hz",
                                               "/velocity_filter/order",
                                               "/position_filter/cutoff_Hz",
                                               "/position_filter/order",
                                               "/transmission/motor_share",
                                               "/transmission/stiffness_N_per_m",
                                               "/transmission/damping_N_s_per_m",
                                               "/force_limit_N",
                                               "/sensor/weight_offset_N",
                                               "/sensor/weight_compensated",
                                               "/sensor/noise_N",
                                               "/servo/stiffness_N_per_m",
                                               "/servo/damping_N_s_per_m",
                                               "/servo/max_force_N",
                                               "/servo/delay_samples",
                                               "/mechanics/carriage_mass_kg",
                                               "/mechanics/handle_mass_kg",
                                               "/mechanics/friction_N_s_per_m",
                                               "/mechanics/structure_stiffness_N_per_m",
                                               "/mechanics/structure_damping_N_s_per_m"};

}  // namespace

std::vector<Scenario> with_each_subject(const Scenario& scenario) {
  const auto* tracking = std::get_if<TrackingHandFields>(&scenario.hand);
  if (tracking == nullptr) return {scenario};
  std::vector<Scenario> scenes;
  for (const Subject& subject : distinct_subjects(*tracking))
    std::get<TrackingHandFields>(scenes.emplace_back(scenario).hand).subjects = {subject};
  return scenes;
}

bool has_permanent_springs(const Scenario& scenario) {
  const auto* springs = std::get_if<SpringsEnvironment>(&scenario.environment);
  const RenderingConfig& r = scenario.rendering;
  return springs != nullptr && springs->bilateral && springs->signed_depths && !r.has_friction() && !r.hunt_crossley &&
         !has_multi_rate_contacts(scenario) && !r.max_damping && !r.max_force && !r.force_stage &&
         !r.passivity_controller && position_is_free(scenario.motion);
}

Vec3 stiffness_eigenvalues(Scenario scenario) {
  // Run one step in which all springs are deflected, and read the tensor.
  scenario.time.steps = 1;
  scenario.bounds = {};
  scenario.initial.position = Vec3(1e-3, 1e-3, 1e-3);
  LastTensor tensor;
  Simulation(simulation_config(scenario), assemble(scenario), {&tensor}).run();
  return Eigen::SelfAdjointEigenSolver<Mat3>(tensor.S, Eigen::EigenvaluesOnly).eigenvalues();
}

SpringDamper tool_on_spring(const Scenario& scenario, double lambda) {
  const RenderingConfig& r = scenario.rendering;
  return {r.stiffness, normal_damping(r), r.mass, scenario.time.step, lambda, scenario.integrator.type};
}

double delay_of(const Scenario& scenario) {
  if (const auto* impedance = std::get_if<ImpedanceDeviceConfig>(&scenario.device)) return impedance->delay_samples;
  const auto* admittance = std::get_if<AdmittanceDeviceConfig>(&scenario.device);
  return admittance != nullptr ? static_cast<double>(admittance->servo.delay) : 0.0;
}

std::string unmodelled_fields(const Scenario& scenario) {
  // Compare with a device that has default values but the same optional parts (filters, transmission).
  DeviceFields plain = AdmittanceDeviceConfig{};
  if (const auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device)) {
    auto& parts = plain.emplace<ImpedanceDeviceConfig>();
    if (std::holds_alternative<LowPassFilter>(device->velocity_filter)) parts.velocity_filter = LowPassFilter{};
    if (std::holds_alternative<AdaptiveWindowFilter>(device->velocity_filter))
      parts.velocity_filter = AdaptiveWindowFilter{};
    if (device->position_filter) parts.position_filter.emplace();
    if (device->transmission) parts.transmission.emplace();
  }
  std::string unknown;
  for (const Json& change : Json::diff(written(plain), written(scenario.device))) {
    const std::string path = change["path"].get<std::string>();
    if (std::ranges::find(kKnownToTheory, path) == std::end(kKnownToTheory))
      unknown += (unknown.empty() ? "device" : ", device") + path;
  }
  std::replace(unknown.begin(), unknown.end(), '/', '.');
  return unknown;
}

Eigen::Matrix2d step_matrix_with_hand(const Scenario& scenario, double lambda) {
  const SpringDamper tool = tool_on_spring(scenario, lambda);
  const SampledHand hand = sampled_hand(scenario);
  return tool.step_matrix() - tool.input_step() * Eigen::RowVector2d(hand.stiffness, hand.damping);
}

DeviceLoop device_loop(const Scenario& scenario, double lambda) {
  const auto* impedance = std::get_if<ImpedanceDeviceConfig>(&scenario.device);
  const auto* admittance = std::get_if<AdmittanceDeviceConfig>(&scenario.device);
  DeviceLoop result = impedance != nullptr ? impedance_loop(scenario, *impedance, lambda)
                                           : admittance_loop(scenario, *admittance, lambda);
  if (delay_of(scenario) > kMaxLoopDelay)
    result.no_theory = "the delay is longer than 200 samples, too long for the eigenvalue computation";
  if (const std::string unknown = unmodelled_fields(scenario); !unknown.empty())
    result.no_theory = unknown + ": not part of the linear theory";
  return result;
}

bool device_acts_on_tool(const Scenario& scenario) {
  const bool is_admittance = std::holds_alternative<AdmittanceDeviceConfig>(scenario.device);
  return has_device(scenario) && (reacts_to_handle(scenario.hand) || !is_admittance);
}

bool has_linear_loop(const Scenario& scenario) {
  return !device_acts_on_tool(scenario) || (delay_of(scenario) <= kMaxLoopDelay && unmodelled_fields(scenario).empty());
}

Eigen::MatrixXd contact_step_matrix(const Scenario& scenario, double lambda) {
  if (!device_acts_on_tool(scenario)) return step_matrix_with_hand(scenario, lambda);
  if (!has_linear_loop(scenario)) return {};
  return device_loop(scenario, lambda).state_matrix();
}

std::vector<Eigen::MatrixXd> contact_step_matrices(const Scenario& scenario, double lambda) {
  std::vector<Eigen::MatrixXd> all;
  for (const Scenario& scene : with_each_subject(scenario))
    if (Eigen::MatrixXd own = contact_step_matrix(scene, lambda); own.size() > 0) all.push_back(std::move(own));
  return all;
}

/// Returns the matrices of the loop, for several subjects of the loops of all subjects.
static std::vector<Eigen::MatrixXd> loop_with(const Scenario& scenario, const LinearContact& contact) {
  std::vector<Eigen::MatrixXd> all;
  const auto add = [&all](const auto& loop, const LinearContact& with) {
    const std::vector<Eigen::MatrixXd> matrices = contact_loop(loop, with);
    all.insert(all.end(), matrices.begin(), matrices.end());
  };
  for (const LinearContact& with : with_each_hand(scenario, contact)) {
    if (device_acts_on_tool(scenario))
      std::visit([&](const auto& loop) { add(loop, with); }, device_loop(scenario, 1.0).loop);
    else
      add(tool_on_spring(scenario, 1.0), with);
  }
  return all;
}

/// Returns the matrices of the loop while dry friction holds the tool. The friction bristle acts along the surface, in
/// the plane perpendicular to the contact's stiffest direction.
static std::vector<Eigen::MatrixXd> loop_held_by_friction(const Scenario& scenario, const LinearContact& contact) {
  const Scenario stuck = stuck_scene(scenario);
  const Mat3& K = contact.rendered.stiffness;
  const Vec3 normal = Eigen::SelfAdjointEigenSolver<Mat3>(K * K.transpose()).eigenvectors().col(2);
  const Mat3 along = Mat3::Identity() - normal * normal.transpose();
  LinearContact held = contact;
  held.rendered.stiffness = stuck.rendering.stiffness * along;
  held.rendered.damping = stuck.rendering.damping.value_or(0.0) * along;
  held.rendered.assumed = {held.rendered.stiffness, held.rendered.damping};
  return loop_with(stuck, held);
}

std::vector<Eigen::MatrixXd> contact_loop(const Scenario& scenario, const LinearContact& contact) {
  std::vector<Eigen::MatrixXd> all;
  for (const NamedLoop& loop : contact_loops(scenario, contact, false))
    all.insert(all.end(), loop.matrices.begin(), loop.matrices.end());
  return all;
}

std::string unstable_without_wall(const Scenario& scenario) {
  if (!has_linear_loop(scenario)) return "";
  Scenario alone = scenario;
  alone.rendering.stiffness = 0.0;
  alone.rendering.damping = 0.0;
  if (is_stable_loop(contact_step_matrices(alone, 1.0))) return "";
  if (!device_acts_on_tool(scenario)) return "the hand";
  const bool has_servo = std::holds_alternative<AdmittanceDeviceConfig>(scenario.device);
  alone.hand = NoHandFields{};
  if (is_stable_loop({device_loop(alone, 1.0).state_matrix()})) return "hand and device";
  return has_servo ? "the device's servo" : "the device";
}

/// Calls `add` with the name and the loop of each hand of typical_hands(), if a hand holds an impedance device.
/// `lambda`: stiffness of the wall in the loop, in units of K.
static void for_typical_hands(const Scenario& scenario, double lambda,
                              const std::function<void(std::string name, const SampledLoop& loop)>& add) {
  const bool held = spring_of(scenario.hand) != nullptr || std::holds_alternative<DragHandFields>(scenario.hand);
  if (!held || !std::holds_alternative<ImpedanceDeviceConfig>(scenario.device)) return;
  SampledLoop loop = std::get<SampledLoop>(device_loop(scenario, lambda).loop);
  loop.sampled_stiffness = loop.sampled_damping = 0.0;
  for (const AttachedHand& hand : typical_hands()) {
    loop.hand = hand;
    add(hand.mass == 0.0 ? "no hand" : fmt::format("a hand of {} kg and {} N/m", hand.mass, hand.stiffness), loop);
  }
}

std::vector<NamedLoop> contact_loops(const Scenario& scenario, const LinearContact& contact, bool over_hands) {
  if (!has_linear_loop(scenario)) return {};
  std::vector<NamedLoop> all;
  const auto add = [&all](std::string name, std::vector<Eigen::MatrixXd> matrices) {
    if (!matrices.empty()) all.push_back({std::move(name), std::move(matrices)});
  };
  add("", loop_with(scenario, contact));
  if (all.empty()) return all;
  if (scenario.rendering.dry_friction) add("the tool held by friction", loop_held_by_friction(scenario, contact));
  if (!over_hands) return all;
  LinearContact without_hand = contact;
  without_hand.hand = {};
  for_typical_hands(scenario, 1.0, [&](std::string name, const SampledLoop& loop) {
    add(std::move(name), contact_loop(loop, without_hand));
  });
  return all;
}

std::vector<NamedLoop> wall_loops(const Scenario& scenario, double lambda, bool over_hands) {
  std::vector<Eigen::MatrixXd> own = contact_step_matrices(scenario, lambda);
  if (own.empty()) return {};
  std::vector<NamedLoop> all = {{"", std::move(own)}};
  if (over_hands)
    for_typical_hands(scenario, lambda, [&](std::string name, const SampledLoop& loop) {
      all.push_back({std::move(name), {loop.state_matrix()}});
    });
  return all;
}

}  // namespace hapbench
