#include "scenarios/program/run_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <string_view>
#include <utility>

#include "results/observe/target_metrics.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/description/metric_sections.hpp"

namespace hapbench {
namespace {

/// A number of few characters: "1440" in place of "1.44e+03", and never "-0".
std::string cell(std::optional<double> value, int digits = 3) {
  if (value && digits < 3) value = std::stod(significant(*value, digits));
  if (value && std::abs(*value) >= 100.0 && std::abs(*value) < 1e6) return fmt::format("{:.0f}", *value);
  return significant(value.value_or(std::numeric_limits<double>::quiet_NaN()) + 0.0, digits);
}

/// The metric of that name with the digits that its tolerance leaves it; `factor`: to the unit that is shown.
std::string metric_cell(const MetricList& metrics, std::string_view name, double factor) {
  const Metric* metric = find_metric(metrics, name);
  const auto value = metric == nullptr ? std::nullopt : number_of(metric->value);
  return value ? cell(factor * *value, deserved_digits(*value, metric->tolerance(), 3)) : "-";
}

/// A time in microseconds of at most four characters, so that tables are as wide on a slow machine as on a fast one:
/// "0.94", "1440", "23ms", "1.2s".
std::string short_time(double seconds) {
  const double us = 1e6 * seconds;
  if (us < 0.995) return fmt::format("{:.2f}", us);
  if (us < 9999.5) return cell(us, 2);
  if (us < 99.5e3) return fmt::format("{:.0f}ms", 1e-3 * us);
  return seconds < 9.95 ? fmt::format("{:.1f}s", seconds) : fmt::format("{:.0f}s", std::min(seconds, 999.0));
}

/// The same time with its unit, for a sentence.
std::string time_text(double seconds) {
  const std::string text = short_time(seconds);
  return text.ends_with('s') ? text : text + " us";
}

/// Runs of one scenario are told apart by their algorithms.
std::string distinct_name(const Result& report, std::span<const Result> reports) {
  const bool one_scenario = reports.front().name == reports.back().name;
  return one_scenario ? report.algorithm : report.name;
}

using ListedRun = std::reference_wrapper<const Result>;

void add_metrics(Columns<ListedRun>& columns, std::span<const RunHeading> headings) {
  for (const RunHeading& heading : headings) {
    columns.print(heading.title, "1", heading.metric, [&heading](const ListedRun& r) {
      return metric_cell(r.get().metrics, heading.metric, heading.factor);
    });
  }
}

Columns<ListedRun> run_columns(bool of_scenes) {
  Columns<ListedRun> columns;
  if (of_scenes) columns.print("scenario", "", "", [](const ListedRun& r) { return r.get().name; });
  columns.print("algorithm", "", "", [](const ListedRun& r) { return r.get().algorithm; });
  columns.print("outcome", "", "outcome", [](const ListedRun& r) { return outcome_name(r.get().end.outcome); });
  add_metrics(columns, kRunHeadings);
  columns.print("ratio", "", "ratio_min", [](const ListedRun& r) {
    const auto least = number_of(r.get().metrics, "ratio_min"), most = number_of(r.get().metrics, "ratio_max");
    return least && most ? fmt::format("{}..{}", cell(least, 2), cell(most, 2)) : "-";
  });
  columns.print("us/\nstep", "1", "step_p50_s", [](const ListedRun& r) {
    const auto& median = r.get().timing.step_p50;
    return median ? short_time(*median) : "-";
  });
  return columns;
}

/// Of runs with a reference force: measured with the stroke, or ideal.
constexpr RunHeading kFidelityHeadings[] = {
    {"error\n%", "fidelity.force_error_relative", 100.0},
    {"normal\nrms N", "fidelity.force_error_normal_rms_N", 1.0},
    {"tangential\nrms N", "fidelity.force_error_tangential_rms_N", 1.0},
    {"direction\ndeg", "fidelity.force_direction_error_rad", 57.295779513082323},
    {"artefacts\n%", "fidelity.force_artefact_share", 100.0},
    {"lag\nms", "fidelity.force_lag_s", 1e3}};

}  // namespace

std::string run_table(std::span<const Result> reports, bool of_scenes) {
  constexpr std::size_t kNarrowGap = 1;  // the names of all algorithms fit into kTableWidth with it
  const std::vector<ListedRun> runs(reports.begin(), reports.end());
  return run_columns(of_scenes).table(runs, kNarrowGap).text();
}

std::string fidelity_text(std::span<const Result> reports) {
  std::vector<ListedRun> with_reference;
  for (const Result& report : reports)
    if (report.has_section("fidelity")) with_reference.emplace_back(report);
  if (with_reference.empty()) return "";
  Columns<ListedRun> columns;
  const bool one_scenario = reports.front().name == reports.back().name;
  columns.print(one_scenario ? "algorithm" : "scenario", "", "",
                [&](const ListedRun& r) { return distinct_name(r.get(), reports); });
  add_metrics(columns, kFidelityHeadings);
  return fmt::format("\nrendered force against the reference, measured or ideal\n\n{}",
                     columns.table(with_reference).text());
}

std::vector<std::string> run_warnings(std::span<const Result> reports) {
  struct Told {
    std::string kind, text;
    std::vector<std::string> algorithms;
  };
  std::vector<Told> warnings;  // in the order of their first appearance
  for (const Result& report : reports) {
    for (const auto& [kind, pointer, text] : report.warnings) {
      if (!pointer.empty()) continue;  // told before the run
      auto known = std::ranges::find(warnings, kind, &Told::kind);
      if (known == warnings.end()) known = warnings.insert(known, {kind, report.name + ": " + text, {}});
      auto& algorithms = known->algorithms;
      // The seeds of an algorithm follow each other.
      if (algorithms.empty() || algorithms.back() != report.algorithm) algorithms.push_back(report.algorithm);
    }
  }
  std::vector<std::string> texts;
  for (const auto& [kind, text, algorithms] : warnings) {
    if (reports.size() == 1) {
      texts.push_back(text);
    } else {
      const auto others = std::span(algorithms).subspan(1);
      texts.push_back(fmt::format("{} ({}{}{})", text, algorithms[0], others.empty() ? "" : "; likewise ",
                                  fmt::join(others, ", ")));
    }
  }
  return texts;
}

std::string step_time_text(std::span<const Result> reports) {
  const auto p99_or = [](double none) {
    return [none](const Result& report) { return report.timing.step_p99.value_or(none); };
  };
  const Result& quickest = *std::ranges::min_element(reports, {}, p99_or(std::numeric_limits<double>::infinity()));
  const Result& slowest = *std::ranges::max_element(reports, {}, p99_or(0.0));
  if (!slowest.timing.step_p99) return "";
  const std::string quick = distinct_name(quickest, reports), slow = distinct_name(slowest, reports);
  const auto of = [](const Result& report, const std::string& name) {
    return fmt::format("{} ({})", time_text(*report.timing.step_p99), name);
  };
  std::string text = "99 % of the steps take at most ";
  if (reports.size() == 1) {
    text += time_text(*slowest.timing.step_p99);
    const double step = slowest.duration / static_cast<double>(slowest.end.rows);
    if (*slowest.timing.step_p99 > step)
      text += fmt::format(", longer than a step of {}: fewer points, rendering.reduction or a cheaper law",
                          time_text(step));
  } else {
    text += quick == slow ? of(slowest, slow) : of(quickest, quick) + " to " + of(slowest, slow);
  }
  return "\n" + wrapped(text, 0);
}

std::string unsettled_text(std::span<const Result> reports) {
  std::vector<std::string> names;
  bool landed = false;
  for (const Result& report : reports) {
    const MetricList& metrics = report.metrics;
    if (number_of(metrics, "steps_in_contact") == 0.0 || number_of(metrics, "force_mean_in_contact_N")) continue;
    names.push_back(distinct_name(report, reports));
    landed = landed || number_of(metrics, "landing_force_max_N");
  }
  if (names.empty()) return "";
  // In runs without landings all contact counts already.
  const std::string_view advice = landed ? "; --set metrics.from_s=0 takes all contact" : "";
  return fmt::format(
      "\n{}", wrapped(fmt::format("\"-\": under 1/30 s of settled contact ({}){}", fmt::join(names, ", "), advice), 0));
}

std::string diagnosis_text(std::span<const Result> reports) {
  std::string text;
  for (const Result& report : reports) {
    std::string rules;
    for (const Diagnosed& found : *report.diagnosis) {
      rules += fmt::format("{}{} ({:.3g})", rules.empty() ? "" : ", ", found.rule, found.value);
      if (reports.size() > 1) continue;
      const std::string unit = found.unit == "1" ? "" : " " + found.unit;
      text += wrapped(
          fmt::format("{} (rule {}: {:.3g} > {:g}{})", found.says, found.rule, found.value, found.threshold, unit), 0);
      text += wrapped("try: " + found.attempt, 2);
    }
    if (reports.size() > 1 && !rules.empty()) text += wrapped(fmt::format("wrong with {}: {}", report.name, rules), 0);
  }
  return text.empty() ? "" : "\n" + text;
}

namespace {

Columns<PlaceMetrics> place_columns() {
  Columns<PlaceMetrics> columns;
  columns.print("place", "1", "number of the target, from 0",
                [](const PlaceMetrics& p) { return std::to_string(p.place); });
  const auto add = [&columns](const char* title, const char* meaning, SubjectMean PlaceMetrics::*of, double factor) {
    columns.print(title, "1", meaning, [of, factor](const PlaceMetrics& p) {
      const SubjectMean& m = p.*of;
      if (m.subjects == 0) return std::string("-");
      return fmt::format("{} +- {}", deserved(factor * m.mean, 0.1 * factor * m.standard_error, 3),
                         significant(factor * m.standard_error, 2));
    });
  };
  add("success rate", "targets.0.success_rate.mean", &PlaceMetrics::success_rate, 1.0);
  add("completion s", "targets.0.completion_time_s.mean", &PlaceMetrics::completion_time, 1.0);
  add("model force N", "targets.0.model_force_N.mean", &PlaceMetrics::model_force, 1.0);
  add("speed mm/s", "targets.0.speed_m_per_s.mean", &PlaceMetrics::speed, 1e3);
  return columns;
}

}  // namespace

std::string targets_text(const Result& report) {
  if (!report.has_section("targets")) return "";
  return fmt::format("\n{}: targets, mean +- standard error over subjects\n\n{}", report.name,
                     place_columns().table(place_metrics(report.targets)).text());
}

Columns<LatencyRow> latency_columns() {
  Columns<LatencyRow> columns;
  const auto add_time = [&columns](const std::string& title, const std::string& meaning,
                                   std::uint64_t StepLatency::*time) {
    columns.print(title, "us", meaning, [time](const LatencyRow& r) {
      return r.latency.steps > 0 ? fmt::format("{:.3f}", static_cast<double>(r.latency.*time) / 1e3) : "-";
    });
  };
  columns.print("step latency", "", "of run --latency: the scene whose steps were timed", &LatencyRow::scenario);
  columns.print("steps", "1", "", [](const LatencyRow& r) { return r.latency.steps; });
  for (const auto& [part, time] : {std::pair{"50", &StepLatency::p50},
                                   {"95", &StepLatency::p95},
                                   {"99", &StepLatency::p99},
                                   {"99.9", &StepLatency::p99_9}}) {
    add_time(fmt::format("p{} us", part), fmt::format("what {} % of the steps take at most, each by itself [us]", part),
             time);
  }
  add_time("max us", "the longest step [us]", &StepLatency::max);
  for (std::size_t i = 0; i < std::size(kStepDeadlines); ++i) {
    columns.print(fmt::format("> {:.3f} ms", 1e3 * kStepDeadlines[i]), "1", "number of steps that took longer",
                  [i](const LatencyRow& r) { return r.latency.misses[i]; });
  }
  add_time("clock us", "what reading the clock takes, which is within each step's time [us]", &StepLatency::overhead);
  return columns;
}

std::vector<DescribedTable> run_tables() {
  Columns<ListedRun> runs = run_columns(true);
  add_metrics(runs, kFidelityHeadings);
  runs.print("ratio", "", "ratio_max", [](const ListedRun&) { return Cell(); });
  return {comparison_columns().described("comparison.csv", "of compare: one line per algorithm"), runs.described(),
          place_columns().described(), latency_columns().described()};
}

namespace {

/// Programs may read these by their place: append new ones.
constexpr const char* kComparedMetrics[] = {"force_max_N",
                                            "velocity_total_variation_m_per_s",
                                            "force_reversals",
                                            "vibration_power_above_30Hz_m2_per_s2",
                                            "depth_max_m",
                                            "ratio_min",
                                            "ratio_max",
                                            "steps_in_contact",
                                            "contact_share",
                                            "landings",
                                            "landing_force_max_N",
                                            "landing_force_step_max_N",
                                            "settled_s",
                                            "force_mean_in_contact_N",
                                            "settled_force_max_N",
                                            "force_step_p99_N",
                                            "settled_force_step_max_N",
                                            "force_rms_above_30Hz_N",
                                            "force_reversals_per_s",
                                            "reduction_changes",
                                            "reduction_force_step_max_N",
                                            "inside_max_m",
                                            "inside_settled_m",
                                            "centre_inside_share",
                                            "vibration_last_quarter_m_per_s",
                                            "fidelity.force_error_relative",
                                            "fidelity.force_direction_error_rad",
                                            "fidelity.force_artefact_share"};

}  // namespace

std::vector<ComparedRun> compared_runs(std::span<const Result> reports, std::size_t seeds) {
  std::vector<ComparedRun> runs;
  for (std::size_t i = 0; i < reports.size(); ++i) {
    const Result& run = reports[i];
    runs.push_back({i % seeds, run.algorithm, std::string(outcome_name(run.end.outcome)), run.end.rows, {}});
    for (const char* name : kComparedMetrics)
      runs.back().metrics.push_back(
          std::visit([](const auto& value) { return Cell(value); }, value_of(run.metrics, name)));
  }
  return runs;
}

Columns<ComparedRun> comparison_columns(bool seeds) {
  Columns<ComparedRun> columns;
  if (seeds) columns.add("seed", "1", "number of the repetition", &ComparedRun::seed);
  columns.add("algorithm", "", "force algorithm", &ComparedRun::algorithm);
  columns.add("outcome", "", "how the run ended", &ComparedRun::outcome);
  columns.add("steps", "1", "rows of the run", &ComparedRun::steps);
  const MetricList metrics = metrics_without_values();
  for (std::size_t i = 0; i < std::size(kComparedMetrics); ++i) {
    const Metric& metric = *find_metric(metrics, kComparedMetrics[i]);
    columns.add(metric.name, metric.unit, metric.meaning, [i](const ComparedRun& r) { return r.metrics[i]; });
  }
  return columns;
}

std::string number_text(double value, const std::optional<double>& error) {
  if (error && *error == 0.0) return significant(value, 6);
  return error && *error >= std::abs(value) ? significant(value, 1) : deserved(value, error);
}

std::string with_error_text(double value, const std::optional<double>& error) {
  return fmt::format("{} +- {}", number_text(value, error), error ? significant(*error, 1) : "?");
}

}  // namespace hapbench
