#pragma once

#include <cstdint>
#include <optional>

#include "results/observe/contact_forces.hpp"
#include "scenarios/analysis/stability/slow_bounces.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/core/hash.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/loop/simulation.hpp"

/// Observes the rows by which the end of a run is judged.
namespace hapbench {

/// Means over the last quarter of a run, unless a member says otherwise.
struct SettledState {
  /// Vibration of the handle above 30 Hz in the judged rows (JudgedRows) [m/s rms]; empty at sampling rates of 60 Hz or
  /// less.
  std::optional<double> vibration;
  double contacts = 0.0;    ///< mean number of rendered contacts, over the rows in contact
  double lambda_max = 0.0;  ///< largest eigenvalue of the mean S over these rows: the stiffness rendered, in units of K
};

/// Records where the tool ends and whether it touches, the vibration and bounces of the judged rows, and sums over the
/// current quarter. The current quarter at the end is the last one, unless the run was cut short because it came to
/// rest.
class LastRows final : public Observer {
 public:
  /// `alone`: there is nothing to touch, and all but the first quarter of the run is judged.
  explicit LastRows(const Scenario& scenario, bool alone = false);

  void on_step(const StepRecord& record) noexcept override;

  /// Returns true if the tool touched in any row.
  bool touched() const { return judged_.begin().has_value(); }
  /// Returns a hash of all positions of the handle (RunStability::motion_hash).
  std::uint64_t motion_hash() const { return motion_.value(); }
  bool goes_on_bouncing() const { return bounces_.go_on(); }
  /// Returns true if the tool ended without contact and beyond the box of the shell by more than `reach` [m].
  bool has_left(const PointShell& shell, double reach) const;
  /// `rests`: the run was cut short because nothing moves any more.
  SettledState state(bool rests) const;

 private:
  bool touches_ = false;
  Vec3 tip_ = Vec3::Zero();  ///< centre of the tip [m]
  Hash64 motion_;
  std::uint64_t steps_;
  JudgedRows judged_;
  Vibration vibration_;
  SlowBounces bounces_;
  std::uint64_t quarter_ = 0, rows_in_contact_ = 0, contacts_ = 0;
  Mat3 S_sum_ = Mat3::Zero();
};

}  // namespace hapbench
