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

/// Force with which the rendered force on the tool is compared [N]: a force that was measured together with a
/// recorded motion of the tool (a stroke), or the force that an ideal rendering would give.
class ReferenceForce {
 public:
  struct Sample {
    double time = 0.0;  ///< [s], strictly increasing from sample to sample
    Vec3 force = Vec3::Zero();
  };
  using Ideal = std::array<Profile, 3>;  ///< x, y, z of the force over time
  /// The spring of a hand that pulls the tool to a moving target. In static equilibrium with the reference force f_m, a
  /// rigid tool rests at target + f_m / stiffness.
  struct HandSpring {
    std::array<Profile, 3> target;  ///< [m]
    double stiffness;               ///< [N/m]
  };

  /// Measured force. Precondition: at least one sample, and times increase.
  /// `error`: largest error of a sample [N]. `hand`: the spring of the hand that is in equilibrium with the force;
  /// empty without such a spring.
  explicit ReferenceForce(std::vector<Sample> samples, double error = 0.0, std::optional<HandSpring> hand = {})
      : force_(std::move(samples)), error_(error), hand_(std::move(hand)) {}
  explicit ReferenceForce(Ideal ideal) : force_(std::move(ideal)) {}

  /// Returns the force at time t [s]. A force given by samples is interpolated linearly; before the first and after the
  /// last sample, returns nothing. Cost: O(log n) for n samples.
  std::optional<Vec3> at(double t) const noexcept;
  /// Returns the tip centre [m] of a rigid tool that is in equilibrium under the hand's spring and the reference force
  /// at time t. Empty without a hand spring, or if `at(t)` is empty.
  std::optional<Vec3> tip_at(double t) const noexcept;
  /// Upper bound of the numerical error of the reference force [N]; 0 for a given or measured force.
  double error() const noexcept { return error_; }
  const std::optional<HandSpring>& hand() const noexcept { return hand_; }

 private:
  std::variant<std::vector<Sample>, Ideal> force_;
  double error_ = 0.0;
  std::optional<HandSpring> hand_;
};

/// Directions of two forces are compared if both exceed this value [N]; weaker forces have no meaningful direction.
inline constexpr double kMinForce = 0.1;
/// Largest magnitude of a lag in the search [s]: lags from -kMaxLag to kMaxLag are tried.
inline constexpr double kMaxLag = 0.1;

/// Time lag of a signal behind another signal.
struct Lag {
  double time = 0.0;  ///< lag [s], > 0 if the signal is late
  /// Distance from `time` to the nearest other lag with the same correlation [s]; empty if no other lag has the same
  /// correlation. For a periodic signal, this is the period.
  std::optional<double> period;
};

/// Returns the lag of `late` behind `early`: the shift with the largest correlation (Pearson, over all components of
/// the overlapping samples), refined by a parabola. If several shifts have correlations that are equally large within
/// 0.01, returns the shift nearest to 0. Returns nothing if a signal does not vary, or if the maximum is at an end of
/// the range +-`max_lag` [s]. `dt`: time between samples [s]. Cost: O(n max_lag / dt).
std::optional<Lag> lag_between(const std::vector<Vec3>& early, const std::vector<Vec3>& late, double dt,
                               double max_lag);

/// Measures the deviation of the rendered force f from the reference force f_m, in the steps with a reference force
/// (evaluation of Ruffaldi et al. 2006). The normal n of a step is the direction of f_spring, the force before damping
/// and friction. If f_spring is zero, n is the direction of f_m. Allocates nothing during the run; about 50 ns a step.
class ForceFidelityObserver final : public MetricObserver {
 public:
  ForceFidelityObserver() = default;
  /// Same effect as `begin` of a trial with these values. Precondition: `reference` outlives this object. `dt`: time
  /// step [s]; `steps`: largest number of steps.
  ForceFidelityObserver(const ReferenceForce& reference, double dt, std::uint64_t steps);

  /// Precondition: the trial has a reference force.
  void begin(const TrialParts& trial) override;
  void on_step(const StepRecord& record) noexcept override;
  void report(Section& section) const override;
  /// Adds reference_error_N, if the reference force has an error.
  void add_members(nlohmann::ordered_json& section) const override;

  /// Reference force f_m in the last step [N]; empty if the step has no reference force.
  const std::optional<Vec3>& reference() const noexcept { return at_row_; }

 private:
  const ReferenceForce* force_ = nullptr;
  double dt_ = 0.0;
  std::uint64_t every_ = 1;  ///< the forces of steps 0, every_, 2 every_, … are kept, to compute the lag
  std::optional<Vec3> at_row_;
  std::uint64_t rows_ = 0, direction_rows_ = 0;
  double displacement_ = 0.0;     ///< sum of the squared distances between the tip and ReferenceForce::tip_at() [m^2]
  double direction_error_ = 0.0;  ///< sum of the angles between f and f_m [rad]
  /// Sums of squares [N^2]: of f_m, of f, of the component of f perpendicular to f_m (all of f if f_m is zero), of
  /// the error f - f_m, and of the error's components along n and perpendicular to n.
  double reference_ = 0.0, rendered_ = 0.0, across_ = 0.0, error_ = 0.0, normal_ = 0.0, tangential_ = 0.0;
  double loads_ = 0.0, drag_ = 0.0;  ///< sums of N^2 and N |f_t| [N^2]; N, f_t: normal and tangential part of f_m
  std::vector<Vec3> kept_reference_, kept_rendered_;  ///< f_m and f of the kept steps, to compute the lag
};

}  // namespace hapbench
