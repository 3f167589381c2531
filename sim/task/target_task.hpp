#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "sim/core/random.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// The display's view of the tip and a target (thesis Fig. D.5): x and y on a panel of the hole's bottom, or z on a
/// height meter.
enum class TargetDisplay { panel, height };

/// A force gauge as a display, on which a person cannot read single samples: the spring force along +z through a
/// first-order low-pass. Unless the rules have a Threshold, its reading is also what the task checks.
struct Gauge {
  double cutoff = 30.0;  ///< of the low-pass [Hz]
  double grace = 0.1;    ///< time for which the reading may stay below least_press without breaking the hold [s]
};

/// A force of the algorithm: f_render, the model reaction force, or f_spring.
enum class PressForce { rendered, spring };

/// What a force that falls below least_press, for longer than the grace, does to the time on the target.
enum class LowForce {
  restarts,  ///< it starts anew
  pauses,    ///< it waits
  closes,    ///< the target disappears
  nothing    ///< it goes on
};

/// The force along +z that the task compares with least_press, sample by sample or after a first-order low-pass. The
/// gauge that the subject sees may show another one.
struct Threshold {
  PressForce force = PressForce::rendered;
  std::optional<double> cutoff = {};  ///< corner of the low-pass [Hz]; without it every sample counts
  double grace = 0.0;                 ///< time below least_press that does not break the hold [s]
  LowForce low = LowForce::restarts;
};

/// The rules of the man-machine experiments (thesis D.2.2, D.3.2).
struct TargetRules {
  TargetDisplay display = TargetDisplay::panel;
  std::vector<Vec3> places;                 ///< where targets appear [m]; only the components on display count
  std::uint64_t targets_per_place = 5;      ///< in one trial
  double tolerance = 0.0002;                ///< the tip is on the target within this distance [m]
  std::optional<double> logged = {};        ///< force and speed are logged within this distance [m]; without, tolerance
  double least_press = 1.0;                 ///< force along +z that activates the task and keeps it so [N]
  std::optional<Gauge> gauge = {};          ///< without one, the subject sees every sample of the rendered force
  std::optional<Threshold> threshold = {};  ///< without one, the task checks what the subject sees
  double hold = 1.0;                        ///< time on the target, without a break, that removes it [s]
  double time_limit = 10.0;                 ///< from the activation until the target disappears [s]
};

/// The end of one target.
struct TargetResult {
  std::size_t place = 0;  ///< index in TargetRules::places
  bool removed = false;   ///< in time
  double time = 0.0;      ///< from the activation to the end [s]; the time limit if it disappeared
};

/// One trial: targets appear one at a time in a pseudo-random order, every place equally often. A target waits until
/// the subject presses, which activates it and starts the time limit. It is removed when the tip has stayed on it and
/// pressed for the holding time, apart from dips of the force within the grace. A target that is not activated also
/// disappears after the time limit, so that a trial ends (our choice). Allocates in the constructor only.
class TargetTask {
 public:
  /// Preconditions: at least one place, targets_per_place > 0. The order is a function of the seed.
  TargetTask(TargetRules rules, std::uint64_t seed);

  /// Returns to the first target.
  void reset() noexcept;
  /// Judges one sampling interval of dt seconds. At its end the tip is at `tip`; `spring` and `rendered` are the
  /// components of f_spring and f_render along +z [N]. Once the trial is finished, only the readings move.
  void advance(const Vec3& tip, double spring, double rendered, double dt) noexcept;
  /// Reading of the gauge [N].
  double reading() const noexcept { return reading_; }

  bool finished() const noexcept { return results_.size() == order_.size(); }
  /// Running number of the target on display. Precondition: not finished.
  std::size_t number() const noexcept { return results_.size(); }
  std::size_t place() const noexcept { return order_[number()]; }
  const TargetRules& rules() const noexcept { return rules_; }
  /// The place of each target, in the order in which they appear.
  const std::vector<std::size_t>& order() const noexcept { return order_; }

  /// Vector from the tip to the target, in the components on display [m]. Precondition: not finished.
  Vec3 error(const Vec3& tip) const noexcept;
  /// True if force and speed of this row are logged. Precondition: not finished.
  bool logs(const Vec3& tip) const noexcept { return error(tip).norm() <= rules_.logged.value_or(rules_.tolerance); }
  bool active() const noexcept { return active_; }

  /// Targets that have ended, in their order.
  const std::vector<TargetResult>& results() const noexcept { return results_; }

 private:
  bool is_pressed(double dt) noexcept;
  void next_target(bool removed, double time) noexcept;

  TargetRules rules_;
  std::vector<std::size_t> order_;
  std::vector<TargetResult> results_;
  bool active_ = false;
  double shown_ = 0.0;    ///< time since the target appeared or, once active, since its activation [s]
  double held_ = 0.0;     ///< time on the target without a break [s]
  double reading_ = 0.0;  ///< of the gauge [N]
  double checked_ = 0.0;  ///< against least_press [N]
  double low_for_ = 0.0;  ///< time since `checked_` was last at least least_press [s]
};

}  // namespace hapbench
