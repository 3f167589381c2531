#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "results/observe/metric_observer.hpp"
#include "sim/core/types.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench {

/// The force on the tool that the rendered one is to match [N]: measured with a stroke, or an ideal rendering's.
class ReferenceForce {
 public:
  struct Sample {
    double time = 0.0;  ///< [s], strictly increasing from sample to sample
    Vec3 force = Vec3::Zero();
  };
  using Ideal = std::array<Profile, 3>;  ///< x, y, z over time

  /// Measured. Precondition: there is a sample, and times increase.
  explicit ReferenceForce(std::vector<Sample> samples) : force_(std::move(samples)) {}
  explicit ReferenceForce(Ideal ideal) : force_(std::move(ideal)) {}

  /// The force at a time [s]: linear between samples; nothing before the first and after the last. O(log n).
  std::optional<Vec3> at(double t) const noexcept;

 private:
  std::variant<std::vector<Sample>, Ideal> force_;
};

/// Directions are compared where both forces exceed this [N].
inline constexpr double kLeastForce = 0.1;
/// Largest lag that is searched for, in both directions [s].
inline constexpr double kMostLag = 0.1;

/// The time by which one signal follows another.
struct Lag {
  double time = 0.0;             ///< [s]
  std::optional<double> period;  ///< distance to the next equally good answer [s], as of periodic signals
};

/// The time by which `late` follows `early`: the shift with the greatest correlation (Pearson's over all components of
/// the overlapping samples), refined by a parabola; of equally great ones, to 0.01, that nearest to 0. Nothing when
/// a signal does not vary, or the greatest value is at the end of the range +-`most` [s]. `dt` [s]. O(n most / dt).
std::optional<Lag> lag_between(const std::vector<Vec3>& early, const std::vector<Vec3>& late, double dt, double most);

/// Deviation of the rendered force f from the reference force f_m over the rows that have one (the evaluation of
/// Ruffaldi et al. 2006). The normal n of a row is that of f_spring, before damping and friction; where nothing is
/// rendered, that of f_m. Allocates nothing in a row, which takes about 50 ns.
class ForceFidelityObserver final : public MetricObserver {
 public:
  ForceFidelityObserver() = default;
  /// As `begin` does. `reference` must outlive it. `dt`: time from row to row [s]; `steps`: the most rows.
  ForceFidelityObserver(const ReferenceForce& reference, double dt, std::uint64_t steps);

  /// Precondition: the trial has a reference.
  void begin(const TrialParts& trial) override;
  void on_step(const StepRecord& record) noexcept override;
  void tell(Section& section) const override;

  /// f_m at the last row; nothing where nothing was measured.
  const std::optional<Vec3>& reference() const noexcept { return at_row_; }

 private:
  const ReferenceForce* force_ = nullptr;
  double dt_ = 0.0;
  std::uint64_t every_ = 1;  ///< every so many rows, one is kept for the lag
  std::optional<Vec3> at_row_;
  std::uint64_t rows_ = 0, direction_rows_ = 0;
  double direction_error_ = 0.0;  ///< sum of angles [rad]
  /// Sums of squares [N^2]: of f_m, of f, of the part of f across f_m (all of f where f_m is zero), of the error, of
  /// its parts along and across n.
  double reference_ = 0.0, rendered_ = 0.0, across_ = 0.0, error_ = 0.0, normal_ = 0.0, tangential_ = 0.0;
  double loads_ = 0.0, drag_ = 0.0;  ///< sums of N^2 and N |f_t| of f_m, N its normal part [N^2]
  std::vector<Vec3> kept_reference_, kept_rendered_;
};

}  // namespace hapbench
