#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>

#include "results/observe/metric_observer.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// Quantiles of numbers >= 0 in constant memory, by a shift and an increment each. A bin is the exponent and the first
/// five bits of the mantissa of the number's square (norms come as squares): 32 bins to a factor of two.
class MagnitudeHistogram {
 public:
  /// Largest relative error of a quantile between kLeast and kMost: half a bin of sqrt(33 / 32) - 1 = 1.55 %.
  static constexpr double kRelativeError = 0.0078;
  static constexpr double kLeast = 0x1p-30;  ///< smaller numbers count as 0
  static constexpr double kMost = 0x1p20;    ///< numbers from here on count as infinite

  /// Counts the number whose square this is. Precondition: square >= 0; at most 2^32 - 1 numbers in all.
  void add_square(double square) noexcept { ++counts_[bin_of(square)]; }

  /// The smallest number that at least the share p of all do not exceed; 0 without numbers. Precondition: 0 < p <= 1.
  double quantile(double p) const noexcept;

 private:
  static constexpr int kDroppedBits = 52 - 5;
  static constexpr std::uint64_t kFirst = std::bit_cast<std::uint64_t>(kLeast * kLeast) >> kDroppedBits;
  static constexpr std::uint64_t kEnd = std::bit_cast<std::uint64_t>(kMost * kMost) >> kDroppedBits;
  static constexpr std::size_t kBins = kEnd - kFirst + 2;  ///< including one for smaller and one for larger numbers

  static std::size_t bin_of(double square) noexcept {
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(square) >> kDroppedBits;
    return bits < kFirst ? 0 : bits < kEnd ? bits - kFirst + 1 : kBins - 1;
  }

  std::array<std::uint32_t, kBins> counts_{};
};

/// A Butterworth high pass of fourth order for a sampled vector signal, component by component: two biquads, from the
/// analogue prototype by the bilinear transform with the cutoff prewarped. Its gain is exactly 1/2 (-3 dB) at the
/// cutoff: |H(f)|^2 = 1 / (1 + (tan(pi fc / fs) / tan(pi f / fs))^8), 0 at f = 0 and 1 at half the sampling rate fs.
class HighPass {
 public:
  /// Cutoff and sampling rate [Hz]. Precondition: 0 < cutoff < sampling_rate / 2.
  HighPass(double cutoff, double sampling_rate);

  /// Filters one sample.
  Vec3 filter(const Vec3& sample) noexcept;
  /// Sets the state to that of a constant past input `value`: the output is exactly zero until the input changes.
  void settle_at(const Vec3& value) noexcept;

 private:
  /// y = b0 (1 - 2 z^-1 + z^-2) / (1 + a1 z^-1 + a2 z^-2) x, transposed direct form II.
  struct Biquad {
    double b0 = 0.0, a1 = 0.0, a2 = 0.0;
    Vec3 s1 = Vec3::Zero(), s2 = Vec3::Zero();
  };
  std::array<Biquad, 2> biquads_;
};

/// Motion and force above this frequency count as vibration [Hz]: voluntary hand movement stays below about 10 Hz, and
/// the sense of touch is most sensitive well above.
inline constexpr double kVibrationCutoff = 30.0;

/// The high-pass at kVibrationCutoff for a sample each `dt` seconds; nothing at a sampling rate of 60 Hz or less.
std::optional<HighPass> vibration_filter(double dt);

/// The mean square of a signal behind that high-pass.
class Vibration {
 public:
  /// Rows are `dt` seconds apart.
  explicit Vibration(double dt) : high_pass_(vibration_filter(dt)) {}
  /// Adds a row; the first, 0, of a trial sets the filter at rest. Rows that do not count are only filtered.
  void add(std::uint64_t row, const Vec3& signal, bool counts = true) noexcept;
  /// Forgets the rows so far, but not what the filter has of them.
  void count_anew() noexcept { rows_ = 0, sum_ = 0.0; }
  /// Over the rows that count, or as if there were so many; none at 60 Hz or less and without rows. And its root.
  std::optional<double> mean_square(std::optional<std::uint64_t> rows = {}) const noexcept;
  std::optional<double> rms(std::optional<std::uint64_t> rows = {}) const noexcept;

 private:
  std::optional<HighPass> high_pass_;
  std::uint64_t rows_ = 0;
  double sum_ = 0.0;
};

/// Root mean square of the handle's speed behind that high-pass in the last quarter of a run.
class LastQuarterVibration {
 public:
  /// The run has `steps` rows, `dt` seconds apart.
  LastQuarterVibration(std::uint64_t steps, double dt) : steps_(steps), vibration_(dt) {}
  /// Begins another trial of the run.
  void begin() noexcept;
  void add(std::uint64_t step, const Vec3& velocity) noexcept;
  /// Over the quarter that was begun last, of several trials the largest [m/s]; none at 60 Hz or less and without rows.
  std::optional<double> value() const noexcept;

 private:
  std::uint64_t steps_, quarter_ = 0;
  Vibration vibration_;
  std::optional<double> of_earlier_trials_;
};

/// The rows by which a run is judged: from a quarter of the time between first touch and end on; where the script
/// repeats, so many whole periods before the end as begin there or later, if one does.
class JudgedRows {
 public:
  /// The run has `steps` rows, its script a period of so many rows; 0: it does not repeat.
  JudgedRows(std::uint64_t steps, double period) : steps_(steps), period_(period) {}
  void touch(std::uint64_t step) noexcept;
  bool contain(std::uint64_t step) const noexcept { return begin_ && step >= *begin_; }
  /// The first of them; none before the first touch.
  const std::optional<std::uint64_t>& begin() const noexcept { return begin_; }
  std::uint64_t end() const noexcept { return steps_; }

 private:
  std::uint64_t steps_;
  double period_;
  std::optional<std::uint64_t> begin_;
};

/// Settled contact shorter than this has no metrics [s]: one period of the cutoff, the slowest vibration. Otherwise a
/// run that hammers, and so hardly settles, would look the calmest.
inline constexpr double kLeastSettled = 1.0 / kVibrationCutoff;

/// Separates a landing, whose impact is much the same under every algorithm, from the contact that follows. A first
/// touch is a row in contact after at least the settling time without, or since the start; the rows within the settling
/// time after it are its landing, the other rows in contact are settled. Times are rounded to whole rows.
struct SettlingRule {
  /// If given [s], all rows before are landing, and all rows in contact from then on are settled.
  std::optional<double> from;
  double time = 0.05;  ///< settling time [s]
};

/// The difference between a row's force and that of the row before.
struct ForceChange {
  double squared = 0.0;   ///< ||f_k - f_(k-1)||^2 [N^2]; 0 in the first row
  bool reverses = false;  ///< their inner product is negative
};

/// Sorts the rows of a run into landing, settled contact and the rest, and adds up their forces. Constant memory; a few
/// nanoseconds a row. The high-pass starts anew after each landing, at rest, so that the impact does not ring in it.
class ContactForces {
 public:
  enum class Phase { away, landing, settled };

  /// `dt`: time from row to row [s], > 0.
  ContactForces(double dt, const SettlingRule& rule);

  /// Begins another trial, in which nothing has been touched yet.
  void begin() noexcept;
  /// Adds the next row and returns its phase.
  Phase add(const Vec3& force, const ForceChange& change, bool in_contact) noexcept;
  void tell(Section& section) const;

  /// True with as much settled contact as its metrics need, kLeastSettled.
  bool has_settled() const noexcept { return settled() >= kLeastSettled; }

 private:
  Phase phase_of_next_row(bool in_contact) noexcept;
  Vec3 filtered(const Vec3& force, Phase phase) noexcept;
  double settled() const noexcept { return static_cast<double>(settled_rows_) * dt_; }  ///< [s]

  double dt_;
  std::uint64_t settling_rows_;
  std::optional<std::uint64_t> settled_from_;  ///< the rule's `from`, as a row
  std::optional<HighPass> high_pass_;          ///< nothing when the sampling rate is too low
  bool filtering_ = false, touched_ = false;   ///< in this trial: the high-pass has started; there was contact
  std::uint64_t row_ = 0, landing_end_ = 0;    ///< the next row, and the first after the last landing
  std::uint64_t rows_away_;                    ///< since the last contact

  std::uint64_t landings_ = 0, landing_rows_ = 0, settled_rows_ = 0;
  double landing_max_squared_ = 0.0, landing_step_max_squared_ = 0.0;  ///< as below, of landings
  double max_squared_ = 0.0, step_max_squared_ = 0.0;  ///< of settled rows: largest ||f||^2, ||f_k - f_(k-1)||^2 [N^2]
  double sum_ = 0.0, above_cutoff_squares_ = 0.0;      ///< of ||f|| [N]; of ||high-passed f||^2 [N^2]
  MagnitudeHistogram steps_;                           ///< ||f_k - f_(k-1)||
  std::uint64_t reversals_ = 0;                        ///< f_k with a negative inner product with f_(k-1)
};

}  // namespace hapbench
