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
#include "scenarios/format/metric_sections.hpp"
#include "scenarios/format/text_lines.hpp"

namespace hapbench {
namespace {

/// A number of few characters: "1440" in place of "1.44e+03", and never "-0".
std::string cell(std::optional<double> value, int digits = 3) {
  if (value && digits < 3) value = std::stod(significant(*value, digits));
  if (value && std::abs(*value) >= 100.0 && std::abs(*value) < 1e6) return fmt::format("{:.0f}", *value);
  return significant(value.value_or(std::numeric_limits<double>::quiet_NaN()) + 0.0, digits);
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

/// The largest force, and of kRunHeadings the usual ones or all.
std::vector<RunHeading> headings_of(bool all) {
  std::vector<RunHeading> headings = {{"largest\nforce [N]", "force_max_N"}};
  for (const RunHeading& heading : kRunHeadings)
    if (all || heading.usual) headings.push_back(heading);
  return headings;
}

using ListedRun = std::reference_wrapper<const Result>;

/// How a run ended, and when, as far as that was before its last row.
std::string ending_text(const Result& report) {
  const std::string name(outcome_name(report.end.outcome));
  const auto last = number_of(report.metrics, "last_contact_s");
  switch (report.end.outcome) {
    case Outcome::leaves_hole:
    case Outcome::tool_horizontal:
      // Several trials have no time in common.
      return !report.has_section("targets") ? fmt::format("{} at {:.3g} s", name, report.duration) : name;
    case Outcome::diverges:
      return fmt::format("{} at {:.3g} s", name, report.end.divergence.time);
    case Outcome::lost_contact:
    case Outcome::went_through:
      return last ? fmt::format("{}, last contact at {:.3g} s", name, *last) : name;
    default:
      return name;
  }
}

template <class Headings>
void add_metrics(Columns<ListedRun>& columns, const Headings& headings) {
  for (const RunHeading& heading : headings) {
    columns.print(heading.title, "1", heading.metric, [heading](const ListedRun& r) -> std::string {
      const Metric* metric = find_metric(r.get().metrics, heading.metric);
      const auto value = metric == nullptr ? std::nullopt : number_of(metric->value);
      return value ? short_text(*value, metric->tolerance(), heading.factor) : "-";
    });
  }
}

Columns<ListedRun> run_columns(bool of_scenes, bool all) {
  Columns<ListedRun> columns;
  if (of_scenes) columns.print("scenario", "", "", [](const ListedRun& r) { return r.get().name; });
  columns.print("algorithm", "", "", [](const ListedRun& r) { return r.get().algorithm; });
  columns.print("how it ended", "", "outcome, and when, as far as that was before the last row", ending_text);
  add_metrics(columns, all ? headings_of(true) : shown_headings());
  if (!of_scenes || all) {
    columns.print("tool shakes\n[mm/s rms]", "1", "root of vibration_power_above_30Hz_m2_per_s2, over all rows",
                  [](const ListedRun& r) {
                    const auto power = number_of(r.get().metrics, kToolVibrationPower);
                    return power ? short_text(std::sqrt(*power), std::nullopt, 1e3) : "-";
                  });
  }
  if (!all) return columns;
  columns.print("stiffness\nratio", "1", "ratio_min", [](const ListedRun& r) {
    const auto least = number_of(r.get().metrics, "ratio_min"), most = number_of(r.get().metrics, "ratio_max");
    return least && most ? fmt::format("{}..{}", cell(least, 2), cell(most, 2)) : "-";
  });
  columns.print("half of the\nsteps [us]", "1", "step_p50_s", [](const ListedRun& r) {
    const auto& median = r.get().timing.step_p50;
    return median ? short_time(*median) : "-";
  });
  return columns;
}

/// Of runs with a reference force: measured with the stroke, or ideal.
constexpr RunHeading kFidelityHeadings[] = {
    {"force\nerror [%]", "fidelity.force_error_relative", 100.0},
    {"normal\n[N rms]", "fidelity.force_error_normal_rms_N"},
    {"tangential\n[N rms]", "fidelity.force_error_tangential_rms_N"},
    {"direction\n[deg]", "fidelity.force_direction_error_rad", 57.295779513082323},
    {"artefacts\n[%]", "fidelity.force_artefact_share", 100.0},
    {"lag\n[ms]", "fidelity.force_lag_s", 1e3}};

}  // namespace

std::vector<RunHeading> shown_headings() {
  return headings_of(output_is_in_full());
}

std::string short_text(double value, const std::optional<double>& tolerance, double factor) {
  return cell(factor * value, deserved_digits(value, tolerance, 3));
}

std::string run_table(std::span<const Result> reports, bool of_scenes) {
  const std::vector<ListedRun> runs(reports.begin(), reports.end());
  return run_columns(of_scenes, output_is_in_full()).table(runs).text();
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
  const auto p99 = [](const Result& report) { return report.timing.step_p99.value_or(0.0); };
  const Result& slowest = *std::ranges::max_element(reports, {}, p99);
  if (p99(slowest) == 0.0) return "";
  const std::string whose = reports.size() == 1 ? "" : fmt::format(" ({})", distinct_name(slowest, reports));
  const double step = slowest.duration / static_cast<double>(slowest.end.rows);
  const std::string longer =
      p99(slowest) <= step
          ? ""
          : fmt::format(", longer than a step of {}: fewer points, rendering.reduction or a cheaper law",
                        time_text(step));
  return "\n" +
         wrapped(fmt::format("99 % of the steps take at most {}{}{}", time_text(p99(slowest)), whose, longer), 0);
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
  return "\n" + wrapped(fmt::format("without mean force and vibration, as under 1/30 s in settled contact: {}{}",
                                    fmt::join(names, ", "), landed ? "; --set metrics.from_s=0 takes all contact" : ""),
                        0);
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
  columns.print("place", "1", "number of the target, from 0", &PlaceMetrics::place);
  const auto add = [&columns](const char* title, const char* meaning, SubjectMean PlaceMetrics::*of, double factor) {
    columns.print(title, "1", meaning, [of, factor](const PlaceMetrics& p) {
      const SubjectMean& m = p.*of;
      if (m.subjects == 0) return std::string("-");
      return fmt::format("{} +- {}", deserved(factor * m.mean, 0.1 * factor * m.standard_error, 3),
                         significant(factor * m.standard_error, 2));
    });
  };
  add("success rate", "targets.0.success_rate.mean", &PlaceMetrics::success_rate, 1.0);
  add("completion [s]", "targets.0.completion_time_s.mean", &PlaceMetrics::completion_time, 1.0);
  add("model force [N]", "targets.0.model_force_N.mean", &PlaceMetrics::model_force, 1.0);
  add("speed [mm/s]", "targets.0.speed_m_per_s.mean", &PlaceMetrics::speed, 1e3);
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
  Columns<ListedRun> runs = run_columns(true, true);
  add_metrics(runs, kFidelityHeadings);
  return {comparison_columns().described("comparison.csv", "of compare: one line per algorithm"), runs.described(),
          place_columns().described(), latency_columns().described()};
}

namespace {

/// Programs may read these by their place: append new ones.
constexpr std::string_view kComparedMetrics =
    "force_max_N velocity_total_variation_m_per_s force_reversals vibration_power_above_30Hz_m2_per_s2 depth_max_m "
    "ratio_min ratio_max steps_in_contact contact_share landings landing_force_max_N landing_force_step_max_N settled_s "
    "force_mean_in_contact_N settled_force_max_N force_step_p99_N settled_force_step_max_N force_rms_above_30Hz_N "
    "force_reversals_per_s reduction_changes reduction_force_step_max_N inside_max_m inside_settled_m "
    "centre_inside_share vibration_last_quarter_m_per_s fidelity.force_error_relative "
    "fidelity.force_direction_error_rad fidelity.force_artefact_share";

}  // namespace

Columns<ComparedRun> comparison_columns(bool seeds) {
  Columns<ComparedRun> columns;
  if (seeds) columns.add("seed", "1", "number of the repetition", &ComparedRun::seed);
  columns.add("algorithm", "", "force algorithm", [](const ComparedRun& r) { return r.run->algorithm; });
  columns.add("outcome", "", "how the run ended",
              [](const ComparedRun& r) { return outcome_name(r.run->end.outcome); });
  columns.add("steps", "1", "rows of the run", [](const ComparedRun& r) { return r.run->end.rows; });
  const MetricList metrics = metrics_without_values();
  for (const std::string_view name : words_of(kComparedMetrics)) {
    const Metric& metric = *find_metric(metrics, name);
    columns.add(metric.name, metric.unit, metric.meaning, [name](const ComparedRun& r) {
      return std::visit([](const auto& value) { return Cell(value); }, value_of(r.run->metrics, name));
    });
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
