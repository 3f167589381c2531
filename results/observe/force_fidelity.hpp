#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "results/observe/reference_force.hpp"
#include "sim/loop/observer.hpp"

namespace hapbench {

/// How near the rendered force f comes to the reference force f_m over the rows in which there is one (the evaluation
/// of Ruffaldi et al. 2006). The normal n of a row is that of what is rendered, f_spring / ||f_spring||, before damping
/// and friction; where nothing is rendered, that of f_m. So the squares of both parts sum up to that of
/// the whole.
struct ForceFidelity {
  std::uint64_t rows = 0;            ///< compared
  double reference_rms = 0.0;        ///< rms ||f_m|| [N]
  double error_rms = 0.0;            ///< rms ||f - f_m|| [N]
  double normal_rms = 0.0;           ///< the same of n n^T (f - f_m)
  double tangential_rms = 0.0;       ///< the same of (I - n n^T) (f - f_m)
  double across_rms = 0.0;           ///< rms of the part of f across f_m, of all of f where f_m is zero [N]
  double rendered_rms = 0.0;         ///< rms ||f|| [N]
  std::uint64_t direction_rows = 0;  ///< rows in which f and f_m both exceed kLeastForce
  double direction_error = 0.0;      ///< mean angle between them in those rows [rad]
  std::optional<double> lag;         ///< how long f comes after f_m [s]; none where either does not vary

  /// rms error in units of that of f_m; none where f_m is zero throughout.
  std::optional<double> relative() const noexcept;
  /// Share of the rendered force that an ideal one would not have: across_rms / rendered_rms; none without force.
  std::optional<double> artefact_share() const noexcept;
};

/// Forces below have no direction worth comparing [N].
inline constexpr double kLeastForce = 0.1;
/// Lags are looked for up to here, either way [s].
inline constexpr double kMostLag = 0.1;

/// The time by which `late` follows `early` [s]: where the correlation of both (Pearson's over all three components,
/// of the samples that overlap) is greatest, by a parabola through the greatest and its neighbours. None when either
/// does not vary, or when the greatest is at the end of +-`most`: then there is no lag within it. `dt`: between
/// samples. O(n most / dt).
std::optional<double> lag_between(const std::vector<Vec3>& early, const std::vector<Vec3>& late, double dt,
                                  double most);

/// Compares every row. Allocates when made and when asked for the metrics, not in a row; about 50 ns for each.
class ForceFidelityObserver final : public Observer {
 public:
  /// `reference` must outlive it. `dt`: time from row to row [s]; `steps`: the most rows.
  ForceFidelityObserver(const ReferenceForce& reference, double dt, std::uint64_t steps);

  void on_step(const StepRecord& record) noexcept override;

  /// f_m at the last row; none where nothing was measured.
  const std::optional<Vec3>& reference() const noexcept { return at_row_; }
  ForceFidelity metrics() const;

 private:
  const ReferenceForce* reference_;
  double dt_;
  std::uint64_t every_;  ///< rows from one that is kept for the lag to the next
  std::optional<Vec3> at_row_;
  ForceFidelity sums_;  ///< of squares and angles, where the metrics have roots and means
  std::vector<Vec3> kept_reference_, kept_rendered_;
};

}  // namespace hapbench
