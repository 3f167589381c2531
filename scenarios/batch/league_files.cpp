#include "scenarios/batch/league.hpp"

#include <nlohmann/json.hpp>

#include "results/io/csv_writer.hpp"

namespace hapbench {
namespace {

template <class Visit>
void for_each_standing(const League& league, Visit visit) {
  for (std::size_t s = 0; s < league.runs.scenarios.size(); ++s) {
    for (std::size_t a = 0; a < league.runs.algorithms.size(); ++a) {
      for (std::size_t m = 0; m < league.runs.metrics.size(); ++m) visit(s, a, m);
    }
  }
}

template <class Value>
Json or_null(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

std::vector<std::string> names_of(const std::vector<std::size_t>& places, const std::vector<std::string>& names) {
  std::vector<std::string> chosen;
  for (const std::size_t place : places) chosen.push_back(names[place]);
  return chosen;
}

}  // namespace

void write_league(const std::filesystem::path& file, const League& league) {
  const LeagueRuns& runs = league.runs;
  CsvWriter csv(file, "scenario,algorithm,metric,seeds,failed,outcome,mean,spread,rank,ratio_to_best,beyond_spread");
  for_each_standing(league, [&](std::size_t s, std::size_t a, std::size_t m) {
    const Standing& standing = league.at(s, a, m);
    const std::string outcomes = league.outcomes(s, a);
    const auto rank = standing.rank ? std::optional(static_cast<double>(*standing.rank)) : std::nullopt;
    csv.row(std::string_view(runs.scenarios[s]), std::string_view(runs.algorithms[a]),
            std::string_view(runs.metrics[m]), static_cast<std::uint64_t>(runs.seeds),
            static_cast<std::uint64_t>(league.failures(s, a)), std::string_view(outcomes), standing.mean,
            standing.spread, rank, standing.ratio_to_best,
            std::string_view(!standing.beyond_spread   ? ""
                             : *standing.beyond_spread ? "true"
                                                       : "false"));
  });
  csv.finish();
}

Json league_json(const League& league) {
  const LeagueRuns& runs = league.runs;
  Json rows = Json::array(), laws = Json::array();
  for_each_standing(league, [&](std::size_t s, std::size_t a, std::size_t m) {
    const Standing& standing = league.at(s, a, m);
    rows.push_back({{"scenario", runs.scenarios[s]},
                    {"algorithm", runs.algorithms[a]},
                    {"metric", runs.metrics[m]},
                    {"seeds", runs.seeds},
                    {"failed", league.failures(s, a)},
                    {"outcome", league.outcomes(s, a)},
                    {"mean", or_null(standing.mean)},
                    {"spread", or_null(standing.spread)},
                    {"rank", or_null(standing.rank)},
                    {"ratio_to_best", or_null(standing.ratio_to_best)},
                    {"beyond_spread", or_null(standing.beyond_spread)}});
  });
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
