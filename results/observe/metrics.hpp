#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "results/observe/contact_forces.hpp"
#include "results/observe/metric_observer.hpp"
#include "sim/contact/contact_buffer.hpp"
#include "sim/core/hash.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {

/// Returns the largest |f_spring| [N] at which an explicit integrator simulates friction stably: (B_max - mu_s) / mu_f,
/// for a tool of `mass` [kg] and the friction coefficients mu_s [N s/m] and mu_f [s/m]. Friction is a damper with
/// coefficient mu_s + mu_f |f_spring|, which a stiff force law makes arbitrarily strong, and an explicit integrator is
/// stable only up to some damper B_max (leapfrog: 2 M / dt). Above the limit each step reverses and enlarges the
/// sliding velocity, whatever the force law. Returns zero if mu_s exceeds B_max. Returns nothing if there is no limit:
/// mu_f is zero, or the integrator is stable with every damper.
std::optional<double> explicit_friction_limit(const IntegratorEntry& integrator, double mass, double dt, double mu_s,
                                              double mu_f);

/// Measures force steps caused by the contact reduction: while the tool slides, the set of kept points changes and the
/// force jumps. Allocates only in the constructor. A step with the same points in the same order as in the previous
/// step costs about 1 ns for each point. Any other step costs about 2 ns for each point if the indices of the points
/// are in ascending order in this step and in the previous step, otherwise O(n log n) for n points.
class ReductionJumps {
 public:
  /// `capacity`: largest number of contacts in a step.
  explicit ReductionJumps(std::size_t capacity);

  /// Begins the next trial, in which the tool has not been in contact yet. Keeps the counts of earlier trials.
  void begin() noexcept { last_.clear(); }
  /// Adds the next step. `kept`: contacts that the reduction kept. `step_squared`: squared force step [N^2].
  /// `settled`: the step is in settled contact.
  void add(const ContactBuffer& kept, double step_squared, bool settled) noexcept;

  /// Number of steps whose set of kept points differs from the set of the previous step.
  std::uint64_t changes() const noexcept { return changes_; }
  /// Largest force step [N] among the steps in settled contact that changes() counts; nothing if changes() counts no
  /// such step.
  std::optional<double> step_max() const noexcept {
    return step_max_squared_ ? std::optional(std::sqrt(*step_max_squared_)) : std::nullopt;
  }

 private:
  std::vector<std::uint32_t> last_;                      ///< point indices of the previous step, in its order
  std::vector<std::uint32_t> sorted_last_, sorted_now_;  ///< scratch memory of `add`
  std::uint64_t changes_ = 0;
  std::optional<double> step_max_squared_;  ///< [N^2]
};

/// Contact statistics of a trial.
struct TrialContact {
  std::uint64_t rows = 0, in_contact = 0;  ///< all steps, and steps with a colliding point
  std::optional<double> last = {};         ///< time of the last step with a colliding point [s]
  double force_max_squared = 0.0;          ///< largest ||f||^2 of a step [N^2]

  /// Returns the statistics of both trials together: sums of the counts, the later time, the larger force.
  TrialContact operator+(const TrialContact& other) const noexcept {
    return {rows + other.rows, in_contact + other.in_contact, std::max(last, other.last),
            std::max(force_max_squared, other.force_max_squared)};
  }
};

/// Settings of MetricsObserver.
struct MetricsConfig {
  std::optional<double> friction_limit = {};  ///< explicit_friction_limit [N]; empty: no limit
  SettlingRule settling = {};
  /// Number of counted steps. 0: unknown; the vibration of the last quarter is then not measured.
  std::uint64_t steps = 0;
  std::optional<std::size_t> reduction_capacity = {};  ///< largest number of contacts in a step; empty: no reduction
  std::uint64_t stride = 1;  ///< only every `stride`-th step counts; all other steps are ignored
  std::uint64_t first = 0;   ///< first step that counts; < stride
};

/// Measures the metrics that every run has. Allocates only in the constructor: two bytes for each counted step, and the
/// memory of ReductionJumps if there is a reduction. About 20 ns a step, 24 ns with a reduction. Several trials are
/// treated as one long run, which ends at the final position of the last trial.
class MetricsObserver final : public MetricObserver {
 public:
  /// `dt`: time between counted steps [s], > 0.
  explicit MetricsObserver(double dt, const MetricsConfig& config = {});

  void begin(const TrialParts&) override { begin(); }
  void begin() noexcept;
  bool wants_ratio() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override;
  /// Reports all metrics except the metrics of `report_end`.
  void report(Section& section) const override;
  /// Reports the remaining metrics, which come after the metrics of an InsideObserver in summary.json.
  void report_end(Section& section) const;

  /// Returns true if the last step was in settled contact.
  bool in_settled_contact() const noexcept { return settled_; }
  /// Returns true if settled contact was long enough for the metrics of settled contact (kMinSettledTime).
  bool has_settled() const noexcept { return contact_forces_.has_settled(); }
  std::uint64_t rows() const noexcept { return before_.rows + now_.rows; }
  /// Contact statistics of the current trial, since the last `begin`.
  const TrialContact& trial() const noexcept { return now_; }
  /// Hash of the bit patterns of position, velocity and f_render of every step; for several trials, a hash of the
  /// hashes of the trials.
  std::uint64_t state_hash() const noexcept;

 private:
  void add_motion(const Vec3& position, const Vec3& v) noexcept;
  ForceChange add_force(const RenderedForce& force) noexcept;
  void add_contacts(const StepRecord& record, const ForceChange& change) noexcept;
  void report_motion_and_force(Section& section) const;
  void report_contacts(Section& section) const;

  std::uint64_t stride_, first_;
  std::uint64_t trials_ = 0;  ///< number of trials begun so far

  // State of the current trial. `begin` resets these members.
  TrialContact now_;
  Hash64 hash_;
  bool settled_ = false;
  Vec3 last_velocity_ = Vec3::Zero();
  Vec3 last_force_ = Vec3::Zero();
  Vec3 position_ = Vec3::Zero();  ///< tip centre in the last step [m]

  // Sums and extremes over all trials. The names with "before" exclude the current trial.
  TrialContact before_;
  Hash64 hashes_before_;
  double velocity_variation_ = 0.0, speed_max_squared_ = 0.0;
  Vibration vibration_;
  LastQuarterVibration last_quarter_;
  std::uint64_t force_reversals_ = 0;
  double force_step_max_squared_ = 0.0;
  double depth_max_ = 0.0;
  /// Smallest and largest stiffness ratio of all rendered contacts; not finite without contacts.
  RatioRange ratio_{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  std::uint64_t colliding_sum_ = 0, colliding_max_ = 0, rendered_sum_ = 0, rendered_max_ = 0;
  std::optional<double> friction_limit_;  ///< [N]; empty if friction cannot become unstable
  std::uint64_t rows_beyond_friction_ = 0;
  /// Number of the first step in which |f_spring| exceeds friction_limit_, within the trial of this step; empty if
  /// |f_spring| never exceeds friction_limit_.
  std::optional<std::uint64_t> first_beyond_friction_;
  ContactForces contact_forces_;
  std::optional<ReductionJumps> reduction_;  ///< empty without a reduction
};

}  // namespace hapbench
