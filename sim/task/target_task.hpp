#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "sim/core/random.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// Components of the tip and the target that the display shows (thesis Fig. D.5): x and y on a panel at the
/// hole's bottom, or z on a height meter.
enum class TargetDisplay { panel, height };

/// A displayed force gauge, on which a person cannot read single samples. It shows the spring force along +z
/// through a first-order low-pass filter. If the rules contain no Threshold, the task compares the reading of this
/// gauge with min_press_force.
struct Gauge {
  double cutoff = 30.0;  ///< cut-off frequency of the low-pass [Hz]
  double grace = 0.1;  ///< time for which the reading may stay below min_press_force without interrupting the hold [s]
};

/// Force that the task checks. `rendered`: f_render, the model reaction force. `spring`: f_spring, the force of the
/// penalty springs.
enum class PressForce { rendered, spring };

/// Effect on the time on the target (TargetRules::hold) if the force stays below min_press_force for longer than the
/// grace time.
enum class LowForce {
  restarts,  ///< the time on the target restarts from 0
  pauses,    ///< the time on the target stops counting until the subject presses again
  closes,    ///< the target disappears
  nothing    ///< the time on the target continues to count
};

/// The force along +z that the task compares with min_press_force: either its single samples, or the force filtered by
/// a first-order low-pass. The gauge that the subject sees may show a different force.
struct Threshold {
  PressForce force = PressForce::rendered;
  std::optional<double> cutoff = {};  ///< cut-off frequency of the low-pass [Hz]; nullopt: single samples
  double grace = 0.0;                 ///< time below min_press_force that does not interrupt the time on the target [s]
  LowForce low = LowForce::restarts;
};

/// The rules of the man-machine experiments of the thesis (sections D.2.2 and D.3.2).
struct TargetRules {
  TargetDisplay display = TargetDisplay::panel;
  /// Positions at which targets appear [m]; only the displayed components count.
  std::vector<Vec3> positions;
  std::uint64_t targets_per_position = 5;  ///< number of targets at each position in one trial
  double tolerance = 0.0002;               ///< largest distance from the target at which the tip is on it [m]
  /// Largest distance of the tip from the target at which force and speed are logged [m]; nullopt: tolerance.
  std::optional<double> logged = {};
  /// Smallest force along +z that counts as pressing and activates the target [N].
  double min_press_force = 1.0;
  std::optional<Gauge> gauge = {};          ///< nullopt: the subject sees every sample of the rendered force
  std::optional<Threshold> threshold = {};  ///< nullopt: the task checks the force that the subject sees
  double hold = 1.0;                        ///< uninterrupted time on the target after which the target is removed [s]
  double time_limit = 10.0;                 ///< time from activation until the target disappears [s]
};

/// The result of one target.
struct TargetResult {
  std::size_t position = 0;  ///< index in TargetRules::positions
  bool removed = false;      ///< true if the target was removed within the time limit
  double time = 0.0;         ///< time from activation to the end [s]; the time limit if the target disappeared
};

/// The task of one trial. Targets appear one at a time in a pseudo-random order, equally often at each position. A
/// target waits until the subject presses; the press activates the target and starts the time limit. The target is
/// removed when the tip has stayed on it and pressed for the holding time. A force below min_press_force for no longer
/// than the grace time does not interrupt the holding time. A target that is never activated disappears when the time
/// limit has passed since its appearance, so that a trial always ends; this rule is an assumption of this project.
/// Allocates in the constructor only.
class TargetTask {
 public:
  /// Preconditions: at least one position, targets_per_position > 0. `seed` determines the order of the targets.
  TargetTask(TargetRules rules, std::uint64_t seed);

  /// Resets the task to the first target.
  void reset() noexcept;
  /// Evaluates one sampling interval of `dt` [s], at whose end the tip is at `tip` [m]. `spring` and `rendered`
  /// are the components of f_spring and f_render along +z [N]. After the trial is finished, only the force
  /// readings are updated.
  void advance(const Vec3& tip, double spring, double rendered, double dt) noexcept;
  /// Returns the reading of the gauge [N]; without a gauge, the last sample of the rendered force.
  double reading() const noexcept { return reading_; }

  bool finished() const noexcept { return results_.size() == order_.size(); }
  /// Index of the displayed target in order(). Precondition: not finished.
  std::size_t number() const noexcept { return results_.size(); }
  /// Index of the displayed target's position in TargetRules::positions. Precondition: not finished.
  std::size_t position_index() const noexcept { return order_[number()]; }
  const TargetRules& rules() const noexcept { return rules_; }
  /// Position of each target as an index in TargetRules::positions, in the order in which the targets appear.
  const std::vector<std::size_t>& order() const noexcept { return order_; }

  /// Returns the vector from the tip to the target in the displayed components; all other components are 0 [m].
  /// Precondition: not finished.
  Vec3 error(const Vec3& tip) const noexcept;
  /// Returns true if force and speed are logged in this step. Precondition: not finished.
  bool logs(const Vec3& tip) const noexcept { return error(tip).norm() <= rules_.logged.value_or(rules_.tolerance); }
  /// Returns true if the displayed target has been activated.
  bool active() const noexcept { return active_; }

  /// Results of the targets that have ended, in order.
  const std::vector<TargetResult>& results() const noexcept { return results_; }

 private:
  bool is_pressed(double dt) noexcept;
  void next_target(bool removed, double time) noexcept;

  TargetRules rules_;
  std::vector<std::size_t> order_;
  std::vector<TargetResult> results_;
  bool active_ = false;
  double shown_ = 0.0;    ///< time since the target appeared or, once active, since its activation [s]
  double held_ = 0.0;     ///< uninterrupted time on the target [s]
  double reading_ = 0.0;  ///< reading of the gauge, or the rendered force without a gauge [N]
  double checked_ = 0.0;  ///< force compared with min_press_force [N]
  double low_for_ = 0.0;  ///< time since `checked_` was last at least min_press_force [s]
};

}  // namespace hapbench
