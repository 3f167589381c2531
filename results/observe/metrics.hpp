#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "results/observe/contact_forces.hpp"
#include "results/observe/explicit_friction.hpp"
#include "results/observe/high_pass.hpp"
#include "results/observe/reduction_jumps.hpp"
#include "sim/core/hash.hpp"
#include "sim/loop/observer.hpp"

namespace hapbench {

/// Figures that sum up a run. Sums and means run over all rows, in order.
struct Metrics {
  std::uint64_t rows = 0;
  double force_max = 0.0;                 ///< largest ||f_render|| [N]
  double force_step_max = 0.0;            ///< largest ||f_render_k - f_render_(k-1)|| [N]
  double velocity_total_variation = 0.0;  ///< sum ||v_k - v_(k-1)|| [m/s]: what a smooth motion has little of
  std::uint64_t force_reversals = 0;      ///< rows whose f_render has a negative inner product with the previous row's
  /// Mean of ||v||^2 after the 30 Hz high-pass, started as if v_0 had been held for ever [m^2/s^2]; none when the
  /// sampling rate is 60 Hz or less, or without rows.
  std::optional<double> vibration_power;
  double depth_max = 0.0;  ///< largest penetration depth of a colliding point [m]; never negative
  std::optional<RatioRange>
      ratio;                    ///< smallest and largest stiffness ratio of a rendered contact; none without contact
  double colliding_mean = 0.0;  ///< colliding points per row, rows without contact included
  std::uint64_t colliding_max = 0;
  double rendered_mean = 0.0;  ///< the same for the points the force law saw
  std::uint64_t rendered_max = 0;
  std::uint64_t steps_in_contact = 0;                      ///< rows with a colliding point
  std::optional<double> last_contact = {};                 ///< time of the last of them [s]
  double speed_max = 0.0;                                  ///< [m/s]
  Vec3 final_position = Vec3::Zero();                      ///< of the last row [m]
  std::optional<ExplicitFriction> explicit_friction = {};  ///< none where friction cannot become unstable
  ContactForces contact = {};                              ///< forces of landings and of settled contact
  std::optional<ReductionJumps> reduction = {};            ///< none without a reduction
  std::uint64_t state_hash = 0;                            ///< over the bit patterns of p, v and f_render of every row
};

/// Combines several runs as if they were one: sums and means over the rows of all of them, and the last one's final
/// position. Differences between the last row of one run and the first of the next do not count. Precondition: at least
/// one run.
Metrics merged(const std::vector<Metrics>& runs) noexcept;

/// What metrics depend on beside the rows.
struct MetricsConfig {
  std::optional<double> friction_limit = {};  ///< of explicit_friction_limit [N]
  SettlingRule settling = {};
  std::optional<std::size_t> most_reduced = {};  ///< the most contacts a row can have; none without a reduction
};

/// Computes the metrics while a run goes on, in constant memory; about 20 ns a row, 24 ns with a reduction. Only a
/// reduction makes the constructor allocate.
class MetricsObserver final : public Observer {
 public:
  /// `dt`: time from row to row [s], > 0.
  explicit MetricsObserver(double dt, const MetricsConfig& config = {});

  bool wants_ratio() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override;

  /// Metrics of the rows seen so far.
  Metrics metrics() const noexcept;

 private:
  void add_motion(const Vec3& position, const Vec3& v) noexcept;
  ForceChange add_force(const RenderedForce& force) noexcept;
  void add_contacts(const StepRecord& record, const ForceChange& change) noexcept;

  Metrics metrics_;                    ///< everything that needs no final division
  std::optional<HighPass> high_pass_;  ///< none when the sampling rate is too low
  ContactForceObserver contact_forces_;
  std::optional<ReductionJumpObserver> reduction_;
  double friction_limit_squared_ = std::numeric_limits<double>::infinity();
  Hash64 hash_;
  Vec3 last_velocity_ = Vec3::Zero();
  Vec3 last_force_ = Vec3::Zero();
  double force_max_squared_ = 0.0;
  double force_step_max_squared_ = 0.0;
  double speed_max_squared_ = 0.0;
  double vibration_sum_ = 0.0;
  std::uint64_t colliding_sum_ = 0;
  std::uint64_t rendered_sum_ = 0;
};

}  // namespace hapbench
