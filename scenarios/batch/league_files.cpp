#include "scenarios/batch/league.hpp"

#include <nlohmann/json.hpp>

#include "results/io/table_writer.hpp"

namespace hapbench {
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
    {{"standard_error", "by name", "of the mean: spread over the root of these seeds"},
     [](const StandingRow& r) { return cell_if(r.standing().standard_error); },
     Field<StandingRow>::In::json},
    {{"mean_tolerance", "by name", "by how much the mean may be wrong, where that is known"},
     [](const StandingRow& r) { return cell_if(r.standing().tolerance); },
     Field<StandingRow>::In::json},
    {{"rank", "1",
      "1 + the number of algorithms that did better in this scenario by this metric; those with failures are last"},
     [](const StandingRow& r) { return cell_if(r.standing().rank); }},
    {{"ratio_to_best", "1", "how many times worse than the best mean; empty after a failure"},
     [](const StandingRow& r) { return cell_if(r.standing().ratio_to_best); }},
    {{"beyond_spread", "",
      "true when the mean differs from the best by more than the spread of the seeds: paired t, 5 %"},
     [](const StandingRow& r) { return cell_if(r.standing().beyond_spread); }},
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
                    {"mean_ratio_to_best", or_null(law.mean_ratio)},
                    {"ratios", law.ratios},
                    {"wins", names_of(law.wins, runs.scenarios)},
                    {"fails", names_of(law.fails, runs.scenarios)}});
  }
  return {{"standings", std::move(rows)}, {"laws", std::move(laws)}};
}

}  // namespace hapbench
