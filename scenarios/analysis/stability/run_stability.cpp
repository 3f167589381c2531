#include "scenarios/analysis/stability/run_stability.hpp"

#include <utility>

#include "results/observe/metrics.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/expectations.hpp"
#include "scenarios/run/outcome.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/scripted_motion.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "sim/contact/contact_buffer.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

RunVerdictText of_outcome(Outcome outcome) {
  const OutcomeInfo& info = outcome_infos()[static_cast<std::size_t>(outcome)];
  return {info.name, info.meaning};
}

/// Steps the simulation, which `classifier` observes, until it ends or comes to rest.
MotionClass classify(Simulation& simulation, const MotionClassifier& classifier) {
  const SimulationResult result = run_to_end(simulation, [&] {
    bool more = true;
    for (std::uint64_t i = 0; i < kAskEvery && more; ++i) more = !classifier.at_rest() && simulation.step();
    return more;
  });
  return classifier.motion_class(result.ending);
}

/// Tells a tool that goes on bouncing, more slowly than what counts as vibration. A bounce is a way off the surface and
/// back that lasts longer than the contact before it, against a hand that presses; its height is the largest distance
/// from where the handle let go, along the force there.
class SlowBounces {
 public:
  explicit SlowBounces(double dt) : slow_(1.0 / (kVibrationCutoff * dt)) {}

  void add(const StepRecord& record, const JudgedRows& judged) noexcept {
    const Vec3& place = record.handle.position;
    if (record.colliding > 0) {
      if (away_ > 0) land(record.step, judged);
      ++touching_;
      away_ = 0;
      place_ = place;
      if (record.force.rendered.squaredNorm() > 0.0) up_ = record.force.rendered.normalized();
      return;
    }
    if (away_++ == 0) height_ = 0.0;
    const double height = (place - place_).dot(up_);
    if (!(height > height_)) return;
    height_ = height;
    pressed_ = record.hand.measured.dot(up_) < 0.0;
  }

  /// True with two bounces or more in each half of the judged rows, those of the second as high to 1 %.
  bool go_on() const noexcept {
    constexpr int kLeast = 2;
    constexpr double kFallen = 0.99;
    return counts_[0] >= kLeast && counts_[1] >= kLeast && highest_[1] > kFallen * highest_[0];
  }

 private:
  void land(std::uint64_t step, const JudgedRows& judged) noexcept {
    const std::uint64_t touching = std::exchange(touching_, 0);
    const bool slow = static_cast<double>(touching + away_) > slow_;
    if (!slow || touching >= away_ || !pressed_ || !judged.contain(step)) return;
    const std::size_t half = 2 * (step - *judged.begin()) / (judged.end() - *judged.begin());
    ++counts_[half];
    highest_[half] = std::max(highest_[half], height_);
  }

  double slow_;  ///< rows of a period of the cutoff
  std::uint64_t touching_ = 0, away_ = 0;
  Vec3 place_ = Vec3::Zero(), up_ = Vec3::Zero();
  double height_ = 0.0;  ///< of the bounce under way [m]
  bool pressed_ = false;
  std::array<int, 2> counts_{};
  std::array<double, 2> highest_{};  ///< [m]
};

/// The end of a run: where the tool is and whether it touches, what its judged rows say, and sums over the quarter that
/// was begun last, which is the last one unless the run was cut short because it came to rest.
class LastRows final : public Observer {
 public:
  /// `alone`: there is nothing to touch, and all but the first quarter of the run is judged.
  explicit LastRows(const Scenario& scenario, bool alone = false)
      : steps_(static_cast<std::uint64_t>(scenario.time.steps)),
        judged_(steps_, script_period(scenario) / scenario.time.step),
        vibration_(scenario.time.step),
        bounces_(scenario.time.step) {
    if (alone) judged_.touch(0);
  }

  void on_step(const StepRecord& record) noexcept override {
    touches_ = record.colliding > 0;
    if (touches_) judged_.touch(record.step);
    vibration_.add(record.step, record.handle.velocity, judged_.contain(record.step));
    bounces_.add(record, judged_);
    place_ = record.tool.pose.position;
    for (const double coordinate : record.handle.position) way_.real(coordinate);
    if (const std::uint64_t quarter = record.step * 4 / steps_; quarter != quarter_) {
      quarter_ = quarter;
      rows_in_contact_ = contacts_ = 0;
      S_sum_.setZero();
    }
    if (record.rendered->size() == 0) return;
    ++rows_in_contact_;
    contacts_ += record.rendered->size();
    S_sum_ += record.force.S;
  }

  bool touched() const { return judged_.begin().has_value(); }  ///< in any row
  std::uint64_t way() const { return way_.value(); }            ///< RunStability::way
  bool goes_on_bouncing() const { return bounces_.go_on(); }
  bool has_left(const PointShell& shell, double reach) const {
    const Box bounds = shell.bounds();
    const Vec3 beyond = (bounds.min - place_).cwiseMax(place_ - bounds.max);
    return !touches_ && beyond.maxCoeff() > reach;
  }
  /// `rests`: the run was cut short because nothing moves any more.
  SettledState state(bool rests) const {
    SettledState state;
    // Nothing moves in the rows that a tool at rest is spared.
    state.vibration = vibration_.rms(if_any(rests && judged_.begin(), judged_.end() - judged_.begin().value_or(0)));
    if (rows_in_contact_ == 0) return state;
    const auto rows = static_cast<double>(rows_in_contact_);
    state.contacts = static_cast<double>(contacts_) / rows;
    state.lambda_max = lambda_max(S_sum_ / rows);
    return state;
  }

 private:
  bool touches_ = false;
  Vec3 place_ = Vec3::Zero();  ///< of the tip centre [m]
  Hash64 way_;
  std::uint64_t steps_;
  JudgedRows judged_;
  Vibration vibration_;
  SlowBounces bounces_;
  std::uint64_t quarter_ = 0, rows_in_contact_ = 0, contacts_ = 0;
  Mat3 S_sum_ = Mat3::Zero();
};

MotionClassifier classifier_of(const Scenario& scenario) {
  const auto steps = static_cast<std::uint64_t>(scenario.time.steps);
  if (!is_moved(scenario)) return MotionClassifier(steps);
  return MotionClassifier::of_moved_tool(steps, scenario.time.step, script_moves_until(scenario) / scenario.time.step);
}

RunVerdict verdict_of(MotionClass motion, const SettledState& settled, std::optional<double> most_vibration) {
  if (!most_vibration || motion == MotionClass::diverged) return motion;
  return settled.vibration && *settled.vibration <= *most_vibration ? RunVerdict::stable : RunVerdict::vibrating;
}

/// The verdict with the name of an outcome; nothing when only the motion can tell.
std::optional<RunVerdict> verdict_of(Outcome outcome) {
  const auto texts = run_verdict_texts();
  const auto found = std::ranges::find(texts, outcome_name(outcome), &RunVerdictText::name);
  if (found == texts.end()) return std::nullopt;
  return static_cast<RunVerdict>(found - texts.begin());
}

RunStability judged_once(const LoadedScenario& loaded, const std::shared_ptr<const PointShell>& shell,
                         const StabilityRule& rule) {
  const Scenario& scenario = loaded.scenario;
  MotionClassifier classifier = classifier_of(scenario);
  LastRows last(scenario);
  SimulationParts parts = assemble(scenario, loaded.files, shell, {});
  const std::shared_ptr<const ToolShape> tool = parts.tool;
  const auto seen = outcome_observer(scenario, loaded.files, parts);
  Simulation simulation(simulation_config(scenario), std::move(parts), {&classifier, &last, seen.get()});
  const MotionClass motion = classify(simulation, classifier);
  const SettledState settled = last.state(classifier.at_rest());
  const Outcome outcome = seen->outcome(simulation.result().ending);
  const auto verdict = [&] {
    if (motion == MotionClass::diverged) return RunVerdict::diverged;
    if (outcome == Outcome::went_through) return RunVerdict::went_through;
    if (!last.touched()) return RunVerdict::no_contact;
    if (outcome == Outcome::leaves_hole || (shell && last.has_left(*shell, tool->reach())))
      return RunVerdict::thrown_out;
    if (const auto known = verdict_of(outcome)) return *known;
    const bool only_fast = rule.most_vibration || is_moved(scenario);
    if (only_fast && last.goes_on_bouncing()) return RunVerdict::vibrating;
    return verdict_of(motion, settled, rule.most_vibration);
  };
  RunStability run{verdict(), settled, last.way()};
  run.undecided = is_stable(run.verdict) && classifier.is_undecided();
  return run;
}

}  // namespace

std::span<const RunVerdictText> run_verdict_texts() noexcept {
  // In the order of the enumeration.
  static const RunVerdictText kTexts[] = {
      {"stable", "at rest, died out or creeping", "all else: at rest, died out, creeping"},
      {"dying_out", "still oscillates, but comes to rest if the run goes on",
       "oscillates as much, but loses a tenth of its amplitude from the second quarter to the third and again to the "
       "last"},
      {"vibrating", "oscillates and does not decay",
       "does not decay: oscillates in the last quarter with at least 1 % of the first quarter's amplitude"},
      {"diverged", "left its bounds, or oscillates with a growing amplitude",
       "left its bounds, or oscillates with an amplitude that grows by 1 % from each quarter to the next"},
      {"thrown_out",
       "the tool left the hole, or ended without contact beyond the environment's box by more than it reaches"},
      {"no_contact", "the tool touched nothing in any row"},
      of_outcome(Outcome::lost_contact),
      of_outcome(Outcome::went_through),
      of_outcome(Outcome::not_dragged),
      of_outcome(Outcome::stuck),
      {"beyond_bound", "stable but for a metric that a --bound does not allow"}};
  return kTexts;
}

RunStability stability_of(const LoadedScenario& loaded, std::shared_ptr<const PointShell> shell,
                          const StabilityRule& rule) {
  constexpr int kLengthenings = 3;
  constexpr std::int64_t kTimes = 4, kMostLengthened = 1'000'000;  // steps
  RunStability run = judged_once(loaded, shell, rule);
  LoadedScenario longer = loaded;
  for (int i = 0; run.undecided && i < kLengthenings && longer.scenario.time.steps * kTimes <= kMostLengthened; ++i) {
    longer.scenario.time.steps *= kTimes;
    const std::uint64_t way = run.way;
    run = judged_once(longer, shell, rule);
    run.way = way;  // of the scenario's own length, as that of other runs
  }
  if (!is_stable(run.verdict) || rule.bounds.empty()) return run;
  const Result whole = run_with_shell(loaded, shell);
  if (!unmet_expectations({{whole.end.outcome}, rule.bounds}, whole).empty()) run.verdict = RunVerdict::beyond_bound;
  return run;
}

bool unstable_without_contact(const LoadedScenario& loaded, std::optional<double> most_vibration) {
  if (spring_of(loaded.scenario.hand) == nullptr ||
      std::holds_alternative<SpringsEnvironment>(loaded.scenario.environment))
    return false;
  // Dry friction only takes energy. What its sticking and slipping leave of vibration is not the loop's fault.
  Scenario scenario = loaded.scenario;
  if (auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device)) device->coulomb = 0.0;
  MotionClassifier classifier = classifier_of(scenario);
  LastRows last(scenario, true);
  constexpr double kCells = 1.0;  // [m], of the grid that local_average wants
  const auto nothing = std::make_shared<const PointShell>(std::vector<SurfacePoint>{}, kCells);
  Simulation simulation(simulation_config(scenario), assemble(scenario, loaded.files, nothing, {}),
                        {&classifier, &last});
  const MotionClass motion = classify(simulation, classifier);
  return !is_stable(verdict_of(motion, last.state(classifier.at_rest()), most_vibration));
}

}  // namespace hapbench
