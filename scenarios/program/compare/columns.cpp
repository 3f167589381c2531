#include "scenarios/program/compare/columns.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "results/summary/summary.hpp"
#include "scenarios/batch/number_with_error.hpp"
#include "scenarios/batch/ranking.hpp"
#include "scenarios/batch/sweep_columns.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/compare/times.hpp"
#include "scenarios/program/digits.hpp"
#include "scenarios/scene/metric_sections.hpp"

namespace hapbench {
namespace {

/// Metrics of comparison.csv. Programs may read these columns by position: append new metrics at the end.
constexpr std::string_view kComparedMetrics =
    "force_max_N velocity_total_variation_m_per_s force_reversals vibration_power_above_30Hz_m2_per_s2 depth_max_m "
    "ratio_min ratio_max steps_in_contact contact_share landings landing_force_max_N landing_force_step_max_N "
    "settled_s force_mean_in_contact_N settled_force_max_N force_step_p99_N settled_force_step_max_N "
    "force_rms_above_30Hz_N force_reversals_per_s reduction_changes reduction_force_step_max_N inside_max_m "
    "inside_settled_m centre_inside_share vibration_last_quarter_m_per_s fidelity.force_error_relative "
    "fidelity.force_direction_error_rad fidelity.force_artefact_share";

/// Returns the error of the mean. If the entry has no spread over seeds, the error is the tolerance of the entry.
/// Otherwise it is the largest of three values: the tolerance of the entry, the standard error over seeds, and a tenth
/// of the difference up to which two means share a rank.
std::optional<double> error_of_mean(const RankingEntry& entry) {
  if (!entry.spread) return entry.tolerance;
  const double of_seeds = *entry.spread / std::sqrt(static_cast<double>(entry.common_seeds));
  return std::max(
      {entry.tolerance, std::optional(of_seeds), std::optional(0.1 * kRankResolution * std::abs(*entry.mean))});
}

/// Returns the spread of the entry as text. A spread below the tolerance of the metric is not resolved: the text then
/// has the tolerance as its bound.
std::string spread_text(const RankingEntry& entry) {
  if (!entry.spread) return "-";
  if (entry.tolerance && *entry.spread < *entry.tolerance) return bound_text(0.0, *entry.tolerance);
  return significant(*entry.spread, 2);
}

}  // namespace

Columns<ComparedRun> comparison_columns(bool seeds) {
  using Row = ComparedRun;
  Columns<Row> columns = {
      {"seed", "1", "index of the repetition, from 0; repetition k runs with the scenario's seed + k", &Row::seed,
       when(seeds)},
      {"algorithm", "", "force algorithm", [](const Row& r) { return r.run.algorithm; }},
      {"outcome", "", "outcome of the run, such as completes or diverges (hapbench describe outcome)",
       [](const Row& r) { return outcome_name(r.run.end.outcome); }},
      {"steps", "1", "number of time steps of the run", [](const Row& r) { return r.run.end.rows; }}};
  for (const std::string_view name : words_of(kComparedMetrics)) {
    const Metric& metric = *find_metric(all_metrics(), name);
    columns.add(
        {{metric.name, metric.unit, metric.meaning, [name](const Row& r) { return value_of(r.run.metrics, name); }}});
  }
  columns.add({{"ended_at_s", "s", kEndedAtMeaning, [](const Row& r) { return cell_of(r.run.end.ended_at); }}});
  return columns;
}

Columns<RankingEntry> ranking_columns(bool seeds) {
  using Row = RankingEntry;
  const auto better = [](const Row& r) {
    return r.better == Better::none ? Cell() : Cell(r.better == Better::less ? "less" : "more");
  };
  return {
      {"scenario", "", "name of the scenario", &Row::scenario, under("scenario")},
      {"algorithm", "", "force algorithm", &Row::algorithm, under("algorithm")},
      {"metric", "", "name of the metric; its unit is part of the name", &Row::metric, under("metric")},
      {"seeds", "1", "number of seeds with which the algorithm ran the scenario", &Row::seeds},
      {"failed", "1", "number of seeds whose run failed (hapbench describe \"failed run\")", &Row::failed},
      {"outcome", "", "outcomes of the runs; if they differ, each outcome with its number of runs", &Row::outcome,
       under("outcome")},
      {"mean", "unit of the metric",
       "mean of the metric over the common seeds (column common_seeds); empty if no run has a value", &Row::mean,
       under("mean"), error_of_mean},
      {"spread", "unit of the metric",
       "standard deviation of the metric over the common seeds; empty with a single seed, or if the seed changes "
       "nothing in the scenario",
       &Row::spread, under("")},
      {seeds ? "spread" : "", "", "", spread_text, only_printed()},
      {"rank", "1",
       "rank of the algorithm in this scenario by this metric: 1 + the number of algorithms that are better by more "
       "than 0.1 % and by more than the sum of both errors; algorithms with failed runs come last, ordered by the "
       "number of failed runs; empty if the metric has no better direction, if the error of the mean is not smaller "
       "than the mean, or if all algorithms would have the same rank",
       &Row::rank, under("rank")},
      {"common_seeds", "1",
       "number of seeds over which mean and spread are taken: seeds in which no algorithm failed, not counting "
       "algorithms that failed in every seed; if there is no such seed, the seeds in which this algorithm did not fail",
       &Row::common_seeds},
      {"better", "",
       "less if smaller values of the metric are better, more if larger values are better; empty if neither is better; "
       "the metric then has no ranks",
       better}};
}

Columns<LawRankingEntry> law_ranking_columns() {
  const auto fails = [](const LawRankingEntry& l) {
    return l.fails.empty() ? "-" : fmt::format("{}", fmt::join(l.fails, ", "));
  };
  return {
      {"algorithm", "", "", &LawRankingEntry::algorithm, under("algorithm")},
      {"mean_rank", "1",
       "mean of the algorithm's ranks over all metrics and scenarios, including the ranks after failed runs; 1 is best",
       &LawRankingEntry::mean_rank, under("mean rank", 3)},
      {"fails in", "", "scenarios in which a run of the algorithm failed", fails, only_printed()}};
}

std::vector<DescribedTable> ranking_tables() {
  return {comparison_columns(false).described("comparison.csv", "written by compare: one line per algorithm"),
          ranking_columns(true).described(
              "ranking.csv",
              "written by compare for several scenarios or seeds: one line per scenario, algorithm and metric"),
          law_ranking_columns().described(), times_table()};
}

}  // namespace hapbench
