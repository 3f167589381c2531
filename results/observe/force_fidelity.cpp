#include "results/observe/force_fidelity.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <span>

#include "sim/core/math.hpp"

namespace hapbench {

std::optional<Vec3> ReferenceForce::at(double t) const noexcept {
  if (const Ideal* ideal = std::get_if<Ideal>(&force_)) return vector_at(*ideal, t);
  const std::vector<Sample>& samples = *std::get_if<std::vector<Sample>>(&force_);
  if (!(t >= samples.front().time && t <= samples.back().time)) return std::nullopt;
  const auto next = std::ranges::upper_bound(samples, t, {}, &Sample::time);
  if (next == samples.end()) return samples.back().force;
  const Sample& from = *(next - 1);
  return from.force + (t - from.time) / (next->time - from.time) * (next->force - from.force);
}

std::optional<Vec3> ReferenceForce::tip_at(double t) const noexcept {
  const std::optional<Vec3> force = hand_ ? at(t) : std::nullopt;
  if (!force) return std::nullopt;
  const auto& target = hand_->target;
  return vector_at(target, t) + *force / hand_->stiffness;
}

namespace {

/// Largest number of samples of each force that are kept to compute the lag. It limits the correlation to about 1e8
/// products, so that computing the lag does not take longer than the run.
constexpr std::uint64_t kMaxKept = 1u << 17;
constexpr double kKeptInterval = 5e-4;  ///< approximate shortest time between kept samples [s]

/// Returns Pearson's correlation coefficient over all components of two signals of equal length; nothing if one of the
/// signals does not vary.
std::optional<double> correlation(std::span<const Vec3> early, std::span<const Vec3> late) {
  const double n = static_cast<double>(early.size());
  const auto mean = [n](auto of) { return Vec3(std::accumulate(of.begin(), of.end(), Vec3(0.0, 0.0, 0.0)) / n); };
  const Vec3 early_mean = mean(early), late_mean = mean(late);
  double both = 0.0, early_square = 0.0, late_square = 0.0;
  for (std::size_t i = 0; i < early.size(); ++i) {
    const Vec3 a = early[i] - early_mean, b = late[i] - late_mean;
    both += a.dot(b);
    early_square += a.squaredNorm();
    late_square += b.squaredNorm();
  }
  // Ignore a variation that may be rounding error.
  const double rounding = 1e-24 * n * (early_mean.squaredNorm() + late_mean.squaredNorm());
  if (!(early_square > rounding && late_square > rounding)) return std::nullopt;
  return both / std::sqrt(early_square * late_square);
}

/// A maximum of the correlation of two signals as a function of the shift between them.
struct Peak {
  double shift = 0.0;   ///< shift at the maximum [samples]
  double value = 0.0;   ///< correlation at the maximum
  bool inside = false;  ///< true if the maximum is not at an end of the range of shifts
};

/// Returns the peaks whose height is within kSamePeak of the highest peak. `found`: correlations at the shifts -m, …,
/// m. Two maxima count as separate peaks only if the correlation between them falls below the largest correlation minus
/// kDip, so noise does not split a peak.
std::vector<Peak> largest_peaks(const std::vector<double>& found) {
  constexpr double kDip = 0.1, kSamePeak = 0.01;
  const double threshold = std::ranges::max(found) - kDip;
  std::vector<Peak> peaks;
  for (auto from = found.begin(); from != found.end();) {
    from = std::find_if(from, found.end(), [threshold](double value) { return value >= threshold; });
    const auto to = std::find_if(from, found.end(), [threshold](double value) { return value < threshold; });
    if (from == to) break;
    const auto top = std::max_element(from, to);
    Peak peak{static_cast<double>(top - found.begin()) - 0.5 * static_cast<double>(found.size() - 1), *top,
              top != found.begin() && top != found.end() - 1};
    if (peak.inside) {  // refine by the parabola through the top and its neighbours
      const double below = *(top - 1), above = *(top + 1), curvature = below - 2.0 * *top + above;
      const double part = curvature < 0.0 ? 0.5 * (below - above) / curvature : 0.0;
      peak.shift += part;
      peak.value += 0.25 * (above - below) * part;
    }
    peaks.push_back(peak);
    from = to;
  }
  double largest = 0.0;
  for (const Peak& peak : peaks) largest = std::max(largest, peak.value);
  std::erase_if(peaks, [largest](const Peak& peak) { return peak.value < largest - kSamePeak; });
  return peaks;
}

}  // namespace

std::optional<Lag> lag_between(const std::vector<Vec3>& early, const std::vector<Vec3>& late, double dt,
                               double max_lag) {
  const std::size_t n = std::min(early.size(), late.size());
  // At least half of the samples must overlap.
  const std::size_t half = n / 2;
  const auto reach = static_cast<std::ptrdiff_t>(std::min(std::round(max_lag / dt), static_cast<double>(half)));
  // Compute the correlation at each shift.
  std::vector<double> found;
  for (std::ptrdiff_t shift = -reach; shift <= reach; ++shift) {
    const auto by = static_cast<std::size_t>(std::abs(shift));
    if (n < by + 3) return std::nullopt;
    const auto coefficient = correlation(std::span(early).subspan(shift < 0 ? by : 0, n - by),
                                         std::span(late).subspan(shift > 0 ? by : 0, n - by));
    if (!coefficient) return std::nullopt;
    found.push_back(*coefficient);
  }
  // If several peaks are equally high, choose the peak nearest to shift 0. The period is the distance from the chosen
  // peak to the nearest other peak.
  const std::vector<Peak> peaks = largest_peaks(found);
  const Peak* nearest = nullptr;
  for (const Peak& peak : peaks) {
    if (peak.inside && (nearest == nullptr || std::abs(peak.shift) < std::abs(nearest->shift))) nearest = &peak;
  }
  if (nearest == nullptr) return std::nullopt;
  Lag lag{nearest->shift * dt, {}};
  for (const Peak& peak : peaks) {
    const double distance = std::abs(peak.shift - nearest->shift) * dt;
    if (&peak != nearest && (!lag.period || distance < *lag.period)) lag.period = distance;
  }
  return lag;
}

ForceFidelityObserver::ForceFidelityObserver(const ReferenceForce& reference, double dt, std::uint64_t steps)
    : force_(&reference), dt_(dt) {
  every_ = std::max<std::uint64_t>(
      {1, (steps + kMaxKept - 1) / kMaxKept, static_cast<std::uint64_t>(std::floor(kKeptInterval / dt))});
  const auto kept = static_cast<std::size_t>(steps / every_ + 1);
  kept_reference_.reserve(kept);
  kept_rendered_.reserve(kept);
}

void ForceFidelityObserver::begin(const TrialParts& trial) {
  *this = ForceFidelityObserver(*trial.reference, trial.config.dt, trial.config.steps);
}

void ForceFidelityObserver::on_step(const StepRecord& record) noexcept {
  at_row_ = force_->at(record.time);
  if (!at_row_) return;
  const Vec3 &reference = *at_row_, &rendered = record.force.rendered;
  const Vec3 error = rendered - reference;
  const double norm = reference.norm(), rendered_norm = rendered.norm();
  const Vec3 direction = unit_or(reference, Vec3::Zero());
  const Vec3 normal = unit_or(record.force.spring, direction);
  const double along = normal.dot(error);
  ++rows_;
  if (const auto tip = force_->tip_at(record.time)) displacement_ += (record.tool.pose.position - *tip).squaredNorm();
  reference_ += norm * norm;
  error_ += error.squaredNorm();
  normal_ += along * along;
  tangential_ += (error - along * normal).squaredNorm();
  // Add the step to the sums of squares: `loads_` and `drag_` fit the friction coefficient by least squares.
  const double load = std::max(0.0, normal.dot(reference));
  loads_ += load * load;
  drag_ += load * (reference - load * normal).norm();
  across_ += (rendered - direction.dot(rendered) * direction).squaredNorm();
  rendered_ += rendered_norm * rendered_norm;
  if (norm > kMinForce && rendered_norm > kMinForce) {
    ++direction_rows_;
    // Use atan2, because the arc cosine would lose half of the digits for angles near 0.
    direction_error_ += math::atan2(reference.cross(rendered).norm(), reference.dot(rendered));
  }
  if (record.step % every_ == 0 && kept_reference_.size() < kept_reference_.capacity()) {
    kept_reference_.push_back(reference);
    kept_rendered_.push_back(rendered);
  }
}

void ForceFidelityObserver::add_members(nlohmann::ordered_json& section) const {
  if (force_ != nullptr && force_->error() > 0.0) section["reference_error_N"] = force_->error();
}

void ForceFidelityObserver::report(Section& s) const {
  // A comparison ranks two laws by a metric only if the difference of their values exceeds the sum of the two
  // tolerances. Each tolerance is five times the error of the reference force, so laws are ranked only by differences
  // of at least ten times this error.
  constexpr double kPerTolerance = 5.0;
  const double reference_error = force_ == nullptr ? 0.0 : kPerTolerance * force_->error();
  const auto limited = [reference_error](Metric& metric, double per_newton) -> Metric& {
    return reference_error > 0.0 ? metric.within(0.0, reference_error * per_newton) : metric;
  };
  const auto rms = [this](double squares) { return std::sqrt(per(squares, rows_)); };
  s.metric(
      "rows", "1",
      "number of steps that have a reference force f_m = (mfx_N, mfy_N, mfz_N) of force_reference.csv (measured with "
      "the stroke, or given by reference_force)",
      rows_);
  s.metric("reference_force_rms_N", "N",
           "root mean square of ||f_m||, the reference force (mfx_N, mfy_N, mfz_N of force_reference.csv)",
           rms(reference_))
      .varies_smoothly();
  limited(s.metric("force_error_rms_N", "N",
                   "root mean square of ||f - f_m||, rendered force minus reference force (force_error_x_N, "
                   "force_error_y_N, force_error_z_N of force_reference.csv)",
                   rms(error_), Better::less)
              .varies_smoothly(),
          1.0);
  limited(s.metric("force_error_relative", "1", "relative force error: force_error_rms_N / reference_force_rms_N",
                   rms(error_) / rms(reference_), Better::less)
              .varies_smoothly(),
          1.0 / rms(reference_));
  limited(
      s.metric("force_error_normal_rms_N", "N",
               "root mean square of the force error along the contact normal, n n^T (f - f_m), with n = f_spring / "
               "||f_spring|| (fspring_x_N, fspring_y_N, fspring_z_N of trajectory.csv); where f_spring is zero, n = "
               "f_m / ||f_m||",
               rms(normal_), Better::less),
      1.0);
  limited(s.metric("force_error_tangential_rms_N", "N",
                   "root mean square of the force error across the contact normal, (I - n n^T) (f - f_m), with n as in "
                   "force_error_normal_rms_N",
                   rms(tangential_), Better::less),
          1.0);
  s.metric(
      "reference_mu", "1",
      "coefficient of dry friction of the reference force: least-squares fit (through 0) of the size of its component "
      "across n to its component along n (0 where this component is negative), with n as in force_error_normal_rms_N; "
      "to find the coefficient that minimises the rendered tangential error, sweep rendering.friction.mu",
      drag_ / loads_);
  limited(s.metric(
              "force_artefact_share", "1",
              "root mean square of the component of f (fx_N, fy_N, fz_N of trajectory.csv) across f_m (all of f where "
              "f_m is zero), divided by the root mean square of ||f||: fraction of the rendered force that points in a "
              "wrong direction",
              rms(across_) / rms(rendered_), Better::less),
          1.0 / rms(rendered_));
  s.metric("direction_rows", "1", "number of steps in which ||f|| and ||f_m|| are both above 0.1 N", direction_rows_);
  limited(s.metric("force_direction_error_rad", "rad",
                   "mean angle between f and f_m over the steps in which both are above 0.1 N; no value without such a "
                   "step",
                   per(direction_error_, direction_rows_), Better::less),
          1.0 / kMinForce);
  const bool has_hand = force_ != nullptr && force_->hand();
  limited(
      s.metric(
           "displacement_rms_m", "m",
           "root mean square of the distance from the tip centre to the position hand.target + f_m / "
           "hand.stiffness_N_per_m, where the same hand would hold a rigid tool without friction; no value if no hand "
           "with a target moves the tool",
           has_hand ? std::optional(rms(displacement_)) : std::nullopt, Better::less)
          .varies_smoothly(),
      has_hand ? 1.0 / force_->hand()->stiffness : 0.0);
  const double interval = dt_ * static_cast<double>(every_);  // time between kept samples
  const auto lag = lag_between(kept_reference_, kept_rendered_, interval, kMaxLag);
  s.metric(
       "force_lag_s", "s",
       "delay of f (fx_N, fy_N, fz_N of trajectory.csv) behind f_m: time shift with the largest correlation (Pearson, "
       "all components) within +-0.1 s; if several maxima are equally large, as with a periodic force, the shift "
       "nearest to 0; resolution: half the spacing of the compared samples; no value if the maximum is at an end of "
       "the range or if a force is constant",
       lag ? std::optional(lag->time) : std::nullopt)
      .within(0.0, 0.5 * interval)
      .has_either_sign();
  s.metric(
      "force_lag_period_s", "s",
      "spacing of equally large maxima (within 0.01) of the correlation behind force_lag_s: the lag is known only up "
      "to multiples of this period; no value if the lag is unambiguous",
      lag ? lag->period : std::nullopt);
}

}  // namespace hapbench
