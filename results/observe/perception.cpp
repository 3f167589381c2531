#include "results/observe/perception.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "results/observe/contact_forces.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

/// Time constant of the mean square of a vibration: one period of the slowest [s].
constexpr double kEnvelopeTime = 1.0 / kVibrationCutoff;

}  // namespace

bool PerceptionThresholds::band_is_sampled(double dt) const noexcept {
  return band_to * dt < 0.5;
}

double PerceptionThresholds::acceleration_rms() const noexcept {
  const double omega = 2.0 * std::numbers::pi * 250.0;
  return amplitude_at_250Hz * omega * omega / std::numbers::sqrt2;
}

PerceptionObserver::PerceptionObserver(const PerceptionThresholds& thresholds, const ReferenceForce* reference,
                                       double dt)
    : thresholds_(thresholds),
      reference_(reference),
      dt_(dt),
      envelope_gain_(-math::expm1(-dt / kEnvelopeTime)),
      force_high_pass_(vibration_filter(dt)) {
  if (thresholds_.band_is_sampled(dt)) {
    if (thresholds_.band_from > 0.0) band_from_.emplace(thresholds_.band_from, 1.0 / dt);
    band_to_.emplace(thresholds_.band_to, 1.0 / dt);
  }
  counts_.threshold_rms = thresholds_.acceleration_rms();
}

double PerceptionObserver::noticed(double force) const noexcept {
  return thresholds_.force_jnd * std::max(force, thresholds_.least_force);
}

void PerceptionObserver::add_force(const StepRecord& record) noexcept {
  const Vec3& f = record.force.rendered;
  if (reference_ != nullptr) {
    if (const auto wanted = reference_->at(record.time)) {
      ++counts_.reference_rows;
      if ((f - *wanted).norm() > noticed(wanted->norm())) ++counts_.error_rows;
    }
  }
  if (force_high_pass_) {
    const Vec3 fast = force_high_pass_->filter(f);
    vibration_square_ += envelope_gain_ * (fast.squaredNorm() - vibration_square_);
    if (record.colliding > 0 && std::sqrt(2.0 * vibration_square_) > noticed((f - fast).norm()))
      ++counts_.vibration_rows;
  }
  if (record.colliding > 0) ++counts_.rows_in_contact;
}

void PerceptionObserver::add_motion(const Vec3& velocity) noexcept {
  Vec3 acceleration = begun_ ? Vec3((velocity - last_velocity_) / dt_) : Vec3(Vec3::Zero());
  begun_ = true;
  last_velocity_ = velocity;
  ++rows_;
  if (!band_to_) return;
  if (band_from_) acceleration = band_from_->filter(acceleration);
  acceleration = band_to_->filter(acceleration);
  acceleration_sum_ += acceleration.squaredNorm();
}

void PerceptionObserver::on_step(const StepRecord& record) noexcept {
  add_force(record);
  add_motion(record.handle.velocity);
}

PerceptionMetrics PerceptionObserver::metrics() const noexcept {
  PerceptionMetrics found = counts_;
  found.vibration_is_sampled = force_high_pass_.has_value();
  if (band_to_ && rows_ > 0) found.acceleration_rms = std::sqrt(acceleration_sum_ / static_cast<double>(rows_));
  return found;
}

MetricList metric_list(const PerceptionMetrics& m) {
  const auto share = [](std::uint64_t part, std::uint64_t whole) {
    return static_cast<double>(part) / static_cast<double>(whole);
  };
  const double rms = m.acceleration_rms.value_or(0.0);
  return {
      {"error_noticed_share", "1",
       "share of the rows with a reference force f_m whose ||f - f_m|| is above the just noticeable "
       "difference: perception.force_jnd of ||f_m||, or of perception.least_force_N where that is more",
       if_any(m.reference_rows > 0, share(m.error_rows, m.reference_rows)), Better::less},
      {"vibration_noticed_share", "1",
       "share of the rows in contact in which the vibration of the force above 30 Hz (Butterworth, fourth order) has "
       "an amplitude, sqrt(2) times its root mean square over the last 1/30 s, above the just noticeable difference "
       "of the rest of the force; none at sampling rates of 60 Hz and less",
       if_any(m.rows_in_contact > 0 && m.vibration_is_sampled, share(m.vibration_rows, m.rows_in_contact)),
       Better::less},
      {"tactile_acceleration_rms_m_per_s2", "m/s2",
       "root mean square of the handle's acceleration between perception.band_Hz, where touch is most sensitive; "
       "none where half the sampling rate is within or below the band",
       m.acceleration_rms, Better::less},
      {"tactile_acceleration_over_threshold", "1",
       "the same over that of a vibration that is just felt, of perception.amplitude_at_250Hz_m; above 1 it "
       "is felt",
       if_any(m.acceleration_rms && m.threshold_rms > 0.0, rms / m.threshold_rms), Better::less}};
}

}  // namespace hapbench
