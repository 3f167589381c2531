#include "scenarios/program/compare/law_metric_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>

#include "scenarios/program/digits.hpp"
#include "scenarios/program/run_table.hpp"

namespace hapbench {
namespace {

/// Returns the heading of a metric in the table of runs. If this table lacks the metric, the heading is the name of the
/// metric, and the metric's values are printed in the metric's unit (factor 1).
RunHeading heading_of(const std::string& metric) {
  const auto* known = std::ranges::find(kRunHeadings, metric, &RunHeading::metric);
  return known == std::end(kRunHeadings) ? RunHeading{metric.c_str(), metric.c_str()} : *known;
}

std::string metric_text(const RankingEntry& entry, double factor) {
  if (!entry.mean) return "-";
  const auto scaled = [factor](const std::optional<double>& number) {
    return number ? std::optional(factor * *number) : std::nullopt;
  };
  // If the spread over the seeds is smaller than the resolution of the ranks, print the mean without the spread. The
  // error that determines the digits of the mean is then at least this resolution.
  const double resolution = kRankResolution * std::abs(*entry.mean);
  if (entry.spread && *entry.spread < resolution)
    return deserved(factor * *entry.mean, factor * std::max(entry.tolerance.value_or(0.0), resolution));
  return with_spread(factor * *entry.mean, scaled(entry.spread), scaled(entry.tolerance));
}

/// Returns the caption of the table, with the seeds over which the means are computed.
std::string caption_of(const Ranking& ranking) {
  if (ranking.seeds < 2) return "mean of each metric";
  std::string caption = fmt::format(
      "mean and spread of each metric over {} seeds; no spread: it is less than 0.1 % of the mean, "
      "or than the error of the metric",
      ranking.seeds);
  for (std::size_t s = 0; s < ranking.scenarios.size(); ++s)
    if (const std::string seeds = seeds_of_means_text(ranking, s); !seeds.empty())
      caption += fmt::format("; in {} {}", ranking.scenarios[s], seeds);
  return caption;
}

}  // namespace

std::string seeds_of_means_text(const Ranking& ranking, std::size_t scenario) {
  const std::size_t common = ranking.common[scenario].size();
  if (common < ranking.seeds)
    return fmt::format("over the {} of {} seeds in which no algorithm failed", common, ranking.seeds);
  if (ranking.lacks_common_seeds(scenario))
    return "over the seeds in which the algorithm itself did not fail, because in every seed an algorithm failed";
  return "";
}

Table law_metric_table(const Ranking& ranking) {
  const bool has_failures = std::ranges::count(ranking.failed, true) > 0;
  const bool several = ranking.scenarios.size() > 1;
  Table table{.caption = caption_of(ranking)};
  if (several) table.columns.push_back({"scenario", false});
  table.columns.push_back({"algorithm", false});
  if (has_failures) table.columns.push_back({"failed\nruns"});
  for (const std::string& metric : ranking.metrics)
    table.columns.push_back({.title = heading_of(metric).title, .unit = metric_unit(metric)});
  table.columns.push_back({"mean\nrank"});
  for (std::size_t s = 0; s < ranking.scenarios.size(); ++s) {
    for (const LawRankingEntry& law : ranking.laws) {
      const auto found = std::ranges::find(ranking.algorithms, law.algorithm);
      const auto a = static_cast<std::size_t>(found - ranking.algorithms.begin());
      auto& row = table.rows.emplace_back();
      if (several) row.push_back(ranking.scenarios[s]);
      row.push_back(law.algorithm);
      if (has_failures) row.push_back(std::to_string(ranking.failures(s, a)));
      for (std::size_t m = 0; m < ranking.metrics.size(); ++m)
        row.push_back(metric_text(ranking.at(s, a, m), heading_of(ranking.metrics[m]).factor));
      row.push_back(law.mean_rank ? significant(*law.mean_rank, 3) : "-");
    }
  }
  return table;
}

}  // namespace hapbench
