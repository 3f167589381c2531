#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>

#include "results/observe/metric_observer.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// Histogram for quantiles of numbers >= 0, in constant memory. A bin is given by the exponent and the first five
/// bits of the mantissa of the number's square, so there are 32 bins per factor of two of the square. Bins use
/// squares, because the caller computes norms as squares.
class MagnitudeHistogram {
 public:
  /// Largest relative error of a quantile between kSmallest and kLargest: half of the relative bin width, which is
  /// sqrt(33 / 32) - 1 = 1.55 %.
  static constexpr double kRelativeError = 0.0078;
  static constexpr double kSmallest = 0x1p-30;  ///< numbers below this value count as 0
  static constexpr double kLargest = 0x1p20;    ///< numbers >= this value count as infinite

  /// Counts the number whose square is `square`. Precondition: square >= 0; at most 2^32 - 1 numbers in total.
  void add_square(double square) noexcept { ++counts_[bin_of(square)]; }

  /// Returns the p-quantile by nearest rank: the smallest number x for which at least the fraction p of all numbers is
  /// not larger than x. Returns 0 without numbers. Precondition: 0 < p <= 1.
  double quantile(double p) const noexcept;

 private:
  static constexpr int kDroppedBits = 52 - 5;
  static constexpr std::uint64_t kFirst = std::bit_cast<std::uint64_t>(kSmallest * kSmallest) >> kDroppedBits;
  static constexpr std::uint64_t kEnd = std::bit_cast<std::uint64_t>(kLargest * kLargest) >> kDroppedBits;
  /// Number of bins, including one bin for all numbers < kSmallest and one bin for all numbers >= kLargest.
  static constexpr std::size_t kBins = kEnd - kFirst + 2;

  static std::size_t bin_of(double square) noexcept {
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(square) >> kDroppedBits;
    return bits < kFirst ? 0 : bits < kEnd ? bits - kFirst + 1 : kBins - 1;
  }

  std::array<std::uint32_t, kBins> counts_{};
};

/// Fourth-order Butterworth high-pass filter of a sampled vector signal, component by component. Two biquads, made
/// from the analogue prototype by the bilinear transform with prewarped cutoff. The gain at the cutoff is exactly
/// 1/sqrt(2) (-3 dB): |H(f)|^2 = 1 / (1 + (tan(pi fc / fs) / tan(pi f / fs))^8), which is 0 at f = 0 and 1 at half
/// the sampling rate fs.
class HighPass {
 public:
  /// Cutoff and sampling rate [Hz]. Precondition: 0 < cutoff < sampling_rate / 2.
  HighPass(double cutoff, double sampling_rate);

  /// Filters one sample.
  Vec3 filter(const Vec3& sample) noexcept;
  /// Sets the steady state of a constant input `value`: the output is exactly zero until the input changes.
  void settle_at(const Vec3& value) noexcept;

 private:
  /// Second-order section y = b0 (1 - 2 z^-1 + z^-2) / (1 + a1 z^-1 + a2 z^-2) x in transposed direct form II.
  struct Biquad {
    double b0 = 0.0, a1 = 0.0, a2 = 0.0;
    Vec3 s1 = Vec3::Zero(), s2 = Vec3::Zero();
  };
  std::array<Biquad, 2> biquads_;
};

/// Motion and force above this frequency count as vibration [Hz]. Voluntary hand movement stays below about 10 Hz,
/// and the sense of touch is most sensitive well above 30 Hz.
inline constexpr double kVibrationCutoff = 30.0;

/// Returns the high-pass filter with the cutoff kVibrationCutoff for a signal that is sampled every `dt` seconds.
/// Returns nothing at a sampling rate of 60 Hz or less.
std::optional<HighPass> vibration_filter(double dt);

/// Mean square of a signal after the high-pass filter at kVibrationCutoff.
class Vibration {
 public:
  /// `dt`: time step [s].
  explicit Vibration(double dt) : high_pass_(vibration_filter(dt)) {}
  /// Adds the sample `signal` of step `row` of a trial. Step 0 sets the filter to the steady state of `signal`. If
  /// `counts` is false, the sample is filtered but not added to the mean.
  void add(std::uint64_t row, const Vec3& signal, bool counts = true) noexcept;
  /// Returns the squared norm of the last sample after the filter; 0 at sampling rates of 60 Hz or less.
  double last_square() const noexcept { return last_square_; }
  /// Restarts the mean, but keeps the filter's state.
  void restart_count() noexcept { rows_ = 0, sum_ = 0.0; }
  /// Return the mean square and its root. The sum is divided by the number of counted samples, or by `rows` if given.
  /// Return nothing at sampling rates of 60 Hz or less, and nothing without samples.
  std::optional<double> mean_square(std::optional<std::uint64_t> rows = {}) const noexcept;
  std::optional<double> rms(std::optional<std::uint64_t> rows = {}) const noexcept;

 private:
  std::optional<HighPass> high_pass_;
  std::uint64_t rows_ = 0;
  double sum_ = 0.0;
  double last_square_ = 0.0;
};

/// Measures the root mean square of the handle's velocity after the high-pass filter at kVibrationCutoff, in the last
/// quarter of a run [m/s]. If a run ends early, the last quarter of the executed steps counts. Uses two bytes for each
/// planned step.
class LastQuarterVibration {
 public:
  /// The run has at most `steps` steps of `dt` seconds. Only the constructor allocates.
  LastQuarterVibration(std::uint64_t steps, double dt) : steps_(steps), vibration_(dt) {
    if (steps > 0) squares_.reserve(steps / 4 + 1);
  }
  /// Begins the next trial of the run.
  void begin() noexcept;
  void add(std::uint64_t step, const Vec3& velocity) noexcept;
  /// Returns the root mean square over the last quarter of the executed steps of a trial; the largest of these values
  /// if there were several trials. Returns nothing at sampling rates of 60 Hz or less, and nothing without samples.
  std::optional<double> value() const noexcept;

 private:
  std::optional<double> of_trial() const noexcept;

  std::uint64_t steps_, quarter_ = 0;
  std::uint64_t rows_ = 0;  ///< steps of this trial so far
  /// Ring buffer of the squared norms of the filtered velocity [m^2/s^2], for a quarter of the planned steps.
  std::vector<double> squares_;
  Vibration vibration_;
  std::optional<double> of_earlier_trials_;
};

/// The steps over which the end of a run is evaluated. The window ends with the run. It begins when a quarter of the
/// time from the first touch to the end has passed. If the script repeats, the window is shortened at its beginning
/// to whole periods, provided that at least one period fits.
class EvaluationWindow {
 public:
  /// The run has `steps` steps. `period`: period of the script [steps]; 0: the script does not repeat.
  EvaluationWindow(std::uint64_t steps, double period) : steps_(steps), period_(period) {}
  /// Records that the tool is in contact in `step`. Only the first call has an effect.
  void touch(std::uint64_t step) noexcept;
  bool contain(std::uint64_t step) const noexcept { return begin_ && step >= *begin_; }
  /// First evaluated step; empty before the first touch.
  const std::optional<std::uint64_t>& begin() const noexcept { return begin_; }
  std::uint64_t end() const noexcept { return steps_; }

 private:
  std::uint64_t steps_;
  double period_;
  std::optional<std::uint64_t> begin_;
};

/// Minimum duration of settled contact in a run [s]. If settled contact is shorter, the metrics of settled contact have
/// no value. The minimum is one period at kVibrationCutoff. Without a minimum, a run in which the tool repeatedly hits
/// the surface and hardly settles would have the smallest vibration.
inline constexpr double kMinSettledTime = 1.0 / kVibrationCutoff;

/// Separates landings from settled contact, because the impact of a landing is similar under every algorithm. A first
/// touch is the first contact of a trial, or a step in contact after at least the settling time without contact. All
/// steps within the settling time after a first touch are a landing, even steps without contact. All other steps in
/// contact are settled contact. Times are rounded to whole steps.
struct SettlingRule {
  /// Fixed time at which landing ends [s]: all steps before `from` are a landing, and all later steps in contact are
  /// settled contact. Empty: first touches decide, as described above.
  std::optional<double> from;
  double time = 0.05;  ///< settling time [s]
};

/// Difference between the forces of a step and of the previous step.
struct ForceChange {
  double squared = 0.0;   ///< ||f_k - f_(k-1)||^2 [N^2]; 0 in the first step
  bool reverses = false;  ///< true if the inner product of f_k and f_(k-1) is negative
};

/// Classifies each step of a run as landing, settled contact or away (no contact), and accumulates force statistics of
/// landings and of settled contact. Constant memory; a few nanoseconds a step. After each landing, the high-pass filter
/// restarts in steady state, so that the impact does not make the filter ring.
class ContactForces {
 public:
  enum class Phase { away, landing, settled };

  /// `dt`: time step [s], > 0.
  ContactForces(double dt, const SettlingRule& rule);

  /// Begins the next trial, in which the tool has not been in contact yet. Keeps the statistics of earlier trials.
  void begin() noexcept;
  /// Adds the next step and returns its phase. `force`: rendered force [N].
  Phase add(const Vec3& force, const ForceChange& change, bool in_contact) noexcept;
  void report(Section& section) const;

  /// Returns true if settled contact lasted for at least kMinSettledTime.
  bool has_settled() const noexcept { return settled() >= kMinSettledTime; }

 private:
  Phase phase_of_next_row(bool in_contact) noexcept;
  Vec3 filtered(const Vec3& force, Phase phase) noexcept;
  double settled() const noexcept { return static_cast<double>(settled_rows_) * dt_; }  ///< [s]

  double dt_;
  std::uint64_t settling_rows_;
  std::optional<std::uint64_t> settled_from_;  ///< the rule's `from` as a step number
  std::optional<HighPass> high_pass_;          ///< empty if the sampling rate is too low
  /// filtering_: true while the high-pass filter runs. touched_: true after the first contact of this trial.
  bool filtering_ = false, touched_ = false;
  /// row_: number of the next step. landing_end_: number of the first step after the last landing.
  std::uint64_t row_ = 0, landing_end_ = 0;
  std::uint64_t rows_away_;  ///< steps since the last contact

  std::uint64_t landings_ = 0, landing_rows_ = 0, settled_rows_ = 0;
  /// During landings: largest ||f||^2, and largest ||f_k - f_(k-1)||^2 [N^2].
  double landing_max_squared_ = 0.0, landing_step_max_squared_ = 0.0;
  /// In settled contact: largest ||f||^2 and largest ||f_k - f_(k-1)||^2 [N^2].
  double max_squared_ = 0.0, step_max_squared_ = 0.0;
  /// In settled contact: sum of ||f|| [N], and sum of the squared norm of the high-pass filtered force [N^2].
  double sum_ = 0.0, above_cutoff_squares_ = 0.0;
  MagnitudeHistogram steps_;     ///< force steps ||f_k - f_(k-1)|| in settled contact [N]
  std::uint64_t reversals_ = 0;  ///< steps in settled contact with a negative inner product of f_k and f_(k-1)
};

}  // namespace hapbench
