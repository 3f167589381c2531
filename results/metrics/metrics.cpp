#include "results/metrics/metrics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace hapbench {
namespace {

void add(Hash64& hash, const Vec3& v) noexcept {
  hash.real(v.x());
  hash.real(v.y());
  hash.real(v.z());
}

}  // namespace

MetricsObserver::MetricsObserver(double dt) {
  assert(dt > 0.0);
  const double sampling_rate = 1.0 / dt;
  if (sampling_rate > 2.0 * kVibrationCutoff) high_pass_.emplace(kVibrationCutoff, sampling_rate);
}

void MetricsObserver::on_step(const StepRecord& record) noexcept {
  add_motion(record.tool);
  add_force(record.force);
  add_contacts(record);
  ++metrics_.rows;

  add(hash_, record.tool.pose.position);
  add(hash_, record.tool.velocity);
  add(hash_, record.force.rendered);
}

void MetricsObserver::add_motion(const ToolState& tool) noexcept {
  const Vec3& v = tool.velocity;
  const bool first = metrics_.rows == 0;
  if (!first) metrics_.velocity_total_variation += (v - last_velocity_).norm();
  if (high_pass_) {
    if (first) high_pass_->settle_at(v);
    vibration_sum_ += high_pass_->filter(v).squaredNorm();
  }
  speed_max_squared_ = std::max(speed_max_squared_, v.squaredNorm());
  metrics_.final_position = tool.pose.position;
  last_velocity_ = v;
}

void MetricsObserver::add_force(const RenderedForce& force) noexcept {
  // Before the first row the last force is zero, which reverses nothing.
  if (force.rendered.dot(last_force_) < 0.0) ++metrics_.force_reversals;
  force_max_squared_ = std::max(force_max_squared_, force.rendered.squaredNorm());
  metrics_.depth_max = std::max(metrics_.depth_max, force.depth_max);
  last_force_ = force.rendered;
}

void MetricsObserver::add_contacts(const StepRecord& record) noexcept {
  const std::uint64_t rendered = record.rendered->size();
  colliding_sum_ += record.colliding;
  rendered_sum_ += rendered;
  metrics_.colliding_max = std::max<std::uint64_t>(metrics_.colliding_max, record.colliding);
  metrics_.rendered_max = std::max(metrics_.rendered_max, rendered);
  if (record.colliding > 0) ++metrics_.steps_in_contact;
  if (rendered == 0) return;
  if (!metrics_.ratio) metrics_.ratio = record.ratio;
  metrics_.ratio->min = std::min(metrics_.ratio->min, record.ratio.min);
  metrics_.ratio->max = std::max(metrics_.ratio->max, record.ratio.max);
}

Metrics MetricsObserver::metrics() const noexcept {
  Metrics m = metrics_;
  m.force_max = std::sqrt(force_max_squared_);
  m.speed_max = std::sqrt(speed_max_squared_);
  m.state_hash = hash_.value();
  if (m.rows == 0) return m;

  const auto rows = static_cast<double>(m.rows);
  if (high_pass_) m.vibration_power = vibration_sum_ / rows;
  m.colliding_mean = static_cast<double>(colliding_sum_) / rows;
  m.rendered_mean = static_cast<double>(rendered_sum_) / rows;
  return m;
}

}  // namespace hapbench
