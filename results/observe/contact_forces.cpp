#include "results/observe/contact_forces.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "sim/core/math.hpp"

namespace hapbench {

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

// The analogue prototype has a section s^2 / (s^2 + s/Q + 1) for each pair of complex poles, with 1/Q = 2 cos(pi/8)
// and 2 cos(3 pi/8). Substituting s = (1 - z^-1) / (k (1 + z^-1)), where k = tan(pi fc / fs), gives with n = 1 / (1
// + k/Q + k^2): a1 = 2 n (k^2 - 1), a2 = n (1 - k/Q + k^2), b0 = n, b1 = -2n, b2 = n.
HighPass::HighPass(double cutoff, double sampling_rate) {
  assert(0.0 < cutoff && cutoff < 0.5 * sampling_rate);
  const double k = math::tan(std::numbers::pi * cutoff / sampling_rate);
  const double pole_angles[] = {std::numbers::pi / 8.0, 3.0 * std::numbers::pi / 8.0};
  for (std::size_t i = 0; i < biquads_.size(); ++i) {
    const double k_over_q = k * 2.0 * math::cos(pole_angles[i]);
    const double n = 1.0 / (1.0 + k_over_q + k * k);
    biquads_[i].b0 = n;
    biquads_[i].a1 = 2.0 * n * (k * k - 1.0);
    biquads_[i].a2 = n * (1.0 - k_over_q + k * k);
  }
}

Vec3 HighPass::filter(const Vec3& sample) noexcept {
  Vec3 x = sample;
  for (Biquad& q : biquads_) {
    const Vec3 bx = q.b0 * x;
    const Vec3 y = bx + q.s1;
    q.s1 = -2.0 * bx - q.a1 * y + q.s2;
    q.s2 = bx - q.a2 * y;
    x = y;
  }
  return x;
}

// In steady state the first section maps the constant input x to 0, so s1 = -b0 x and s2 = b2 x = b0 x. The input of
// the second section is then 0. The output is exactly 0, because `filter` then only adds b0 x, -b0 x and -2 b0 x, which
// involves no rounding.
void HighPass::settle_at(const Vec3& value) noexcept {
  biquads_[0].s1 = -(biquads_[0].b0 * value);
  biquads_[0].s2 = biquads_[0].b0 * value;
  biquads_[1].s1 = biquads_[1].s2 = Vec3::Zero();
}

namespace {

std::uint64_t rows_in(double time, double dt) noexcept {
  // The bound 2^62 exceeds every possible number of steps, and fits into std::uint64_t.
  return static_cast<std::uint64_t>(std::min(std::round(time / dt), 0x1p62));
}

}  // namespace

std::optional<HighPass> vibration_filter(double dt) {
  const double sampling_rate = 1.0 / dt;
  if (sampling_rate <= 2.0 * kVibrationCutoff) return std::nullopt;
  return HighPass(kVibrationCutoff, sampling_rate);
}

void Vibration::add(std::uint64_t row, const Vec3& signal, bool counts) noexcept {
  if (!high_pass_) return;
  if (row == 0) high_pass_->settle_at(signal);
  last_square_ = high_pass_->filter(signal).squaredNorm();
  if (!counts) return;
  ++rows_;
  sum_ += last_square_;
}

std::optional<double> Vibration::mean_square(std::optional<std::uint64_t> rows) const noexcept {
  const std::uint64_t over = rows.value_or(rows_);
  return if_any(high_pass_ && over > 0, per(sum_, over));
}

std::optional<double> Vibration::rms(std::optional<std::uint64_t> rows) const noexcept {
  const auto square = mean_square(rows);
  return square ? std::optional(std::sqrt(*square)) : std::nullopt;
}

void LastQuarterVibration::begin() noexcept {
  of_earlier_trials_ = value();
  quarter_ = rows_ = 0;
  squares_.clear();
  vibration_.restart_count();
}

void LastQuarterVibration::add(std::uint64_t step, const Vec3& velocity) noexcept {
  if (steps_ == 0) return;
  const std::uint64_t quarter = step * 4 / steps_;
  if (quarter != std::exchange(quarter_, quarter)) vibration_.restart_count();
  vibration_.add(step, velocity);
  // Keep as many squares as a quarter of the planned steps, which is enough for the last quarter of a run that ends
  // early. The constructor has reserved the memory.
  if (squares_.size() < squares_.capacity())
    squares_.push_back(vibration_.last_square());
  else
    squares_[rows_ % squares_.size()] = vibration_.last_square();
  ++rows_;
}

std::optional<double> LastQuarterVibration::of_trial() const noexcept {
  if (rows_ == steps_ || rows_ == 0) return vibration_.rms();
  // Sum over the last quarter of the executed steps: the steps i with 4 i >= 3 rows_. The run may have ended early.
  const std::uint64_t from = (3 * rows_ + 3) / 4;
  double sum = 0.0;
  for (std::uint64_t i = from; i < rows_; ++i) sum += squares_[i % squares_.size()];
  return if_any(vibration_.rms().has_value() && from < rows_,
                std::sqrt(sum / static_cast<double>(std::max<std::uint64_t>(1, rows_ - from))));
}

std::optional<double> LastQuarterVibration::value() const noexcept {
  return std::max(of_earlier_trials_, of_trial());  // an empty optional compares less than any number
}

void EvaluationWindow::touch(std::uint64_t step) noexcept {
  if (begin_) return;
  const std::uint64_t quarter = step + (steps_ - step) / 4;
  begin_ = quarter;
  const double periods = period_ > 0.0 ? std::floor(static_cast<double>(steps_ - quarter) / period_) : 0.0;
  if (periods > 0.0) begin_ = steps_ - static_cast<std::uint64_t>(std::round(periods * period_));
}

ContactForces::ContactForces(double dt, const SettlingRule& rule)
    : dt_(dt), settling_rows_(rows_in(rule.time, dt)), high_pass_(vibration_filter(dt)), rows_away_(settling_rows_) {
  assert(dt > 0.0);
  if (rule.from) settled_from_ = rows_in(*rule.from, dt);
}

void ContactForces::begin() noexcept {
  filtering_ = touched_ = false;
  row_ = landing_end_ = 0;
  rows_away_ = settling_rows_;
}

ContactForces::Phase ContactForces::phase_of_next_row(bool in_contact) noexcept {
  if (in_contact) {
    // A first touch is a contact after at least the settling time without contact, or the first contact of the trial
    // (`begin` sets rows_away_ to settling_rows_). If the settling time is 0, one step without contact is enough.
    const bool first_touch = rows_away_ >= settling_rows_ && (rows_away_ > 0 || !touched_);
    rows_away_ = 0;
    if (first_touch) {
      ++landings_;
      touched_ = true;
      landing_end_ = row_ + settling_rows_;
    }
  } else {
    ++rows_away_;
  }
  const bool landing = settled_from_ ? row_ < *settled_from_ : row_ < landing_end_;
  ++row_;
  return landing ? Phase::landing : in_contact ? Phase::settled : Phase::away;
}

Vec3 ContactForces::filtered(const Vec3& force, Phase phase) noexcept {
  if (phase == Phase::landing) filtering_ = false;
  if (phase == Phase::settled && !filtering_) {
    high_pass_->settle_at(force);
    filtering_ = true;
  }
  if (!filtering_) return Vec3::Zero();
  if (rows_away_ <= settling_rows_) return high_pass_->filter(force);
  // After a long time without contact, the output of the filter has decayed. Set the output to zero, because denormal
  // numbers would be slow.
  if (rows_away_ == settling_rows_ + 1) high_pass_->settle_at(Vec3::Zero());
  return Vec3::Zero();
}

ContactForces::Phase ContactForces::add(const Vec3& force, const ForceChange& change, bool in_contact) noexcept {
  const Phase phase = phase_of_next_row(in_contact);
  const double above_cutoff_squared = high_pass_ ? filtered(force, phase).squaredNorm() : 0.0;
  if (phase == Phase::away) return phase;

  // Add the step to the statistics of its phase.
  const double squared = force.squaredNorm();
  if (phase == Phase::landing) {
    ++landing_rows_;
    landing_max_squared_ = std::max(landing_max_squared_, squared);
    landing_step_max_squared_ = std::max(landing_step_max_squared_, change.squared);
    return phase;
  }
  ++settled_rows_;
  sum_ += std::sqrt(squared);
  max_squared_ = std::max(max_squared_, squared);
  step_max_squared_ = std::max(step_max_squared_, change.squared);
  steps_.add_square(change.squared);
  above_cutoff_squares_ += above_cutoff_squared;
  if (change.reverses) ++reversals_;
  return phase;
}

void ContactForces::report(Section& s) const {
  const bool landed = landing_rows_ > 0, is_settled = has_settled();
  const auto rows = static_cast<double>(settled_rows_);
  s.metric(
      "landings", "1",
      "number of first touches: the first step in contact of the run (colliding of trajectory.csv > 0), and each step "
      "in contact that follows at least metrics.settling_s without contact; times are rounded to whole steps",
      landings_);
  s.metric(
      "landing_force_max_N", "N",
      "largest norm of the rendered force, max ||f||, during landings (metrics.settling_s from a first touch on, or "
      "all steps before metrics.from_s if it is given), with f = (fx_N, fy_N, fz_N) of trajectory.csv; no value "
      "without a landing",
      if_any(landed, std::sqrt(landing_max_squared_)), Better::less);
  s.metric("landing_force_step_max_N", "N",
           "largest force step ||f_k - f_(k-1)|| from one time step to the next during landings (as "
           "landing_force_max_N); no value without a landing",
           if_any(landed, std::sqrt(landing_step_max_squared_)), Better::less);
  s.metric(
      "settled_s", "s",
      "duration of settled contact: number of steps in contact that belong to no landing, times the time step; below "
      "1/30 s, one period of the 30 Hz high-pass, the metrics of settled contact have no value",
      settled());
  s.metric(
      "force_mean_in_contact_N", "N",
      "mean norm of the rendered force, mean ||f||, over the steps in settled contact; no value if settled_s < 1/30 s",
      if_any(is_settled, sum_ / rows));
  s.metric("settled_force_max_N", "N",
           "largest norm of the rendered force, max ||f||, in settled contact; no value if settled_s < 1/30 s",
           if_any(is_settled, std::sqrt(max_squared_)));
  s.metric(
       "force_step_p99_N", "N",
       "99th percentile (nearest rank) of the force step ||f_k - f_(k-1)|| from one time step to the next in settled "
       "contact; "
       "relative error at most 0.8 %; no value if settled_s < 1/30 s",
       // A quantile is the middle of a bin and can exceed all numbers in this bin. Limit it to the largest force step.
       if_any(is_settled, std::min(steps_.quantile(0.99), std::sqrt(step_max_squared_))), Better::less)
      .within(MagnitudeHistogram::kRelativeError, MagnitudeHistogram::kSmallest);
  s.metric(
      "settled_force_step_max_N", "N",
      "largest force step ||f_k - f_(k-1)|| from one time step to the next in settled contact; no value if settled_s "
      "< 1/30 s",
      if_any(is_settled, std::sqrt(step_max_squared_)), Better::less);
  s.metric(
      "force_rms_above_30Hz_N", "N",
      "vibration of the rendered force: root mean square of f = (fx_N, fy_N, fz_N) of trajectory.csv after the 30 Hz "
      "high-pass (as vibration_power_above_30Hz_m2_per_s2) over the steps in settled contact. The filter starts in "
      "steady state at the first step in settled contact after each landing. Until the next landing, it also filters "
      "the steps without contact, and is reset to zero after more than metrics.settling_s without contact. No value at "
      "sampling rates of 60 Hz or less or if settled_s < 1/30 s",
      if_any(is_settled && high_pass_.has_value(), std::sqrt(above_cutoff_squares_ / rows)), Better::less);
  s.metric("force_reversals_per_s", "1/s",
           "number of reversals in settled contact per second: steps whose force has a negative inner product with the "
           "force of the previous step, f_k . f_(k-1) < 0, divided by settled_s; no value if settled_s < 1/30 s",
           if_any(is_settled, per(reversals_, settled())), Better::less);
}

}  // namespace hapbench
