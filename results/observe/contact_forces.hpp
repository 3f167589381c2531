#pragma once

#include <cstdint>
#include <optional>

#include "results/observe/butterworth.hpp"
#include "results/observe/magnitude_histogram.hpp"

namespace hapbench {

/// Motion and force above this frequency count as vibration [Hz]: voluntary movement of the hand stays below about 10
/// Hz, and the sense of touch is most alert to vibration well above.
inline constexpr double kVibrationCutoff = 30.0;

/// The high-pass at that frequency for one sample each `dt` seconds; none where the sampling rate is 60 Hz or less and
/// cannot hold it.
std::optional<HighPass> vibration_filter(double dt);

/// Settled contact shorter than this has no metrics [s]: one period of the cutoff, the longest that counts as
/// vibration. Of less, no vibration is seen whole, and a run that hammers and so hardly settles would look the calmest.
inline constexpr double kLeastSettled = 1.0 / kVibrationCutoff;

/// Tells a landing from the contact that follows. The blow of a first touch is set by the speed of arrival and by the
/// stiffness, and is much the same under every algorithm; what separates them comes after. A first touch is a row in
/// contact after at least the settling time without, or since the start; the rows within the settling time after it are
/// its landing, the other rows in contact are settled. Times count in whole rows, rounded.
struct SettlingRule {
  /// [s]; with it, all rows before are landing and all rows in contact from then on settled.
  std::optional<double> from;
  double time = 0.05;  ///< settling time [s]
};

/// f_render of landings and of settled contact, as sums and largest squares, so that runs add up.
struct ContactForces {
  std::uint64_t landings = 0;  ///< first touches
  std::uint64_t landing_rows = 0;
  double landing_max_squared = 0.0;       ///< largest ||f||^2 [N^2]
  double landing_step_max_squared = 0.0;  ///< largest ||f_k - f_(k-1)||^2 [N^2]

  std::uint64_t settled_rows = 0;
  double settled = 0.0;  ///< their time [s]
  double sum = 0.0;      ///< of ||f|| [N]
  double max_squared = 0.0;
  double step_max_squared = 0.0;
  MagnitudeHistogram steps;                    ///< ||f_k - f_(k-1)||
  std::optional<double> above_cutoff_squares;  ///< sum of ||high-passed f||^2 [N^2]; none at 60 Hz or less
  std::uint64_t reversals = 0;                 ///< f_k with a negative inner product with f_(k-1)

  /// As if the other run's rows came after these, but for the seam.
  ContactForces& operator+=(const ContactForces& other) noexcept;

  // What to report; nothing without such rows, of settled contact nothing below kLeastSettled.
  std::optional<double> landing_max() const noexcept;       ///< [N]
  std::optional<double> landing_step_max() const noexcept;  ///< [N]
  std::optional<double> mean() const noexcept;              ///< [N]
  std::optional<double> max() const noexcept;               ///< [N]
  std::optional<double> step_max() const noexcept;          ///< [N]
  /// 99 % of the steps are at most this [N], within MagnitudeHistogram::kRelativeError.
  std::optional<double> step_p99() const noexcept;
  std::optional<double> rms_above_cutoff() const noexcept;      ///< [N]
  std::optional<double> reversals_per_second() const noexcept;  ///< [1/s]
};

/// How a row's force differs from that of the row before.
struct ForceChange {
  double squared = 0.0;   ///< ||f_k - f_(k-1)||^2 [N^2]; 0 in the first row
  bool reverses = false;  ///< their inner product is negative
};

/// Sorts the rows of a run into landing, settled contact and the rest, and adds up their forces. Constant memory; a few
/// nanoseconds a row. The high-pass starts at the first settled row after each landing, at rest at its force, so that
/// the blow does not ring on in it.
class ContactForceObserver {
 public:
  enum class Phase { away, landing, settled };

  /// `dt`: time from row to row [s], > 0.
  ContactForceObserver(double dt, const SettlingRule& rule);

  /// The next row. Returns what it belongs to.
  Phase add(const Vec3& force, const ForceChange& change, bool in_contact) noexcept;

  ContactForces forces() const noexcept;

 private:
  Phase phase_of_next_row(bool in_contact) noexcept;
  Vec3 filtered(const Vec3& force, Phase phase) noexcept;

  double dt_;
  std::uint64_t settling_rows_;
  std::optional<std::uint64_t> settled_from_;  ///< the rule's `from`, as a row
  std::optional<HighPass> high_pass_;          ///< none when the sampling rate is too low
  bool filtering_ = false;                     ///< it has started
  std::uint64_t row_ = 0;
  std::uint64_t landing_end_ = 0;  ///< the row behind the last landing
  std::uint64_t rows_away_;        ///< since the last contact
  ContactForces forces_;
};

}  // namespace hapbench
