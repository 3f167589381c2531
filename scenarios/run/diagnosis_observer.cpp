#include "scenarios/run/diagnosis_observer.hpp"

#include <algorithm>
#include <cstddef>
#include <variant>

#include "algorithms/registry.hpp"
#include "device_model/impedance_device.hpp"
#include "scenarios/scene/scenario.hpp"

namespace hapbench {
namespace {

constexpr double kAtLimit = 0.999;  ///< a force of at least this fraction of a limit counts as at the limit

/// Returns the largest force that the device and the rendering allow [N]; empty without limits.
std::optional<double> force_limit(const Scenario& scenario) {
  const auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device);
  std::optional<double> limit = device != nullptr ? device->force_max : std::nullopt;
  if (const auto& rendered = scenario.rendering.max_force) limit = std::min(limit.value_or(*rendered), *rendered);
  return limit;
}

/// Returns true if a force points deeper into the surface at every contact with a depth above 0, and there is such a
/// contact. A law f = -K sum c_i d_i u_i with weights c_i >= 0 never gives such a force: from f . u_i > 0 for all i
/// follows sum c_i d_i u_i . f > 0, but this sum is -|f|^2 / K.
bool points_inwards(const Vec3& force, const ContactBuffer& contacts) noexcept {
  bool has_depth = false;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (!(contacts.depth[i] > 0.0)) continue;
    if (!(force.dot(contacts.gradient(i)) > 0.0)) return false;
    has_depth = true;
  }
  return has_depth;
}

}  // namespace

DiagnosisObserver::DiagnosisObserver(const Scenario& scenario)
    : scenario_(scenario), force_limit_(force_limit(scenario)), input_limit_(input_force_limit(scenario.device)) {
  // The steps of a quarter are stored; on_step must not allocate.
  observations_.last_forces.reserve(std::min(kMaxForces, static_cast<std::size_t>(scenario.time.steps) / 4 + 1));
  if (std::holds_alternative<ImpedanceDeviceConfig>(scenario.device)) observations_.created_by_motors = 0.0;
  const AlgorithmEntry* law = find_algorithm(scenario.rendering.algorithm);
  const bool has_surface = !std::holds_alternative<SpringsEnvironment>(scenario.environment);
  if (has_surface && law != nullptr && law->is_external()) observations_.inward = 0;
}

void DiagnosisObserver::on_step(const StepRecord& record) noexcept {
  // A new trial begins.
  if (record.step == 0) {
    was_in_contact_ = false;
    stored_at_start_ = record.springs.energy;
  }
  if (record.device && observations_.created_by_motors) {
    double& created = *observations_.created_by_motors;
    created = std::max(created, record.device->actuator - stored_at_start_);
  }
  if (record.colliding > 0) add_contact(record);
  add_to_quarter(record);
  was_in_contact_ = record.colliding > 0;
  observations_.tip = record.tool.pose.position;
  observations_.last_force = record.force.rendered;
  observations_.last_spring = record.force.spring;
  observations_.last_hand_force = record.hand_force;
}

void DiagnosisObserver::add_contact(const StepRecord& record) noexcept {
  const Vec3& f = record.force.rendered;
  ++observations_.in_contact;
  // Behind the surface, a tool that was thrown through it can touch where no equilibrium is near.
  if (outcome_ == nullptr || !outcome_->has_passed()) observations_.last_contact = contact_state(record);
  if (force_limit_ && f.norm() >= kAtLimit * *force_limit_) ++observations_.at_force_limit;
  if (observations_.inward && points_inwards(record.force.spring, *record.rendered)) ++*observations_.inward;
  if (input_limit_ && record.hand.input.norm() >= kAtLimit * *input_limit_) ++observations_.at_input_limit;
  if (!was_in_contact_) return;
  const Vec3 moved = record.tool.pose.position - observations_.tip, normal = record.force.spring.stableNormalized();
  observations_.path_in_contact += (moved - moved.dot(normal) * normal).norm();
}

void DiagnosisObserver::add_to_quarter(const StepRecord& record) noexcept {
  RunObservations::Quarter& last = observations_.last_quarter;
  const std::uint64_t quarter = record.step * 4 / static_cast<std::uint64_t>(scenario_.time.steps);
  // Start the statistics again when a new quarter begins.
  if (record.step == 0 || quarter != quarter_) {
    last = {.start = record.tool.pose.position};
    observations_.last_forces.clear();
  }
  quarter_ = quarter;
  ++last.rows;
  last.always_in_contact = last.always_in_contact && record.colliding > 0;
  if (observations_.last_forces.size() < observations_.last_forces.capacity())
    observations_.last_forces.push_back(record.force.rendered);
}

}  // namespace hapbench
