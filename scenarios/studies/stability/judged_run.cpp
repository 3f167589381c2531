#include "scenarios/studies/stability/judged_run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "results/observe/contact_forces.hpp"
#include "results/observe/metrics.hpp"
#include "results/summary/outcome_names.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/encounter.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/scene_facts.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "sim/contact/stiffness_tensor.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

constexpr double kGrowth = 1.01;
constexpr double kLeft = 0.01;
constexpr double kSustained = 0.9;
constexpr std::uint64_t kTurns = 2;
constexpr double kRest = 1e-12;
constexpr double kFelt = 1e-3;  // [m/s]

}  // namespace

const MotionClassText& text_of(MotionClass motion) noexcept {
  // In the order of the enumeration.
  static constexpr MotionClassText kTexts[] = {
      {"stable", "at rest, died out or creeping", "all else: at rest, died out, creeping"},
      {"dying_out", "still oscillates, but comes to rest if the run goes on",
       "oscillates as much, but loses a tenth of its amplitude from the second quarter to the third and again to the "
       "last"},
      {"vibrating", "oscillates and does not decay",
       "does not decay: oscillates in the last quarter with at least 1 % of the first quarter's amplitude"},
      {"diverged", "left its bounds, or oscillates with a growing amplitude",
       "left its bounds, or oscillates with an amplitude that grows by 1 % from each quarter to the next"}};
  return kTexts[static_cast<std::size_t>(motion)];
}

MotionClassifier MotionClassifier::of_moved_tool(std::uint64_t steps, double time_step, double still,
                                                 const TremorSpeeds& tremor) {
  MotionClassifier classifier(steps);
  classifier.is_moved_ = true;
  classifier.tremor_ = tremor;
  classifier.high_pass_ = vibration_filter(time_step);
  if (still <= 0.5 * static_cast<double>(steps)) classifier.still_ = static_cast<std::uint64_t>(std::ceil(still));
  return classifier;
}

void MotionClassifier::Stretch::add(std::uint64_t quarter, const Vec3& velocity) noexcept {
  Quarter& here = quarters[std::min<std::uint64_t>(3, quarter)];
  here.amplitude = std::max(here.amplitude, velocity.norm());
  for (int i = 0; i < 3; ++i) {
    if (velocity[i] == 0.0) continue;
    here.turns[static_cast<std::size_t>(i)] += velocity[i] * last_velocity[i] < 0.0;
    last_velocity[i] = velocity[i];
  }
}

void MotionClassifier::on_step(const StepRecord& record) noexcept {
  if (high_pass_ && record.step == 0) high_pass_->settle_at(record.body_velocity());
  const Vec3 v = high_pass_ ? high_pass_->filter(record.body_velocity()) : record.body_velocity();
  all_.add(record.step * 4 / steps_, v);
  if (still_ && record.step >= *still_)
    held_.add((record.step - *still_) * 4 / (steps_ - *still_), record.body_velocity());
  const double speed = v.norm();
  largest_speed_ = std::max(largest_speed_, speed);
  rows_at_rest_ = speed <= kRest * largest_speed_ ? rows_at_rest_ + 1 : 0;
}

bool MotionClassifier::Quarter::oscillates() const noexcept {
  return std::any_of(turns.begin(), turns.end(), [](std::uint64_t n) { return n >= kTurns; });
}

bool MotionClassifier::is_undecided() const noexcept {
  const auto& q = all_.quarters;
  return !is_moved_ && !at_rest() && !q[3].oscillates() && q[3].amplitude >= kLeft * q[0].amplitude &&
         q[3].amplitude > 0.0;
}

MotionClass MotionClassifier::motion_class(Outcome outcome) const noexcept {
  if (outcome == Outcome::diverges) return MotionClass::diverged;
  if (at_rest()) return MotionClass::stable;
  // A hand that comes to rest may swing a little more for a while: below 30 Hz that is not called growth.
  return std::max(all_.motion_class(is_moved_ ? kFelt + tremor_.handle : 0.0),
                  std::min(held_.motion_class(kFelt + tremor_.target), MotionClass::vibrating));
}

MotionClass MotionClassifier::Stretch::motion_class(double felt) const noexcept {
  const auto& q = quarters;
  if (!q[3].oscillates() || q[3].amplitude < felt) return MotionClass::stable;
  bool grows = true;
  for (std::size_t i = 1; i < q.size(); ++i) grows = grows && q[i].amplitude > kGrowth * q[i - 1].amplitude;
  if (grows) return MotionClass::diverged;
  if (q[3].amplitude < kLeft * q[0].amplitude) return MotionClass::stable;
  const bool decays = q[2].amplitude < kSustained * q[1].amplitude && q[3].amplitude < kSustained * q[2].amplitude;
  return decays ? MotionClass::dying_out : MotionClass::vibrating;
}

MotionClass classify(Simulation& simulation, const MotionClassifier& classifier) {
  for (bool more = true; more;) {
    throw_if_stopped();
    for (std::uint64_t i = 0; i < kAskEvery && more; ++i) more = !classifier.at_rest() && simulation.step();
  }
  throw_if_stopped();
  return classifier.motion_class(simulation.result().outcome);
}

namespace {

/// Whether the tool ever touched, where it was last, and a hash of where it was.
class LastPlace final : public Observer {
 public:
  void on_step(const StepRecord& record) noexcept override {
    touches = record.colliding > 0;
    touched = touched || touches;
    position = record.tool.pose.position;
    for (const double coordinate : record.handle.position) way.real(coordinate);
  }
  Hash64 way;
  bool touched = false, touches = false;
  Vec3 position = Vec3::Zero();
};

bool has_left(const LastPlace& last, const PointShell& shell, double reach) {
  const Box bounds = shell.bounds();
  const bool inside =
      ((last.position - bounds.min).array() >= -reach).all() && ((last.position - bounds.max).array() <= reach).all();
  return !last.touches && !inside;
}

/// Sums over the quarter that was begun last: the last one, unless the run was cut short because it came to rest.
class LastQuarter final : public Observer {
 public:
  explicit LastQuarter(const TimeFields& time)
      : steps_(static_cast<std::uint64_t>(time.steps)), vibration_(steps_, time.step) {}

  void on_step(const StepRecord& record) noexcept override {
    if (const std::uint64_t quarter = record.step * 4 / steps_; quarter != quarter_) {
      quarter_ = quarter;
      rows_in_contact_ = contacts_ = 0;
      press_sum_ = 0.0;
      S_sum_.setZero();
    }
    vibration_.add(record.step, record.handle.velocity);
    if (record.rendered->size() == 0) return;
    if (!touch_speed_) touch_speed_ = record.handle.velocity.norm();
    press_sum_ += record.hand.measured.norm();
    ++rows_in_contact_;
    contacts_ += record.rendered->size();
    S_sum_ += record.force.S;
  }

  SettledState state() const {
    SettledState state;
    state.vibration = vibration_.value();
    state.touch_speed = touch_speed_.value_or(0.0);
    if (rows_in_contact_ == 0) return state;
    const auto rows = static_cast<double>(rows_in_contact_);
    state.contacts = static_cast<double>(contacts_) / rows;
    state.lambda_max = lambda_max(S_sum_ / rows);
    state.press = press_sum_ / rows;
    return state;
  }

 private:
  std::uint64_t steps_;
  LastQuarterVibration vibration_;
  std::uint64_t quarter_ = 0, rows_in_contact_ = 0, contacts_ = 0;
  std::optional<double> touch_speed_;
  double press_sum_ = 0.0;
  Mat3 S_sum_ = Mat3::Zero();
};

MotionClassifier classifier_of(const Scenario& scenario, const TremorSpeeds& tremor) {
  const auto steps = static_cast<std::uint64_t>(scenario.time.steps);
  if (!is_moved(scenario)) return MotionClassifier(steps);
  return MotionClassifier::of_moved_tool(steps, scenario.time.step, script_moves_until(scenario) / scenario.time.step,
                                         tremor);
}

RunVerdict verdict_of(MotionClass motion, const SettledState& settled, std::optional<double> most_vibration) {
  // Both enumerations begin with the same classes.
  if (!most_vibration || motion == MotionClass::diverged) return static_cast<RunVerdict>(motion);
  return settled.vibration && *settled.vibration <= *most_vibration ? RunVerdict::stable : RunVerdict::vibrating;
}
static_assert(static_cast<int>(RunVerdict::diverged) == static_cast<int>(MotionClass::diverged));

}  // namespace

namespace {

/// The outcome after which a verdict is named, if it is one.
std::optional<Outcome> outcome_of(RunVerdict verdict) {
  switch (verdict) {
    case RunVerdict::lost_contact:
      return Outcome::lost_contact;
    case RunVerdict::went_through:
      return Outcome::went_through;
    case RunVerdict::not_dragged:
      return Outcome::not_dragged;
    case RunVerdict::stuck:
      return Outcome::stuck;
    default:
      return std::nullopt;
  }
}

}  // namespace

std::string_view run_verdict_name(RunVerdict verdict) noexcept {
  if (const auto outcome = outcome_of(verdict)) return outcome_name(*outcome);
  if (verdict == RunVerdict::thrown_out) return "thrown_out";
  if (verdict == RunVerdict::no_contact) return "no_contact";
  if (verdict == RunVerdict::beyond_bound) return "beyond_bound";
  return motion_class_name(static_cast<MotionClass>(verdict));
}

const char* run_verdict_meaning(RunVerdict verdict) noexcept {
  if (const auto outcome = outcome_of(verdict)) return outcome_infos()[static_cast<std::size_t>(*outcome)].meaning;
  if (verdict == RunVerdict::thrown_out)
    return "the tool left the hole, or ended without contact beyond the environment's box by more than it reaches";
  if (verdict == RunVerdict::no_contact) return "the tool touched nothing in any row";
  if (verdict == RunVerdict::beyond_bound) return "stable but for a metric that a --bound does not allow";
  return text_of(static_cast<MotionClass>(verdict)).meaning;
}

std::string rule_text(const StabilityRule& rule, bool moved) {
  std::string text =
      rule.most_vibration
          ? fmt::format(
                "stable: at most {} m/s rms above {:.0f} Hz at the handle in the last quarter of "
                "a run",
                *rule.most_vibration, kVibrationCutoff)
          : fmt::format("stable: comes to rest or dies out{}", rule.bounded ? ", or vibrates without growing" : "");
  if (!rule.most_vibration && moved)
    text +=
        ", as far as it is above 30 Hz and 1 mm/s, because a script moves the tool; where that ends in the first half of a run, all beyond 1 mm/s from then on";
  if (!rule.most_vibration && rule.tremor && rule.tremor->target > 0.0) {
    text += fmt::format(
        "; allowed besides is what the hand's tremor does without a wall, {:.2g} mm/s above 30 Hz, and the speed of its "
        "target, {:.2g} mm/s, below",
        1e3 * rule.tremor->handle, 1e3 * rule.tremor->target);
  }
  for (const auto& [metric, bound] : rule.bounds) {
    if (bound.min) text += fmt::format(", {} >= {}", metric, *bound.min);
    if (bound.max) text += fmt::format(", {} <= {}", metric, *bound.max);
  }
  std::vector<std::string_view> others;
  for (const RunVerdict verdict : kRunVerdicts) {
    const bool of_bounds = verdict == RunVerdict::beyond_bound;
    if (!rule.holds(verdict) && (!of_bounds || !rule.bounds.empty())) others.push_back(run_verdict_name(verdict));
  }
  return fmt::format("{}; not: {}", text, fmt::join(others, ", "));
}

/// The class of the motion of hand and device without any environment.
static MotionClass classify_alone(const Scenario& scenario, const NamedFiles& files, const MotionClassifier& classifier,
                                  const std::vector<Observer*>& observers) {
  constexpr double kCells = 1.0;  // [m], of the grid that local_average wants
  const auto nothing = std::make_shared<const PointShell>(std::vector<SurfacePoint>{}, kCells);
  Simulation simulation(simulation_config(scenario), assemble(scenario, files, nothing, {}), observers);
  return classify(simulation, classifier);
}

TremorSpeeds tremor_speeds(const LoadedScenario& loaded) {
  const TremorConfig* tremor = tremor_of(loaded.scenario);
  if (tremor == nullptr) return {};
  constexpr double kNothing = 1e-9;  // [N/m], of springs, which no shell takes away
  Scenario scenario = loaded.scenario;
  scenario.rendering.stiffness = kNothing;
  scenario.rendering.damping = 0.0;
  MotionClassifier classifier = classifier_of(scenario, {});
  classify_alone(scenario, loaded.files, classifier, {&classifier});
  return {tremor->largest_speed(), classifier.late_amplitude()};
}

namespace {

/// True when the run, made once more to its end, keeps all bounds.
bool keeps(const LoadedScenario& loaded, const std::shared_ptr<const PointShell>& shell,
           const std::map<std::string, MetricBound>& bounds) {
  const Result report = run_with_shell(loaded, shell, std::nullopt, false);
  ExpectFields expect;
  expect.outcomes = {report.end.outcome};
  expect.metrics = bounds;
  return unmet_expectations(expect, report).empty();
}

/// The verdict of a run that did all its steps in view of what it touched; nothing when only its motion can tell.
std::optional<RunVerdict> verdict_of(Outcome outcome) {
  if (outcome == Outcome::no_contact) return RunVerdict::no_contact;
  for (const RunVerdict verdict : kRunVerdicts) {
    if (outcome_of(verdict) == outcome) return verdict;
  }
  return std::nullopt;
}

}  // namespace

static JudgedRun judged_once(const LoadedScenario& loaded, const std::shared_ptr<const PointShell>& shell,
                             const StabilityRule& rule) {
  const Scenario& scenario = loaded.scenario;
  MotionClassifier classifier = classifier_of(scenario, rule.tremor ? *rule.tremor : tremor_speeds(loaded));
  LastPlace last;
  LastQuarter quarter(scenario.time);
  SimulationParts parts = assemble(scenario, loaded.files, shell, {});
  const std::shared_ptr<const ToolShape> tool = parts.tool;
  EncounterObservers seen(scenario, loaded.files, parts);
  std::vector<Observer*> observers = {&classifier, &last, &quarter};
  for (Observer* observer : seen.all()) observers.push_back(observer);
  Simulation simulation(simulation_config(scenario), std::move(parts), observers);
  const MotionClass motion = classify(simulation, classifier);
  SettledState settled = quarter.state();
  // A run that was cut short there would tell the vibration of an earlier quarter.
  if (classifier.at_rest() && settled.vibration) settled.vibration = 0.0;
  TrialContact touched;
  touched.in_contact = last.touched ? 1 : 0;
  const Outcome outcome = seen.outcome(touched, simulation.result().outcome);
  const auto verdict = [&] {
    if (motion == MotionClass::diverged) return RunVerdict::diverged;
    if (outcome == Outcome::went_through) return RunVerdict::went_through;
    if (!last.touched) return RunVerdict::no_contact;
    if (outcome == Outcome::leaves_hole || (shell && has_left(last, *shell, tool->reach())))
      return RunVerdict::thrown_out;
    if (const auto known = verdict_of(outcome)) return *known;
    return verdict_of(motion, settled, rule.most_vibration);
  };
  JudgedRun run{verdict(), settled, last.way.value(), classifier.at_rest()};
  run.undecided = is_stable(run.verdict) && classifier.is_undecided();
  return run;
}

JudgedRun judged_run(const LoadedScenario& loaded, std::shared_ptr<const PointShell> shell, const StabilityRule& rule) {
  constexpr int kLengthenings = 3;
  constexpr std::int64_t kTimes = 4, kMostLengthened = 1'000'000;  // steps
  JudgedRun run = judged_once(loaded, shell, rule);
  LoadedScenario longer = loaded;
  for (int i = 0; run.undecided && i < kLengthenings && longer.scenario.time.steps * kTimes <= kMostLengthened; ++i) {
    longer.scenario.time.steps *= kTimes;
    const std::uint64_t way = run.way;
    run = judged_once(longer, shell, rule);
    run.way = way;  // of the scenario's own length, as that of other runs
  }
  if (is_stable(run.verdict) && !rule.bounds.empty() && !keeps(loaded, shell, rule.bounds))
    run.verdict = RunVerdict::beyond_bound;
  return run;
}

bool unstable_without_contact(const LoadedScenario& loaded, std::optional<double> most_vibration) {
  if (spring_of(loaded.scenario.hand) == nullptr ||
      std::holds_alternative<SpringsEnvironment>(loaded.scenario.environment))
    return false;
  // Dry friction only takes energy. What its sticking and slipping leave of vibration is no fault of the loop.
  Scenario scenario = loaded.scenario;
  if (auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device)) device->coulomb = 0.0;
  MotionClassifier classifier = classifier_of(scenario, tremor_speeds(loaded));
  LastQuarter quarter(scenario.time);
  const MotionClass motion = classify_alone(scenario, loaded.files, classifier, {&classifier, &quarter});
  return !is_stable(verdict_of(motion, quarter.state(), most_vibration));
}

}  // namespace hapbench
