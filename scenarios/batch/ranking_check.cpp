#include "scenarios/batch/ranking_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "results/io/table_writer.hpp"
#include "scenarios/batch/finer_scene.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/run/assemble.hpp"

namespace hapbench {
namespace {

constexpr HoldingInfo kHoldings[] = {
    {"holds", "sampled twice as finely, no two laws change their order and no number moves by more than 10 %"},
    {"drifts",
     "sampled twice as finely, a number moves by more than 10 %; no two laws that are clearly apart change "
     "their order"},
    {"flips",
     "sampled twice as finely, two laws that are more than 10 % apart both times change their order; one that "
     "fails counts as the worst"},
    {"unchecked", "the scene has no such sampling, or too many points at half of it"}};

constexpr double kWorst = std::numeric_limits<double>::infinity();

/// Change relative to the larger number; 0 between equal ones, infinity between a number and none.
double relative_change(double before, double after) {
  if (before == after) return 0.0;
  if (std::isinf(before) || std::isinf(after)) return kWorst;
  return std::abs(after - before) / std::max(std::abs(before), std::abs(after));
}

/// A number of a column and what it may be wrong by.
struct Number {
  double value, tolerance;
};

Number at(const RankedNumbers& column, std::size_t law) {
  return {column.values[law], column.tolerances.empty() ? 0.0 : column.tolerances[law]};
}

/// Tells numbers of a column apart.
struct Apart {
  double floor;  ///< smaller differences do not count

  bool operator()(const Number& a, const Number& b) const {
    return relative_change(a.value, b.value) > kHeld &&
           !(std::abs(a.value - b.value) <= std::max(floor, a.tolerance + b.tolerance));
  }
};

Apart apart_in(std::span<const double> before, std::span<const double> after) {
  double largest = 0.0;
  for (const auto& column : {before, after}) {
    for (const double number : column) {
      if (std::isfinite(number)) largest = std::max(largest, std::abs(number));
    }
  }
  return {kSameRank * largest};
}

}  // namespace

std::span<const HoldingInfo> holding_infos() noexcept {
  return kHoldings;
}

ColumnVerdict judged_column(const RankedNumbers& before, const RankedNumbers& after, bool ranked) {
  const Apart apart = apart_in(before.values, after.values);
  const std::size_t laws = before.values.size();
  ColumnVerdict verdict;
  double furthest = -1.0;
  for (std::size_t a = 0; ranked && a < laws; ++a) {
    for (std::size_t b = a + 1; b < laws; ++b) {
      const bool flips = apart(at(before, a), at(before, b)) && apart(at(after, a), at(after, b)) &&
                         (before.values[a] < before.values[b]) != (after.values[a] < after.values[b]);
      const double far =
          relative_change(before.values[a], before.values[b]) + relative_change(after.values[a], after.values[b]);
      if (!flips || far <= furthest) continue;
      verdict = {Holding::flips, a, b};
      furthest = far;
    }
  }
  if (verdict.holding == Holding::flips) return verdict;
  for (std::size_t a = 0; a < laws; ++a) {
    const bool moves = apart(at(before, a), at(after, a)), is_first = moves && verdict.holding == Holding::holds;
    const double change = relative_change(before.values[a], after.values[a]);
    if (!is_first && (change <= furthest || moves != (verdict.holding == Holding::drifts))) continue;
    verdict = {moves ? Holding::drifts : Holding::holds, a};
    furthest = change;
  }
  return verdict;
}

namespace {

/// The scenario of that number in the plan, sampled more finely, after a look whether it can be.
FinerScene finer_scene(const BatchPlan& plan, std::size_t scenario, Finer finer) {
  const std::size_t each = plan.size() / plan.scenarios.size();
  const LoadedScenario loaded = scenario_of(plan, scenario * each);
  FinerScene scene = finer == Finer::spacing ? with_finer_spacing(loaded, 2) : with_finer_step(loaded.scenario, 2);
  if (scene.overrides.empty()) return scene;
  try {
    std::vector<std::string> overrides = plan.definition.overrides;
    overrides.push_back("rendering.algorithm=" + plan.definition.algorithms[0]);  // on record it has this one
    overrides.insert(overrides.end(), scene.overrides.begin(), scene.overrides.end());
    check_named_files(load_scenario(plan.scenarios[scenario], overrides));
  } catch (const InputError& error) {
    scene = {{}, fmt::format("{}: {}", scene.change, error.problem())};
  }
  return scene;
}

/// The numbers of a column; kWorst for a law that fails or has none, and signs turned where more is better.
std::vector<double> keys_of(const League& league, std::size_t scenario, std::size_t metric) {
  std::vector<double> keys;
  for (std::size_t a = 0; a < league.runs.algorithms.size(); ++a) {
    const auto& mean = league.at(scenario, a, metric).mean;
    const double sign = league.runs.better[metric] == Better::more ? -1.0 : 1.0;
    keys.push_back(mean && league.failures(scenario, a) == 0 ? sign * *mean : kWorst);
  }
  return keys;
}

std::optional<std::size_t> best_of(const std::vector<double>& keys, bool ranked) {
  const auto best = std::min_element(keys.begin(), keys.end());
  if (!ranked || std::isinf(*best)) return std::nullopt;
  return static_cast<std::size_t>(best - keys.begin());
}

std::vector<std::optional<double>> numbers_of(const League& league, std::size_t scenario, std::size_t metric,
                                              std::optional<double> Standing::*part) {
  std::vector<std::optional<double>> numbers;
  for (std::size_t a = 0; a < league.runs.algorithms.size(); ++a) {
    const bool failed = league.failures(scenario, a) > 0;
    numbers.push_back(failed ? std::nullopt : league.at(scenario, a, metric).*part);
  }
  return numbers;
}

/// The tolerances of a column; 0 where none is known.
std::vector<double> or_zero(const std::vector<std::optional<double>>& tolerances) {
  std::vector<double> all;
  for (const auto& tolerance : tolerances) all.push_back(tolerance.value_or(0.0));
  return all;
}

/// The columns of a scenario that has the places `before` and `after` in the two leagues.
void add_columns(const League& coarse, std::size_t before, const League& fine, std::size_t after,
                 const RankingColumn& named, std::vector<RankingColumn>& columns) {
  for (std::size_t m = 0; m < coarse.runs.metrics.size(); ++m) {
    const bool ranked = coarse.runs.better[m] != Better::none;
    const std::vector<double> keys = keys_of(coarse, before, m), keys_after = keys_of(fine, after, m);
    RankingColumn& column = columns.emplace_back(named);
    column.metric = coarse.runs.metrics[m];
    column.before = numbers_of(coarse, before, m, &Standing::mean);
    column.after = numbers_of(fine, after, m, &Standing::mean);
    column.tolerance_before = numbers_of(coarse, before, m, &Standing::tolerance);
    column.tolerance_after = numbers_of(fine, after, m, &Standing::tolerance);
    const std::vector<double> within = or_zero(column.tolerance_before), within_after = or_zero(column.tolerance_after);
    column.verdict = judged_column({keys, within}, {keys_after, within_after}, ranked);
    column.best_before = best_of(keys, ranked);
    column.best_after = best_of(keys_after, ranked);
  }
}

/// The plan of those scenarios that can be sampled more finely. Adds a column for each of the others.
struct FinerPlan {
  BatchPlan plan;
  std::vector<std::size_t> places;  ///< of its scenarios among all
  std::vector<std::string> changes;
};

FinerPlan finer_plan(const BatchPlan& plan, Finer finer, std::vector<RankingColumn>& columns) {
  FinerPlan fine{.plan = plan, .places = {}, .changes = {}};
  fine.plan.scenarios.clear();
  fine.plan.names.clear();
  fine.plan.on_record.clear();
  if (finer == Finer::step) fine.plan.stride = 2;
  for (std::size_t s = 0; s < plan.scenarios.size(); ++s) {
    FinerScene scene = finer_scene(plan, s, finer);
    if (scene.overrides.empty()) {
      columns.push_back({.scenario = plan.names[s], .finer = finer, .change = scene.change, .metric = ""});
      continue;
    }
    fine.plan.scenarios.push_back(plan.scenarios[s]);
    fine.plan.names.push_back(plan.names[s]);
    if (!plan.on_record.empty()) {
      const auto each = static_cast<std::ptrdiff_t>(plan.size() / plan.scenarios.size());
      const auto first = plan.on_record.begin() + static_cast<std::ptrdiff_t>(s) * each;
      fine.plan.on_record.insert(fine.plan.on_record.end(), first, first + each);
    }
    fine.plan.scenario_overrides.push_back(scene.overrides);
    fine.places.push_back(s);
    fine.changes.push_back(scene.change);
  }
  return fine;
}

}  // namespace

std::vector<RankingColumn> compared_columns(const League& before, const League& after) {
  std::vector<RankingColumn> columns;
  add_columns(before, 0, after, 0, {.scenario = before.runs.scenarios[0], .change = "", .metric = ""}, columns);
  return columns;
}

RankingCheck check_ranking(const BatchPlan& plan, const League& league, const BatchOptions& options) {
  RankingCheck check{.algorithms = plan.definition.algorithms, .columns = {}};
  for (const Finer finer : {Finer::spacing, Finer::step}) {
    const FinerPlan fine = finer_plan(plan, finer, check.columns);
    if (fine.places.empty()) continue;
    BatchOptions unwritten = options;
    unwritten.directory.reset();
    const BatchReport report = run_batch(fine.plan, unwritten);
    const League again = make_league(league_runs(fine.plan, report, league.runs.metrics));
    for (std::size_t s = 0; s < fine.places.size(); ++s) {
      const RankingColumn named{
          .scenario = fine.plan.names[s], .finer = finer, .change = fine.changes[s], .metric = ""};
      add_columns(league, fine.places[s], again, s, named, check.columns);
    }
  }
  return check;
}

namespace {

/// A line of ranking.csv: a column and a law in it, none of a column that was not checked.
struct RankingRow {
  const RankingCheck& check;
  const RankingColumn& column;
  std::optional<std::size_t> law;

  Cell name(std::optional<std::size_t> algorithm) const {
    return algorithm ? Cell(check.algorithms[*algorithm]) : Cell();
  }
  Cell number(const std::vector<std::optional<double>>& numbers) const { return law ? cell_if(numbers[*law]) : Cell(); }
};

const Field<RankingRow> kRankingFields[] = {
    {{"scenario", "", "name of the scenario"}, [](const RankingRow& r) -> Cell { return r.column.scenario; }},
    {{"halved", "", "spacing: the distance of the shell's points; step: the time step"},
     [](const RankingRow& r) -> Cell { return r.column.finer == Finer::spacing ? "spacing" : "step"; }},
    {{"change", "", "the field that was halved with its values, or why none was"},
     [](const RankingRow& r) -> Cell { return r.column.change; }},
    {{"metric", "", "name of the metric; its unit is part of the name"},
     [](const RankingRow& r) -> Cell { return r.column.metric; }},
    {{"algorithm", "", "force algorithm"}, [](const RankingRow& r) { return r.name(r.law); }},
    {{"before", "by name", "mean of the metric as compared; empty after a failure"},
     [](const RankingRow& r) { return r.number(r.column.before); }},
    {{"after", "by name", "the same with half the spacing or step, measured at the same times"},
     [](const RankingRow& r) { return r.number(r.column.after); }},
    {{"verdict", "", "holds, drifts, flips or unchecked: of the metric over all algorithms"},
     [](const RankingRow& r) -> Cell { return kHoldings[static_cast<std::size_t>(r.column.verdict.holding)].name; }},
    {{"best_before", "", "the best algorithm as compared; empty where nothing is ranked"},
     [](const RankingRow& r) { return r.name(r.column.best_before); }},
    {{"best_after", "", "the best with half the spacing or step"},
     [](const RankingRow& r) { return r.name(r.column.best_after); }},
    {{"tolerance_before", "by name", "by how much `before` may be wrong; empty where that is not known"},
     [](const RankingRow& r) { return r.number(r.column.tolerance_before); }},
    {{"tolerance_after", "by name", "the same of `after`"},
     [](const RankingRow& r) { return r.number(r.column.tolerance_after); }}};

std::vector<RankingRow> ranking_rows(const RankingCheck& check) {
  std::vector<RankingRow> rows;
  for (const RankingColumn& column : check.columns) {
    if (column.before.empty()) rows.push_back({check, column, std::nullopt});
    for (std::size_t a = 0; a < column.before.size(); ++a) rows.push_back({check, column, a});
  }
  return rows;
}

}  // namespace

std::vector<Column> ranking_columns() {
  return columns_of(kRankingFields);
}

void write_ranking(const std::filesystem::path& file, const RankingCheck& check) {
  write_csv(file, kRankingFields, ranking_rows(check));
}

Json ranking_json(const RankingCheck& check) {
  Json rows = Json::array();
  for (const RankingRow& row : ranking_rows(check)) add_row(rows.emplace_back(), kRankingFields, row);
  return rows;
}

}  // namespace hapbench
