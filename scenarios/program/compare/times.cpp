#include "scenarios/program/compare/times.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "scenarios/batch/run_cost.hpp"
#include "scenarios/program/digits.hpp"

namespace hapbench {
namespace {

constexpr const char* kTimesFile = "comparison_timing.csv";

/// Cost of a law in a scene. It is measured with the first seed.
struct LawTime {
  std::string scenario, algorithm;
  RunCost cost;
  std::optional<double> contacts;  ///< mean number of contacts in a step; empty if the run has no such metric
  std::uint64_t rank = 1;          ///< 1 + number of laws that are faster by more than the sum of both spreads
};

Columns<LawTime> time_columns(bool several_scenes) {
  using Row = LawTime;
  const auto step = [](const Row& r) { return r.cost.step_s; };
  const auto spread = [](const Row& r) { return r.cost.spread_s; };
  const auto simulated = [](const Row& r) { return r.cost.per_simulated_second(); };
  const auto share = [](const Row& r) { return r.cost.deadline_share(); };
  const auto steps = [](const Row& r) { return r.cost.steps; };
  const auto microseconds = [](const Row& r) { return significant(1e6 * r.cost.step_s, 3); };
  const auto spread_us = [](const Row& r) { return significant(1e6 * r.cost.spread_s, 1); };
  const auto milliseconds = [](const Row& r) { return significant(1e3 * r.cost.per_simulated_second(), 3); };
  const auto percent = [](const Row& r) { return significant(100.0 * r.cost.deadline_share(), 2); };
  return {
      {"scenario", "", "name of the scenario", &Row::scenario, several_scenes ? under("scenario") : Shown{}},
      {"algorithm", "", "force law", &Row::algorithm, under("algorithm")},
      {"seconds_per_step", "s", "processor time of a step in a run without observers: smallest of five repetitions",
       step},
      {"us per step", "1", "seconds_per_step in microseconds", microseconds, only_printed()},
      {"spread_s", "s", "median of the repetitions minus the smallest repetition, of one step", spread},
      {"spread us", "1", "spread_s in microseconds", spread_us, only_printed()},
      {"seconds_per_simulated_second", "s/s", "processor time per simulated second", simulated},
      {"ms per s", "1", "processor time per simulated second [ms]", milliseconds, only_printed()},
      {"contacts_per_step", "1", "mean number of contacts over all steps of the run", &Row::contacts,
       under("contacts per\nstep", 3)},
      {"deadline_share", "1", "processor time of a step divided by 0.5 ms", share},
      {"% of 0.5 ms", "1", "deadline_share as a percentage", percent, only_printed()},
      {"steps", "1",
       "steps of the measured run; fewer than the steps of the scenario if the run diverges or its task ends", steps},
      {"rank", "1", "1 + the number of laws that are faster by more than the sum of both spreads", &Row::rank,
       under("rank")}};
}

std::optional<double> mean_contacts(const Result& result) {
  const Metric* metric = find_metric(result.metrics, "colliding_mean");
  return metric == nullptr ? std::nullopt : number_of(metric->value);
}

}  // namespace

void report_times(const Comparison& comparison, const std::vector<Result>& reports, const JobOptions& jobs,
                  const Layout& layout, Report& report) {
  const std::size_t laws = comparison.algorithms.size(), scenes = comparison.scenes.size();
  const auto run = [&comparison](std::size_t i) { return i * comparison.seeds; };
  const std::vector<RunCost> costs = measure_cost(
      scenes * laws, [&](std::size_t i) { return checked(comparison.load(run(i))); }, jobs);
  std::vector<LawTime> rows;
  for (std::size_t i = 0; i < costs.size(); ++i) {
    LawTime& row = rows.emplace_back(
        LawTime{comparison.names[i / laws], comparison.algorithms[i % laws], costs[i], mean_contacts(reports[run(i)])});
    for (std::size_t a = 0; a < laws; ++a)
      if (is_faster(costs[i / laws * laws + a], costs[i])) ++row.rank;
  }
  for (std::size_t s = 0; s < scenes; ++s) {
    const auto first = rows.begin() + static_cast<std::ptrdiff_t>(s * laws);
    std::stable_sort(first, first + static_cast<std::ptrdiff_t>(laws),
                     [](const LawTime& a, const LawTime& b) { return a.cost.step_s < b.cost.step_s; });
  }
  const Columns<LawTime> columns = time_columns(scenes > 1);
  report.write(kTimesFile, columns, rows);
  report.add_text("\n");
  report.show(columns.table(rows, "processor time of the laws", layout.in_full()));
  bool has_trials = false;
  for (const Cases& scene : comparison.scenes) has_trials |= trial_count(scene.load(0).scenario.hand) > 1.0;
  report.add_text(layout.wrapped(
      fmt::format("processor time in runs{} without observers and files, one run at a time: smallest of five "
                  "repetitions; equal ranks mean that the difference is within the spreads",
                  has_trials ? " (of an experiment: in its first trial)" : ""),
      0));
  if (report.json().is_array()) report.json() = {{"runs", std::move(report.json())}};
  report.json()["times"] = columns.json_list(rows);
}

DescribedTable times_table() {
  return time_columns(true).described(kTimesFile,
                                      "written by compare --time: one line per scenario and algorithm, fastest first");
}

}  // namespace hapbench
