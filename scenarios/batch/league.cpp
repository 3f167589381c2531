#include "scenarios/batch/league.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "results/io/table_writer.hpp"
#include "results/summary/outcome_names.hpp"
#include "scenarios/batch/statistics.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/run/encounter.hpp"

namespace hapbench {
namespace {

bool seeds_matter_in(const LeagueRuns& runs, std::size_t scenario) {
  for (std::size_t a = 0; a < runs.algorithms.size(); ++a) {
    for (std::size_t k = 1; k < runs.seeds; ++k)
      if (runs.run(scenario, a, k).state_hash != runs.run(scenario, a, 0).state_hash) return true;
  }
  return false;
}

std::vector<std::size_t> common_seeds(const League& league, std::size_t scenario) {
  const LeagueRuns& runs = league.runs;
  const auto where_none_fails = [&](std::size_t most_failures) {
    std::vector<std::size_t> seeds;
    for (std::size_t k = 0; k < runs.seeds; ++k) {
      bool failed = false;
      for (std::size_t a = 0; a < runs.algorithms.size(); ++a)
        failed |= runs.run(scenario, a, k).failed && league.failures(scenario, a) <= most_failures;
      if (!failed) seeds.push_back(k);
    }
    return seeds;
  };
  const std::vector<std::size_t> seeds = where_none_fails(runs.seeds - 1);
  return seeds.empty() ? where_none_fails(0) : seeds;
}

/// The values of a metric in the common seeds of the scenario, without those of runs that failed or do not have it.
std::vector<double> values_of(const League& league, std::size_t scenario, std::size_t algorithm, std::size_t metric) {
  std::vector<double> values;
  for (const std::size_t k : league.common[scenario]) {
    const LeagueRun& run = league.runs.run(scenario, algorithm, k);
    if (!run.failed && run.metrics[metric]) values.push_back(*run.metrics[metric]);
  }
  return values;
}

std::optional<double> mean_tolerance(const League& league, std::size_t scenario, std::size_t algorithm,
                                     std::size_t metric) {
  std::vector<double> known;
  for (const std::size_t k : league.common[scenario]) {
    const LeagueRun& run = league.runs.run(scenario, algorithm, k);
    if (!run.failed && metric < run.tolerances.size() && run.tolerances[metric])
      known.push_back(*run.tolerances[metric]);
  }
  return known.empty() ? std::nullopt : std::optional(mean_of(known));
}

bool is_same(double a, double b) {
  return std::abs(a - b) <= kSameRank * std::max(std::abs(a), std::abs(b));
}

/// The standings of one scenario and metric.
class ScenarioStandings {
 public:
  ScenarioStandings(const League& league, std::size_t scenario, std::size_t metric)
      : better_(league.runs.better[metric]) {
    const LeagueRuns& runs = league.runs;
    for (std::size_t a = 0; a < runs.algorithms.size(); ++a) {
      failures_.push_back(league.failures(scenario, a));
      Standing standing;
      const std::vector<double> numbers = values_of(league, scenario, a, metric);
      if (!numbers.empty()) standing.mean = mean_of(numbers);
      standing.tolerance = mean_tolerance(league, scenario, a, metric);
      if (numbers.size() >= 2 && league.seeds_matter[scenario]) standing.spread = standard_deviation(numbers);
      standings_.push_back(standing);
    }
    if (better_ == Better::none) return;
    rank();
  }

  const std::vector<Standing>& standings() const { return standings_; }

 private:
  bool is_better(std::size_t a, std::size_t b) const {
    return better_ == Better::more ? *standings_[a].mean > *standings_[b].mean
                                   : *standings_[a].mean < *standings_[b].mean;
  }

  /// Order: algorithms without failures by their means, a missing mean last; then the others by their number of
  /// failures. There are no ranks for a metric that no algorithm has.
  void rank() {
    std::vector<std::size_t> order;
    bool any_mean = false;
    for (std::size_t a = 0; a < standings_.size(); ++a) {
      any_mean |= standings_[a].mean.has_value();
      if (failures_[a] == 0 && standings_[a].mean) order.push_back(a);
    }
    if (!any_mean) return;
    std::stable_sort(order.begin(), order.end(), [this](std::size_t a, std::size_t b) { return is_better(a, b); });
    std::size_t leader = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (!is_same(*standings_[order[leader]].mean, *standings_[order[i]].mean)) leader = i;
      standings_[order[i]].rank = 1 + leader;
    }
    for (std::size_t a = 0; a < standings_.size(); ++a) {
      if (failures_[a] == 0 && !standings_[a].mean) standings_[a].rank = 1 + order.size();
      if (failures_[a] == 0) continue;
      const auto better = std::count_if(failures_.begin(), failures_.end(),
                                        [this, a](std::size_t failures) { return failures < failures_[a]; });
      standings_[a].rank = 1 + static_cast<std::size_t>(better);
    }
  }

  Better better_;
  std::vector<Standing> standings_;
  std::vector<std::size_t> failures_;
};

LawStanding law_standing(const League& league, std::size_t algorithm) {
  LawStanding law;
  law.algorithm = algorithm;
  std::vector<double> ranks;
  for (std::size_t s = 0; s < league.runs.scenarios.size(); ++s) {
    for (std::size_t m = 0; m < league.runs.metrics.size(); ++m) {
      if (const auto rank = league.at(s, algorithm, m).rank) ranks.push_back(static_cast<double>(*rank));
    }
    if (league.failures(s, algorithm) > 0) law.fails.push_back(s);
  }
  if (!ranks.empty()) law.mean_rank = mean_of(ranks);
  return law;
}

}  // namespace

std::size_t League::failures(std::size_t scenario, std::size_t algorithm) const {
  std::size_t failures = 0;
  for (std::size_t k = 0; k < runs.seeds; ++k) failures += runs.run(scenario, algorithm, k).failed ? 1u : 0u;
  return failures;
}

std::string League::outcomes(std::size_t scenario, std::size_t algorithm) const {
  std::vector<std::pair<std::string, std::size_t>> counts;
  for (std::size_t k = 0; k < runs.seeds; ++k) {
    const std::string& outcome = runs.run(scenario, algorithm, k).outcome;
    const auto known =
        std::find_if(counts.begin(), counts.end(), [&outcome](const auto& count) { return count.first == outcome; });
    if (known == counts.end())
      counts.emplace_back(outcome, 1);
    else
      ++known->second;
  }
  if (counts.size() == 1) return counts.front().first;
  std::vector<std::string> texts;
  for (const auto& [outcome, count] : counts) texts.push_back(fmt::format("{} {}", outcome, count));
  return fmt::format("{}", fmt::join(texts, "; "));
}

League make_league(LeagueRuns runs) {
  League league;
  league.runs = std::move(runs);
  const std::size_t scenarios = league.runs.scenarios.size(), algorithms = league.runs.algorithms.size(),
                    metrics = league.runs.metrics.size();
  league.standings.resize(scenarios * algorithms * metrics);
  for (std::size_t s = 0; s < scenarios; ++s) {
    league.seeds_matter.push_back(seeds_matter_in(league.runs, s));
    league.common.push_back(common_seeds(league, s));
    for (std::size_t m = 0; m < metrics; ++m) {
      const ScenarioStandings column(league, s, m);
      for (std::size_t a = 0; a < algorithms; ++a)
        league.standings[(s * algorithms + a) * metrics + m] = column.standings()[a];
    }
  }
  for (std::size_t a = 0; a < algorithms; ++a) league.laws.push_back(law_standing(league, a));
  std::stable_sort(league.laws.begin(), league.laws.end(), [](const LawStanding& a, const LawStanding& b) {
    return a.mean_rank && (!b.mean_rank || *a.mean_rank < *b.mean_rank);
  });
  return league;
}

std::string default_metrics_text() {
  return fmt::format("{}", fmt::join(kDefaultMetrics, ","));
}

bool is_failure(std::string_view outcome) {
  const std::optional<Outcome> known = outcome_named(outcome);
  return known && outcome_infos()[static_cast<std::size_t>(*known)].is_failure;
}

bool have_reference(std::span<const RunReport> runs) {
  const auto has = [](const RunReport& run) { return run.summary.section("fidelity") != nullptr; };
  return std::all_of(runs.begin(), runs.end(), has);
}

LeagueRuns league_runs(const BatchPlan& plan, const BatchReport& report, const std::vector<std::string>& metrics) {
  LeagueRuns league;
  league.scenarios = plan.names;
  league.algorithms = plan.definition.algorithms;
  const std::span<const std::string_view> usual =
      have_reference(report.runs) ? std::span<const std::string_view>(kFidelityMetrics) : kDefaultMetrics;
  league.metrics = metrics.empty() ? std::vector<std::string>(usual.begin(), usual.end()) : metrics;
  const MetricList known = metrics_without_values();
  for (const std::string& name : league.metrics) {
    const auto metric = std::find_if(known.begin(), known.end(), [&](const Metric& m) { return m.name == name; });
    league.better.push_back(metric == known.end() ? Better::none : metric->better);
  }
  league.seeds = plan.definition.seeds;
  for (std::size_t i = 0; i < plan.size(); ++i) {
    const RunSummary& summary = report.runs[i].summary;
    const MetricList list = metric_list(summary);
    LeagueRun run;
    run.outcome = outcome_name(summary.result.outcome);
    const Scenario& scenario = scenario_of(plan, i).scenario;
    // No law keeps a tool out that a script leads in: its force along the way is comparable all the same.
    const bool is_led = summary.result.outcome == Outcome::went_through &&
                        !std::holds_alternative<FreePosition>(scenario.motion.position);
    run.failed = !is_led && (is_failure(run.outcome) || !outcome_is_expected(scenario.expect, summary.result.outcome));
    run.state_hash = summary.metrics.state_hash;
    for (const std::string& name : league.metrics) {
      const Metric* metric = find_metric(list, name);
      run.metrics.push_back(metric == nullptr ? std::nullopt : number_of(metric->value));
      run.tolerances.push_back(metric == nullptr ? std::nullopt : metric->tolerance());
    }
    league.runs.push_back(std::move(run));
  }
  return league;
}

namespace {

/// A line of league.csv: places of scenario, algorithm and metric.
struct StandingRow {
  const League& league;
  std::size_t scenario, algorithm, metric;

  const Standing& standing() const { return league.at(scenario, algorithm, metric); }
};

std::vector<StandingRow> standing_rows(const League& league) {
  std::vector<StandingRow> rows;
  for (std::size_t s = 0; s < league.runs.scenarios.size(); ++s) {
    for (std::size_t a = 0; a < league.runs.algorithms.size(); ++a) {
      for (std::size_t m = 0; m < league.runs.metrics.size(); ++m) rows.push_back({league, s, a, m});
    }
  }
  return rows;
}

const Field<StandingRow> kStandingFields[] = {
    {{"scenario", "", "name of the scenario"},
     [](const StandingRow& r) -> Cell { return r.league.runs.scenarios[r.scenario]; }},
    {{"algorithm", "", "force algorithm"},
     [](const StandingRow& r) -> Cell { return r.league.runs.algorithms[r.algorithm]; }},
    {{"metric", "", "name of the metric; its unit is part of the name"},
     [](const StandingRow& r) -> Cell { return r.league.runs.metrics[r.metric]; }},
    {{"seeds", "1", "seeds of the algorithm in the scenario"},
     [](const StandingRow& r) -> Cell { return r.league.runs.seeds; }},
    {{"failed", "1", "seeds that failed"},
     [](const StandingRow& r) -> Cell { return r.league.failures(r.scenario, r.algorithm); }},
    {{"outcome", "", "how the runs ended; of several ways with their numbers"},
     [](const StandingRow& r) -> Cell { return r.league.outcomes(r.scenario, r.algorithm); }},
    {{"mean", "by name", "mean of the metric over the common seeds; empty when there is none"},
     [](const StandingRow& r) { return cell_if(r.standing().mean); }},
    {{"spread", "by name",
      "standard deviation over these seeds; empty when there is one, or when seeds change nothing"},
     [](const StandingRow& r) { return cell_if(r.standing().spread); }},
    {{"rank", "1",
      "1 + the number of algorithms that did better in this scenario by this metric; those with failures are last"},
     [](const StandingRow& r) { return cell_if(r.standing().rank); }},
    {{"common_seeds", "1",
      "seeds that mean and spread are over: those in which no algorithm failed that has any success in the scenario; if "
      "there are none, all seeds of the algorithms that never failed"},
     [](const StandingRow& r) -> Cell { return std::uint64_t{r.league.common[r.scenario].size()}; }},
    {{"better", "", "less or more, whichever is better of the metric; empty when neither is, and nothing is ranked"},
     [](const StandingRow& r) {
       const Better better = r.league.runs.better[r.metric];
       return better == Better::none ? Cell() : Cell(better == Better::less ? "less" : "more");
     }}};

std::vector<std::string> names_of(const std::vector<std::size_t>& places, const std::vector<std::string>& names) {
  std::vector<std::string> chosen;
  for (const std::size_t place : places) chosen.push_back(names[place]);
  return chosen;
}

}  // namespace

std::vector<Column> league_columns() {
  return columns_of(kStandingFields);
}

void write_league(const std::filesystem::path& file, const League& league) {
  write_csv(file, kStandingFields, standing_rows(league));
}

Json league_json(const League& league) {
  const LeagueRuns& runs = league.runs;
  const auto or_null = [](const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); };
  Json rows = Json::array(), laws = Json::array();
  for (const StandingRow& row : standing_rows(league)) add_row(rows.emplace_back(), kStandingFields, row);
  for (const LawStanding& law : league.laws) {
    laws.push_back({{"algorithm", runs.algorithms[law.algorithm]},
                    {"mean_rank", or_null(law.mean_rank)},
                    {"fails", names_of(law.fails, runs.scenarios)}});
  }
  return {{"standings", std::move(rows)}, {"laws", std::move(laws)}};
}

}  // namespace hapbench
