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
#include "scenarios/run/assemble.hpp"
#include "scenarios/scene/environments.hpp"
#include "scenarios/scene/field_files.hpp"

namespace hapbench {
namespace {

void check_sampling(const LoadedScenario& loaded) {
  const double step = loaded.scenario.time.step;
  if (kVibrationCutoff * step < 0.5) return;
  fail_in({.file = loaded.file, .pointer = "/time/step_s"},
          fmt::format("got {}; allowed for --vibration, which is what is above {} Hz: below {:.4g}", step,
                      kVibrationCutoff, 0.5 / kVibrationCutoff));
}

/// The runs of a search. Each value is run once.
class JudgedRuns {
 public:
  explicit JudgedRuns(const LimitQuestion& question) : question_(question) {}

  /// Runs the values at these parameters in parallel, except those that were run before.
  void run_ahead(std::span<const double> parts) {
    std::vector<double> values;
    for (const double t : parts) {
      const double value = question_.search.value_at(t);
      if (runs_.try_emplace(value).second) values.push_back(value);
    }
    for_each_job(values.size(), {question_.threads, ""}, [&](std::size_t i) {
      const LoadedScenario loaded = question_.at(values[i]);
      const auto judged = [&] {
        return stability_of(loaded, make_shell(loaded.scenario, loaded.files), question_.rule);
      };
      runs_.at(values[i]) = with_file(loaded, judged);
    });
  }

  /// Returns true if the run at a parameter is stable; runs it first if necessary.
  bool is_stable_at(double t) {
    run_ahead({&t, 1});
    return question_.rule.holds(at(t).verdict);
  }

  // Precondition: the value was run.

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

/// Evaluates the first values: the middles of intervals that are stable in theory, and a scan of the range.
TriedParts first_values(JudgedRuns& runs, std::vector<double> parts) {
  for (int i = 0; i <= kEdgeIntervals; ++i) parts.push_back(static_cast<double>(i) / kEdgeIntervals);
  runs.run_ahead(parts);
  TriedParts tried;
  for (const double t : parts) tried[t] = runs.is_stable_at(t);
  return tried;
}

FoundEdge searched_edge(const LimitQuestion& question, JudgedRuns& runs, TriedParts tried, bool near) {
  const auto is_stable = [&](double t) { return runs.is_stable_at(t); };
  const auto run_ahead = [&](std::span<const double> parts) { runs.run_ahead(parts); };
  return question.between ? find_tried_edge(question.search, tried, is_stable, near, run_ahead)
                          : find_edge(question.search, tried, is_stable, true);
}

/// Adds the interval that was found.
void add_interval(const LimitQuestion& question, const FoundEdge& edge, const JudgedRuns& runs, FieldLimit& limit) {
  const SearchWay& search = question.search;
  limit.scattered = edge.scattered;
  if (edge.stable) {
    limit.tried_between = question.between ? kTriedBetween : 0;
    limit.end.value = search.value_at(*edge.stable);
    limit.settled = runs.of(*limit.end.value).settled;
  }
  if (edge.beyond) limit.end.beyond = runs.at(*edge.beyond);
  if (edge.first) limit.other.value = search.value_at(*edge.first);
  if (edge.before) limit.other.beyond = runs.at(*edge.before);
  if (search.own_part()) limit.own = runs.at(*search.own_part());
}

/// Adds the runs of the search, and which of them contradict the limit.
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

/// Adds whether hand and device are unstable by themselves.
void add_cause(const LimitQuestion& question, FieldLimit& limit) {
  const JudgedValue suspect = limit.end.beyond ? *limit.end.beyond : limit.runs.front();
  limit.unstable_alone = !question.rule.holds(suspect.verdict) &&
                         unstable_without_contact(question.at(suspect.value), question.rule.most_vibration);
}

/// Adds the limits by formulas, and the linear limit in contact.
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
  if (question.rule.most_vibration) check_sampling(load_scenario(*question.scene, question.overrides));
  FieldLimit limit;
  TheoreticalLimit theory = eigenvalue_limit(question);
  limit.theory = theory.value;
  limit.theory_has_none = theory.has_none;
  JudgedRuns runs(question);
  TriedParts tried = first_values(runs, std::move(theory.islands));
  const bool near = !limit.theory;
  const FoundEdge edge = searched_edge(question, runs, std::move(tried), near);
  add_interval(question, edge, runs, limit);
  add_runs(question, runs.by_value(), limit);
  add_cause(question, limit);
  add_formulas(question, limit);
  return limit;
}

}  // namespace hapbench
