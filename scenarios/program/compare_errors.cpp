#include "scenarios/program/compare_errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

#include "scenarios/batch/league.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/studies/convergence/convergence.hpp"

namespace hapbench {
namespace {

/// The numbers of a metric, by algorithm, in JSON.
struct ComparedNumber {
  std::string algorithm;
  NumberWithError number;
  KnownError known;
};

Columns<ComparedNumber> number_columns() {
  Columns<ComparedNumber> columns;
  columns.add("algorithm", "", "force algorithm", &ComparedNumber::algorithm);
  const auto add = [&columns](const char* name, const char* meaning, auto get) {
    columns.add(name, "by metric", meaning, get);
  };
  add("value", "mean over the seeds; null where one failed", [](const ComparedNumber& n) { return n.number.value; });
  add("error_estimate", "by how much it may be wrong in all", [](const ComparedNumber& n) { return n.number.error; });
  add("error_of_step", "by the time step", [](const ComparedNumber& n) { return n.known.step; });
  add("error_of_spacing", "by the distance of the shell's points",
      [](const ComparedNumber& n) { return n.known.spacing; });
  return columns;
}

/// A table of the numbers of a scenario with their errors, and a sentence on each metric.
class ScenarioErrors {
 public:
  ScenarioErrors(const League& league, const FinerRuns& finer, std::size_t scenario)
      : league_(league), finer_(finer), scenario_(scenario) {
    for (std::size_t m = 0; m < league.metrics.size(); ++m) {
      known_.emplace_back();
      numbers_.emplace_back();
      for (std::size_t a = 0; a < league.algorithms.size(); ++a) {
        const KnownError known = known_error(a, m);
        const bool failed = league.failures(scenario, a) > 0;
        known_.back().push_back(known);
        numbers_.back().push_back({failed ? std::nullopt : league.at(scenario, a, m).mean, known.sum()});
      }
    }
  }

  std::string text() const {
    Columns<std::size_t> columns;  // a row is the place of an algorithm
    columns.print("algorithm", "", "", [this](std::size_t a) { return league_.algorithms[a]; });
    std::string sentences;
    for (std::size_t m = 0; m < league_.metrics.size(); ++m) {
      const std::string& metric = league_.metrics[m];
      const auto* heading = std::ranges::find(kRunHeadings, metric, &RunHeading::metric);
      const bool known = heading != std::end(kRunHeadings);
      const double factor = known ? heading->factor : 1.0;
      columns.print(known ? heading->title : metric, "by name", "", [this, m, factor](std::size_t a) {
        const auto& [value, error] = numbers_[m][a];
        const auto scaled = error ? std::optional(factor * *error) : std::nullopt;
        return value ? with_error_text(factor * *value, scaled) : "-";
      });
      sentences += wrapped(fmt::format("{}: {}", metric, held_text(numbers_[m], league_.algorithms, kSameRank)), 0);
    }
    std::vector<std::size_t> places(league_.algorithms.size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    return fmt::format("\nhow sure: {}\n\n{}\n{}\n{}", league_.scenarios[scenario_],
                       columns.table(places).text(prose_width()), sentences,
                       wrapped(fmt::format("+-: {}", finer_.refined(scenario_)), 0));
  }

  void add_json(Json& rows) const {
    const Columns<ComparedNumber> columns = number_columns();
    for (std::size_t m = 0; m < league_.metrics.size(); ++m) {
      const std::vector<NumberWithError>& found = numbers_[m];
      Json numbers = Json::array();
      for (std::size_t a = 0; a < found.size(); ++a)
        numbers.push_back(columns.json({league_.algorithms[a], found[a], known_[m][a]}));
      Json order = Json::array();
      for (const auto& group : held_order(found, kSameRank).groups) {
        Json names = Json::array();
        for (const std::size_t a : group) names.push_back(league_.algorithms[a]);
        order.push_back(std::move(names));
      }
      rows.push_back({{"scenario", league_.scenarios[scenario_]},
                      {"metric", league_.metrics[m]},
                      {"order", std::move(order)},
                      {"numbers", std::move(numbers)},
                      {"says", held_text(found, league_.algorithms, kSameRank)}});
    }
  }

 private:
  /// The mean of the errors over the common seeds, which bounds the error of their mean.
  KnownError known_error(std::size_t algorithm, std::size_t metric) const {
    const std::vector<std::size_t>& seeds = league_.common[scenario_];
    KnownError mean{.step = 0.0, .spacing = 0.0};
    const auto add = [&seeds](std::optional<double>& sum, const std::optional<double>& error) {
      sum = sum && error ? std::optional(*sum + *error / static_cast<double>(seeds.size())) : std::nullopt;
    };
    for (const std::size_t seed : seeds) {
      const std::size_t run = (scenario_ * league_.algorithms.size() + algorithm) * league_.seeds + seed;
      const KnownError known = finer_.known_error(run, league_.metrics[metric]);
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

ComparedErrors errors_of(const Comparison& comparison, std::span<const Result> reports,
                         const std::vector<std::string>& metrics, const JobOptions& jobs) {
  const League league = league_of(comparison, reports, metrics);
  const auto finer = std::make_shared<const FinerRuns>(comparison, reports, jobs);
  ComparedErrors errors;
  errors.of_run = [finer](std::size_t run, const std::string& metric) { return finer->known_error(run, metric).sum(); };
  for (std::size_t s = 0; s < comparison.scenes.size(); ++s) {
    const ScenarioErrors scenario(league, *finer, s);
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
