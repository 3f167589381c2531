#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "results/io/columns.hpp"
#include "results/observe/butterworth.hpp"
#include "results/observe/contact_forces.hpp"
#include "results/observe/inside.hpp"
#include "sim/contact/contact_buffer.hpp"
#include "sim/core/hash.hpp"
#include "sim/loop/integrators/table.hpp"
#include "sim/loop/observer.hpp"

namespace hapbench {

/// How often a run left the range in which its integrator steps its friction stably. Friction is a damper with the
/// coefficient mu_s + mu_f |f_spring|, which a stiff law makes arbitrarily strong; an explicit integrator is stable up
/// to some coefficient only (leapfrog: 2 M / dt). Beyond it, each step reverses the sliding velocity and enlarges it:
/// an artefact of the integrator, not of the law.
struct ExplicitFriction {
  double limit = 0.0;                            ///< largest |f_spring| whose friction is stepped stably [N]
  std::uint64_t rows_beyond = 0;                 ///< rows with a larger |f_spring|
  std::optional<std::uint64_t> first_step = {};  ///< the first of those rows
};

/// Returns ExplicitFriction::limit [N], (B_max - mu_s) / mu_f with the largest coefficient B_max that the integrator
/// steps stably, for a tool of `mass` [kg] under friction mu_s [N s/m], mu_f [s/m]. Zero when mu_s alone is too much;
/// nothing when no force is too large: without mu_f, or where the integrator is stable on every damper.
std::optional<double> explicit_friction_limit(const IntegratorEntry& integrator, double mass, double dt, double mu_s,
                                              double mu_f);

/// Force steps that the contact reduction causes: as the tool slides, other contacts are kept, and the force jumps.
struct ReductionJumps {
  std::uint64_t changes = 0;               ///< rows whose set of kept points is another than the row before's
  std::optional<double> step_max_squared;  ///< largest squared force step of such rows in settled contact [N^2]
  /// The same over the other rows in settled contact [N^2], without the row after each change: there, the damping
  /// responds to the jump of the velocity.
  double step_max_squared_elsewhere = 0.0;

  ReductionJumps& operator+=(const ReductionJumps& other) noexcept;
  std::optional<double> step_max() const noexcept;  ///< [N]
  double step_max_elsewhere() const noexcept;       ///< [N]
  /// True when the force steps more than three times as far where the points change as it does elsewhere.
  bool stand_out() const noexcept;
};

/// Compares the points that a law sees from row to row. Allocates in the constructor only; about 1 ns a point.
class ReductionJumpObserver {
 public:
  /// `capacity`: the most contacts a row can have.
  explicit ReductionJumpObserver(std::size_t capacity) { last_.reserve(capacity); }

  /// Adds the next row: the contacts that the reduction kept, its squared force step [N^2], and whether it is in
  /// settled contact.
  void add(const ContactBuffer& kept, double step_squared, bool settled) noexcept;

  const ReductionJumps& jumps() const noexcept { return jumps_; }

 private:
  std::vector<std::uint32_t> last_;  ///< numbers of the points of the row before
  bool changed_ = false;             ///< they were others than those before
  ReductionJumps jumps_;
};

/// Sums up a run over all its rows, in order. Units and meanings are those of metric_list;
struct Metrics {
  std::uint64_t rows = 0;
  double force_max = 0.0, force_step_max = 0.0;
  double velocity_total_variation = 0.0;
  std::uint64_t force_reversals = 0;
  std::optional<double> vibration_power;  ///< nothing at a sampling rate of 60 Hz or less, or without rows
  /// Root mean square of the handle's speed above 30 Hz in the last quarter of the run, the largest of several runs
  /// [m/s].
  std::optional<double> last_quarter_vibration = {};
  double depth_max = 0.0;           ///< never negative
  std::optional<RatioRange> ratio;  ///< of all rendered contacts; nothing without contact
  double colliding_mean = 0.0;
  std::uint64_t colliding_max = 0;
  double rendered_mean = 0.0;
  std::uint64_t rendered_max = 0;
  std::uint64_t steps_in_contact = 0;
  std::optional<double> last_contact = {};
  double speed_max = 0.0;
  Vec3 final_position = Vec3::Zero();
  std::optional<ExplicitFriction> explicit_friction = {};  ///< nothing where friction cannot become unstable
  ContactForces contact = {};                              ///< forces of landings and of settled contact
  std::optional<ReductionJumps> reduction = {};            ///< nothing without a reduction
  std::optional<InsideMetrics> inside = {};                ///< of an InsideObserver; nothing without a solid
  std::uint64_t state_hash = 0;                            ///< over the bit patterns of p, v and f_render of every row
};

MetricList metric_list(const Metrics& metrics);
/// The coordinates of the final position.
MetricList final_position_list(const Metrics& metrics);

/// Combines several runs as if they were one: sums and means over the rows of all of them, and the last one's final
/// position. Differences between the last row of one run and the first of the next do not count. Precondition: at least
/// one run.
Metrics merged(const std::vector<Metrics>& runs) noexcept;

/// Settings of the metrics.
struct MetricsConfig {
  std::optional<double> friction_limit = {};  ///< of explicit_friction_limit [N]
  SettlingRule settling = {};
  std::uint64_t steps = 0;                       ///< of the run; 0: unknown, no vibration of its last quarter
  std::optional<std::size_t> most_reduced = {};  ///< the most contacts a row can have; none without a reduction
};

/// Computes the metrics while a run goes on, in constant memory; about 20 ns a row, 24 ns with a reduction. The
/// constructor allocates only for a reduction.
class MetricsObserver final : public Observer {
 public:
  /// `dt`: time from row to row [s], > 0.
  explicit MetricsObserver(double dt, const MetricsConfig& config = {});

  bool wants_ratio() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override;

  /// True when the last row was in settled contact.
  bool in_settled_contact() const noexcept { return settled_; }
  /// Metrics of the rows seen so far.
  Metrics metrics() const noexcept;

 private:
  void add_motion(const Vec3& position, const Vec3& v) noexcept;
  ForceChange add_force(const RenderedForce& force) noexcept;
  void add_contacts(const StepRecord& record, const ForceChange& change) noexcept;

  Metrics metrics_;                    ///< everything that needs no final division
  std::optional<HighPass> high_pass_;  ///< none when the sampling rate is too low
  LastQuarterVibration last_quarter_;
  ContactForceObserver contact_forces_;
  bool settled_ = false;
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
