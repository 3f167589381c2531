#include "scenarios/program/compare_errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "scenarios/batch/league.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/studies/convergence/known_error.hpp"

namespace hapbench {
namespace {

/// A table of the numbers of a scenario with their errors, and a sentence on each metric.
class ScenarioErrors {
 public:
  ScenarioErrors(const League& league, const FinerRuns& finer, std::size_t scenario)
      : league_(league), finer_(finer), scenario_(scenario) {
    for (std::size_t m = 0; m < league.runs.metrics.size(); ++m) {
      known_.emplace_back();
      numbers_.emplace_back();
      for (std::size_t a = 0; a < league.runs.algorithms.size(); ++a) {
        const KnownError known = known_error(a, m);
        const bool failed = league.failures(scenario, a) > 0;
        known_.back().push_back(known);
        numbers_.back().push_back({failed ? std::nullopt : league.at(scenario, a, m).mean, known.sum()});
      }
    }
  }

  std::string text() const {
    std::vector<Table::Column> columns = {{"algorithm", false}};
    std::vector<double> factors;
    std::string sentences;
    for (std::size_t m = 0; m < league_.runs.metrics.size(); ++m) {
      const std::string& metric = league_.runs.metrics[m];
      const auto* heading =
          std::ranges::find_if(kRunHeadings, [&](const RunHeading& h) { return h.shows[0] == metric; });
      const bool known = heading != std::end(kRunHeadings) && heading->factor != 0.0;
      columns.push_back({known ? heading->title : metric});
      factors.push_back(known ? heading->factor : 1.0);
      sentences +=
          wrapped(fmt::format("{}: {}", metric, held_text(numbers_[m], league_.runs.algorithms, kSameRank)), 0);
    }
    Table table(columns);
    for (std::size_t a = 0; a < league_.runs.algorithms.size(); ++a) {
      std::vector<std::string> cells = {league_.runs.algorithms[a]};
      for (std::size_t m = 0; m < factors.size(); ++m) {
        const auto& [value, error] = numbers_[m][a];
        const auto scaled = error ? std::optional(factors[m] * *error) : std::nullopt;
        cells.push_back(value ? with_error_text(factors[m] * *value, scaled) : "-");
      }
      table.add(std::move(cells));
    }
    return fmt::format("\nhow sure: {}\n\n{}\n{}\n{}", league_.runs.scenarios[scenario_], table.text(prose_width()),
                       sentences, wrapped(fmt::format("+-: {}", finer_.refined(scenario_)), 0));
  }

  void add_json(Json& rows) const {
    for (std::size_t m = 0; m < league_.runs.metrics.size(); ++m) {
      const std::vector<NumberWithError>& found = numbers_[m];
      Json numbers = Json::array();
      for (std::size_t a = 0; a < found.size(); ++a) {
        const KnownError& known = known_[m][a];
        numbers.push_back({{"algorithm", league_.runs.algorithms[a]},
                           {"value", or_null(found[a].value)},
                           {"error_estimate", or_null(found[a].error)},
                           {"error_of_step", or_null(known.step)},
                           {"error_of_spacing", or_null(known.spacing)}});
      }
      Json order = Json::array();
      for (const auto& group : held_order(found, kSameRank).groups) {
        Json names = Json::array();
        for (const std::size_t a : group) names.push_back(league_.runs.algorithms[a]);
        order.push_back(std::move(names));
      }
      rows.push_back({{"scenario", league_.runs.scenarios[scenario_]},
                      {"metric", league_.runs.metrics[m]},
                      {"order", std::move(order)},
                      {"numbers", std::move(numbers)},
                      {"says", held_text(found, league_.runs.algorithms, kSameRank)}});
    }
  }

 private:
  /// The mean of the errors over the common seeds, which bounds the error of their mean.
  KnownError known_error(std::size_t algorithm, std::size_t metric) const {
    const LeagueRuns& runs = league_.runs;
    const std::vector<std::size_t>& seeds = league_.common[scenario_];
    KnownError mean{.step = 0.0, .spacing = 0.0};
    const auto add = [&seeds](std::optional<double>& sum, const std::optional<double>& error) {
      sum = sum && error ? std::optional(*sum + *error / static_cast<double>(seeds.size())) : std::nullopt;
    };
    for (const std::size_t seed : seeds) {
      const std::size_t run = (scenario_ * runs.algorithms.size() + algorithm) * runs.seeds + seed;
      const KnownError known = finer_.known_error(run, runs.metrics[metric]);
      add(mean.step, known.step);
      add(mean.spacing, known.spacing);
      mean.has_points = known.has_points;
      mean.tolerance += known.tolerance / static_cast<double>(seeds.size());
    }
    return mean;
  }

  const League& league_;
  const FinerRuns& finer_;
  std::size_t scenario_;
  std::vector<std::vector<KnownError>> known_;         ///< by metric and algorithm
  std::vector<std::vector<NumberWithError>> numbers_;  ///< likewise: the means that are compared
};

}  // namespace

ComparedErrors errors_of(const BatchPlan& plan, const BatchReport& report, const std::vector<std::string>& metrics,
                         const BatchOptions& options) {
  const League league = make_league(league_runs(plan, report, metrics));
  const FinerRuns finer(plan, report, options);
  ComparedErrors errors;
  for (std::size_t s = 0; s < plan.scenarios.size(); ++s) {
    const ScenarioErrors scenario(league, finer, s);
    errors.text += scenario.text();
    scenario.add_json(errors.json);
  }
  errors.text +=
      "\n" +
      wrapped(
          "+-: how far half and a quarter of the step and of the distance of the points move a number, and what the metric "
          "itself may be wrong by. <: less by more than both errors, every law to the left than every one to the right; ~: "
          "not so. -: a run failed. ?: a finer run ends otherwise or has no such number.",
          0);
  return errors;
}

}  // namespace hapbench
