#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "results/observe/contact_forces.hpp"
#include "scenarios/analysis/stability/run_verdict.hpp"
#include "sim/loop/simulation.hpp"

/// Classifies a run by its motion alone, without eigenvalues, tensors or knowledge of the law.
///
/// The run is cut into quarters. The amplitude of a quarter is the largest speed of the tool in it (of the handle where
/// the handle moves the tool: an encoder turns its motion into jumps that nobody feels). A turn is a change of sign of
/// a component of the velocity. A quarter oscillates if one component has two turns or more. run_verdict_texts() has
/// the rules of the classes.
///
/// A damped oscillation over n steps dies out to 1 % within three quarters if it loses more than 6.1 / n of its
/// amplitude in each step, and it vibrates if it loses less than 0.42 / n. Between the two lies a thin strip below the
/// limit of a damped linear system. All stable undamped systems and the limit cycles of nonlinear ones also vibrate.
namespace hapbench {

/// Observes a run and classifies it. Constant memory.
class MotionClassifier final : public Observer {
 public:
  /// `steps`: number of rows of the run. Precondition: steps >= 4.
  explicit MotionClassifier(std::uint64_t steps) : steps_(steps) {}
  /// Returns a classifier for a tool that a script moves and that is therefore never at rest. It counts the velocity
  /// above 30 Hz (the whole velocity if steps are longer than a 60th of a second) where it exceeds 1 mm/s in the last
  /// quarter, about what a hand can feel. If the script ends at the row `still` in the first half of the run, all later
  /// motion faster than 1 mm/s counts as well, by quarters of the remaining rows.
  static MotionClassifier of_moved_tool(std::uint64_t steps, double time_step, double still);

  void on_step(const StepRecord& record) noexcept override;

  /// Returns true once the tool is at rest to 1e-12 of its largest speed for 200 rows: the remaining motion is rounding
  /// and the run may be cut short.
  bool at_rest() const noexcept { return !is_moved_ && rows_at_rest_ >= kRowsAtRest; }
  /// Returns true for a complete run that is too short to judge: in the last quarter the tool still moves by at least
  /// 1 % of the first quarter's amplitude, but does not oscillate.
  bool is_undecided() const noexcept;
  /// Returns the class of a complete run, or of a run that was cut short because it came to rest.
  MotionClass motion_class(Ending ending) const noexcept;

 private:
  static constexpr int kRowsAtRest = 200;

  struct Quarter {
    double amplitude = 0.0;                ///< largest speed [m/s]
    std::array<std::uint64_t, 3> turns{};  ///< of each component
    bool oscillates() const noexcept;
  };
  /// An interval of the run, in quarters.
  struct Interval {
    std::array<Quarter, 4> quarters{};
    Vec3 last_velocity = Vec3::Zero();  ///< the last value of each component that was not zero

    void add(std::uint64_t quarter, const Vec3& velocity) noexcept;
    /// Motion slower than `felt` [m/s] in the last quarter is stable.
    MotionClass motion_class(double felt) const noexcept;
    /// Returns true if the amplitude grows by 1 % from each quarter to the next.
    bool grows() const noexcept;
  };

  std::uint64_t steps_;
  bool is_moved_ = false;
  std::optional<HighPass> high_pass_;
  Interval all_;
  std::optional<std::uint64_t> still_;  ///< row from which on the script does not move the tool
  Interval held_;                       ///< from row still_ on, without the filter
  double largest_speed_ = 0.0;
  int rows_at_rest_ = 0;
};

}  // namespace hapbench
