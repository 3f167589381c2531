#include "scenarios/batch/league_runs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "results/summary/outcome_names.hpp"
#include "scenarios/run/expectation.hpp"

namespace hapbench {

std::string default_metrics_text() {
  return fmt::format("{}", fmt::join(kDefaultMetrics, ","));
}

bool is_failure(std::string_view outcome) {
  const std::optional<Outcome> known = outcome_named(outcome);
  return known && outcome_infos()[static_cast<std::size_t>(*known)].is_failure;
}

LeagueRuns league_runs(const BatchPlan& plan, const BatchReport& report, const std::vector<std::string>& metrics) {
  LeagueRuns league;
  league.scenarios = plan.names;
  league.algorithms = plan.definition.algorithms;
  const bool all_have_reference = std::all_of(report.runs.begin(), report.runs.end(), [](const RunReport& run) {
    return run.summary.section("fidelity") != nullptr;
  });
  const std::span<const std::string_view> usual =
      all_have_reference ? std::span<const std::string_view>(kFidelityMetrics) : kDefaultMetrics;
  league.metrics = metrics.empty() ? std::vector<std::string>(usual.begin(), usual.end()) : metrics;
  league.seeds = plan.definition.seeds;
  for (std::size_t i = 0; i < plan.size(); ++i) {
    const RunSummary& summary = report.runs[i].summary;
    const MetricList list = metric_list(summary);
    LeagueRun run;
    run.outcome = outcome_name(summary.result.outcome);
    run.failed =
        is_failure(run.outcome) || !outcome_is_expected(scenario_of(plan, i).scenario.expect, summary.result.outcome);
    run.state_hash = summary.metrics.state_hash;
    for (const std::string& name : league.metrics) run.metrics.push_back(number_of(value_of(list, name)));
    league.runs.push_back(std::move(run));
  }
  return league;
}

}  // namespace hapbench
