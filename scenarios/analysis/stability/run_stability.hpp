#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "results/observe/contact_forces.hpp"
#include "scenarios/run/scripted_motion.hpp"
#include "scenarios/run/vibration_limit.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "sim/geometry/point_shell.hpp"
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
  static MotionClassifier of_moved_tool(std::uint64_t steps, double time_step, double still) {
    MotionClassifier classifier(steps);
    classifier.is_moved_ = true;
    classifier.high_pass_ = vibration_filter(time_step);
    if (still <= 0.5 * static_cast<double>(steps)) classifier.still_ = static_cast<std::uint64_t>(std::ceil(still));
    return classifier;
  }

  void on_step(const StepRecord& record) noexcept override {
    const Vec3& velocity = record.body_velocity();
    if (high_pass_ && record.step == 0) high_pass_->settle_at(velocity);
    const Vec3 v = high_pass_ ? high_pass_->filter(velocity) : velocity;
    all_.add(record.step * 4 / steps_, v);
    if (still_ && record.step >= *still_) held_.add((record.step - *still_) * 4 / (steps_ - *still_), velocity);
    const double speed = v.norm();
    largest_speed_ = std::max(largest_speed_, speed);
    rows_at_rest_ = speed <= kRest * largest_speed_ ? rows_at_rest_ + 1 : 0;
  }

  /// True once the tool is at rest to 1e-12 of its largest speed for 200 rows: the rest is rounding and may be cut off.
  bool at_rest() const noexcept { return !is_moved_ && rows_at_rest_ >= kRowsAtRest; }
  /// True for a complete run that is too short to tell: it moves on in the last quarter, by 1 % of the first one's
  /// amplitude or more, without oscillating.
  bool is_undecided() const noexcept {
    const auto& q = all_.quarters;
    return !is_moved_ && !at_rest() && !q[3].oscillates() && q[3].amplitude >= kLeft * q[0].amplitude &&
           q[3].amplitude > 0.0;
  }
  /// Class of a complete run, or of one that was cut short because it came to rest.
  MotionClass motion_class(Ending ending) const noexcept {
    if (ending == Ending::diverged) return MotionClass::diverged;
    if (at_rest()) return MotionClass::stable;
    // A hand that comes to rest may swing a little more for a while: below 30 Hz that is not called growth.
    return std::max(all_.motion_class(is_moved_ ? kFelt : 0.0),
                    std::min(held_.motion_class(kFelt), MotionClass::vibrating));
  }

 private:
  static constexpr int kRowsAtRest = 200;
  static constexpr double kGrowth = 1.01, kLeft = 0.01, kSustained = 0.9, kRest = 1e-12;
  static constexpr double kFelt = 1e-3;  ///< [m/s]

  struct Quarter {
    double amplitude = 0.0;                ///< largest speed [m/s]
    std::array<std::uint64_t, 3> turns{};  ///< of each component
    bool oscillates() const noexcept { return std::ranges::max(turns) >= 2; }
  };
  /// A stretch of the run in quarters.
  struct Stretch {
    std::array<Quarter, 4> quarters{};
    Vec3 last_velocity = Vec3::Zero();  ///< the last value of each component that was not zero

    void add(std::uint64_t quarter, const Vec3& velocity) noexcept {
      Quarter& here = quarters[std::min<std::uint64_t>(3, quarter)];
      here.amplitude = std::max(here.amplitude, velocity.norm());
      for (int i = 0; i < 3; ++i) {
        if (velocity[i] == 0.0) continue;
        here.turns[static_cast<std::size_t>(i)] += velocity[i] * last_velocity[i] < 0.0;
        last_velocity[i] = velocity[i];
      }
    }
    MotionClass motion_class(double felt) const noexcept {
      const auto& q = quarters;
      if (!q[3].oscillates() || q[3].amplitude < felt) return MotionClass::stable;
      bool grows = true;
      for (std::size_t i = 1; i < q.size(); ++i) grows = grows && q[i].amplitude > kGrowth * q[i - 1].amplitude;
      if (grows) return MotionClass::diverged;
      if (q[3].amplitude < kLeft * q[0].amplitude) return MotionClass::stable;
      const bool decays = q[2].amplitude < kSustained * q[1].amplitude && q[3].amplitude < kSustained * q[2].amplitude;
      return decays ? MotionClass::dying_out : MotionClass::vibrating;
    }
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

/// The rule by default: where a script moves the tool, what is felt decides (kMostVibration), not at 60 Hz and less.
inline StabilityRule rule_of(const Scenario& scenario) {
  StabilityRule rule;
  if (vibration_filter(scenario.time.step) && is_moved(scenario)) rule.most_vibration = kMostVibration;
  return rule;
}

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
