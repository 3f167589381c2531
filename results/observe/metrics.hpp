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

/// The largest |f_spring| whose friction the integrator steps stably [N]. Friction is a damper of coefficient
/// mu_s + mu_f |f_spring|, which a stiff law makes arbitrarily strong; an explicit integrator is stable up to some
/// B_max only (leapfrog: 2 M / dt). Beyond it, which is no fault of the law, each step reverses and enlarges the
/// sliding velocity. Returns (B_max - mu_s) / mu_f for a tool of `mass` [kg] under friction mu_s [N s/m], mu_f [s/m]:
/// zero when mu_s alone is too much; nothing when no force is too large: without mu_f, or where every damper is stable.
std::optional<double> explicit_friction_limit(const IntegratorEntry& integrator, double mass, double dt, double mu_s,
                                              double mu_f);

/// Force steps that the contact reduction causes: as the tool slides, other points are kept, and the force jumps.
/// Allocates in the constructor only. About 1 ns a point where the points stay in their order; a row whose points or
/// their order change costs O(n log n), some 2 ns a point where both orders ascend.
class ReductionJumps {
 public:
  /// `capacity`: largest number of contacts of a row.
  explicit ReductionJumps(std::size_t capacity);

  /// Begins another trial, in which nothing has been touched yet.
  void begin() noexcept { last_.clear(); }
  /// Adds the next row: the contacts that the reduction kept, its squared force step [N^2], and whether it has settled.
  void add(const ContactBuffer& kept, double step_squared, bool settled) noexcept;

  /// Rows whose set of kept points is another than the row before's.
  std::uint64_t changes() const noexcept { return changes_; }
  /// Largest force step of such rows in settled contact [N]; none without any.
  std::optional<double> step_max() const noexcept {
    return step_max_squared_ ? std::optional(std::sqrt(*step_max_squared_)) : std::nullopt;
  }

 private:
  std::vector<std::uint32_t> last_;                      ///< numbers of the points of the row before, in its order
  std::vector<std::uint32_t> sorted_last_, sorted_now_;  ///< scratch of `add`
  std::uint64_t changes_ = 0;
  std::optional<double> step_max_squared_;  ///< [N^2]
};

/// The contact of a trial.
struct TrialContact {
  std::uint64_t rows = 0, in_contact = 0;  ///< all, and those with a colliding point
  std::optional<double> last = {};         ///< time of the last of those [s]
  double force_max_squared = 0.0;          ///< largest ||f||^2 of a row [N^2]

  /// Adds the counts and keeps the later time, where an empty one is the least, and the larger force.
  TrialContact operator+(const TrialContact& other) const noexcept {
    return {rows + other.rows, in_contact + other.in_contact, std::max(last, other.last),
            std::max(force_max_squared, other.force_max_squared)};
  }
};

/// Settings of the metrics.
struct MetricsConfig {
  std::optional<double> friction_limit = {};  ///< of explicit_friction_limit [N]
  SettlingRule settling = {};
  std::uint64_t steps = 0;                       ///< rows that count; 0: unknown, no vibration of the last quarter
  std::optional<std::size_t> most_reduced = {};  ///< the most contacts a row can have; none without a reduction
  std::uint64_t stride = 1;                      ///< one row in so many counts, as if the others were not there
};

/// The metrics that every run has, in constant memory; about 20 ns a row, 24 ns with a reduction, for which it
/// allocates. Of several trials they are those of one long run, with the last one's final position.
class MetricsObserver final : public MetricObserver {
 public:
  /// `dt`: time between rows that count [s], > 0.
  explicit MetricsObserver(double dt, const MetricsConfig& config = {});

  void begin(const TrialParts&) override { begin(); }
  void begin() noexcept;
  bool wants_ratio() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override;
  /// All but what `tell_end` tells.
  void tell(Section& section) const override;
  /// The metrics behind those of an InsideObserver.
  void tell_end(Section& section) const;

  /// True when the last row was in settled contact.
  bool in_settled_contact() const noexcept { return settled_; }
  /// True when settled contact was long enough for its metrics.
  bool has_settled() const noexcept { return contact_forces_.has_settled(); }
  std::uint64_t rows() const noexcept { return before_.rows + now_.rows; }
  /// The contact of the current trial: the one after the last `begin`.
  const TrialContact& trial() const noexcept { return now_; }
  /// Over the bit patterns of p, v and f_render of every row; of several trials the hash of their hashes.
  std::uint64_t state_hash() const noexcept;

 private:
  void add_motion(const Vec3& position, const Vec3& v) noexcept;
  ForceChange add_force(const RenderedForce& force) noexcept;
  void add_contacts(const StepRecord& record, const ForceChange& change) noexcept;
  void tell_motion_and_force(Section& section) const;
  void tell_contacts(Section& section) const;

  std::uint64_t stride_;
  std::uint64_t trials_ = 0;  ///< begun so far

  // State of the current trial, which `begin` resets.
  TrialContact now_;
  Hash64 hash_;
  bool settled_ = false;
  Vec3 last_velocity_ = Vec3::Zero();
  Vec3 last_force_ = Vec3::Zero();
  Vec3 position_ = Vec3::Zero();  ///< in the last row [m]

  // Sums and extremes over all trials; "before": over the trials before the current one.
  TrialContact before_;
  Hash64 hashes_before_;
  double velocity_variation_ = 0.0, speed_max_squared_ = 0.0;
  Vibration vibration_;
  LastQuarterVibration last_quarter_;
  std::uint64_t force_reversals_ = 0;
  double force_step_max_squared_ = 0.0;
  double depth_max_ = 0.0;
  /// Of all rendered contacts; not finite without any.
  RatioRange ratio_{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  std::uint64_t colliding_sum_ = 0, colliding_max_ = 0, rendered_sum_ = 0, rendered_max_ = 0;
  std::optional<double> friction_limit_;  ///< [N]; empty where friction cannot become unstable
  std::uint64_t rows_beyond_friction_ = 0;
  std::optional<std::uint64_t> first_beyond_friction_;  ///< in its trial
  ContactForces contact_forces_;
  std::optional<ReductionJumps> reduction_;  ///< none without a reduction
};

}  // namespace hapbench
