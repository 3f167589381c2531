#include "scenarios/program/compare/errors.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <vector>

#include "scenarios/analysis/convergence/significant_order.hpp"
#include "scenarios/program/run_table.hpp"

namespace hapbench {
namespace {

/// Returns the mean of an algorithm's errors over the common seeds (Ranking::common). This mean bounds the error of the
/// mean value.
KnownError mean_error(const Ranking& ranking, const FinerRuns& finer, std::size_t scenario, std::size_t algorithm,
                      const std::string& metric) {
  const std::vector<std::size_t>& seeds = ranking.common[scenario];
  KnownError mean{.step = 0.0, .spacing = 0.0};
  const auto add = [&seeds](std::optional<double>& sum, const std::optional<double>& error) {
    sum = sum && error ? std::optional(*sum + *error / static_cast<double>(seeds.size())) : std::nullopt;
  };
  for (const std::size_t seed : seeds) {
    const KnownError known = finer.known_error(ranking.first_run(scenario, algorithm) + seed, metric);
    add(mean.step, known.step);
    add(mean.spacing, known.spacing);
    mean.has_points = known.has_points;
    mean.tolerance += known.tolerance / static_cast<double>(seeds.size());
  }
  return mean;
}

/// Returns, for each algorithm, the mean of a metric in a scenario and the error of this mean. The mean is empty for an
/// algorithm with failed runs. Adds the means and the significant order of the algorithms to `json`.
std::vector<NumberWithError> numbers_of(const Ranking& ranking, const FinerRuns& finer, std::size_t scenario,
                                        std::size_t metric, Json& json) {
  std::vector<NumberWithError> numbers;
  Json rows = Json::array(), order = Json::array();
  for (std::size_t a = 0; a < ranking.algorithms.size(); ++a) {
    const RankingEntry& entry = ranking.at(scenario, a, metric);
    const KnownError known = mean_error(ranking, finer, scenario, a, entry.metric);
    const auto& [value, error] =
        numbers.emplace_back(NumberWithError{entry.failed > 0 ? std::nullopt : entry.mean, known.sum()});
    rows.push_back({{"algorithm", entry.algorithm},
                    {"value", cell_json(cell_of(value))},
                    {"error_estimate", cell_json(cell_of(error))},
                    {"error_of_step", cell_json(cell_of(known.step))},
                    {"error_of_spacing", cell_json(cell_of(known.spacing))}});
  }
  for (const auto& group : significant_order(numbers).groups) {
    Json& names = order.emplace_back(Json::array());
    for (const std::size_t a : group) names.push_back(ranking.algorithms[a]);
  }
  json["order"] = std::move(order);
  json["numbers"] = std::move(rows);
  return numbers;
}

}  // namespace

// NOLINTNEXTLINE(readability-function-cognitive-complexity): one pass over the metrics fills table, JSON and sentences.
void report_errors(const Ranking& ranking, const FinerRuns& finer, std::size_t scenario, bool all, Report& report,
                   const Layout& layout) {
  Table table{{{"algorithm", false}}};
  bool has_order = false, has_ties = false, has_unknown = false;  // true if the signs <, ~ and ? are printed
  for (const std::string& algorithm : ranking.algorithms) table.rows.push_back({algorithm});
  std::string sentences;
  // Evaluate each metric. The JSON has all metrics. Unless `all` is true, the printed table has only the
  // metrics of the table of runs.
  for (std::size_t m = 0; m < ranking.metrics.size(); ++m) {
    const std::string& metric = ranking.metrics[m];
    Json& json =
        report.json()["errors"].emplace_back(Json{{"scenario", ranking.scenarios[scenario]}, {"metric", metric}});
    const std::vector<NumberWithError> numbers = numbers_of(ranking, finer, scenario, m, json);
    const std::string says = significant_order_text(numbers, ranking.algorithms);
    json["says"] = says;
    const auto* heading = std::ranges::find(kRunHeadings, metric, &RunHeading::metric);
    const bool known = heading != std::end(kRunHeadings);
    if (!all && (!known || heading->wide)) continue;
    const double factor = known ? heading->factor : 1.0;
    std::string title = known ? heading->title : metric;
    table.columns.push_back({.title = title, .unit = metric_unit(metric)});
    for (std::size_t a = 0; a < numbers.size(); ++a) {
      const auto& [value, error] = numbers[a];
      const auto shown_error = error ? std::optional(factor * *error) : error;
      table.rows[a].push_back(value ? with_error_text(factor * *value, shown_error) : "-");
      has_unknown |= value && !error;
    }
    // Name the metric by its heading in one line.
    std::ranges::replace(title, '\n', ' ');
    sentences += layout.wrapped(fmt::format("{}: {}", title, says), 0);
    has_order |= says.find(" < ") != std::string::npos;
    has_ties |= says.find(" ~ ") != std::string::npos;
  }
  std::string signs = fmt::format("+-: error, estimated from runs with finer values: {}", finer.refined(scenario));
  if (has_order) signs += "\n<: smaller by more than the sum of both errors";
  if (has_ties) signs += "\n~: the difference is within the sum of both errors";
  if (has_unknown) signs += "\n?: unknown, because a finer run has another outcome";
  table.caption = fmt::format("error estimates: {}", ranking.scenarios[scenario]);
  report.add_text(fmt::format("\n{}\n\n", table.caption));
  report.show(std::move(table), layout.prose_width());
  report.add_text(fmt::format("\n{}\n{}", sentences, layout.wrapped(signs, 0)));
}

std::string vibration_text(const Ranking& ranking, const Layout& layout) {
  struct VibrationMetric {
    const char *of, *metric;
    double threshold;  ///< largest vibration that a hand cannot feel [unit of the metric]
  };
  constexpr VibrationMetric kVibrations[] = {{"force", "force_rms_above_30Hz_N", 1e-4},
                                             {"tool", kToolVibrationPower, 1e-10}};
  if (ranking.algorithms.size() < 2) return "";
  std::string says;
  // Algorithms with a failed run have no vibration to compare.
  std::vector<std::string> failing;
  for (std::size_t a = 0; a < ranking.algorithms.size(); ++a)
    if (ranking.failures(0, a) > 0) failing.push_back(ranking.algorithms[a]);
  if (failing.size() == ranking.algorithms.size())
    return "\n" + layout.wrapped("every run failed: there is no vibration to compare", 0);
  // Compare the vibration of the force. If a law without failures has no value of this metric, compare the vibration of
  // the tool.
  for (const auto& [of, metric, threshold] : kVibrations) {
    const auto metric_index =
        static_cast<std::size_t>(std::ranges::find(ranking.metrics, metric) - ranking.metrics.begin());
    std::vector<NumberWithError> numbers;
    std::size_t known = 0;
    for (std::size_t a = 0; a < ranking.algorithms.size(); ++a) {
      const RankingEntry& entry = ranking.at(0, a, metric_index);
      numbers.push_back({entry.failed > 0 ? std::nullopt : entry.mean, entry.tolerance.value_or(0.0) + threshold});
      known += numbers.back().value.has_value();
    }
    says = fmt::format("vibration of the {} in these runs: {}", of, order_text(numbers, ranking.algorithms));
    if (known + failing.size() == ranking.algorithms.size()) break;
  }
  if (!failing.empty()) says += fmt::format("; failed: {}", fmt::join(failing, ", "));
  const bool has_order = failing.size() + 1 < ranking.algorithms.size();
  return "\n" +
         layout.wrapped(
             says + (has_order
                         ? ". The option --errors also prints the error of each number, estimated by runs with smaller "
                           "time steps and point spacings"
                         : ""),
             0);
}

}  // namespace hapbench
