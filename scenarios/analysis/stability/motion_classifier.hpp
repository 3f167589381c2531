#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "results/observe/contact_forces.hpp"
#include "scenarios/analysis/stability/run_verdict.hpp"
#include "sim/loop/simulation.hpp"

/// Classifies a run only by the motion of its tool, without eigenvalues or knowledge of the force law.
///
/// The run is divided into quarters. The amplitude of a quarter is the largest speed of the tool in it. If the handle
/// moves the tool, the speed of the handle is used, because an encoder quantizes the motion of the tool. A turn is a
/// sign change of one component of the velocity. A quarter oscillates if at least one component has two or more turns.
/// run_verdict_texts() states the rule of each class.
///
/// For a damped oscillation over n steps: if it loses more than 6.1 / n of its amplitude in each step, it decays to 1 %
/// within three quarters and is stable. If it loses less than 0.42 / n in each step, it is vibrating. Losses between
/// these rates are dying_out; for a damped linear system this is a narrow range below the stability limit. Stable
/// undamped systems and limit cycles of nonlinear systems are vibrating.
namespace hapbench {

/// Observes a run and classifies its motion. Needs constant memory.
class MotionClassifier final : public Observer {
 public:
  /// `steps`: number of time steps of the run. Precondition: steps >= 4.
  explicit MotionClassifier(std::uint64_t steps) : steps_(steps) {}
  /// Returns a classifier for a tool that a script moves. Such a tool need not come to rest. `time_step` [s].
  ///
  /// Classifies the part of the velocity above 30 Hz (the whole velocity if a step is 1/60 s or longer). The run is
  /// stable if this part stays below 1 mm/s in the last quarter, which is about the smallest speed that a hand feels.
  /// If the script ends at step `still` in the first half of the run, also classifies the unfiltered velocity over
  /// quarters of the remaining steps.
  static MotionClassifier of_moved_tool(std::uint64_t steps, double time_step, double still);

  void on_step(const StepRecord& record) noexcept override;

  /// Returns true if the speed was at most 1e-12 of its largest value for the last 200 steps. The remaining motion is
  /// rounding, and the run may be stopped. Always false for a tool that a script moves.
  bool at_rest() const noexcept { return !is_moved_ && rows_at_rest_ >= kRowsAtRest; }
  /// Called after a complete run. Returns true if the run is too short to judge: the amplitude of the last quarter is
  /// at least 1 % of the amplitude of the first quarter, but the last quarter does not oscillate. Always false for a
  /// tool that a script moves.
  bool is_undecided() const noexcept;
  /// Called after a complete run. Returns true if the amplitude of each quarter is at least 1 % smaller than the
  /// amplitude of the quarter before. Always false for a tool that a script moves.
  bool fades() const noexcept { return !is_moved_ && all_.fades(); }
  /// Called after the run. Returns the class of the motion. Precondition: the run is complete, diverged, or at_rest().
  MotionClass motion_class(Ending ending) const noexcept;

 private:
  static constexpr int kRowsAtRest = 200;

  struct Quarter {
    double amplitude = 0.0;                ///< largest speed [m/s]
    std::array<std::uint64_t, 3> turns{};  ///< number of turns of each component
    bool oscillates() const noexcept;
  };
  /// An interval of the run, divided into quarters.
  struct Interval {
    std::array<Quarter, 4> quarters{};
    Vec3 last_velocity = Vec3::Zero();  ///< last nonzero value of each component [m/s]

    void add(std::uint64_t quarter, const Vec3& velocity) noexcept;
    /// Returns the class of the motion in the interval. The class is `stable` if the speed stays below `felt` [m/s] in
    /// the last quarter.
    MotionClass motion_class(double felt) const noexcept;
    /// Returns true if the amplitude grows by more than 1 % from each quarter to the next.
    bool grows() const noexcept;
    /// Returns true if the amplitude falls by at least 1 % from each quarter to the next.
    bool fades() const noexcept;
  };

  std::uint64_t steps_;
  bool is_moved_ = false;  ///< true if a script moves the tool
  std::optional<HighPass> high_pass_;
  Interval all_;                        ///< the whole run, filtered
  std::optional<std::uint64_t> still_;  ///< first step at which the script no longer moves the tool
  Interval held_;                       ///< steps from `still_` on, unfiltered
  double largest_speed_ = 0.0;          ///< largest speed over all steps so far [m/s]
  int rows_at_rest_ = 0;
};

}  // namespace hapbench
