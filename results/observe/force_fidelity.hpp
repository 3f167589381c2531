#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "results/io/columns.hpp"
#include "sim/core/profile.hpp"
#include "sim/core/types.hpp"
#include "sim/loop/observer.hpp"

namespace hapbench {

/// The force on the tool that the rendered one is to match [N]: measured while a stroke was recorded, or what an ideal
/// rendering would give, where that is known.
class ReferenceForce {
 public:
  struct Sample {
    double time = 0.0;  ///< [s], strictly increasing from sample to sample
    Vec3 force = Vec3::Zero();
  };
  using Ideal = std::array<Profile, 3>;  ///< x, y, z over time

  /// Measured. Throws std::invalid_argument when there is no sample or times do not increase.
  explicit ReferenceForce(std::vector<Sample> samples);
  explicit ReferenceForce(Ideal ideal) : force_(std::move(ideal)) {}

  /// The force at a time [s]: linear between samples; nothing before the first and after the last. O(log n).
  std::optional<Vec3> at(double t) const noexcept;

 private:
  std::variant<std::vector<Sample>, Ideal> force_;
};

/// Deviation of the rendered force f from the reference force f_m over the rows that have one (the evaluation of
/// Ruffaldi et al. 2006). The normal n of a row is that of the rendered force, f_spring / ||f_spring||, before damping
/// and friction; where nothing is rendered, that of f_m. Hence the squares of the normal and the tangential error add
/// up to the square of the whole error. metric_list documents the numbers that it reports.
struct ForceFidelity {
  std::uint64_t rows = 0;                                                               ///< compared
  double reference_rms = 0.0, error_rms = 0.0, normal_rms = 0.0, tangential_rms = 0.0;  ///< [N]
  double across_rms = 0.0;    ///< rms of the part of f across f_m, of all of f where f_m is zero [N]
  double rendered_rms = 0.0;  ///< rms ||f|| [N]
  double reference_loads = 0.0, reference_drag = 0.0;  ///< sums of N^2 and N |f_t| of f_m, N its normal part [N^2]
  std::uint64_t direction_rows = 0;
  double direction_error = 0.0;      ///< [rad]
  std::optional<double> lag;         ///< [s]
  double lag_within = 0.0;           ///< half the time between the rows that are compared [s]
  std::optional<double> lag_period;  ///< [s], of an ambiguous lag

  /// rms error in units of that of f_m; nothing where f_m is zero throughout.
  std::optional<double> relative() const noexcept;
  /// The coefficient of dry friction mu that fits f_m best, |f_t| = mu N by least squares; nothing without a load.
  std::optional<double> reference_mu() const noexcept;
  /// Share of the rendered force that an ideal one would not have: across_rms / rendered_rms; nothing without force.
  std::optional<double> artefact_share() const noexcept;
};

MetricList metric_list(const ForceFidelity& fidelity);

/// Directions are compared where both forces exceed this [N].
inline constexpr double kLeastForce = 0.1;
/// Largest lag that is searched for, in both directions [s].
inline constexpr double kMostLag = 0.1;

/// The time by which one signal follows another.
struct Lag {
  double time = 0.0;             ///< [s]
  std::optional<double> period;  ///< distance to the next equally good answer [s], as of periodic signals
};

/// Returns the time by which `late` follows `early`: the shift with the greatest correlation (Pearson's over all three
/// components of the overlapping samples), refined by a parabola through the greatest value and its neighbours. Of
/// equally great ones, to 0.01 of the coefficient, it is that nearest to 0. Nothing when either signal does not vary,
/// or when the greatest value is at the end of the range +-`most` [s]. `dt`: time between samples [s]. O(n most / dt).
std::optional<Lag> lag_between(const std::vector<Vec3>& early, const std::vector<Vec3>& late, double dt, double most);

/// Compares every row. Allocates in the constructor and in metrics(), not in a row; about 50 ns a row.
class ForceFidelityObserver final : public Observer {
 public:
  /// `reference` must outlive it. `dt`: time from row to row [s]; `steps`: the most rows.
  ForceFidelityObserver(const ReferenceForce& reference, double dt, std::uint64_t steps);

  void on_step(const StepRecord& record) noexcept override;

  /// f_m at the last row; nothing where nothing was measured.
  const std::optional<Vec3>& reference() const noexcept { return at_row_; }
  ForceFidelity metrics() const;

 private:
  const ReferenceForce* reference_;
  double dt_;
  std::uint64_t every_;  ///< every so many rows, one is kept for the lag
  std::optional<Vec3> at_row_;
  ForceFidelity sums_;  ///< of squares and angles, where the metrics have roots and means
  std::vector<Vec3> kept_reference_, kept_rendered_;
};

}  // namespace hapbench
