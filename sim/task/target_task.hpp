#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "sim/core/random.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// The display's view of the tip and a target (thesis Fig. D.5): a panel of the hole's bottom, or a height meter.
enum class TargetDisplay {
  panel,  ///< x and y
  height  ///< z
};

/// A force gauge as a display, from which a person reads no single samples: the spring force along +z through a
/// first-order low-pass. The thesis asks to keep
/// pressing; a dip of the reading that is short does not count as letting go.
struct Gauge {
  double cutoff = 30.0;  ///< of the low-pass [Hz]
  double grace = 0.1;    ///< how long the reading may stay below the least press without a break of the hold [s]
};

/// The rules of the man-machine experiments (thesis D.2.2, D.3.2).
struct TargetRules {
  TargetDisplay display = TargetDisplay::panel;
  std::vector<Vec3> places;             ///< where targets appear [m]; only the components on display count
  std::uint64_t targets_per_place = 5;  ///< in one trial
  double tolerance = 0.0002;            ///< the tip is on the target within this distance [m]
  double least_press = 1.0;             ///< reading of the gauge that activates the task [N]
  std::optional<Gauge> gauge = {};      ///< none: reads the rendered force along +z, and every sample counts
  double hold = 1.0;                    ///< time on the target, without a break, that removes it [s]
  double time_limit = 10.0;             ///< from the activation until the target disappears [s]
};

/// How one target ended.
struct TargetResult {
  std::size_t place = 0;  ///< index of its place
  bool removed = false;   ///< in time
  double time = 0.0;      ///< from the activation to the end [s]; the time limit when it disappeared
};

/// One trial: targets appear one at a time in a pseudo-random order, every place equally often. A target waits until
/// the subject presses; from this activation on it has the time limit. It is removed when the tip stays on it, pressed
/// all the while, for the holding time, dips of the reading within the gauge's grace included. A target that nobody
/// activates disappears after the time limit as well, so that a trial ends (ours; the thesis does not say). Allocates
/// in the constructor only.
class TargetTask {
 public:
  /// Preconditions: at least one place, targets_per_place > 0. The order is a function of the seed.
  TargetTask(TargetRules rules, std::uint64_t seed);

  /// Back to the first target.
  void reset() noexcept;
  /// Judges one sampling interval of dt seconds, at whose end the tip is at `tip` and `press` is the force along +z
  /// that the gauge measures [N]: the spring force, or without a gauge the rendered force. Once the trial is finished,
  /// only the gauge moves.
  void advance(const Vec3& tip, double press, double dt) noexcept;
  /// What the gauge shows [N].
  double reading() const noexcept { return reading_; }

  bool finished() const noexcept { return results_.size() == order_.size(); }
  /// Running number of the target on display. Precondition: not finished.
  std::size_t number() const noexcept { return results_.size(); }
  std::size_t place() const noexcept { return order_[number()]; }
  const TargetRules& rules() const noexcept { return rules_; }
  std::size_t targets() const noexcept { return order_.size(); }

  /// From the tip to the target, in the components on display [m]. Precondition: not finished.
  Vec3 error(const Vec3& tip) const noexcept;
  bool on_target(const Vec3& tip) const noexcept { return error(tip).norm() <= rules_.tolerance; }
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
  double low_for_ = 0.0;  ///< time since the reading was last enough [s]
};

}  // namespace hapbench
