#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "scenarios/run/linear_contact.hpp"
#include "scenarios/run/outcome.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/core/types.hpp"
#include "sim/loop/simulation.hpp"

namespace hapbench {

/// Quantities that the diagnosis rules need, accumulated over the steps of all trials of a run. The exceptions:
/// `last_quarter` covers only the quarter of the planned duration in which the last trial ended, and the other members
/// with `last` in their names are of the last trial, too.
struct RunObservations {
  std::uint64_t in_contact = 0;  ///< number of steps in contact
  /// Number of steps in contact whose rendered force reaches the force limit of device or rendering.
  std::uint64_t at_force_limit = 0;
  /// Number of steps in contact whose hand force reaches the input limit of the device.
  std::uint64_t at_input_limit = 0;
  /// Number of steps in contact in which the spring force of an external law points deeper into the surface at every
  /// contact. Empty for a built-in law and for springs.
  std::optional<std::uint64_t> inward = {};
  /// Path length of the tip in contact [m]. Motion along the spring force is left out: a vibration normal to the
  /// surface is no path.
  double path_in_contact = 0.0;
  /// Largest OutcomeObserver::longest_step() of all trials [m].
  double longest_step = 0.0;
  Vec3 last_force = Vec3::Zero();  ///< rendered force in the last step [N]
  /// Spring force of the rendering, and force of the hand on the handle, in the last step [N].
  Vec3 last_spring = Vec3::Zero(), last_hand_force = Vec3::Zero();
  /// On an impedance device: largest energy that its motors had given in any trial, minus the energy that the springs
  /// of the rendering held at the start of the trial [J]; at least 0. It includes the delay and the limits of the
  /// device. Empty for other devices.
  std::optional<double> created_by_motors;
  /// State at the last step in contact before the tool passed through the surface (OutcomeObserver::has_passed()),
  /// over all trials.
  std::optional<ContactState> last_contact;
  struct Quarter {
    std::uint64_t rows = 0;
    bool always_in_contact = true;  ///< true if every step of the quarter is in contact
    Vec3 start = Vec3::Zero();      ///< tip position in the first step of the quarter [m]
  } last_quarter;
  /// Rendered force in the steps of the last quarter [N], at most its first DiagnosisObserver::kMaxForces steps.
  std::vector<Vec3> last_forces;
  Vec3 tip = Vec3::Zero();  ///< tip position in the last step [m]
  OutcomeFacts facts;       ///< facts of the first trial whose OutcomeFacts are not all empty
};

/// Accumulates the quantities for the diagnosis rules. Cost: about 20 ns a step, and for an external law about 1 ns for
/// each contact; at most 400 KB.
class DiagnosisObserver final : public Observer {
 public:
  static constexpr std::size_t kMaxForces = 16384;  ///< largest number of stored forces

  /// The scenario must outlive the observer.
  explicit DiagnosisObserver(const Scenario& scenario);

  /// Must be called before each trial. `outcome`: observer of the trial, which is notified of each step before this
  /// observer and outlives the trial.
  void begin(const OutcomeObserver& outcome) noexcept { outcome_ = &outcome; }

  /// The energy of an impedance device is compared with a threshold.
  bool wants_energy() const noexcept override { return observations_.created_by_motors.has_value(); }
  void on_step(const StepRecord& record) noexcept override;

  /// Must be called after each trial. `length`: OutcomeObserver::longest_step() of the trial [m].
  void add_longest_step(double length) noexcept {
    observations_.longest_step = std::max(observations_.longest_step, length);
  }

  /// Must be called after each trial. `facts`: OutcomeObserver::facts() of the trial.
  void add_facts(OutcomeFacts facts) {
    OutcomeFacts& known = observations_.facts;
    if (!known.began_inside && known.scale_question.empty() && !known.holding_friction) known = std::move(facts);
  }

  const RunObservations& rows() const noexcept { return observations_; }

 private:
  void add_contact(const StepRecord& record) noexcept;
  void add_to_quarter(const StepRecord& record) noexcept;

  const Scenario& scenario_;
  const OutcomeObserver* outcome_ = nullptr;  ///< observer of the current trial; null before the first trial
  /// Limits of the rendered force and of the hand's input force [N]; empty without a limit.
  std::optional<double> force_limit_, input_limit_;
  std::uint64_t quarter_ = 0;
  bool was_in_contact_ = false;   ///< true if the tool was in contact in the previous step
  double stored_at_start_ = 0.0;  ///< energy of the springs in the first step of the trial [J]
  RunObservations observations_;
};

}  // namespace hapbench
