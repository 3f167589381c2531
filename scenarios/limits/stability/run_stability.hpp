#pragma once

#include <algorithm>
#include <array>
#include <map>

#include "results/observe/contact_forces.hpp"
#include "scenarios/format/load_scenario.hpp"
#include "scenarios/run/scene_checks.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/loop/observer.hpp"
#include "sim/loop/simulation.hpp"

/// Judges whether a run is stable: first by its motion alone, without eigenvalues, tensors or knowledge of the law,
/// then also by where its tool ends.
///
/// The run is cut into quarters. The amplitude of a quarter is the largest speed of the tool in it (of a handle that
/// moves the tool: an encoder turns its motion into jumps that nobody feels); a turn is a change of sign of a component
/// of the velocity. A quarter oscillates with two turns or more of one component. The rules of the classes are those of
/// run_verdict_texts().
///
/// A damped oscillation dies out to 1 % within three quarters of n steps when it loses more than 6.1 / n of its
/// amplitude in a step, and vibrates when it loses less than 0.42 / n: a thin strip below the limit of a damped linear
/// system, all that is stable of an undamped one, and the limit cycles of a nonlinear one.
namespace hapbench {

/// The classes of motion, ends of a run that no motion tells (outcomes of the same name), and a bound that is not kept.
enum class RunVerdict {
  stable,
  dying_out,
  vibrating,
  diverged,
  thrown_out,
  no_contact,
  lost_contact,
  went_through,
  not_dragged,
  stuck,
  beyond_bound
};
/// One of the first four.
using MotionClass = RunVerdict;
inline constexpr std::size_t kMotionClasses = 4;

/// A verdict for people.
struct RunVerdictText {
  std::string_view name;  ///< also in result files: "stable", "dying_out", ...
  const char* meaning;
  const char* rule = "";  ///< by which a run belongs to a class of motion
};
/// In the order of the enumeration.
std::span<const RunVerdictText> run_verdict_texts() noexcept;

inline std::string_view run_verdict_name(RunVerdict verdict) noexcept {
  return run_verdict_texts()[static_cast<std::size_t>(verdict)].name;
}

/// Watches a run and classifies it. Constant memory.
class MotionClassifier final : public Observer {
 public:
  /// `steps`: rows the run will have. Precondition: steps >= 4.
  explicit MotionClassifier(std::uint64_t steps) : steps_(steps) {}
  /// For a tool that a script moves, which is never at rest: what counts is its velocity above 30 Hz (all of it when
  /// steps are longer than a 60th of a second), in the last quarter beyond 1 mm/s, about what a hand can feel there.
  /// If the script ends at the row `still` in the first half of the run, all motion from then on that is faster than
  /// 1 mm/s counts as well, by quarters of what is left.
  static MotionClassifier of_moved_tool(std::uint64_t steps, double time_step, double still);

  void on_step(const StepRecord& record) noexcept override;

  /// True once the tool has come to rest to 1e-12 of its largest speed for 200 rows: what is left is rounding, and the
  /// run may be cut short.
  bool at_rest() const noexcept { return !is_moved_ && rows_at_rest_ >= kRowsAtRest; }
  /// True for a complete run that is too short to tell: it moves on in the last quarter, by 1 % of the first one's
  /// amplitude or more, without oscillating.
  bool is_undecided() const noexcept;
  /// Class of a complete run, or of one that was cut short because it came to rest.
  MotionClass motion_class(Outcome outcome) const noexcept;

 private:
  static constexpr int kRowsAtRest = 200;

  struct Quarter {
    double amplitude = 0.0;                ///< largest speed [m/s]
    std::array<std::uint64_t, 3> turns{};  ///< of each component
    bool oscillates() const noexcept { return std::ranges::max(turns) >= 2; }
  };
  /// A stretch of the run in quarters.
  struct Stretch {
    std::array<Quarter, 4> quarters{};
    Vec3 last_velocity = Vec3::Zero();  ///< the last value of each component that was not zero
    void add(std::uint64_t quarter, const Vec3& velocity) noexcept;
    MotionClass motion_class(double felt) const noexcept;
  };

  std::uint64_t steps_;
  bool is_moved_ = false;
  std::optional<HighPass> high_pass_;
  Stretch all_;
  std::optional<std::uint64_t> still_;  ///< row from which on the script does not move the tool
  Stretch held_;                        ///< from there on, without the filter
  double largest_speed_ = 0.0;
  int rows_at_rest_ = 0;
};

/// True for runs that come to rest in contact: stable and dying_out.
inline bool is_stable(RunVerdict verdict) noexcept {
  return verdict == RunVerdict::stable || verdict == RunVerdict::dying_out;
}

/// Means over the last quarter of a run, unless said otherwise.
struct SettledState {
  /// Of the handle above 30 Hz in the judged rows (JudgedRows) [m/s rms]; empty at sampling rates of 60 Hz or less.
  std::optional<double> vibration;
  double contacts = 0.0;    ///< mean number of rendered contacts of the rows in contact
  double lambda_max = 0.0;  ///< largest eigenvalue of their mean S: the stiffness rendered, in units of K
};

/// What a run has to do to be stable.
struct StabilityRule {
  /// Most vibration of the handle in the judged rows [m/s rms], which then decides in place of the motion: what is too
  /// small to be felt is stable, what is felt is not, though it may die out; nothing is stable where no vibration is
  /// measured. A tool that bounces below 30 Hz vibrates while bounces do not get lower by 1 %.
  std::optional<double> most_vibration = {};
  /// Bounds on metrics of summary.json; a metric without a value keeps none.
  std::map<std::string, MetricBound> bounds = {};
  bool bounded = false;  ///< a run that vibrates without growing is also stable

  bool holds(RunVerdict verdict) const noexcept {
    return is_stable(verdict) || (bounded && verdict == RunVerdict::vibrating);
  }
};

/// The rule where nobody asks for another: where a script moves the tool, what is felt decides (kMostVibration), but
/// not at 60 Hz and less.
StabilityRule rule_of(const Scenario& scenario);

struct RunStability {
  RunVerdict verdict = RunVerdict::stable;
  SettledState settled;
  std::uint64_t way = 0;  ///< a hash of all positions of the handle: runs that differ in it moved differently
  /// Neither at rest nor long enough for an oscillation, after it was made four times as long up to three times.
  bool undecided = false;
};

/// Runs the scenario's first trial, without records, and judges it, longer where that is too short to tell; where there
/// are bounds and it is stable, runs it again for its metrics. `shell` is make_shell of the scenario. Throws Stopped.
/// Precondition: the position is free, and there are 4 steps or more.
RunStability stability_of(const LoadedScenario& loaded, std::shared_ptr<const PointShell> shell,
                          const StabilityRule& rule = {});

/// True when the tool vibrates or diverges without any environment, so that hand and device are to blame and not the
/// contact; `most_vibration` as in the rule. False for hands that do not feel the handle, and for those that need a
/// surface to be there.
bool unstable_without_contact(const LoadedScenario& loaded, std::optional<double> most_vibration = {});

}  // namespace hapbench
