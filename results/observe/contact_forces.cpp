#include "results/observe/contact_forces.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

namespace hapbench {

MagnitudeHistogram& MagnitudeHistogram::operator+=(const MagnitudeHistogram& other) noexcept {
  std::transform(counts_.begin(), counts_.end(), other.counts_.begin(), counts_.begin(), std::plus<>());
  return *this;
}

double MagnitudeHistogram::quantile(double p) const noexcept {
  const std::uint64_t all = std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
  const auto rank = static_cast<std::uint64_t>(std::ceil(p * static_cast<double>(all)));
  std::size_t bin = 0;
  for (std::uint64_t counted = counts_[0]; counted < rank; counted += counts_[bin]) ++bin;
  if (bin == 0) return 0.0;
  if (bin == kBins - 1) return std::numeric_limits<double>::infinity();
  const auto edge = [](std::uint64_t bits) { return std::sqrt(std::bit_cast<double>(bits << kDroppedBits)); };
  return 0.5 * (edge(kFirst + bin - 1) + edge(kFirst + bin));
}

namespace {

std::uint64_t rows_in(double time, double dt) noexcept {
  // The bound exceeds every possible number of rows and fits the integer.
  return static_cast<std::uint64_t>(std::min(std::round(time / dt), 0x1p62));
}

std::optional<double> if_settled(const ContactForces& forces, double value) noexcept {
  return forces.settled >= kLeastSettled ? std::optional(value) : std::nullopt;
}

}  // namespace

ContactForces& ContactForces::operator+=(const ContactForces& other) noexcept {
  landings += other.landings;
  landing_rows += other.landing_rows;
  landing_max_squared = std::max(landing_max_squared, other.landing_max_squared);
  landing_step_max_squared = std::max(landing_step_max_squared, other.landing_step_max_squared);
  settled_rows += other.settled_rows;
  settled += other.settled;
  sum += other.sum;
  max_squared = std::max(max_squared, other.max_squared);
  step_max_squared = std::max(step_max_squared, other.step_max_squared);
  steps += other.steps;
  if (above_cutoff_squares && other.above_cutoff_squares) {
    *above_cutoff_squares += *other.above_cutoff_squares;
  } else {
    above_cutoff_squares.reset();
  }
  reversals += other.reversals;
  return *this;
}

std::optional<double> ContactForces::landing_max() const noexcept {
  return if_any(landing_rows > 0, std::sqrt(landing_max_squared));
}

std::optional<double> ContactForces::landing_step_max() const noexcept {
  return if_any(landing_rows > 0, std::sqrt(landing_step_max_squared));
}

std::optional<double> ContactForces::mean() const noexcept {
  return if_settled(*this, sum / static_cast<double>(settled_rows));
}

std::optional<double> ContactForces::max() const noexcept {
  return if_settled(*this, std::sqrt(max_squared));
}

std::optional<double> ContactForces::step_max() const noexcept {
  return if_settled(*this, std::sqrt(step_max_squared));
}

std::optional<double> ContactForces::step_p99() const noexcept {
  if (settled < kLeastSettled) return std::nullopt;
  // The middle of the highest bin may exceed all numbers in it.
  return std::min(steps.quantile(0.99), *step_max());
}

std::optional<double> ContactForces::rms_above_cutoff() const noexcept {
  if (!above_cutoff_squares) return std::nullopt;
  return if_settled(*this, std::sqrt(*above_cutoff_squares / static_cast<double>(settled_rows)));
}

std::optional<double> ContactForces::reversals_per_second() const noexcept {
  return if_settled(*this, static_cast<double>(reversals) / settled);
}

std::optional<HighPass> vibration_filter(double dt) {
  const double sampling_rate = 1.0 / dt;
  if (sampling_rate <= 2.0 * kVibrationCutoff) return std::nullopt;
  return HighPass(kVibrationCutoff, sampling_rate);
}

void LastQuarterVibration::add(std::uint64_t step, const Vec3& velocity) noexcept {
  if (!high_pass_ || steps_ == 0) return;
  if (const std::uint64_t quarter = step * 4 / steps_; quarter != quarter_) {
    quarter_ = quarter;
    rows_ = 0;
    sum_ = 0.0;
  }
  if (step == 0) high_pass_->settle_at(velocity);
  ++rows_;
  sum_ += high_pass_->filter(velocity).squaredNorm();
}

std::optional<double> LastQuarterVibration::value() const noexcept {
  return if_any(rows_ > 0, std::sqrt(sum_ / static_cast<double>(rows_)));
}

ContactForceObserver::ContactForceObserver(double dt, const SettlingRule& rule)
    : dt_(dt), settling_rows_(rows_in(rule.time, dt)), rows_away_(settling_rows_) {
  assert(dt > 0.0);
  if (rule.from) settled_from_ = rows_in(*rule.from, dt);
  high_pass_ = vibration_filter(dt);
  if (high_pass_) forces_.above_cutoff_squares = 0.0;
}

ContactForceObserver::Phase ContactForceObserver::phase_of_next_row(bool in_contact) noexcept {
  if (in_contact) {
    // Without a settling time, one row without contact suffices.
    const bool first_touch = rows_away_ >= settling_rows_ && (rows_away_ > 0 || forces_.landings == 0);
    rows_away_ = 0;
    if (first_touch) {
      ++forces_.landings;
      landing_end_ = row_ + settling_rows_;
    }
  } else {
    ++rows_away_;
  }
  const bool landing = settled_from_ ? row_ < *settled_from_ : row_ < landing_end_;
  ++row_;
  return landing ? Phase::landing : in_contact ? Phase::settled : Phase::away;
}

Vec3 ContactForceObserver::filtered(const Vec3& force, Phase phase) noexcept {
  if (phase == Phase::landing) filtering_ = false;
  if (phase == Phase::settled && !filtering_) {
    high_pass_->settle_at(force);
    filtering_ = true;
  }
  if (!filtering_) return Vec3::Zero();
  if (rows_away_ <= settling_rows_) return high_pass_->filter(force);
  // After a long time without contact the output has decayed; denormal numbers would be slow.
  if (rows_away_ == settling_rows_ + 1) high_pass_->settle_at(Vec3::Zero());
  return Vec3::Zero();
}

ContactForceObserver::Phase ContactForceObserver::add(const Vec3& force, const ForceChange& change,
                                                      bool in_contact) noexcept {
  const Phase phase = phase_of_next_row(in_contact);
  ContactForces& f = forces_;
  const double above_cutoff_squared = high_pass_ ? filtered(force, phase).squaredNorm() : 0.0;
  if (phase == Phase::away) return phase;

  const double squared = force.squaredNorm();
  if (phase == Phase::landing) {
    ++f.landing_rows;
    f.landing_max_squared = std::max(f.landing_max_squared, squared);
    f.landing_step_max_squared = std::max(f.landing_step_max_squared, change.squared);
    return phase;
  }
  ++f.settled_rows;
  f.sum += std::sqrt(squared);
  f.max_squared = std::max(f.max_squared, squared);
  f.step_max_squared = std::max(f.step_max_squared, change.squared);
  f.steps.add_square(change.squared);
  if (f.above_cutoff_squares) *f.above_cutoff_squares += above_cutoff_squared;
  if (change.reverses) ++f.reversals;
  return phase;
}

ContactForces ContactForceObserver::forces() const noexcept {
  ContactForces forces = forces_;
  forces.settled = static_cast<double>(forces.settled_rows) * dt_;
  return forces;
}

MetricList metric_list(const ContactForces& c) {
  return {
      {"landings", "1",
       "first touches: rows in contact after at least metrics.settling_s without contact, or since the start",
       c.landings},
      {"landing_force_max_N", "N",
       "largest ||f|| within metrics.settling_s after a first touch, or before metrics.from_s", c.landing_max(),
       Better::less},
      {"landing_force_step_max_N", "N", "largest ||f_k - f_(k-1)|| of those rows", c.landing_step_max(), Better::less},
      {"settled_s", "s",
       "time in settled contact: rows in contact that belong to no landing, times the time step; below 1/30 s, a "
       "period of the high-pass, the metrics of settled contact have no value",
       c.settled},
      {"force_mean_in_contact_N", "N", "mean ||f|| of the rows in settled contact", c.mean()},
      {"settled_force_max_N", "N", "largest ||f|| of the rows in settled contact", c.max()},
      Metric("force_step_p99_N", "N",
             "99 % of the rows in settled contact have at most this force step ||f_k - f_(k-1)||; within 0.8 %",
             c.step_p99(), Better::less)
          .within(MagnitudeHistogram::kRelativeError, MagnitudeHistogram::kLeast),
      {"settled_force_step_max_N", "N", "largest force step ||f_k - f_(k-1)|| of the rows in settled contact",
       c.step_max(), Better::less},
      {"force_rms_above_30Hz_N", "N",
       "vibration of the force, which the hand feels: root mean square of f behind a high-pass (Butterworth, "
       "fourth order, 30 Hz, started at rest at the end of each landing) over the rows in settled contact; none at "
       "sampling rates of 60 Hz or less",
       c.rms_above_cutoff(), Better::less},
      {"force_reversals_per_s", "1/s",
       "rows in settled contact whose f has a negative inner product with that of the row before, per settled_s",
       c.reversals_per_second(), Better::less}};
}

}  // namespace hapbench
