#pragma once

#include <cstdint>
#include <optional>

#include "results/observe/contact_forces.hpp"
#include "scenarios/analysis/stability/slow_bounces.hpp"
#include "scenarios/run/linear_contact.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/core/hash.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/tool/tool_shape.hpp"

/// Observes the state at the end of a run, from which the run is judged.
namespace hapbench {

/// How a run touched, and its settled state. `contacts`, `lambda_max`, `share_away`, `contacts_change` and
/// `directions_change` refer to the steps of the last quarter of the run. The last quarter of a run that comes to rest
/// early is the quarter in which it came to rest.
struct SettledState {
  /// Vibration of the handle above 30 Hz over the judged steps (EvaluationWindow) [m/s rms]; empty at sampling rates of
  /// 60 Hz or less.
  std::optional<double> vibration;
  std::optional<double> touch_speed;  ///< speed of the handle in the first step in contact [m/s]; empty without contact
  double hand_force_max = 0.0;        ///< largest force of the hand on the handle [N]
  double contacts = 0.0;              ///< mean number of rendered contacts, over the steps in contact
  double lambda_max = 0.0;            ///< largest eigenvalue of the mean stiffness tensor S in contact, in units of K
  std::optional<ContactState> last_contact;  ///< state at the last step in contact; empty without contact
  double share_away = 1.0;                   ///< share of the steps in which the tool is not in contact
  /// True if the set of rendered points differs between two consecutive steps. Exception: as many points as before
  /// touch and are rendered, and their stiffness tensor S is the same.
  bool contacts_change = false;
  /// True if the stiffness tensor S of a step in contact differs by more than 1 % from S in the quarter's first step in
  /// contact: the stiff directions turn.
  bool directions_change = false;
  bool rests = false;    ///< true if the run was stopped because the tool came to rest
  bool touches = false;  ///< true if the tool was in contact in the last step
  bool is_held = false;  ///< true if dry friction of device or surface acts on the tool that rests
};

/// Returns true if the tool rests in contact, or if in the last quarter of the run the contact persists and the same
/// points touch, so that the contact has a single linear loop. If a script moves the tool in the last quarter, the
/// touching points may change as long as the stiff directions do not.
bool contact_lasts(const SettledState& settled, const Scenario& scenario);

/// Records the end position of the tool, whether the tool was in contact, and the vibration and bounces over the
/// judged steps (EvaluationWindow). Accumulates contacts and stiffness tensors over the current quarter of the run. At
/// the end of the run, the current quarter is the last quarter, or the quarter in which the tool came to rest.
class RunEndObserver final : public Observer {
 public:
  /// `alone`: true if there is no environment; then all steps after the first quarter are judged.
  explicit RunEndObserver(const Scenario& scenario, bool alone = false);

  void on_step(const StepRecord& record) noexcept override;

  /// Returns true if the tool was in contact in any step.
  bool touched() const { return judged_.begin().has_value(); }
  /// Returns a hash of all positions of the handle (RunStability::motion_hash).
  std::uint64_t motion_hash() const { return motion_.value(); }
  /// Returns true if the tool keeps bouncing slowly until the end (SlowBounces::persist).
  bool keeps_bouncing() const { return bounces_.persist(); }
  /// Returns true if the tool ends without contact and more than `reach` [m] outside of the shell's bounding box.
  bool has_left(const PointShell& shell, double reach) const;
  /// Returns the state at the end of the run. `rests`: true if the run was stopped early because the tool came to
  /// rest.
  SettledState state(bool rests) const;

 private:
  void add_contact(const StepRecord& record) noexcept;

  bool touches_ = false;               ///< true if the tool was in contact in the last step
  Vec3 tip_ = Vec3::Zero();            ///< tip centre in the last step [m]
  std::optional<double> touch_speed_;  ///< SettledState::touch_speed [m/s]
  double hand_force_max_ = 0.0;        ///< SettledState::hand_force_max [N]
  Hash64 motion_;
  std::uint64_t steps_;  ///< number of steps of the run
  EvaluationWindow judged_;
  Vibration vibration_;
  SlowBounces bounces_;
  std::uint64_t quarter_ = 0;  ///< number of the current quarter of the run, from 0
  // Counts and sums over the current quarter, up to directions_change_.
  std::uint64_t steps_in_quarter_ = 0, steps_in_contact_ = 0, contacts_ = 0;
  Mat3 S_sum_ = Mat3::Zero();
  Mat3 S_first_ = Mat3::Zero();  ///< S of the first step in contact
  /// Contacts of a step in contact.
  struct ContactSet {
    std::uint64_t hash;               ///< hash of the numbers of the rendered points
    std::size_t rendered, colliding;  ///< number of rendered and of colliding points
    Mat3 S;
  };
  std::optional<ContactSet> last_set_;  ///< contacts of the last step in contact
  bool contacts_change_ = false, directions_change_ = false;
  std::optional<ContactState> last_contact_;
  bool sticks_ = false;   ///< true if dry friction of the surface holds the tool in the last step
  double coulomb_ = 0.0;  ///< Coulomb friction of an impedance device [N]
};

}  // namespace hapbench
