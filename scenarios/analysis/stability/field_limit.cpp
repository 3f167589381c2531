#include "scenarios/analysis/stability/field_limit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include <utility>

#include "results/observe/contact_forces.hpp"
#include "scenarios/analysis/convergence/metric_errors.hpp"
#include "scenarios/analysis/stability/limit_theory.hpp"
#include "scenarios/analysis/stability/quoted_limit.hpp"
#include "scenarios/batch/jobs.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/scene_loop.hpp"
#include "scenarios/scene/environments.hpp"
#include "scenarios/scene/field_files.hpp"

namespace hapbench {
namespace {

/// Throws InputError if the sampling rate is too low to measure vibration above kVibrationCutoff.
void check_sampling(const LoadedScenario& loaded) {
  const double step = loaded.scenario.time.step;
  if (kVibrationCutoff * step < 0.5) return;
  fail_in({.file = loaded.file, .pointer = "/time/step_s", .about_options = {"--vibration"}},
          fmt::format("got {}; allowed for --vibration, which is the vibration above {} Hz: below {:.4g}", step,
                      kVibrationCutoff, 0.5 / kVibrationCutoff));
}

/// The runs of a search. Runs the scenario once with each value of the field and caches the result. A parameter t in
/// [0, 1] stands for a value (IntervalSearchOptions::value_at).
class RunCache {
 public:
  explicit RunCache(const LimitQuestion& question) : question_(question) {}

  /// Runs the scenario with the field's values at these parameters, in parallel. Skips cached values.
  void run_ahead(std::span<const double> parameters) {
    std::vector<double> values;
    for (const double t : parameters) {
      const double value = question_.search.value_at(t);
      if (runs_.try_emplace(value).second) values.push_back(value);
    }
    for_each_job(values.size(), {question_.threads, ""}, [&](std::size_t i) {
      const CheckedScenario run = checked(question_.at(values[i]));
      const auto judged = [&] { return stability_of(run, make_shell(run.scenario(), run.files()), question_.rule); };
      runs_.at(values[i]) = with_file(run.loaded(), judged);
    });
  }

  /// Returns true if the run with the value at a parameter is stable by the question's rule. If the value is not
  /// cached, makes the run.
  bool is_stable_at(double t) {
    run_ahead({&t, 1});
    return question_.rule.holds(at(t).verdict);
  }

  // Precondition of the functions `at` and `of`: the run with the value is cached.

  JudgedValue at(double t) const {
    const double value = question_.search.value_at(t);
    return {value, of(value).verdict};
  }
  const RunStability& of(double value) const { return runs_.at(value); }
  /// Returns the reason why the run at a parameter is not stable: its class, and the bounds that it violates.
  std::pair<RunVerdict, std::vector<ViolatedBound>> failure_at(double t) const {
    const RunStability& run = of(question_.search.value_at(t));
    return {run.verdict, run.violated};
  }

  const std::map<double, RunStability>& by_value() const { return runs_; }

 private:
  const LimitQuestion& question_;
  std::map<double, RunStability> runs_;
};

/// Evaluates the given parameters (middles of the intervals that are stable in theory) and the end points of the
/// kScanIntervals intervals of a scan.
EvaluatedParameters evaluate_first(RunCache& runs, std::vector<double> parameters) {
  for (const double t : scan_parameters(kScanIntervals)) parameters.push_back(t);
  runs.run_ahead(parameters);
  EvaluatedParameters evaluated;
  for (const double t : parameters) evaluated[t] = runs.is_stable_at(t);
  return evaluated;
}

/// If no evaluated parameter is stable, searches between neighbours whose runs fail in different ways, such as passing
/// through a surface that is too soft and vibrating on one that is too stiff: a stable interval between them may be
/// narrower than a scan interval. Bisects each such pair, and every half whose ends still differ, down to the
/// resolution or up to kMaxRuns runs. Stops at the first stable parameter.
void search_between_failures(const LimitQuestion& question, RunCache& runs, EvaluatedParameters& evaluated) {
  constexpr int kMaxRuns = 60;
  const auto is_stable = [](const auto& entry) { return entry.second; };
  if (std::ranges::any_of(evaluated, is_stable)) return;
  std::vector<std::pair<double, double>> pairs;
  for (auto low = evaluated.begin(), high = std::next(low); high != evaluated.end(); ++low, ++high)
    pairs.emplace_back(low->first, high->first);
  std::ranges::reverse(pairs);  // the pair at the low end is the last, and is taken first
  for (int made = 0; !pairs.empty() && made < kMaxRuns;) {
    const auto [low, high] = pairs.back();
    pairs.pop_back();
    if (runs.failure_at(low) == runs.failure_at(high) || !question.search.needs_bisection(low, high)) continue;
    const double middle = 0.5 * (low + high);
    evaluated[middle] = runs.is_stable_at(middle);
    ++made;
    if (evaluated[middle]) return;
    pairs.emplace_back(middle, high);
    pairs.emplace_back(low, middle);
  }
}

StableInterval find_interval(const LimitQuestion& question, RunCache& runs, EvaluatedParameters evaluated, bool near) {
  const auto is_stable = [&](double t) { return runs.is_stable_at(t); };
  const auto run_ahead = [&](std::span<const double> parameters) { runs.run_ahead(parameters); };
  return question.between ? find_verified_interval(question.search, evaluated, is_stable, near, run_ahead)
                          : find_stable_interval(question.search, evaluated, is_stable, true);
}

/// Returns the number of distinct values of the verification samples, without the ends of the interval.
std::size_t verification_samples(const IntervalSearchOptions& search, const StableInterval& interval) {
  const double first = interval.first.value_or(*interval.stable);
  std::set<double> values;
  for (const double t : parameters_between(first, *interval.stable, kVerificationSamples))
    values.insert(search.value_at(t));
  values.erase(search.value_at(first));
  values.erase(search.value_at(*interval.stable));
  return values.size();
}

/// Returns true if every whole number of the interval was run.
bool all_were_run(const IntervalSearchOptions& search, const StableInterval& interval, const RunCache& runs) {
  if (!search.whole) return false;
  const auto [low, high] =
      std::minmax({search.value_at(interval.first.value_or(*interval.stable)), search.value_at(*interval.stable)});
  for (double value = low; value <= high; value += 1.0)
    if (!runs.by_value().contains(value)) return false;
  return true;
}

/// Stores in `limit` the interval that was found.
void add_interval(const LimitQuestion& question, const StableInterval& interval, const RunCache& runs,
                  FieldLimit& limit) {
  const IntervalSearchOptions& search = question.search;
  limit.scattered = interval.scattered;
  limit.scattered_at_current = interval.scattered_at_current;
  if (interval.stable) {
    if (question.between) limit.tried_between = verification_samples(search, interval);
    limit.tried_all = all_were_run(search, interval, runs);
    limit.end.value = search.value_at(*interval.stable);
    limit.settled = runs.of(*limit.end.value).settled;
  }
  if (interval.beyond) {
    limit.end.beyond = runs.at(*interval.beyond);
    limit.beyond_fades = runs.of(limit.end.beyond->value).fades;
  }
  if (interval.first) limit.other.value = search.value_at(*interval.first);
  if (interval.before) limit.other.beyond = runs.at(*interval.before);
  if (search.current_parameter()) limit.own = runs.at(*search.current_parameter());
}

/// Stores in `limit` all runs of the search, and the runs that contradict the interval that was found.
void add_runs(const LimitQuestion& question, const std::map<double, RunStability>& runs, FieldLimit& limit) {
  const auto is_before = [&](double a, double b) { return question.search.smallest ? a > b : a < b; };
  for (const auto& [value, run] : runs) {
    limit.runs.push_back({value, run.verdict});
    const bool in_interval = (!limit.end.beyond || is_before(value, limit.end.beyond->value)) &&
                             (!limit.other.beyond || is_before(limit.other.beyond->value, value));
    if (limit.end.value && question.rule.holds(run.verdict) != in_interval)
      limit.inconsistent.push_back(limit.runs.back());
    limit.undecided += run.undecided;
  }
  limit.has_effect = std::any_of(runs.begin(), runs.end(), [&](const auto& run) {
    return run.second.motion_hash != runs.begin()->second.motion_hash;
  });
}

/// Finds out whether hand and device are unstable without contact, and stores the result in `limit`.
void add_cause(const LimitQuestion& question, FieldLimit& limit) {
  const JudgedValue suspect = limit.end.beyond ? *limit.end.beyond : limit.runs.front();
  if (question.rule.holds(suspect.verdict)) return;
  const CheckedScenario scenario = checked(question.at(suspect.value));
  limit.unstable_part = unstable_without_wall(scenario.scenario());
  limit.unstable_alone =
      !limit.unstable_part.empty() || unstable_without_contact(scenario, question.rule.max_vibration);
  if (limit.unstable_alone && limit.unstable_part.empty()) limit.unstable_part = "hand and device";
}

/// Stores FieldLimit::linear, or the reason why it has no value (FieldLimit::no_linear).
void add_linear_limit(const LimitQuestion& question, const std::map<double, RunStability>& runs, FieldLimit& limit) {
  if (limit.theory || limit.theory_has_none) return;
  if (!limit.end.value) {
    limit.no_linear = "no run is stable, so that no tool rests in contact";
    return;
  }
  const Scenario scenario = question.at(*limit.end.value).scenario;
  if (has_multi_rate_contacts(scenario)) {
    limit.no_linear = "the contacts are not found in every step";
    return;
  }
  if (!has_linear_loop(scenario)) {
    limit.no_linear = "the delay or a field of the device is not part of the linear theory";
    return;
  }
  // Springs that cannot lose contact have the same linear loop in every run. The search for an equilibrium in contact
  // is skipped, because it would count springs at zero deflection as not in contact.
  if (has_permanent_springs(scenario)) {
    const TheoreticalLimit loop = frictionless_limit(question);
    limit.linear = loop.has_none ? limit_without_transition(false, question.search.smallest) : loop.value;
    if (limit.linear) return;
  }
  // Among the stable values, find the value nearest to the limit whose run has a lasting contact (contact_lasts()).
  std::optional<double> nearest;
  const auto distance = [&](double value) { return std::abs(value - *limit.end.value); };
  for (const auto& [value, judged] : runs) {
    const bool is_on_stable_side = question.search.smallest ? value >= *limit.end.value : value <= *limit.end.value;
    if (!is_on_stable_side || (nearest && distance(value) >= distance(*nearest))) continue;
    if (question.rule.holds(judged.verdict) && contact_lasts(judged.settled, question.at(value).scenario))
      nearest = value;
  }
  if (!nearest) {
    limit.no_linear = "contacts come and go in every stable run";
    return;
  }
  limit.linear = contact_limit(question, *nearest, *runs.at(*nearest).settled.last_contact);
  if (!limit.linear) limit.no_linear = "the tool has no equilibrium in contact";
}

/// Stores in `limit` the further theoretical limits: the limits by closed formulas, the linear limit with the worst of
/// the typical hands, and the linear limit of a tool in contact. If a linear limit is missing, also stores the reason.
void add_formulas(const LimitQuestion& question, const std::map<double, RunStability>& runs, FieldLimit& limit) {
  limit.closed_form = inequality_limit(question).value;
  WallLimits wall = wall_limits(question);
  limit.closed_forms = std::move(wall.closed_forms);
  limit.worst_hand = wall.worst_hand;
  limit.no_theory = std::move(wall.no_theory);
  add_linear_limit(question, runs, limit);
}

}  // namespace

std::optional<double> IntervalEnd::tolerance() const {
  if (!value || !beyond) return std::nullopt;
  return std::abs(beyond->value - *value);
}

/// Finds the limit with the bounds of the question's rule. Ignores the errors of the bounded metrics.
static FieldLimit limit_with_bounds(const LimitQuestion& question) {
  FieldLimit limit;
  // Find the linear limit, if the theory applies.
  TheoreticalLimit theory = eigenvalue_limit(question);
  limit.theory = theory.value;
  limit.theory_has_none = theory.has_none;
  // Search the interval by runs. Samples near the limit are needed only if no theory confirms the limit.
  RunCache runs(question);
  EvaluatedParameters evaluated = evaluate_first(runs, std::move(theory.islands));
  search_between_failures(question, runs, evaluated);
  const bool near = !limit.theory;
  const StableInterval interval = find_interval(question, runs, std::move(evaluated), near);
  add_interval(question, interval, runs, limit);
  add_runs(question, runs.by_value(), limit);
  add_cause(question, limit);
  add_formulas(question, runs.by_value(), limit);
  return limit;
}

/// Computes the errors of the bounded metrics at a value of the field. Stores each error in `errors` if it is larger
/// than the stored error. If a metric with its error violates the user's bound, tightens the bound in `rule` to the
/// user's bound, reduced by the error; a bound that is already tighter stays. Returns true if a metric with its error
/// violates a bound.
static bool tighten_bounds(const LimitQuestion& question, double value, StabilityRule& rule, MetricValues& errors) {
  std::vector<std::string> chosen = question.overrides;
  chosen.push_back(override_of(question, value));
  const CheckedScenario scenario = checked(question.at(value));
  const Result run = run_with_shell(scenario, make_shell(scenario.scenario(), scenario.files()));
  MetricValues metrics;
  for (const auto& [name, bound] : question.rule.bounds)
    if (const auto number = number_of(run.metrics, name)) metrics[name] = *number;
  const MetricErrors refined = metric_errors(*question.scene, chosen, metrics, question.threads);
  bool violates = false;
  for (const auto& [name, error] : refined.errors) {
    errors[name] = std::max(errors[name], error);
    const MetricBound& bound_of_user = question.rule.bounds.at(name);
    MetricBound& bound = rule.bounds[name];
    if (bound_of_user.max && metrics[name] + error > *bound_of_user.max) {
      bound.max = std::min(*bound.max, *bound_of_user.max - error);
      violates = true;
    }
    if (bound_of_user.min && metrics[name] - error < *bound_of_user.min) {
      bound.min = std::max(*bound.min, *bound_of_user.min + error);
      violates = true;
    }
  }
  return violates;
}

/// Finds the limit at which the bounded metrics keep the bounds of the question's rule even with their errors added.
static FieldLimit limit_with_errors(const LimitQuestion& question) {
  FieldLimit limit = limit_with_bounds(question);
  if (question.rule.bounds.empty()) return limit;
  constexpr int kMaxTightenings = 4;  // maximum number of repeated searches; the errors change little between them
  LimitQuestion tighter = question;
  MetricValues errors;
  const auto violates_a_bound = [&] {
    bool violates = tighten_bounds(question, *limit.end.value, tighter.rule, errors);
    if (limit.other.value) violates |= tighten_bounds(question, *limit.other.value, tighter.rule, errors);
    return violates;
  };
  bool violates = limit.end.value && violates_a_bound();
  for (int i = 0; violates && i < kMaxTightenings; ++i) {
    limit = limit_with_bounds(tighter);
    violates = limit.end.value && violates_a_bound();
  }
  limit.metric_errors = std::move(errors);
  limit.violates_with_errors = violates;
  return limit;
}

FieldLimit field_limit(const LimitQuestion& question) {
  if (question.rule.max_vibration) check_sampling(load_scenario(*question.scene, question.overrides));
  FieldLimit limit = limit_with_errors(question);
  limit.quoted = quoted_limit(question, limit);
  return limit;
}

}  // namespace hapbench
