#include "scenarios/analysis/stability/field_limit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include "results/observe/contact_forces.hpp"
#include "scenarios/analysis/stability/limit_theory.hpp"
#include "scenarios/batch/jobs.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/scene/environments.hpp"
#include "scenarios/scene/field_files.hpp"

namespace hapbench {
namespace {

/// Throws InputError if the sampling rate is too low to measure vibration above kVibrationCutoff.
void check_sampling(const LoadedScenario& loaded) {
  const double step = loaded.scenario.time.step;
  if (kVibrationCutoff * step < 0.5) return;
  fail_in({.file = loaded.file, .pointer = "/time/step_s", .about_options = {"--vibration"}},
          fmt::format("got {}; allowed for --vibration, which is what is above {} Hz: below {:.4g}", step,
                      kVibrationCutoff, 0.5 / kVibrationCutoff));
}

/// The runs of a search. Runs each value once and caches its result.
class RunCache {
 public:
  explicit RunCache(const LimitQuestion& question) : question_(question) {}

  /// Runs the values at these parameters in parallel. Skips values that were run before.
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

  /// Returns true if the run at a parameter is stable by the question's rule. Runs the value if it is not cached.
  bool is_stable_at(double t) {
    run_ahead({&t, 1});
    return question_.rule.holds(at(t).verdict);
  }

  // Precondition of the following functions: the value was run.

  JudgedValue at(double t) const {
    const double value = question_.search.value_at(t);
    return {value, of(value).verdict};
  }
  const RunStability& of(double value) const { return runs_.at(value); }

  const std::map<double, RunStability>& by_value() const { return runs_; }

 private:
  const LimitQuestion& question_;
  std::map<double, RunStability> runs_;
};

/// Evaluates the given parameters (middles of the intervals that are stable in theory) and the end points of a scan.
EvaluatedParameters evaluate_first(RunCache& runs, std::vector<double> parameters) {
  for (int i = 0; i <= kScanIntervals; ++i) parameters.push_back(static_cast<double>(i) / kScanIntervals);
  runs.run_ahead(parameters);
  EvaluatedParameters evaluated;
  for (const double t : parameters) evaluated[t] = runs.is_stable_at(t);
  return evaluated;
}

StableInterval find_interval(const LimitQuestion& question, RunCache& runs, EvaluatedParameters evaluated, bool near) {
  const auto is_stable = [&](double t) { return runs.is_stable_at(t); };
  const auto run_ahead = [&](std::span<const double> parameters) { runs.run_ahead(parameters); };
  return question.between ? find_verified_interval(question.search, evaluated, is_stable, near, run_ahead)
                          : find_stable_interval(question.search, evaluated, is_stable, true);
}

/// Stores the interval that was found in the limit.
void add_interval(const LimitQuestion& question, const StableInterval& interval, const RunCache& runs,
                  FieldLimit& limit) {
  const IntervalSearchOptions& search = question.search;
  limit.scattered = interval.scattered;
  if (interval.stable) {
    limit.tried_between = question.between ? kVerificationSamples : 0;
    limit.end.value = search.value_at(*interval.stable);
    limit.settled = runs.of(*limit.end.value).settled;
  }
  if (interval.beyond) limit.end.beyond = runs.at(*interval.beyond);
  if (interval.first) limit.other.value = search.value_at(*interval.first);
  if (interval.before) limit.other.beyond = runs.at(*interval.before);
  if (search.current_parameter()) limit.own = runs.at(*search.current_parameter());
}

/// Stores in the limit all runs of the search, and the runs that contradict the interval that was found.
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

/// Finds out whether hand and device are unstable without contact, and stores the result in the limit.
void add_cause(const LimitQuestion& question, FieldLimit& limit) {
  const JudgedValue suspect = limit.end.beyond ? *limit.end.beyond : limit.runs.front();
  limit.unstable_alone = !question.rule.holds(suspect.verdict) &&
                         unstable_without_contact(checked(question.at(suspect.value)), question.rule.max_vibration);
}

/// Computes the limits by closed forms and the linear limit in contact, and stores them in the limit.
void add_formulas(const LimitQuestion& question, FieldLimit& limit) {
  limit.closed_form = inequality_limit(question).value;
  WallLimits wall = wall_limits(question);
  limit.closed_forms = std::move(wall.closed_forms);
  limit.worst_hand = wall.worst_hand;
  limit.no_theory = std::move(wall.no_theory);
  if (!limit.theory && limit.settled.lambda_max > 0.0 && !question.search.smallest)
    limit.linear = contact_limit(question, limit.settled.lambda_max);
}

}  // namespace

std::optional<double> IntervalEnd::tolerance() const {
  if (!value || !beyond) return std::nullopt;
  return std::abs(beyond->value - *value);
}

bool FieldLimit::is_beyond_linear(double resolution) const {
  return end.value && linear && *end.value > (1.0 + resolution) * *linear;
}

FieldLimit field_limit(const LimitQuestion& question) {
  if (question.rule.max_vibration) check_sampling(load_scenario(*question.scene, question.overrides));
  FieldLimit limit;
  // Find the linear limit, where the theory applies.
  TheoreticalLimit theory = eigenvalue_limit(question);
  limit.theory = theory.value;
  limit.theory_has_none = theory.has_none;
  // Search the interval by runs. Samples near the limit are needed only if no theory confirms the limit.
  RunCache runs(question);
  EvaluatedParameters evaluated = evaluate_first(runs, std::move(theory.islands));
  const bool near = !limit.theory;
  const StableInterval interval = find_interval(question, runs, std::move(evaluated), near);
  add_interval(question, interval, runs, limit);
  add_runs(question, runs.by_value(), limit);
  add_cause(question, limit);
  add_formulas(question, limit);
  return limit;
}

}  // namespace hapbench
