#include "scenarios/run/diagnosis_observer.hpp"

#include <cmath>
#include <cstddef>
#include <variant>

#include "device_model/impedance_device.hpp"
#include "scenarios/scene/scenario.hpp"

namespace hapbench {
namespace {

constexpr double kAtLimit = 0.999;  ///< of a limit, from which on a force is at it

/// The largest force that the device or the rendering lets through [N]; none without limits.
std::optional<double> force_limit(const Scenario& scenario) {
  const auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device);
  std::optional<double> most = device != nullptr ? device->force_max : std::nullopt;
  if (const auto& limit = scenario.rendering.max_force) most = std::min(most.value_or(*limit), *limit);
  return most;
}

}  // namespace

DiagnosisObserver::DiagnosisObserver(const Scenario& scenario)
    : scenario_(scenario),
      force_limit_(force_limit(scenario)),
      input_limit_(input_force_limit(scenario.device)),
      high_pass_(vibration_filter(scenario.time.step)) {}

void DiagnosisObserver::on_step(const StepRecord& record) noexcept {
  if (record.step == 0) {
    touched_ = false;
    high_.setZero();
    if (high_pass_) high_pass_->settle_at(record.force.rendered);
  }
  if (record.colliding > 0) add_contact(record);
  add_to_quarter(record);
  touched_ = record.colliding > 0;
  seen_.tip = record.tool.pose.position;
  seen_.last_force = record.force.rendered;
}

void DiagnosisObserver::add_contact(const StepRecord& record) noexcept {
  const Vec3& f = record.force.rendered;
  ++seen_.touching;
  if (force_limit_ && f.norm() >= kAtLimit * *force_limit_) ++seen_.at_force_limit;
  if (input_limit_ && record.hand.input.norm() >= kAtLimit * *input_limit_) ++seen_.at_limiter;
  if (touched_) seen_.way_in_contact += (record.tool.pose.position - seen_.tip).norm();
}

void DiagnosisObserver::add_to_quarter(const StepRecord& record) noexcept {
  SeenRows::Quarter& last = seen_.last_quarter;
  const std::uint64_t quarter = record.step * 4 / static_cast<std::uint64_t>(scenario_.time.steps);
  if (record.step == 0 || quarter != quarter_) last = {.start = record.tool.pose.position};
  quarter_ = quarter;
  ++last.rows;
  last.touches = last.touches && record.colliding > 0;
  if (!high_pass_) return;
  const Vec3 high = high_pass_->filter(record.force.rendered);
  last.high_squares += high.cwiseAbs2();
  for (int i = 0; i < 3; ++i) last.high_turns[static_cast<std::size_t>(i)] += high[i] * high_[i] < 0.0;
  high_ = high;
}

}  // namespace hapbench
